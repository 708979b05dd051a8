//! [`Transfer`]: the way from a level to the next and back.

use super::chunks::{self, CHUNK};
use super::couplings::BlockRows;

/// Calls a function generic over the sizes of blocks on two levels, and over the second one padded to registers; those that
/// occur are components of a displacement and rigid motions in one to three dimensions.
macro_rules! with_shape {
    ($shape:expr, $($call:ident).+ ( $($argument:expr),* )) => {
        match $shape {
            (3, 3) => $($call).+::<3, 3, 4>($($argument),*),
            (3, _) => $($call).+::<3, 6, 8>($($argument),*),
            (6, _) => $($call).+::<6, 6, 8>($($argument),*),
            (2, 2) => $($call).+::<2, 2, 2>($($argument),*),
            (2, _) => $($call).+::<2, 3, 4>($($argument),*),
            _ => $($call).+::<1, 1, 1>($($argument),*),
        }
    };
}
pub(super) use with_shape;

/// A prolongator P of `shape.0 x shape.1` blocks, and the rows of its transpose.
///
/// The values are in single precision. The Galerkin product is made of them as they are, so that rigid motions, which they
/// represent to 1e-7, gain an energy of 1e-14 of the stiffest motions.
#[derive(Debug)]
pub(super) struct Transfer {
    pub shape: (usize, usize),
    pub rows: BlockRows,
    /// Every block row by row.
    pub values: Vec<f32>,
    /// By column of P: where it begins in `back`.
    pub back_starts: Vec<usize>,
    /// Row and number of every block, by columns, rows ascending.
    pub back: Vec<(u32, u32)>,
}

impl Transfer {
    /// One without values yet.
    pub fn new(shape: (usize, usize), rows: BlockRows) -> Self {
        let mut starts = vec![0; rows.block_columns + 1];
        rows.columns.iter().for_each(|&j| starts[j as usize + 1] += 1);
        (0..rows.block_columns).for_each(|j| starts[j + 1] += starts[j]);
        let (mut next, mut back) = (starts.clone(), vec![(0, 0); rows.columns.len()]);
        for i in 0..rows.rows() {
            for k in rows.row(i) {
                let at = &mut next[rows.columns[k] as usize];
                back[*at] = (i as u32, k as u32);
                *at += 1;
            }
        }
        Transfer { shape, rows, values: Vec::new(), back_starts: starts, back }
    }

    /// The blocks.
    pub fn blocks<const R: usize, const C: usize>(&self) -> &[[[f32; C]; R]] {
        self.values.as_chunks::<C>().0.as_chunks::<R>().0
    }

    /// `y = P x`.
    pub fn prolong(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        with_shape!(self.shape, self.prolong_blocks(x, y, parallel));
    }

    fn prolong_blocks<const R: usize, const C: usize, const W: usize>(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        let ((x, _), blocks) = (x.as_chunks::<C>(), self.blocks::<R, C>());
        let parts = chunks::rows(y.as_chunks_mut::<R>().0, 1).collect();
        chunks::each(parts, parallel, |k, y: &mut [[f64; R]]| {
            for (i, y) in y.iter_mut().enumerate() {
                let row = self.rows.row(CHUNK * k + i);
                *y = [0.0; R];
                for (block, &j) in blocks[row.clone()].iter().zip(&self.rows.columns[row]) {
                    let x = &x[j as usize];
                    for r in 0..R {
                        y[r] += (0..C).map(|c| f64::from(block[r][c]) * x[c]).sum::<f64>();
                    }
                }
            }
        });
    }

    /// `y = P^T x`.
    pub fn restrict(&self, x: &[f64], y: &mut [f64], parallel: bool) {
        with_shape!(self.shape, self.restrict_blocks(x, y, parallel));
    }

    fn restrict_blocks<const R: usize, const C: usize, const W: usize>(
        &self,
        x: &[f64],
        y: &mut [f64],
        parallel: bool,
    ) {
        let ((x, _), blocks) = (x.as_chunks::<R>(), self.blocks::<R, C>());
        // a row of the transpose has a hundred blocks or so
        let few = CHUNK / 16;
        let parts = y.as_chunks_mut::<C>().0.chunks_mut(few).collect();
        chunks::each(parts, parallel, |k, y: &mut [[f64; C]]| {
            for (j, y) in y.iter_mut().enumerate() {
                *y = [0.0; C];
                for &(i, at) in self.column(few * k + j) {
                    let (x, block) = (&x[i as usize], &blocks[at as usize]);
                    for r in 0..R {
                        for c in 0..C {
                            y[c] += f64::from(block[r][c]) * x[r];
                        }
                    }
                }
            }
        });
    }

    /// Row and number of every block of a column.
    pub fn column(&self, j: usize) -> &[(u32, u32)] {
        &self.back[self.back_starts[j]..self.back_starts[j + 1]]
    }
}
