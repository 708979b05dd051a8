//! [`LinearError`]: why a system has no solution.

use crate::error::FactorError;

/// A linear system could not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// The matrix cannot be factorised.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// The residual stays above what was asked.
    #[error(
        "relative residual {residual:.1e} where {wanted:.1e} is wanted: the tangent is numerically singular \
         (a bifurcation, or a body held too loosely)"
    )]
    Singular {
        /// Relative residual reached.
        residual: f64,
        /// Relative residual asked.
        wanted: f64,
    },
    /// Rounding of the matrix decides the sign of an eigenvalue.
    #[error(
        "the smallest eigenvalue is about {smallest:.1e}, below its own rounding {rounding:.1e}: the tangent is singular to working \
         precision (a limit or bifurcation point)"
    )]
    NearlySingular {
        /// Absolute value of the eigenvalue nearest zero.
        smallest: f64,
        /// Rounding of the Rayleigh quotient of its eigenvector.
        rounding: f64,
    },
    /// Multigrid does not converge.
    #[error(
        "multigrid reached a relative residual of {residual:.1e} in {cycles} cycles where {wanted:.1e} is wanted; \
         the material may be too nearly incompressible for it"
    )]
    Multigrid {
        /// Relative residual reached.
        residual: f64,
        /// Cycles taken.
        cycles: usize,
        /// Relative residual asked.
        wanted: f64,
    },
    /// GMRES does not converge.
    #[error(
        "GMRES reached a relative residual of {residual:.1e} in {iterations} iterations where {wanted:.1e} is wanted; the \
         non-symmetric part is too large beside the symmetric one, or the matrix is singular"
    )]
    Gmres {
        /// Relative residual reached.
        residual: f64,
        /// Iterations taken.
        iterations: usize,
        /// Relative residual asked.
        wanted: f64,
    },
    /// The solver takes positive definite matrices alone.
    #[error("the tangent is not positive definite")]
    Indefinite {
        /// A quotient `p . A p / p . p` that is not positive, where one was met.
        quotient: Option<f64>,
    },
    /// Multigrid does not serve, and for a factor there are products of cells alone.
    #[error("a factor is needed, and there are no entries to make it of")]
    NoEntries,
    /// No shift of the diagonal makes the matrix positive definite.
    #[error("the tangent stays indefinite under any shift")]
    Shift,
    /// Signs of eigenvalues are counted of symmetric matrices alone.
    #[error("the matrix is not symmetric, so that signs of its eigenvalues are not counted")]
    NoInertia,
    /// The solver does not count signs of eigenvalues, or cannot decide whether a matrix is positive definite.
    #[error("the solver \"{solver}\" does not tell the signs of eigenvalues; take \"direct\" where they are wanted")]
    NotCounted {
        /// Its name.
        solver: &'static str,
    },
    /// A field by which the potential is said to have a maximum does not give that.
    #[error(
        "the tangent has {negative} negative eigenvalues where the potential has a maximum by the {maxima} free unknowns of fields of the role \"saddle\": \
         hold such a field somewhere (a ground); where it is held, make it a primary one, or change the sign of its energy"
    )]
    NoMaximum {
        /// Negative eigenvalues.
        negative: usize,
        /// Free unknowns by which there should be a maximum.
        maxima: usize,
    },
    /// The solver takes symmetric matrices alone.
    #[error("the matrix is not symmetric; use the general solver")]
    NotSymmetric,
    /// The border has other lengths than the right-hand sides.
    #[error("the border does not fit: {scalars} columns and rows of length {unknowns} are needed, and a square corner")]
    ForeignBorder {
        /// Length of f.
        unknowns: usize,
        /// Length of g.
        scalars: usize,
    },
    /// The border makes the system singular.
    #[error(
        "the bordered system is singular: its Schur complement of {scalars} scalar unknowns has no inverse; constraints that depend on each \
         other, as two volumes of one room do, or taut tendons along one way, cannot be shown apart: leave one out"
    )]
    Border {
        /// Number of scalar unknowns.
        scalars: usize,
    },
    /// A solver failed and a factor would be too large to fall back on.
    #[error("{source}, and a factor of the tangent takes {gib:.0} GiB; try a coarser mesh")]
    TooLarge {
        /// Why the solver failed.
        source: Box<LinearError>,
        /// Memory of a factor.
        gib: f64,
    },
    /// More or fewer eigenvalues are wanted than there are.
    #[error("{count} eigenvalues are wanted; ask for 1 to {unknowns}, the number of free unknowns")]
    EigenpairCount {
        /// How many are wanted.
        count: usize,
        /// Unknowns that are not fixed.
        unknowns: usize,
    },
    /// The eigenvectors and their Krylov space would be too large.
    #[error("{count} eigenvalues of {unknowns} unknowns take {gib:.0} GiB; ask for fewer")]
    EigenpairsTooLarge {
        /// How many are wanted.
        count: usize,
        /// Unknowns that are not fixed.
        unknowns: usize,
        /// Memory of the basis.
        gib: f64,
    },
    /// Lanczos's method does not find all eigenvalues.
    #[error("only {found} of {wanted} eigenvalues were found; ask for fewer")]
    Eigenpairs {
        /// How many were found.
        found: usize,
        /// How many are wanted.
        wanted: usize,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// What a solver of another crate or program says.
    #[error("the solver \"{solver}\" failed: {what}")]
    External {
        /// Its name.
        solver: &'static str,
        /// Why.
        what: String,
    },
    /// A factor is needed and would be too large.
    #[error("a factor of the tangent is needed and takes {gib:.0} GiB; try a coarser mesh")]
    FactorTooLarge {
        /// Memory of a factor.
        gib: f64,
    },
}

impl LinearError {
    /// Whether the matrix is singular to working precision, and not merely no answer was had.
    pub fn is_singular(&self) -> bool {
        matches!(self, Self::Factor(FactorError::Singular { .. }) | Self::Singular { .. } | Self::NearlySingular { .. })
    }

    /// Whether the machine has too little memory, or what limits it cannot be read: the same system may have a solution elsewhere.
    pub fn is_lack_of_memory(&self) -> bool {
        match self {
            Self::Factor(FactorError::Memory { .. } | FactorError::Limit(_)) => true,
            Self::TooLarge { source, .. } => source.is_lack_of_memory(),
            _ => false,
        }
    }
}
