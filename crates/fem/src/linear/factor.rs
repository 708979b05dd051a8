//! Factors and what is done with them: solve, refactorise, count negative pivots.

use std::sync::Arc;

use faer::{MatMut, MatRef};

use super::bunch_kaufman::{Blocks, Pivot};
use super::error::FactorError;
use super::matrix::SymmetricMatrix;
use super::numeric::{self, Breakdown, Panel};
use super::rotations::Rotations;
use super::solve;
use super::symbolic::Symbolic;

/// Which pivots a factorisation accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pivots {
    /// Cholesky, `L L^T`: stops at the first pivot that is not positive.
    Positive,
    /// `L D L^T` with blocks of one and two in `D`, pivoted inside the fronts: gives the inertia.
    AnySign,
}

/// A factorised matrix.
///
/// After a failed [`Factor::refactorize`] it holds no factor, and solutions are NaN.
#[derive(Clone, Debug)]
pub struct Factor {
    symbolic: Arc<Symbolic>,
    pivots: Pivots,
    usable: bool,
    parallel: bool,
    values: Vec<f64>,
    /// Bunch-Kaufman only, else empty.
    subdiagonal: Vec<f64>,
    order: Vec<u32>,
    rotations: Option<Arc<Rotations>>,
}

impl Factor {
    pub(super) fn empty(symbolic: &Arc<Symbolic>) -> Self {
        Self {
            symbolic: Arc::clone(symbolic),
            pivots: Pivots::Positive,
            usable: false,
            parallel: false,
            values: vec![0.0; symbolic.panel_values()],
            subdiagonal: Vec::new(),
            order: Vec::new(),
            rotations: None,
        }
    }

    /// Factorises another matrix of the same pattern in the memory of this factor.
    ///
    /// # Errors
    /// [`FactorError`]; this factor is then unusable until the next success.
    pub fn refactorize(&mut self, matrix: &SymmetricMatrix, pivots: Pivots, parallel: bool) -> Result<(), FactorError> {
        let symbolic = Arc::clone(&self.symbolic);
        if !Arc::ptr_eq(matrix.pattern(), symbolic.pattern()) || matrix.values.len() != symbolic.pattern().values() {
            return Err(FactorError::ForeignPattern);
        }
        self.usable = false;
        self.rotations = None;
        self.pivots = pivots;
        self.parallel = parallel;
        matrix.check_finite()?;
        let extra = if pivots == Pivots::AnySign { symbolic.pattern().dofs() } else { 0 };
        self.subdiagonal.resize(extra, 0.0);
        self.order.resize(extra, 0);
        numeric::factorize(&symbolic, &matrix.values, self.panels(), parallel).map_err(|b| self.explain(b))?;
        self.usable = true;
        Ok(())
    }

    /// Notes how far the configuration is turned that the matrix belongs to, for [`Turned`](super::Turned).
    pub fn stand_in(&mut self, rotations: Arc<Rotations>) {
        self.rotations = Some(rotations);
    }

    /// The rotations it was told of since it was made.
    pub fn rotations(&self) -> Option<&Rotations> {
        self.rotations.as_deref()
    }

    fn panels(&mut self) -> Vec<Panel<'_>> {
        let mut values = &mut self.values[..];
        let (mut subdiagonal, mut order) = (&mut self.subdiagonal[..], &mut self.order[..]);
        let mut panels = Vec::with_capacity(self.symbolic.fronts().len());
        for (f, front) in self.symbolic.fronts().iter().enumerate() {
            let own = values.split_off_mut(..front.panel.len()).unwrap_or_default();
            let width = self.symbolic.width(f);
            let blocks = match (subdiagonal.split_off_mut(..width), order.split_off_mut(..width)) {
                (Some(subdiagonal), Some(order)) => Some(Blocks { subdiagonal, order }),
                _ => None,
            };
            panels.push(Panel { values: own, blocks });
        }
        panels
    }

    fn explain(&self, breakdown: Breakdown) -> FactorError {
        let pattern = self.symbolic.pattern();
        let dim = pattern.dim();
        let node = pattern.ordering().new_to_old()[breakdown.dof / dim] as usize;
        let component = breakdown.dof % dim;
        if breakdown.singular {
            FactorError::Singular { node, component }
        } else {
            FactorError::NotPositive { node, component }
        }
    }

    /// The symbolic factorisation it rests on.
    pub fn symbolic(&self) -> &Arc<Symbolic> {
        &self.symbolic
    }

    /// Which pivots were accepted.
    pub fn pivots(&self) -> Pivots {
        self.pivots
    }

    /// Memory of its numbers, in bytes; the symbolic factorisation is shared and not counted.
    pub fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
            + size_of_val(self.subdiagonal.as_slice())
            + size_of_val(self.order.as_slice())
    }

    /// Whether the last factorisation succeeded.
    pub fn is_usable(&self) -> bool {
        self.usable
    }

    /// Number of negative pivots: by Sylvester's law of inertia the number of negative eigenvalues of the matrix.
    pub fn negative_pivots(&self) -> usize {
        if self.pivots == Pivots::Positive || !self.usable {
            return 0;
        }
        (0..self.symbolic.fronts().len()).flat_map(|f| self.diagonal_blocks(f)).map(|pivot| pivot.negative()).sum()
    }

    /// The blocks of `D` in front `f`.
    pub(super) fn diagonal_blocks(&self, f: usize) -> Vec<Pivot> {
        let (top, _) = self.panel(f);
        let first = self.first_dof(f);
        Pivot::all(top, &self.subdiagonal[first..first + top.ncols()])
    }

    /// `A x = b` for `columns` right-hand sides at once: `rhs` holds one after the other, dofs by mesh node, and is
    /// overwritten by the solutions. Sixteen columns cost about 2.5 times one.
    pub fn solve(&self, rhs: &mut [f64], columns: usize) {
        if !self.usable {
            rhs.fill(f64::NAN);
            return;
        }
        let n = self.symbolic.pattern().dofs();
        if n == 0 || columns == 0 {
            return;
        }
        solve::solve(self, &mut rhs[..n * columns], columns, self.parallel);
    }

    /// The panel of front `f`: its square top and what stands below.
    pub(super) fn panel(&self, f: usize) -> (MatRef<'_, f64>, MatRef<'_, f64>) {
        let (width, height) = (self.symbolic.width(f), self.symbolic.height(f));
        let values = &self.values[self.symbolic.fronts()[f].panel.clone()];
        MatRef::from_column_major_slice(values, height, width).split_at_row(width)
    }

    fn first_dof(&self, f: usize) -> usize {
        self.symbolic.pattern().dim() * self.symbolic.fronts()[f].columns.start
    }

    /// Brings the rows of front `f` into the order of its pivots.
    pub(super) fn permute(&self, f: usize, mut own: MatMut<'_, f64>) {
        let order = &self.order[self.first_dof(f)..][..own.nrows()];
        for j in 0..own.ncols() {
            let column: Vec<f64> = order.iter().map(|&k| own[(k as usize, j)]).collect();
            column.into_iter().enumerate().for_each(|(k, value)| own[(k, j)] = value);
        }
    }

    /// Undoes [`Factor::permute`].
    pub(super) fn unpermute(&self, f: usize, mut own: MatMut<'_, f64>) {
        let order = &self.order[self.first_dof(f)..][..own.nrows()];
        for j in 0..own.ncols() {
            let column: Vec<f64> = (0..own.nrows()).map(|k| own[(k, j)]).collect();
            order.iter().zip(column).for_each(|(&k, value)| own[(k as usize, j)] = value);
        }
    }
}
