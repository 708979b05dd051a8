//! [`ReducedWorkspace`]: what one evaluation of a reduced problem leaves for the next.

use crate::state_predictor::StatePredictor;
use nastic_fem::Workspace;

/// The preconditioner of the last solve and the predictor of the next state. Owned by whoever makes the evaluations, one
/// after the other; results depend on it only within the accuracy asked of them, and the same history gives the same bits.
#[derive(Debug, Default)]
pub struct ReducedWorkspace {
    pub(crate) solve: Workspace,
    pub(crate) predictor: StatePredictor,
}

impl ReducedWorkspace {
    /// Memory of the factor kept for the next solve, in bytes.
    pub fn factor_bytes(&self) -> usize {
        self.solve.factor_bytes()
    }

    /// Empties it: the next evaluation is as if it were the first.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}
