//! [`FactorReuse`]: when a factor held in the workspace serves as a preconditioner and when a new one is due.

use crate::factor::symbolic::Symbolic;

/// Iterations that cost as much as a factorisation, per square root of the flops per entry of the factor: an iteration is bound
/// by memory, a factorisation by arithmetic, which is faster for larger fronts (measured on hex8 in single
/// precision with the product that goes with it: 7 at 10k unknowns, 11 at 31k, 15 at 98k).
const ITERATION_RATIO: f64 = 0.4;
/// Accuracy of a step from which the equilibrium is near.
const NEAR_EQUILIBRIUM_TOLERANCE: f64 = 1e-3;

/// Counts iterations with the factor held: when they have cost as much as a factorisation, one is due. That is at most
/// twice the least possible work, and the last factor is one from near the end.
#[derive(Clone, Debug, Default)]
pub(super) struct FactorReuse {
    /// Iterations with the factor held since it was made, in this nonlinear solve.
    pub spent: usize,
    /// Whether a step has been cut short where the curvature turned negative. Once in a nonlinear solve that is faster
    /// than knowing the whole tangent, which is positive again at most next iterates; where it is not, a factor shows.
    pub cut_short: bool,
}

impl FactorReuse {
    /// Iterations with the factor held that are worth it instead of a factorisation.
    pub fn worth(symbolic: &Symbolic) -> usize {
        let ratio = ITERATION_RATIO * (symbolic.flops() / (symbolic.nonzeros() as f64).max(1.0)).sqrt();
        ratio.round().clamp(5.0, 40.0) as usize
    }

    /// Whether the factor held may be used for a step of this accuracy. A factor made near the equilibrium serves the
    /// adjoint and the next solve nearby as well, which take some six iterations more with an old one: it is due earlier.
    pub fn serves(&self, symbolic: &Symbolic, tolerance: f64) -> bool {
        let worth = Self::worth(symbolic);
        self.spent < if tolerance <= NEAR_EQUILIBRIUM_TOLERANCE { 2 * worth / 5 } else { worth }
    }
}
