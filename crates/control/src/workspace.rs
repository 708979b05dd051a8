//! [`ReducedWorkspace`]: what one evaluation of a reduced problem leaves for the next.

use crate::known_limits::KnownLimits;
use crate::state_predictor::StatePredictor;
use nastic_fem::Workspace;

/// The preconditioner of the last solve, the predictor of the next state, and limit points that were met. Owned by the run that makes the evaluations, one
/// after the other; results depend on it only within the accuracy asked of them, but that a trial behind a
/// limit point which was met before is given up where the path of equilibria turns back; the same history gives the same bits.
#[derive(Debug, Default)]
pub struct ReducedWorkspace {
    pub(crate) solve: Workspace,
    pub(crate) predictor: StatePredictor,
    pub(crate) limits: KnownLimits,
}

impl ReducedWorkspace {
    /// Memory of the factor kept for the next solve, in bytes.
    pub fn factor_bytes(&self) -> usize {
        self.solve.factor_bytes()
    }

    /// Drops what an evaluation left of which it is not known whether it ran, as beside one that failed: the next does not depend on it.
    pub fn after_failure(&mut self) {
        self.solve.clear();
        self.limits = KnownLimits::default();
    }

    /// Empties it: the next evaluation is as if it were the first.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
