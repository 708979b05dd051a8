//! The gradient check of a run at its present point.

use super::Run;
use crate::certificate::{Base, Certificate};
use crate::objective::Objective;
use crate::taylor::TaylorError;

impl<O: Objective> Run<O> {
    /// Checks the derivative at the present point: see [`Certificate::of`]. Evaluations have a workspace of their own,
    /// so that the run continues as without the check.
    ///
    /// # Errors
    /// As [`Certificate::of`].
    pub fn certify(&self, size: Option<f64>, seed: u64) -> Result<Certificate, TaylorError> {
        let at = &self.current;
        let base = Base { m: &at.m, point: &at.point, derivative: &at.derivative, stage: self.progress.stage };
        let mut workspace = O::Workspace::default();
        Certificate::of(&self.setting.objective, self.setting.set.as_ref(), &base, &mut workspace, size, seed)
    }
}
