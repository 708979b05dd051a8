//! `P A P^T = L D L^T` of one front, `D` with blocks of one and two: pivots of either sign, chosen inside the front.
//!
//! Bunch, Kaufman, "Some stable methods for calculating inertia and solving symmetric linear systems", Math. Comp. 31
//! (1977). The permutation stays inside the front's own columns, so the structure of the factor is that of Cholesky.

use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::lblt::factor as lblt;
use faer::{ColMut, Mat, MatMut, MatRef, Par};

use super::dense::{self, Slabs, Stop, Triangle};
use super::real::Real;

/// What a front stores beside its panel: `D` has the panel's diagonal and this subdiagonal (non-zero at the first column
/// of a block of two); column `k` of the panel is column `order[k]` of the front.
pub(super) struct Blocks<'a> {
    pub subdiagonal: &'a mut [f64],
    pub order: &'a mut [u32],
}

/// `[A; B] -> [L, D; B P^T L^-T D^-1]` and `update = -B A^-1 B^T`; a column with a zero pivot is the error.
pub(super) fn eliminate(
    panel: MatMut<'_, f64>,
    slabs: Slabs,
    update: &mut [f64],
    blocks: &mut Blocks<'_>,
    parallel: bool,
) -> Result<(), Stop> {
    let width = panel.ncols();
    let (mut top, mut bottom) = panel.split_at_row_mut(width);
    let mut memory = MemBuffer::new(lblt::cholesky_in_place_scratch::<u32, f64>(width, Par::Seq, Default::default()));
    let mut inverse = vec![0u32; width];
    let subdiagonal: DiagMut<'_, f64> = ColMut::from_slice_mut(blocks.subdiagonal).as_diagonal_mut();
    let stack = MemStack::new(&mut memory);
    lblt::cholesky_in_place(top.as_mut(), subdiagonal, blocks.order, &mut inverse, Par::Seq, stack, Default::default());
    let d = Pivot::all(top.as_ref(), blocks.subdiagonal);
    if let Some(bad) = d.iter().find(|pivot| !pivot.usable()) {
        return Err(Stop::Singular(blocks.order[bad.column] as usize));
    }
    if bottom.nrows() == 0 {
        return Ok(());
    }
    let mut times_d = Mat::from_fn(bottom.nrows(), width, |i, j| bottom[(i, blocks.order[j] as usize)]);
    dense::solve_rows(times_d.as_mut(), top.as_ref(), Triangle::UnitLower, parallel);
    bottom.copy_from(&times_d);
    for pivot in &d {
        pivot.divide_columns(bottom.as_mut());
    }
    slabs.set_minus_product(update, times_d.as_ref(), bottom.as_ref(), parallel);
    Ok(())
}

/// A block of `D`: `[a b; b c]` at two columns, or `a` at one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pivot {
    pub column: usize,
    a: f64,
    second: Option<(f64, f64)>,
}

impl Pivot {
    /// The blocks of a front's `D`.
    pub fn all(top: MatRef<'_, f64>, subdiagonal: &[f64]) -> Vec<Self> {
        let mut pivots = Vec::new();
        let mut column = 0;
        while column < top.ncols() {
            let b = subdiagonal[column];
            let second = (b != 0.0 && column + 1 < top.ncols()).then(|| (b, top[(column + 1, column + 1)]));
            pivots.push(Self { column, a: top[(column, column)], second });
            column += pivots[pivots.len() - 1].size();
        }
        pivots
    }

    pub fn size(&self) -> usize {
        if self.second.is_some() { 2 } else { 1 }
    }

    fn usable(&self) -> bool {
        match self.second {
            None => self.a.is_finite() && self.a != 0.0,
            Some((b, c)) => {
                let scaled = (self.a / b) * (c / b) - 1.0;
                scaled.is_finite() && scaled != 0.0 && b.is_finite()
            }
        }
    }

    /// Number of negative eigenvalues of the block.
    pub fn negative(&self) -> usize {
        match self.second {
            None => usize::from(self.a < 0.0),
            Some((b, c)) if (self.a / b) * (c / b) < 1.0 => 1,
            Some((_, c)) => usize::from(self.a + c < 0.0) * 2,
        }
    }

    /// `D^-1 (x, y)`; `y` is not used by a block of one.
    fn divide(&self, x: f64, y: f64) -> (f64, f64) {
        match self.second {
            None => (x / self.a, y),
            Some((b, c)) => {
                let (a, c, x, y) = (self.a / b, c / b, x / b, y / b);
                let determinant = a * c - 1.0;
                ((c * x - y) / determinant, (a * y - x) / determinant)
            }
        }
    }

    fn divide_columns(&self, mut matrix: MatMut<'_, f64>) {
        let last = self.column + self.size() - 1;
        for i in 0..matrix.nrows() {
            let (x, y) = self.divide(matrix[(i, self.column)], matrix[(i, last)]);
            matrix[(i, last)] = y;
            matrix[(i, self.column)] = x;
        }
    }

    /// `D^-1` times the block's rows.
    pub fn divide_rows<T: Real>(&self, mut matrix: MatMut<'_, T>) {
        let last = self.column + self.size() - 1;
        for j in 0..matrix.ncols() {
            let (x, y) = self.divide(matrix[(self.column, j)].double(), matrix[(last, j)].double());
            matrix[(last, j)] = T::of(y);
            matrix[(self.column, j)] = T::of(x);
        }
    }
}
