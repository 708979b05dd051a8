//! Dense kernels of one front, cut into tiles that threads may share.
//!
//! The tiles depend on sizes alone, never on the number of threads, and so do the bits of the result.

use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor as llt;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use super::real::Real;

/// Rows and columns of the largest tile.
const MAX_TILE: usize = 384;

/// Runs both, on two threads if `parallel`.
fn join(parallel: bool, a: impl FnOnce() + Send, b: impl FnOnce() + Send) {
    if parallel {
        rayon::join(a, b);
    } else {
        a();
        b();
    }
}

/// Why, and at which column, an elimination stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    NotPositive(usize),
    Singular(usize),
}

/// `[A; B] -> [L; B L^-T]` with `A = L L^T`; only the lower triangle of `A` is read.
pub(super) fn cholesky<T: Real>(panel: MatMut<'_, T>, parallel: bool) -> Result<(), Stop> {
    let width = panel.ncols();
    if width > MAX_TILE {
        let half = width / 2;
        let (mut left, right) = panel.split_at_col_mut(half);
        cholesky(left.as_mut(), parallel)?;
        let mut right = right.subrows_mut(half, left.nrows() - half);
        let below = left.as_ref().subrows(half, right.nrows());
        let (beside, rest) = below.split_at_row(width - half);
        let (top, bottom) = right.as_mut().split_at_row_mut(width - half);
        join(
            parallel,
            || minus_symmetric_product(top, Accum::Add, beside, beside, parallel),
            || minus_product(bottom, Accum::Add, rest, beside, parallel),
        );
        return cholesky(right, parallel).map_err(|stop| stop.shifted(half));
    }
    let (mut top, bottom) = panel.split_at_row_mut(width);
    let mut memory = MemBuffer::new(llt::cholesky_in_place_scratch::<T>(width, Par::Seq, Default::default()));
    let stack = MemStack::new(&mut memory);
    llt::cholesky_in_place(top.as_mut(), Default::default(), Par::Seq, stack, Default::default())
        .map_err(|llt::LltError::NonPositivePivot { index }| Stop::NotPositive(index))?;
    if let Some(column) = (0..width).find(|&j| !top[(j, j)].double().is_finite()) {
        return Err(Stop::Singular(column));
    }
    solve_rows(bottom, top.as_ref(), Triangle::Lower, parallel);
    Ok(())
}

impl Stop {
    fn shifted(self, columns: usize) -> Self {
        match self {
            Self::NotPositive(column) => Self::NotPositive(column + columns),
            Self::Singular(column) => Self::Singular(column + columns),
        }
    }
}

/// Diagonal of a triangular matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Triangle {
    Lower,
    UnitLower,
}

/// `B -> B L^-T`.
pub(super) fn solve_rows<T: Real>(b: MatMut<'_, T>, l: MatRef<'_, T>, kind: Triangle, parallel: bool) {
    let rows = b.nrows();
    if rows > MAX_TILE {
        let (upper, lower) = b.split_at_row_mut(rows / 2);
        join(parallel, || solve_rows(upper, l, kind, parallel), || solve_rows(lower, l, kind, parallel));
    } else if rows > 0 {
        match kind {
            Triangle::Lower => triangular_solve::solve_lower_triangular_in_place(l, b.transpose_mut(), Par::Seq),
            Triangle::UnitLower => {
                triangular_solve::solve_unit_lower_triangular_in_place(l, b.transpose_mut(), Par::Seq);
            }
        }
    }
}

/// The lower triangle of a symmetric matrix in slabs of [`MAX_TILE`] columns, each a dense column-major block that starts at
/// its diagonal: half the memory of the square, and columns stay contiguous.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slabs {
    size: usize,
}

impl Slabs {
    pub fn new(size: usize) -> Self {
        Self { size }
    }

    /// Number of values.
    pub fn values(self) -> usize {
        self.slabs().map(|(first, width)| (self.size - first) * width).sum()
    }

    /// First column and width of each slab.
    fn slabs(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.size).step_by(MAX_TILE).map(move |first| (first, MAX_TILE.min(self.size - first)))
    }

    /// Where column `j` is stored, and its first row there (that of its slab, at most `j`).
    pub fn column(self, j: usize) -> (Range<usize>, usize) {
        let slab = j / MAX_TILE;
        let first = MAX_TILE * slab;
        // The slabs before have size, size - MAX_TILE, ... rows of MAX_TILE values.
        let before = MAX_TILE * (slab * self.size - MAX_TILE * (slab * slab.saturating_sub(1) / 2));
        let start = before + (j - first) * (self.size - first);
        (start..start + self.size - first, first)
    }

    /// `-X Y^T`, lower triangle of a symmetric product.
    pub fn set_minus_product<T: Real>(self, values: &mut [T], x: MatRef<'_, T>, y: MatRef<'_, T>, parallel: bool) {
        let mut rest = values;
        let mut slabs = Vec::new();
        for (first, width) in self.slabs() {
            let rows = self.size - first;
            let own = rest.split_off_mut(..rows * width).unwrap_or_default();
            slabs.push((
                MatMut::from_column_major_slice_mut(own, rows, width),
                x.subrows(first, rows),
                y.subrows(first, width),
            ));
        }
        let set = |(slab, x, y): (MatMut<'_, T>, MatRef<'_, T>, MatRef<'_, T>)| {
            let width = slab.ncols();
            let (corner, below) = slab.split_at_row_mut(width);
            let (x_corner, x_below) = x.split_at_row(width);
            minus_symmetric_product(corner, Accum::Replace, x_corner, y, parallel);
            minus_product(below, Accum::Replace, x_below, y, parallel);
        };
        if parallel { slabs.into_par_iter().for_each(set) } else { slabs.into_iter().for_each(set) }
    }
}

/// Lower triangle of `C = -X Y^T` or `C -= X Y^T`, for a symmetric product.
fn minus_symmetric_product<T: Real>(
    c: MatMut<'_, T>,
    accum: Accum,
    x: MatRef<'_, T>,
    y: MatRef<'_, T>,
    parallel: bool,
) {
    let n = c.nrows();
    if n > MAX_TILE {
        let (left, right) = c.split_at_col_mut(n / 2);
        let (corner, below) = left.split_at_row_mut(n / 2);
        let ((x_upper, x_lower), (y_upper, y_lower)) = (x.split_at_row(n / 2), y.split_at_row(n / 2));
        let triangles = || {
            join(
                parallel,
                || minus_symmetric_product(corner, accum, x_upper, y_upper, parallel),
                || minus_symmetric_product(right.subrows_mut(n / 2, n - n / 2), accum, x_lower, y_lower, parallel),
            );
        };
        join(parallel, triangles, || minus_product(below, accum, x_lower, y_upper, parallel));
    } else if n > 0 {
        let (lower, full) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
        triangular::matmul(c, lower, accum, x, full, y.transpose(), full, T::of(-1.0), Par::Seq);
    }
}

/// `C = -X Y^T` or `C -= X Y^T`.
fn minus_product<T: Real>(c: MatMut<'_, T>, accum: Accum, x: MatRef<'_, T>, y: MatRef<'_, T>, parallel: bool) {
    let (rows, columns) = (c.nrows(), c.ncols());
    if rows > 2 * MAX_TILE && rows >= columns {
        let (upper, lower) = c.split_at_row_mut(rows / 2);
        let (x_upper, x_lower) = x.split_at_row(rows / 2);
        join(
            parallel,
            || minus_product(upper, accum, x_upper, y, parallel),
            || minus_product(lower, accum, x_lower, y, parallel),
        );
    } else if columns > 2 * MAX_TILE {
        let (left, right) = c.split_at_col_mut(columns / 2);
        let (y_left, y_right) = y.split_at_row(columns / 2);
        join(
            parallel,
            || minus_product(left, accum, x, y_left, parallel),
            || minus_product(right, accum, x, y_right, parallel),
        );
    } else if rows > 0 && columns > 0 {
        matmul(c, accum, x, y.transpose(), T::of(-1.0), Par::Seq);
    }
}
