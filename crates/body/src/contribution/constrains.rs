//! [`Constrains`]: constraints that a contribution holds the body to.

use crate::error::FemError;
use crate::instant::Instant;
use nalgebra::DMatrix;

/// Constraints `g_k(u; m) = 0`, each with a multiplier `p_k`, whose potential `-sum_k p_k g_k` and residuals `-p_k dg_k/du` and `-g_k` the
/// contribution gives with its others; see [`Contribution`](crate::contribution::Contribution).
pub trait Constrains {
    /// How many.
    fn count(&self) -> usize;

    /// Whether they are inequalities `g_k >= 0`, with `p_k >= 0` and `p_k g_k = 0`.
    fn are_inequalities(&self) -> bool {
        false
    }

    /// Where they are functions of the displacement of a few nodes alone, at which their derivatives are linearly independent: these nodes, and a basis of
    /// the changes of their unknowns that keep the constraints to first order, by columns. They are eliminated there, unless they are inequalities or the contribution has controls. The contribution
    /// [ties](crate::contribution::Contribution::tied) these nodes together.
    fn local(&self, _at: &Instant) -> Option<(Vec<u32>, DMatrix<f64>)> {
        None
    }

    /// Where the displacement of those nodes can be put onto them at once: what their unknowns, one after the other, become near a displacement.
    fn restored(&self, _u: &[f64]) -> Option<Vec<(usize, f64)>> {
        None
    }

    /// Whether they can be fulfilled under these controls.
    ///
    /// # Errors
    /// Which cannot, and what can.
    fn check(&self, _at: &Instant) -> Result<(), FemError> {
        Ok(())
    }
}
