//! The blocks on the diagonal of the matrices of cells, by sum factorisation with products of two shapes.

use super::lanes::{Lanes, Single};
use super::{CELLS, Grid, Line, MODULI, NODES, contract, splat_transposed};
use pulp::{Arch, Simd, WithSimd};
use std::array::from_fn;

/// Entries of a symmetric block: those with column `j >= i`, row by row.
pub(crate) const ENTRIES: usize = 6;

/// Sixteen cells.
pub(crate) struct DiagonalBatch<'a> {
    pub line: &'a Line,
    /// `[point][45][cell]`, with quadrature weights.
    pub moduli: &'a [f32],
    /// `[node][entry][cell]`
    pub blocks: &'a mut [f32],
}

impl DiagonalBatch<'_> {
    /// Sets the blocks: `D_ij = sum_q d_K N A_iKjM(q) d_M N`.
    pub fn compute(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for DiagonalBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = Single(simd);
        // by how many of the two shapes are differentiated along a direction
        let Line { shapes: n, derivatives: d, .. } = self.line;
        let product = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]| from_fn(|q| from_fn(|node| a[q][node] * b[q][node]));
        let pairs = [product(n, n), product(n, d), product(d, d)].map(|m| splat_transposed(lanes, &m));
        let moduli = self.moduli.as_chunks::<CELLS>().0.as_chunks::<MODULI>().0;
        let blocks = self.blocks.as_chunks_mut::<CELLS>().0;
        for part in 0..<Single<S> as Lanes>::PARTS {
            let mut sums = [[lanes.splat(0.0); NODES]; ENTRIES];
            let mut modulus = 0;
            for r in 0..9 {
                for c in r..9 {
                    let ((i, k), (j, m)) = ((r / 3, r % 3), (c / 3, c % 3));
                    let mut own: Grid<Single<S>> = from_fn(|q| lanes.load(&moduli[q][modulus], part));
                    if i == j && k != m {
                        // (K, M) and (M, K)
                        own = from_fn(|q| lanes.mul_add(own[q], lanes.splat(2.0), lanes.splat(0.0)));
                    }
                    let pair = |direction: usize| &pairs[usize::from(k == direction) + usize::from(m == direction)];
                    let zero = [lanes.splat(0.0); NODES];
                    let (mut first, mut second) = (zero, zero);
                    contract::<_, 1>(lanes, pair(0), &own, &mut first);
                    contract::<_, 3>(lanes, pair(1), &first, &mut second);
                    contract::<_, 9>(lanes, pair(2), &second, &mut sums[i * (5 - i) / 2 + j]);
                    modulus += 1;
                }
            }
            for (entry, sums) in sums.iter().enumerate() {
                for (node, sum) in sums.iter().enumerate() {
                    lanes.store(*sum, &mut blocks[ENTRIES * node + entry], part);
                }
            }
        }
    }
}
