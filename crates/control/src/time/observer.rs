//! [`MotionObserver`]: what is called while a motion runs.

use nastic_fem::State;
use nastic_fields::ControlError;

/// A step of a motion that is to be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepUnderWay {
    /// Steps before it.
    pub done: usize,
    /// All steps.
    pub of: usize,
    /// The instant that it leads to.
    pub time: f64,
    /// The last instant.
    pub end: f64,
}

/// Called while a motion runs, so that the states of a motion that fails or is stopped are available, and it may be resumed.
pub trait MotionObserver: Sync {
    /// What an earlier motion of the same problem and control vector reported [`resumable`](Self::resumable): this one continues from there.
    fn resume(&self) -> Option<Vec<u8>> {
        None
    }

    /// The n-th state was reached.
    ///
    /// # Errors
    /// What ends the motion.
    fn reached(&self, n: usize, state: &State) -> Result<(), ControlError>;

    /// The motion can continue from the n-th state, with the same bits, by what `bytes` returns: wherever the next step begins
    /// without what was kept of earlier ones ([`Recording::begins_anew`](nastic_fem::Recording::begins_anew)), and at the end, but not under costs that use all states.
    fn resumable(&self, _n: usize, _bytes: &dyn Fn() -> Vec<u8>) {}
}
