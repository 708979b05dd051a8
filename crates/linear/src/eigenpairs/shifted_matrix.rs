//! [`ShiftedMatrix`]: A of an eigenproblem as the search sees it.

use crate::solver::LinearError;

/// A as the search sees it.
pub(super) trait ShiftedMatrix {
    /// `out = A x`.
    fn multiply(&self, x: &[f64], out: &mut [f64]);

    /// `A_ii`.
    fn diagonal(&self) -> Vec<f64>;

    /// `16 eps |x| . |A| |x|` of each of these vectors.
    fn rounding(&self, vectors: &[Vec<f64>]) -> Vec<f64>;

    /// `(A + s M)^-1`, or nearly so.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`](crate::FactorError::NotPositive) where `A + s M` is not positive definite.
    fn inverse(&self, shift: f64) -> Result<Box<dyn Inverse + '_>, LinearError>;

    /// Accuracy and length of the search.
    fn search_limits(&self) -> SearchLimits;

    /// Whether eigenvalues are counted.
    fn counts(&self) -> bool {
        false
    }

    /// Number of eigenvalues below mu; `None` where nothing counts them.
    fn count_below(&self, mu: f64) -> Result<Option<usize>, LinearError> {
        let _ = mu;
        Ok(None)
    }
}

/// Accuracy and length of a search.
#[derive(Clone, Copy)]
pub(super) struct SearchLimits {
    /// Relative error of the vector of a Ritz pair in the energy norm, as estimated by the preconditioned residual, at which the pair has converged; the error of the
    /// value is its square.
    pub tolerance: f64,
    /// Relative error of products of A that residuals have by rounding, as a share of the largest `|A_ii| / M_ii`.
    pub rounding: f64,
    /// Iterations.
    pub iterations: usize,
}

/// `(A + s M)^-1`, or nearly so.
pub(super) trait Inverse {
    /// Overwrites columns, one after the other.
    fn apply(&self, columns: &mut [f64], count: usize);

    /// Makes a vector meet the constraints, if there are any.
    fn constrain(&self, x: &mut [f64]) {
        let _ = x;
    }
}
