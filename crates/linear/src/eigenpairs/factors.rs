//! [`Factors`]: a matrix that is inverted by Cholesky factors, and counts its eigenvalues.

use super::shifted_matrix::{Inverse, SearchLimits, ShiftedMatrix};
use super::{Eigenproblem, MassMatrix};
use crate::error::{FactorError, StructureError};
use crate::factor::factor_size::fits;
use crate::factor::symbolic::Symbolic;
use crate::factor::symmetric::{Factor, Pivots};
use crate::pattern::matrix::SparseMatrix;
use crate::solver::LinearError;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use nastic_numeric::vector::{axpy, dot};
use std::sync::Arc;

/// Error of the vector of a pair in the energy norm.
const TOLERANCE: f64 = 1e-9;
/// Iterations: eigenvalues that are close beyond the block need hundreds.
const MAX_ITERATIONS: usize = 400;

/// A by its entries, on the null space of `B^T`.
pub(super) struct Factors<'a> {
    matrix: &'a SparseMatrix,
    magnitudes: SparseMatrix,
    mass: MassMatrix<'a>,
    fixed: &'a [bool],
    constraints: &'a [Vec<f64>],
    symbolic: &'a Arc<Symbolic>,
    parallel: bool,
}

impl<'a> Factors<'a> {
    /// # Errors
    /// A matrix that is not symmetric, or a factor that does not fit.
    pub fn new(
        problem: &Eigenproblem<'a>,
        matrix: &'a SparseMatrix,
        constraints: &'a [Vec<f64>],
        symbolic: &'a Arc<Symbolic>,
    ) -> Result<Self, LinearError> {
        if !matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric);
        }
        if !fits(symbolic.factor_bytes()) {
            return Err(LinearError::FactorTooLarge { gib: symbolic.factor_bytes() as f64 / f64::from(1 << 30) });
        }
        let Eigenproblem { mass, fixed, parallel, .. } = *problem;
        Ok(Factors { matrix, magnitudes: matrix.magnitudes(), mass, fixed, constraints, symbolic, parallel })
    }

    /// `A + s M`, fixed unknowns left alone.
    fn shifted(&self, shift: f64) -> Result<SparseMatrix, FactorError> {
        let mut matrix = self.matrix.clone();
        match self.mass {
            MassMatrix::Diagonal(mass) => {
                let entry = |(m, &fixed): (&f64, &bool)| if fixed { 0.0 } else { shift * m };
                matrix.add_diagonal(&mass.iter().zip(self.fixed).map(entry).collect::<Vec<_>>());
            }
            MassMatrix::Sparse(mass) => matrix.add_scaled(shift, mass).map_err(StructureError::from)?,
        }
        Ok(matrix)
    }

    fn factorize(&self, shift: f64, pivots: Pivots) -> Result<Factor, FactorError> {
        if shift == 0.0 {
            return self.symbolic.factorize(self.matrix, pivots, self.parallel);
        }
        self.symbolic.factorize(&self.shifted(shift)?, pivots, self.parallel)
    }

    /// `B^T C B` and the columns `C B`, C the inverse of a factor.
    fn schur(&self, factor: &Factor) -> (Vec<Vec<f64>>, DMatrix<f64>) {
        let inverse = |column: &Vec<f64>| {
            let mut z = column.clone();
            factor.solve(&mut z, 1);
            z
        };
        let b = self.constraints;
        let z: Vec<Vec<f64>> = b.iter().map(inverse).collect();
        let schur = DMatrix::from_fn(z.len(), z.len(), |i, k| 0.5 * (dot(&b[i], &z[k]) + dot(&b[k], &z[i])));
        (z, schur)
    }
}

impl ShiftedMatrix for Factors<'_> {
    fn multiply(&self, x: &[f64], out: &mut [f64]) {
        self.matrix.multiply_on(x, out, self.parallel);
    }

    fn diagonal(&self) -> Vec<f64> {
        self.matrix.diagonal()
    }

    fn rounding(&self, vectors: &[Vec<f64>]) -> Vec<f64> {
        super::inner_product::rounding(&self.magnitudes, vectors, self.parallel)
    }

    fn inverse(&self, shift: f64) -> Result<Box<dyn Inverse + '_>, LinearError> {
        let factor = self.factorize(shift, Pivots::Positive)?;
        let (z, schur) = self.schur(&factor);
        let schur = schur.cholesky().ok_or(LinearError::Border { scalars: z.len() })?;
        Ok(Box::new(FactoredInverse { factor, constraints: self.constraints, z, schur }))
    }

    fn search_limits(&self) -> SearchLimits {
        SearchLimits { tolerance: TOLERANCE, rounding: f64::EPSILON, iterations: MAX_ITERATIONS }
    }

    fn counts(&self) -> bool {
        true
    }

    /// With constraints the number of negative pivots of `A - mu M` less the negative eigenvalues of `B^T (A - mu M)^-1 B` (Haynsworth's inertia additivity).
    fn count_below(&self, mu: f64) -> Result<Option<usize>, LinearError> {
        let factor = self.factorize(-mu, Pivots::AnySign)?;
        if self.constraints.is_empty() {
            return Ok(Some(factor.negative_pivots()));
        }
        let (_, mut schur) = self.schur(&factor);
        // Congruence with a diagonal matrix keeps the signs, and takes the units of the constraints away.
        let size: Vec<f64> = (0..schur.nrows()).map(|k| schur.row(k).amax().sqrt().max(f64::MIN_POSITIVE)).collect();
        schur = DMatrix::from_fn(size.len(), size.len(), |i, k| schur[(i, k)] / (size[i] * size[k]));
        let of_constraints = schur.symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
        Ok(Some(factor.negative_pivots().saturating_sub(of_constraints)))
    }
}

/// The inverse C of a positive definite matrix on the null space of `B^T`: `C - C B S^-1 B^T C`, `S = B^T C B`.
struct FactoredInverse<'a> {
    factor: Factor,
    constraints: &'a [Vec<f64>],
    /// `C B`.
    z: Vec<Vec<f64>>,
    schur: Cholesky<f64, Dyn>,
}

impl Inverse for FactoredInverse<'_> {
    fn apply(&self, columns: &mut [f64], count: usize) {
        self.factor.solve(columns, count);
        let length = columns.len() / count.max(1);
        columns.chunks_mut(length.max(1)).for_each(|x| self.constrain(x));
    }

    fn constrain(&self, x: &mut [f64]) {
        let slopes = DVector::from_iterator(self.z.len(), self.constraints.iter().map(|column| dot(column, x)));
        let p = self.schur.solve(&slopes);
        self.z.iter().zip(p.iter()).for_each(|(z, p)| axpy(-p, z, x));
    }
}
