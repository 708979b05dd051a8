//! From element matrices in component blocks to the node blocks of the global one.

use super::block_index;

/// See [`CellKernel::scatter`](super::CellKernel::scatter).
pub(super) fn scatter<const N: usize, const NP: usize, const D: usize>(
    map: &[u32],
    matrix: &[f64],
    values: &mut [f64],
) {
    let (rows, _) = matrix.as_chunks::<NP>();
    let (blocks, _) = rows.as_chunks::<N>();
    let blocks = &blocks[..=block_index(D - 1, D - 1, D)]; // one check of the length for all
    let (columns, _) = values.as_chunks_mut::<D>();
    let (targets, _) = columns.as_chunks_mut::<D>();
    let mut codes = map.iter();
    for a in 0..N {
        for (b, &code) in (0..=a).zip(&mut codes) {
            let target = &mut targets[(code >> 1) as usize];
            let transposed = code & 1 == 1;
            for i in 0..D {
                target[i][i] += blocks[block_index(i, i, D)][a][b];
                for k in i + 1..D {
                    // K_ab and K_ba of block (i, k): entries (i, k) and (k, i) of the node block
                    let block = &blocks[block_index(i, k, D)];
                    let (upper, lower) = (block[a][b], block[b][a]);
                    let (upper, lower) = if transposed { (lower, upper) } else { (upper, lower) };
                    target[k][i] += upper;
                    target[i][k] += lower;
                }
            }
        }
    }
}

/// The same where the displacement is the first part of a node's block of so many unknowns.
pub(super) fn scatter_among<const N: usize, const NP: usize, const D: usize>(
    map: &[u32],
    matrix: &[f64],
    block: usize,
    values: &mut [f64],
) {
    let (rows, _) = matrix.as_chunks::<NP>();
    let (blocks, _) = rows.as_chunks::<N>();
    let mut codes = map.iter();
    for a in 0..N {
        for (b, &code) in (0..=a).zip(&mut codes) {
            let target = &mut values[block * block * (code >> 1) as usize..][..block * block];
            let (first, second) = if code & 1 == 1 { (b, a) } else { (a, b) };
            for i in 0..D {
                // of blocks of one component the lower triangle alone is there
                target[(block + 1) * i] += blocks[block_index(i, i, D)][a][b];
                for k in i + 1..D {
                    let own = &blocks[block_index(i, k, D)];
                    target[block * k + i] += own[first][second];
                    target[block * i + k] += own[second][first];
                }
            }
        }
    }
}
