//! Factors: solve, refactorise, count negative pivots.

use std::sync::Arc;

use faer::{MatMut, MatRef};

use super::bunch_kaufman::{Blocks, Pivot};
use super::numeric::{self, Breakdown};
use super::panel::{AnySign, Positive};
use super::real::Real;
use super::rotations::Rotations;
use super::solve;
use super::symbolic::Symbolic;
use crate::error::FactorError;
use crate::memory;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Preconditioner;

/// Which pivots a factorisation accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pivots {
    /// Cholesky, `L L^T`: stops at the first pivot that is not positive.
    Positive,
    /// `L D L^T` with blocks of one and two in `D`, pivoted inside the fronts: gives the inertia.
    AnySign,
}

/// In which precision a factor's numbers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 53 bits: solutions as they are.
    Double,
    /// 24 bits: a preconditioner, good to about `6e-8` times the condition number.
    Single,
}

#[derive(Clone, Debug)]
enum FactorValues {
    Double(Vec<f64>),
    /// Of the matrix times `scale`, a power of two that brings its largest entry near one.
    Single {
        values: Vec<f32>,
        scale: f64,
    },
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
    values: FactorValues,
    /// Bunch-Kaufman only, else empty.
    subdiagonal: Vec<f64>,
    order: Vec<u32>,
    rotations: Option<Arc<Rotations>>,
}

impl Symbolic {
    /// A factor of A in single precision, for [`Preconditioner`](crate::Preconditioner)s: half the memory and about half
    /// the time of a whole one. See [`Factor::approximate`].
    ///
    /// # Errors
    /// As [`factorize`](Self::factorize).
    pub fn approximate(self: &Arc<Self>, matrix: &SparseMatrix, parallel: bool) -> Result<Factor, FactorError> {
        self.check_size()?;
        let mut factor = Factor::empty(self);
        factor.approximate(matrix, parallel)?;
        Ok(factor)
    }

    /// Factorises `A = L L^T` ([`Pivots::Positive`]) or `A = L D L^T` ([`Pivots::AnySign`]).
    ///
    /// `parallel` uses all threads of the current rayon pool; the bits of the result do not depend on it.
    ///
    /// # Errors
    /// [`FactorError`]; [`StructureError::TooLarge`](crate::StructureError::TooLarge) in it when the factor would have more than 2^31 entries (17 GB).
    pub fn factorize(
        self: &Arc<Self>,
        matrix: &SparseMatrix,
        pivots: Pivots,
        parallel: bool,
    ) -> Result<Factor, FactorError> {
        self.check_size()?;
        let mut factor = Factor::empty(self);
        factor.refactorize(matrix, pivots, parallel)?;
        Ok(factor)
    }

    /// Bytes of one factorisation at its largest, predicted: the factor, and the update matrices that are alive at the same
    /// time where fronts are eliminated one after the other. (On several threads more of them are.)
    pub fn factorisation_bytes(&self, precision: Precision) -> usize {
        let size = if precision == Precision::Single { size_of::<f32>() } else { size_of::<f64>() };
        size * (self.panel_values() + self.update_values())
    }
}

impl Preconditioner for Factor {
    fn apply(&self, vector: &mut [f64]) {
        self.solve(vector, 1);
    }
}

impl Factor {
    pub(crate) fn empty(symbolic: &Arc<Symbolic>) -> Self {
        Self {
            symbolic: Arc::clone(symbolic),
            pivots: Pivots::Positive,
            usable: false,
            parallel: false,
            values: FactorValues::Double(Vec::new()),
            subdiagonal: Vec::new(),
            order: Vec::new(),
            rotations: None,
        }
    }

    /// Factorises another matrix of the same pattern in the memory of this factor.
    ///
    /// # Errors
    /// [`FactorError`]; this factor is then unusable until the next success.
    pub fn refactorize(&mut self, matrix: &SparseMatrix, pivots: Pivots, parallel: bool) -> Result<(), FactorError> {
        let symbolic = Arc::clone(&self.symbolic);
        self.begin(matrix, pivots, parallel)?;
        let extra = if pivots == Pivots::AnySign { symbolic.pattern().dofs() } else { 0 };
        self.subdiagonal.resize(extra, 0.0);
        self.order.resize(extra, 0);
        let mut values = match std::mem::replace(&mut self.values, FactorValues::Double(Vec::new())) {
            FactorValues::Double(values) => values,
            FactorValues::Single { .. } => Vec::new(),
        };
        check_memory(&symbolic, values.capacity(), Precision::Double)?;
        values.resize(symbolic.panel_values(), 0.0);
        let eliminated = match pivots {
            Pivots::Positive => {
                let panels = split(&symbolic, &mut values).into_iter().map(Positive).collect();
                numeric::factorize(&symbolic, &matrix.values, 1.0, panels, parallel)
            }
            Pivots::AnySign => {
                let panels = self.any_sign(&mut values);
                numeric::factorize(&symbolic, &matrix.values, 1.0, panels, parallel)
            }
        };
        self.values = FactorValues::Double(values);
        eliminated.map_err(|b| self.explain(b))?;
        self.usable = true;
        Ok(())
    }

    /// Factorises another matrix of the same pattern in single precision, `A = L L^T`, for a preconditioner.
    ///
    /// A matrix that is barely positive definite may be refused though [`refactorize`](Self::refactorize) takes it.
    ///
    /// # Errors
    /// [`FactorError`]; this factor is then unusable until the next success.
    pub fn approximate(&mut self, matrix: &SparseMatrix, parallel: bool) -> Result<(), FactorError> {
        let symbolic = Arc::clone(&self.symbolic);
        self.begin(matrix, Pivots::Positive, parallel)?;
        (self.subdiagonal, self.order) = (Vec::new(), Vec::new());
        let mut values = match std::mem::replace(&mut self.values, FactorValues::Double(Vec::new())) {
            FactorValues::Single { values, .. } => values,
            FactorValues::Double(_) => Vec::new(),
        };
        check_memory(&symbolic, values.capacity(), Precision::Single)?;
        values.resize(symbolic.panel_values(), 0.0);
        let largest = matrix.diagonal().iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        // Within the range of single precision, and of a power of two: nothing is rounded by it.
        let scale = if largest > 0.0 { (-largest.log2().round()).clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
        let panels = split(&symbolic, &mut values).into_iter().map(Positive).collect();
        let eliminated = numeric::factorize(&symbolic, &matrix.values, scale, panels, parallel);
        self.values = FactorValues::Single { values, scale };
        eliminated.map_err(|b| self.explain(b))?;
        self.usable = true;
        Ok(())
    }

    fn begin(&mut self, matrix: &SparseMatrix, pivots: Pivots, parallel: bool) -> Result<(), FactorError> {
        let pattern = self.symbolic.pattern();
        if !Arc::ptr_eq(matrix.pattern(), pattern) || matrix.values.len() != pattern.values() {
            return Err(FactorError::ForeignPattern);
        }
        if !matrix.beyond().is_empty() {
            return Err(FactorError::Beyond { blocks: matrix.beyond().len() });
        }
        if !matrix.is_symmetric() {
            return Err(FactorError::NotSymmetric);
        }
        self.usable = false;
        self.rotations = None;
        self.pivots = pivots;
        self.parallel = parallel;
        matrix.check_finite()
    }

    /// Notes how far the configuration is turned that the matrix belongs to, for [`CorotatedPreconditioner`](crate::CorotatedPreconditioner).
    pub fn set_rotations(&mut self, rotations: Arc<Rotations>) {
        self.rotations = Some(rotations);
    }

    /// The rotations it was given since it was made.
    pub fn rotations(&self) -> Option<&Rotations> {
        self.rotations.as_deref()
    }

    fn any_sign<'a>(&'a mut self, values: &'a mut [f64]) -> Vec<AnySign<'a>> {
        let (mut subdiagonal, mut order) = (&mut self.subdiagonal[..], &mut self.order[..]);
        let mut panels = Vec::with_capacity(self.symbolic.fronts().len());
        for (f, values) in split(&self.symbolic, values).into_iter().enumerate() {
            let width = self.symbolic.width(f);
            let subdiagonal = subdiagonal.split_off_mut(..width).unwrap_or_default();
            let order = order.split_off_mut(..width).unwrap_or_default();
            panels.push(AnySign { values, blocks: Blocks { subdiagonal, order } });
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

    /// How precise it is.
    pub fn precision(&self) -> Precision {
        match self.values {
            FactorValues::Double(_) => Precision::Double,
            FactorValues::Single { .. } => Precision::Single,
        }
    }

    /// Memory of its numbers, in bytes; the symbolic factorisation is shared and not counted.
    pub fn bytes(&self) -> usize {
        let values = match &self.values {
            FactorValues::Double(values) => size_of_val(values.as_slice()),
            FactorValues::Single { values, .. } => size_of_val(values.as_slice()),
        };
        values + size_of_val(self.subdiagonal.as_slice()) + size_of_val(self.order.as_slice())
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
        let FactorValues::Double(values) = &self.values else { return Vec::new() };
        let (top, _) = self.panel(f, values);
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
        let rhs = &mut rhs[..n * columns];
        match &self.values {
            FactorValues::Double(values) => solve::solve(self, values, rhs, columns, self.parallel),
            FactorValues::Single { values, scale } => {
                let sizes: Vec<f64> = rhs.chunks_exact_mut(n).map(normalise).collect();
                solve::solve(self, values, rhs, columns, self.parallel);
                for (column, size) in rhs.chunks_exact_mut(n).zip(sizes) {
                    column.iter_mut().for_each(|x| *x *= scale * size);
                }
            }
        }
    }

    /// The panel of front `f` among the factor's values: its square top and what stands below.
    pub(super) fn panel<'a, T>(&self, f: usize, values: &'a [T]) -> (MatRef<'a, T>, MatRef<'a, T>) {
        let (width, height) = (self.symbolic.width(f), self.symbolic.height(f));
        MatRef::from_column_major_slice(self.panel_values(f, values), height, width).split_at_row(width)
    }

    /// The same, column by column.
    pub(super) fn panel_values<'a, T>(&self, f: usize, values: &'a [T]) -> &'a [T] {
        &values[self.symbolic.fronts()[f].panel.clone()]
    }

    fn first_dof(&self, f: usize) -> usize {
        self.symbolic.pattern().dim() * self.symbolic.fronts()[f].columns.start
    }

    /// Brings the rows of front `f` into the order of its pivots.
    pub(super) fn permute<T: Real>(&self, f: usize, mut own: MatMut<'_, T>) {
        let order = &self.order[self.first_dof(f)..][..own.nrows()];
        for j in 0..own.ncols() {
            let column: Vec<T> = order.iter().map(|&k| own[(k as usize, j)]).collect();
            column.into_iter().enumerate().for_each(|(k, value)| own[(k, j)] = value);
        }
    }

    /// Undoes [`Factor::permute`].
    pub(super) fn unpermute<T: Real>(&self, f: usize, mut own: MatMut<'_, T>) {
        let order = &self.order[self.first_dof(f)..][..own.nrows()];
        for j in 0..own.ncols() {
            let column: Vec<T> = (0..own.nrows()).map(|k| own[(k, j)]).collect();
            order.iter().zip(column).for_each(|(&k, value)| own[(k as usize, j)] = value);
        }
    }
}

/// The values of every front.
fn split<'a, T>(symbolic: &Symbolic, mut values: &'a mut [T]) -> Vec<&'a mut [T]> {
    let fronts = symbolic.fronts().iter();
    fronts.map(|front| values.split_off_mut(..front.panel.len()).unwrap_or_default()).collect()
}

/// Divides by the largest entry, which is returned; single precision does not reach as far down as residuals do.
fn normalise(column: &mut [f64]) -> f64 {
    let size = column.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if size > 0.0 {
        column.iter_mut().for_each(|x| *x /= size);
    }
    size
}

/// Before a factor is allocated; one in the memory of another passes.
fn check_memory(symbolic: &Symbolic, held: usize, precision: Precision) -> Result<(), FactorError> {
    match held < symbolic.panel_values() {
        true => memory::check_factor("a factor of the tangent", symbolic.factorisation_bytes(precision)),
        false => Ok(()),
    }
}
