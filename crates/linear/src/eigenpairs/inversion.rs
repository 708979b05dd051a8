//! [`Inversion`]: A of an eigenproblem, and how `A + s M` is inverted.

use super::Eigenproblem;
use super::cycles::Cycles;
use super::factors::Factors;
use super::shifted_matrix::ShiftedMatrix;
use crate::factor::symbolic::Symbolic;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Operator;
use crate::solver::{LinearError, System};
use std::sync::Arc;

/// A, symmetric, and how `A + s M` is inverted.
#[derive(Clone, Copy)]
pub enum Inversion<'a> {
    /// By Cholesky factors, exactly, which also count the eigenvalues; with constraints the problem is `A x + B p = lambda M x`, `B^T x = 0`.
    Factors {
        /// A, with rows and columns of fixed unknowns replaced by positive multiples of those of the identity.
        matrix: &'a SparseMatrix,
        /// Columns of B, zero where fixed: the pairs are those on the null space of `B^T`. Empty for all.
        constraints: &'a [Vec<f64>],
        /// The symbolic factorisation of A.
        symbolic: &'a Arc<Symbolic>,
    },
    /// Approximately, by cycles of multigrid.
    Cycles {
        /// `out = A v`, zero where fixed for a v that is.
        product: &'a dyn Operator,
        /// A, or a matrix close to it, for the levels of multigrid.
        system: System<'a>,
    },
}

impl<'a> Inversion<'a> {
    /// The number of constraints.
    pub(super) fn constraints(&self) -> usize {
        match self {
            Self::Factors { constraints, .. } => constraints.len(),
            Self::Cycles { .. } => 0,
        }
    }

    /// What the search needs of it.
    pub(super) fn on(&self, problem: &Eigenproblem<'a>) -> Result<Box<dyn ShiftedMatrix + 'a>, LinearError> {
        Ok(match *self {
            Self::Factors { matrix, constraints, symbolic } => {
                Box::new(Factors::new(problem, matrix, constraints, symbolic)?)
            }
            Self::Cycles { product, system } => Box::new(Cycles::new(problem, product, system)),
        })
    }
}
