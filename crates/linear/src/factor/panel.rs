//! [`Panel`]: the numbers of one front, and how its pivots are eliminated.

use faer::MatMut;

use super::bunch_kaufman::{self, Blocks};
use super::dense::{self, Slabs, Stop};
use super::real::Real;

/// The numbers of one front, borrowed from the factor: `height x width` values, and what an elimination adds to them.
pub(super) trait Panel: Send {
    /// In which precision.
    type Number: Real;

    /// Column by column.
    fn values(&mut self) -> &mut [Self::Number];

    /// `[A; B] -> [L; B L^-T]` (or what takes its place) and `update = -B A^-1 B^T`, with A of `width` columns.
    fn eliminate(
        &mut self,
        width: usize,
        slabs: Slabs,
        update: &mut [Self::Number],
        parallel: bool,
    ) -> Result<(), Stop>;
}

/// Cholesky.
pub(super) struct Positive<'a, T>(pub &'a mut [T]);

impl<T: Real> Panel for Positive<'_, T> {
    type Number = T;

    fn values(&mut self) -> &mut [T] {
        self.0
    }

    fn eliminate(&mut self, width: usize, slabs: Slabs, update: &mut [T], parallel: bool) -> Result<(), Stop> {
        let mut panel = matrix(self.0, width);
        dense::cholesky(panel.as_mut(), parallel)?;
        let below = panel.as_ref().subrows(width, panel.nrows() - width);
        slabs.set_minus_product(update, below, below, parallel);
        Ok(())
    }
}

/// Bunch-Kaufman.
pub(super) struct AnySign<'a> {
    pub values: &'a mut [f64],
    pub blocks: Blocks<'a>,
}

impl Panel for AnySign<'_> {
    type Number = f64;

    fn values(&mut self) -> &mut [f64] {
        self.values
    }

    fn eliminate(&mut self, width: usize, slabs: Slabs, update: &mut [f64], parallel: bool) -> Result<(), Stop> {
        bunch_kaufman::eliminate(matrix(self.values, width), slabs, update, &mut self.blocks, parallel)
    }
}

fn matrix<T>(values: &mut [T], width: usize) -> MatMut<'_, T> {
    let height = values.len().checked_div(width).unwrap_or(0);
    MatMut::from_column_major_slice_mut(values, height, width)
}
