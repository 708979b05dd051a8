//! What a problem reports while it is solved.

use crate::time::StepUnderWay;
use nastic_fem::Progress;
use std::fmt;
use std::sync::Arc;

/// What is reported after every Newton iteration.
#[derive(Clone)]
pub(super) struct SolveProgress(pub Arc<dyn Fn(&Progress) + Send + Sync>);

impl fmt::Debug for SolveProgress {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("SolveProgress(..)")
    }
}

/// What is reported before every step of a motion.
#[derive(Clone)]
pub(super) struct StepProgress(pub Arc<dyn Fn(&StepUnderWay) + Send + Sync>);

impl fmt::Debug for StepProgress {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("StepProgress(..)")
    }
}
