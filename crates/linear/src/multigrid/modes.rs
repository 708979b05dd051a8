//! Rigid motions: what an elastic body resists least, and what every level must therefore represent.

use super::chunks;

/// Number of rigid motions of a body with `dim` displacement components (1: shifts alone).
pub(super) fn count(dim: usize) -> usize {
    dim * (dim + 1) / 2
}

/// The rigid motions of points, `dim x count(dim)` values per node, column by column: shifts, then rotations about the
/// body's centre over its size. Components of `fixed` unknowns are zero.
///
/// Points are the current ones: a turned piece of a body resists rotations of its present shape least.
pub(super) fn rigid_motions(points: &[[f64; 3]], dim: usize, fixed: &[bool], parallel: bool) -> Vec<f64> {
    let n = points.len().max(1) as f64;
    let centre = [0, 1, 2].map(|k| points.iter().map(|x| x[k]).sum::<f64>() / n);
    let reach = points.iter().map(|x| (0..3).map(|k| (x[k] - centre[k]).powi(2)).sum::<f64>()).fold(0.0, f64::max);
    let reach = if reach > 0.0 { reach.sqrt() } else { 1.0 };
    let size = dim * count(dim);
    let mut modes = vec![0.0; points.len() * size];
    chunks::each(chunks::rows(&mut modes, size).collect(), parallel, |k, modes: &mut [f64]| {
        for (node, modes) in (chunks::CHUNK * k..).zip(modes.chunks_exact_mut(size)) {
            let r = [0, 1, 2].map(|k| (points[node][k] - centre[k]) / reach);
            for (at, value) in modes.iter_mut().enumerate() {
                let (mode, c) = (at / dim, at % dim);
                *value = if fixed[dim * node + c] { 0.0 } else { component(dim, mode, c, &r) };
            }
        }
    });
    modes
}

fn component(dim: usize, mode: usize, c: usize, r: &[f64; 3]) -> f64 {
    if mode < dim {
        return f64::from(u8::from(mode == c));
    }
    match (dim, mode, c) {
        (2, 2, 0) | (3, 5, 0) => -r[1],
        (2, 2, 1) | (3, 5, 1) => r[0],
        (3, 3, 1) => -r[2],
        (3, 3, 2) => r[1],
        (3, 4, 0) => r[2],
        (3, 4, 2) => -r[0],
        _ => 0.0,
    }
}
