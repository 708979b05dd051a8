//! Loops over rows in chunks of fixed size, on one thread or on all: the same bits.

use std::ops::Range;

use rayon::prelude::*;

/// Block rows handled by one task. Fixed, so that nothing depends on the number of threads.
pub(super) const CHUNK: usize = 512;

/// The results of a function for every chunk of rows, in their order.
pub(super) fn map<T: Send>(rows: usize, parallel: bool, make: impl Fn(Range<usize>) -> T + Sync + Send) -> Vec<T> {
    let chunk = |k: usize| make(CHUNK * k..(CHUNK * (k + 1)).min(rows));
    let chunks = 0..rows.div_ceil(CHUNK);
    if parallel && chunks.len() > 1 { chunks.into_par_iter().map(chunk).collect() } else { chunks.map(chunk).collect() }
}

/// Calls with the number of every part and the part.
pub(super) fn each<T: Send>(parts: Vec<T>, parallel: bool, work: impl Fn(usize, T) + Sync + Send) {
    each_with(parts, parallel, || (), |(), k, part| work(k, part));
}

/// The same, with working memory that is made once per thread or so.
pub(super) fn each_with<T: Send, W>(
    parts: Vec<T>,
    parallel: bool,
    memory: impl Fn() -> W + Sync + Send,
    work: impl Fn(&mut W, usize, T) + Sync + Send,
) {
    if parallel && parts.len() > 1 {
        parts.into_par_iter().enumerate().for_each_init(memory, |memory, (k, part)| work(memory, k, part));
    } else {
        let mut memory = memory();
        parts.into_iter().enumerate().for_each(|(k, part)| work(&mut memory, k, part));
    }
}

/// Values, `size` per row, in chunks of rows.
pub(super) fn rows<T>(values: &mut [T], size: usize) -> std::slice::ChunksMut<'_, T> {
    values.chunks_mut(CHUNK * size)
}
