//! The matrices of the first-order shapes on the corners of cells, at the points of second order.

use super::lanes::{Double, Lanes};
use super::{CELLS, Line, MODULI, NODES};
use pulp::{Arch, Simd, WithSimd};
use std::array::from_fn;

/// Corners of a cell, the first direction running fastest.
pub(crate) const CORNERS: usize = 8;
/// Pairs of corners `(a, b)` with `b <= a`, row by row.
pub(crate) const PAIRS: usize = CORNERS * (CORNERS + 1) / 2;

/// Sixteen cells.
pub(crate) struct CornerBatch<'a> {
    pub line: &'a Line,
    /// `[point][45][cell]`, with quadrature weights.
    pub moduli: &'a [f32],
    /// `[pair][9][cell]`: the block of a pair, row by row.
    pub matrices: &'a mut [f64],
}

impl CornerBatch<'_> {
    /// Sets the matrices. Sums are in double precision: what moves a whole cell must cancel in them.
    pub fn compute(self) {
        Arch::new().dispatch(self);
    }

    /// `[point][corner][direction]`
    fn gradients(&self) -> [[[f64; 3]; CORNERS]; NODES] {
        let Line { ends, end_derivatives, .. } = self.line;
        let along = |direction: usize, by: usize, point: usize, corner: usize| {
            let (q, end) = (point / 3_usize.pow(direction as u32) % 3, corner >> direction & 1);
            if direction == by { end_derivatives[end] } else { ends[q][end] }
        };
        from_fn(|q| from_fn(|a| from_fn(|by| (0..3).map(|direction| along(direction, by, q, a)).product())))
    }
}

impl WithSimd for CornerBatch<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let lanes = Double(simd);
        let gradients = self.gradients();
        let moduli = self.moduli.as_chunks::<CELLS>().0.as_chunks::<MODULI>().0;
        let matrices = self.matrices.as_chunks_mut::<CELLS>().0;
        for part in 0..<Double<S> as Lanes>::PARTS {
            let mut sums = [[lanes.splat(0.0); 9]; PAIRS];
            for (moduli, gradients) in moduli.iter().zip(&gradients) {
                let own: [_; MODULI] = from_fn(|k| lanes.moduli(&moduli[k], part));
                let modulus = |r: usize, c: usize| {
                    let (r, c) = (r.min(c), r.max(c));
                    own[r * (17 - r) / 2 + c]
                };
                let gradients: [[_; 3]; CORNERS] = from_fn(|a| from_fn(|k| lanes.splat(gradients[a][k])));
                let mut pair = 0;
                for a in 0..CORNERS {
                    let mut half = [[lanes.splat(0.0); 9]; 3];
                    for (i, half) in half.iter_mut().enumerate() {
                        for (c, half) in half.iter_mut().enumerate() {
                            (0..3).for_each(|k| *half = lanes.mul_add(gradients[a][k], modulus(3 * i + k, c), *half));
                        }
                    }
                    for b in 0..=a {
                        for (at, sum) in sums[pair].iter_mut().enumerate() {
                            let (i, j) = (at / 3, at % 3);
                            (0..3).for_each(|m| *sum = lanes.mul_add(half[i][3 * j + m], gradients[b][m], *sum));
                        }
                        pair += 1;
                    }
                }
            }
            for (block, sums) in sums.iter().enumerate() {
                sums.iter().enumerate().for_each(|(at, sum)| lanes.store(*sum, &mut matrices[9 * block + at], part));
            }
        }
    }
}
