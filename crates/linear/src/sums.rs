//! Vectors by chunks of fixed length, on one thread or on all: the same bits.

use nastic_numeric::vector;
use rayon::prelude::*;

/// Numbers of one chunk: a vector that fits is summed as elsewhere.
const CHUNK_LENGTH: usize = 1 << 15;

/// `a . b`.
pub(crate) fn dot(a: &[f64], b: &[f64], parallel: bool) -> f64 {
    if parallel && a.len() > CHUNK_LENGTH {
        let parts: Vec<f64> =
            a.par_chunks(CHUNK_LENGTH).zip(b.par_chunks(CHUNK_LENGTH)).map(|(a, b)| vector::dot(a, b)).collect();
        return parts.iter().sum();
    }
    a.chunks(CHUNK_LENGTH).zip(b.chunks(CHUNK_LENGTH)).map(|(a, b)| vector::dot(a, b)).sum()
}

/// `|a|`, Euclidean.
pub(crate) fn norm(a: &[f64], parallel: bool) -> f64 {
    dot(a, a, parallel).sqrt()
}

/// Calls with every entry of y and that of x.
pub(crate) fn zipped(y: &mut [f64], x: &[f64], parallel: bool, change: impl Fn(&mut f64, f64) + Sync) {
    let chunk = |(y, x): (&mut [f64], &[f64])| y.iter_mut().zip(x).for_each(|(y, &x)| change(y, x));
    if parallel && y.len() > CHUNK_LENGTH {
        y.par_chunks_mut(CHUNK_LENGTH).zip(x.par_chunks(CHUNK_LENGTH)).for_each(chunk);
    } else {
        chunk((y, x));
    }
}

/// `a . b` with a in single precision.
pub(crate) fn dot_single(a: &[f32], b: &[f64], parallel: bool) -> f64 {
    let part = |(a, b): (&[f32], &[f64])| a.iter().zip(b).map(|(&a, b)| f64::from(a) * b).sum::<f64>();
    if parallel && a.len() > CHUNK_LENGTH {
        let parts: Vec<f64> = a.par_chunks(CHUNK_LENGTH).zip(b.par_chunks(CHUNK_LENGTH)).map(part).collect();
        return parts.iter().sum();
    }
    a.chunks(CHUNK_LENGTH).zip(b.chunks(CHUNK_LENGTH)).map(part).sum()
}

/// `y += factor x` with x in single precision.
pub(crate) fn add_single(factor: f64, x: &[f32], y: &mut [f64], parallel: bool) {
    let chunk = |(y, x): (&mut [f64], &[f32])| y.iter_mut().zip(x).for_each(|(y, &x)| *y += factor * f64::from(x));
    if parallel && y.len() > CHUNK_LENGTH {
        y.par_chunks_mut(CHUNK_LENGTH).zip(x.par_chunks(CHUNK_LENGTH)).for_each(chunk);
    } else {
        chunk((y, x));
    }
}
