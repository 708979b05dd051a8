//! [`smallest_eigenpairs`]: the smallest eigenvalues of `A x = lambda M x`, with Cholesky factors or with cycles of multigrid.

mod cycles;
mod factors;
mod inner_product;
mod inversion;
mod leading;
mod search;
mod shifted_matrix;

pub use inversion::Inversion;
pub use leading::{DefiniteProblem, leading_eigenpairs};

use crate::pattern::matrix::SparseMatrix;
use crate::solver::LinearError;
use search::Search;
use std::sync::atomic::AtomicBool;

/// M of `A x = lambda M x`.
#[derive(Clone, Copy, Debug)]
pub enum MassMatrix<'a> {
    /// The diagonal of a diagonal one, positive, by unknown.
    Diagonal(&'a [f64]),
    /// Symmetric, with rows and columns of fixed unknowns replaced by zeros.
    Sparse(&'a SparseMatrix),
}

impl MassMatrix<'_> {
    /// `M_ii`.
    fn diagonal(&self) -> Vec<f64> {
        match self {
            Self::Diagonal(mass) => mass.to_vec(),
            Self::Sparse(mass) => mass.diagonal(),
        }
    }
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
    /// Of pairs without a factor: how they were found.
    pub by_products: Option<ByProducts>,
}

/// How eigenpairs were found without a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct ByProducts {
    /// Iterations, each of one cycle for every vector of the block and one product of A for those that are not known yet.
    pub iterations: usize,
    /// By pair `sqrt(r . T r / (lambda + s))`, `r = A x - lambda M x`, T the preconditioner, near `(A + s M)^-1`: an estimate, no bound, of the
    /// relative error of x in the norm of `A + s M`, whose square is about that of `lambda + s`.
    pub errors: Vec<f64>,
}

/// `A x = lambda M x` on the unknowns that are not fixed, A symmetric.
#[derive(Clone, Copy)]
pub struct Eigenproblem<'a> {
    /// M, positive definite on the unknowns that are not fixed.
    pub mass: MassMatrix<'a>,
    /// By unknown: whether it is fixed.
    pub fixed: &'a [bool],
    /// A, and how `A + s M` is inverted.
    pub inversion: Inversion<'a>,
    /// Number of zero eigenvalues, of free rigid motions: the block is larger than this, since their vectors are arbitrary within one space.
    pub zeros: usize,
    /// Set to stop between iterations.
    pub cancel: Option<&'a AtomicBool>,
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
}

impl Eigenproblem<'_> {
    /// Number of eigenvalues.
    fn unknowns(&self) -> usize {
        let free = self.fixed.iter().filter(|&&fixed| !fixed).count();
        free.saturating_sub(self.inversion.constraints())
    }
}

/// The `count` algebraically smallest eigenvalues with their vectors, and all negative ones (without a factor all that are found) where these are more.
///
/// A block Davidson method: the Rayleigh-Ritz values of a space that grows by the residuals `A x - theta M x` of a block of Ritz vectors, preconditioned by
/// `(A + s M)^-1`, its Cholesky factor or a cycle of multigrid, and is restarted with the present and the previous Ritz vectors: the locally optimal gradients
/// of Knyazev, "Toward the optimal preconditioned eigensolver", SIAM J. Sci. Comput. 23 (2001), with the orthogonal basis of Stathopoulos, Saad, "Restarting
/// techniques for the (Jacobi-)Davidson symmetric eigenvalue methods", ETNA 7 (1998). s is zero for a positive definite A, and else makes `A + s M` so; it
/// keeps a distance from the lowest eigenvalue. The start is random with a fixed seed.
///
/// With factors no eigenvalue is missed: those below the largest one returned are counted by the pivots of `A - mu M` (Sylvester's law of inertia), and the block
/// grows until as many are found. Without a factor nothing proves that ([`Eigenpairs::counted`]): an eigenvector that is orthogonal to all vectors of the block,
/// half as many again as are asked for or are zero, is not found.
///
/// # Errors
/// A matrix that is not symmetric or not finite; more eigenvalues wanted than there are unknowns, or than fit; a factor that does not fit;
/// [`LinearError::Eigenpairs`] where the iteration does not find them; [`LinearError::Shift`] where no shift makes A positive definite;
/// [`LinearError::Cancelled`].
pub fn smallest_eigenpairs(problem: &Eigenproblem, count: usize) -> Result<Eigenpairs, LinearError> {
    let unknowns = problem.unknowns();
    if count == 0 || count > unknowns {
        return Err(LinearError::EigenpairCount { count, unknowns });
    }
    let matrix = problem.inversion.on(problem)?;
    Search::check_size(problem, count)?;
    let mut search = Search::begin(problem, matrix.as_ref())?;
    let counted = search.negative()?;
    let wanted = count.max(counted.unwrap_or(0));
    let mut sought = wanted;
    loop {
        search.widen(sought)?;
        let mut found = search.run(sought)?;
        let is_negative = |(value, rounding): (&f64, &f64)| *value < -*rounding;
        let negative = found.values.iter().zip(&found.rounding).filter(|pair| is_negative(*pair)).count();
        found.negative = counted.unwrap_or(negative);
        found.counted = counted.is_some();
        let missing = match counted {
            Some(_) => search.missing(&found, wanted)?,
            None if negative == sought => sought,
            None => 0,
        };
        if missing == 0 || sought == unknowns && counted.is_none() {
            found.truncate(count.max(found.negative));
            return Ok(found);
        }
        if sought == unknowns {
            return Err(LinearError::Eigenpairs { found: wanted.saturating_sub(missing), wanted });
        }
        sought = unknowns.min(sought + missing);
    }
}

impl Eigenpairs {
    fn truncate(&mut self, count: usize) {
        self.values.truncate(count);
        self.vectors.truncate(count);
        self.rounding.truncate(count);
        self.by_products.iter_mut().for_each(|how| how.errors.truncate(count));
    }
}
