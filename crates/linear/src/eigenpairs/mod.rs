//! Smallest eigenvalues: [`smallest_eigenpairs`], with a factor or with multigrid.

mod davidson;
mod factor;
mod inner_product;
mod preconditioner;
mod problem;

pub use davidson::smallest_eigenpairs;

use crate::factor::symbolic::Symbolic;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Operator;
use crate::solver::System;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Most memory of a basis: 8 GiB.
const BASIS_BYTES: usize = 8 << 30;
/// Relative error of the entries of A: sums of some tens of products.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// M of `A x = lambda M x`.
#[derive(Clone, Copy, Debug)]
pub enum MassMatrix<'a> {
    /// The diagonal of a diagonal one, positive, by unknown.
    Diagonal(&'a [f64]),
    /// Symmetric, with rows and columns of fixed unknowns replaced by zeros.
    Sparse(&'a SparseMatrix),
}

/// `A x = lambda M x` on the unknowns that are not fixed, A symmetric; with constraints `A x + B p = lambda M x`, `B^T x = 0`.
#[derive(Clone, Copy)]
pub struct Eigenproblem<'a> {
    /// `out = A v`, zero where fixed for a v that is.
    pub product: &'a dyn Operator,
    /// A, or for multigrid a matrix close to it, with rows and columns of fixed unknowns replaced by positive multiples of those of the identity.
    pub system: System<'a>,
    /// M, positive definite on the unknowns that are not fixed.
    pub mass: MassMatrix<'a>,
    /// What stands for the inverse of A.
    pub inverse: ApproximateInverse<'a>,
    /// Set to end between iterations.
    pub cancel: Option<&'a AtomicBool>,
}

/// What stands for the inverse of the matrix of an [`Eigenproblem`].
#[derive(Clone, Copy)]
pub enum ApproximateInverse<'a> {
    /// Cycles of multigrid.
    Multigrid {
        /// Eigenvalues that are zero, as those of rigid motions that nothing holds: the block goes beyond them, since nothing tells these apart.
        zeros: usize,
    },
    /// A factor.
    Factor(ByFactor<'a>),
}

/// What a factor is made of, beside the matrix.
#[derive(Clone, Copy)]
pub struct ByFactor<'a> {
    /// The symbolic factorisation of A.
    pub symbolic: &'a Arc<Symbolic>,
    /// Columns of B, zero where fixed: the pairs are those on the null space of `B^T`. Empty for all.
    pub constraints: &'a [Vec<f64>],
}

/// Eigenvalues in ascending order, with their vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpairs {
    /// Eigenvalues, ascending.
    pub values: Vec<f64>,
    /// Their vectors, `x_i . M x_k = delta_ik`, zero where fixed.
    pub vectors: Vec<Vec<f64>>,
    /// What rounding of the entries of A may change each eigenvalue by, `16 eps |x| . |A| |x|`: a smaller one cannot be
    /// distinguished from zero.
    pub rounding: Vec<f64>,
    /// Negative eigenvalues of the matrix (on the null space of `B^T`).
    pub negative: usize,
    /// Whether the pivots of `A - mu M = L D L^T` show that no eigenvalue is missing, and how many are negative; else these are those that were found.
    pub counted: bool,
    /// Of pairs by products: how they were found.
    pub by_products: Option<ByProducts>,
}

impl Eigenpairs {
    /// The first ones.
    fn first(mut self, count: usize) -> Self {
        self.values.truncate(count);
        self.vectors.truncate(count);
        self.rounding.truncate(count);
        self.by_products.iter_mut().for_each(|how| how.errors.truncate(count));
        self
    }
}

/// How eigenpairs were found without a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct ByProducts {
    /// Iterations, each of one product of A and one cycle for every vector of the block that is not known yet.
    pub iterations: usize,
    /// By pair `sqrt(r . T r / (lambda + s))`, `r = A x - lambda M x`, T the preconditioner, near `(A + s M)^-1`: an estimate, no bound, of the
    /// relative error of x in the norm of `A + s M`, whose square is about that of `lambda + s`.
    pub errors: Vec<f64>,
}
