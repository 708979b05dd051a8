//! [`ShiftedFactor`]: the inverse of `A + s M` by a factor, on the null space of constraints; eigenvalues counted by pivots.

use super::inner_product::InnerProduct;
use super::{ByFactor, Eigenproblem, MassMatrix};
use crate::error::{FactorError, StructureError};
use crate::factor::factor_size::fits;
use crate::factor::symmetric::{Factor, Pivots};
use crate::pattern::matrix::SparseMatrix;
use crate::solver::LinearError;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use nastic_numeric::vector::{axpy, dot};

/// What counts as zero of a singular matrix, as a share of the largest `|A_ii| / M_ii`.
const LEAST_SHIFT: f64 = 1e-14;

/// The inverse of a positive definite `A + s M` on the null space of `B^T`.
pub(super) struct ShiftedFactor<'a> {
    factor: Factor,
    constraints: &'a [Vec<f64>],
    z: Vec<Vec<f64>>,
    schur: Cholesky<f64, Dyn>,
}

impl<'a> ShiftedFactor<'a> {
    /// # Errors
    /// [`FactorError::NotPositive`] where more has to be added.
    pub fn new(problem: &Eigenproblem, by: ByFactor<'a>, shift: f64) -> Result<Self, LinearError> {
        let bytes = by.symbolic.factor_bytes();
        if !fits(bytes) {
            return Err(LinearError::FactorTooLarge { gib: bytes as f64 / f64::from(1 << 30) });
        }
        let factor = by.symbolic.factorize(&shifted(problem, shift)?, Pivots::Positive, problem.system.parallel)?;
        let (z, schur) = schur(&factor, by.constraints);
        let schur = schur.cholesky().ok_or(LinearError::Border { scalars: by.constraints.len() })?;
        Ok(ShiftedFactor { factor, constraints: by.constraints, z, schur })
    }

    /// `(A + s M)^-1 M x` of several vectors.
    pub fn images(&self, inner: &InnerProduct, vectors: &[&[f64]]) -> Vec<Vec<f64>> {
        let mut all: Vec<f64> = vectors.iter().flat_map(|x| inner.times_mass(x)).collect();
        self.factor.solve(&mut all, vectors.len());
        let mut images: Vec<Vec<f64>> = all.chunks(inner.fixed.len()).map(<[f64]>::to_vec).collect();
        for x in &mut images {
            let slopes = DVector::from_iterator(self.z.len(), self.constraints.iter().map(|column| dot(column, x)));
            let p = self.schur.solve(&slopes);
            self.z.iter().zip(p.iter()).for_each(|(z, p)| axpy(-p, z, x));
        }
        images
    }
}

/// `A + s M`, fixed unknowns left alone.
fn shifted(problem: &Eigenproblem, s: f64) -> Result<SparseMatrix, FactorError> {
    let mut matrix = problem.system.matrix.clone();
    match problem.mass {
        MassMatrix::Diagonal(mass) => {
            let entry = |(m, &fixed): (&f64, &bool)| if fixed { 0.0 } else { s * m };
            matrix.add_diagonal(&mass.iter().zip(problem.system.fixed).map(entry).collect::<Vec<_>>());
        }
        MassMatrix::Sparse(mass) => matrix.add_scaled(s, mass).map_err(StructureError::from)?,
    }
    Ok(matrix)
}

/// Number of negative eigenvalues; of a matrix that has no factor, being singular, of those below rounding.
pub(super) fn count_negative(problem: &Eigenproblem, by: ByFactor) -> Result<usize, LinearError> {
    match count_below(problem, by, 0.0) {
        Err(error) if error.is_singular() => {
            let (diagonal, masses) = (problem.system.matrix.diagonal(), problem.mass_diagonal());
            let free = diagonal.iter().zip(&masses).zip(problem.system.fixed).filter(|(_, fixed)| !**fixed);
            let largest = free.fold(0.0, |most: f64, ((a, m), _)| most.max(a.abs() / m));
            count_below(problem, by, -LEAST_SHIFT * largest)
        }
        counted => counted,
    }
}

/// Number of eigenvalues below mu.
pub(super) fn count_below(problem: &Eigenproblem, by: ByFactor, mu: f64) -> Result<usize, LinearError> {
    let factor = by.symbolic.factorize(&shifted(problem, -mu)?, Pivots::AnySign, problem.system.parallel)?;
    if by.constraints.is_empty() {
        return Ok(factor.negative_pivots());
    }
    let (_, mut schur) = schur(&factor, by.constraints);
    // Congruence with a diagonal matrix keeps the signs, and takes the units of the constraints away.
    let size: Vec<f64> = (0..schur.nrows()).map(|k| schur.row(k).amax().sqrt().max(f64::MIN_POSITIVE)).collect();
    schur = DMatrix::from_fn(size.len(), size.len(), |i, k| schur[(i, k)] / (size[i] * size[k]));
    let of_constraints = schur.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
    Ok(factor.negative_pivots().saturating_sub(of_constraints))
}

/// `B^T A^-1 B` and the columns `A^-1 B`.
fn schur(factor: &Factor, constraints: &[Vec<f64>]) -> (Vec<Vec<f64>>, DMatrix<f64>) {
    let inverse = |column: &Vec<f64>| {
        let mut z = column.clone();
        factor.solve(&mut z, 1);
        z
    };
    let z: Vec<Vec<f64>> = constraints.iter().map(inverse).collect();
    let schur =
        DMatrix::from_fn(z.len(), z.len(), |i, k| 0.5 * (dot(&constraints[i], &z[k]) + dot(&constraints[k], &z[i])));
    (z, schur)
}
