//! Smallest eigenvalues: [`smallest_eigenpairs`] with a factor, [`smallest_eigenpairs_by_products`] where there is none.

mod davidson;
mod inner_product;
mod lanczos;
mod preconditioner;

pub use davidson::{ProductEigenproblem, smallest_eigenpairs_by_products};
pub use lanczos::{Eigenproblem, smallest_eigenpairs};

use crate::pattern::matrix::SparseMatrix;

/// Memory of a basis: 8 GiB.
const MAX_BASIS_BYTES: usize = 8 << 30;
/// Relative error of the entries of A: sums of some tens of products.
const ENTRY_ROUNDING: f64 = 16.0 * f64::EPSILON;

/// M of `A x = lambda M x`.
#[derive(Clone, Copy, Debug)]
pub enum MassMatrix<'a> {
    /// The diagonal of a diagonal one, positive, by unknown.
    Diagonal(&'a [f64]),
    /// Symmetric, with rows and columns of fixed unknowns replaced by zeros.
    Sparse(&'a SparseMatrix),
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

/// How eigenpairs were found without a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct ByProducts {
    /// Iterations, each of one product of A and one cycle for every vector of the block that is not known yet.
    pub iterations: usize,
    /// By pair `sqrt(r . T r / (lambda + s))`, `r = A x - lambda M x`, T the preconditioner, near `(A + s M)^-1`: an estimate, no bound, of the
    /// relative error of x in the norm of `A + s M`, whose square is about that of `lambda + s`.
    pub errors: Vec<f64>,
}
