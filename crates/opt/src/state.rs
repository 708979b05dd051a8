//! A run as plain numbers: what a checkpoint holds.

use crate::method::Memory;

/// What a run has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Accepted steps.
    pub iterations: usize,
    /// Trials after the start, accepted or not, a new stage's first point among them.
    pub trials: usize,
    /// Trials that could not be evaluated, or whose derivative could not.
    pub failed: usize,
    /// Derivatives taken.
    pub derivatives: usize,
    /// Products with the second derivative.
    pub products: usize,
}

/// How a stage ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StageEnd {
    /// Which stage.
    pub stage: usize,
    /// Iterations spent in it.
    pub iterations: usize,
    /// Whether it met its tolerance.
    pub converged: bool,
    /// The reason in words.
    pub why: String,
}

/// Where a run stands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// What was done.
    pub counts: Counts,
    /// Whether the observer has seen the start.
    pub announced: bool,
    /// Continuation stage.
    pub stage: usize,
    /// Iterations before this stage.
    pub stage_began: usize,
    /// The control with which this stage began.
    pub stage_start: Vec<f64>,
    /// Best cost so far, per iteration of this stage, its start first.
    pub costs: Vec<f64>,
    /// Projected gradient norm, per iteration of this stage, its start first.
    pub gradients: Vec<f64>,
    /// Steps in a row whose predicted decrease was below the rounding of the cost.
    pub flat: usize,
    /// Stages that ended.
    pub ends: Vec<StageEnd>,
}

impl Progress {
    /// A gradient norm relative to the stage's first.
    pub fn relative(&self, gradient_norm: f64) -> f64 {
        match self.gradients.first() {
            Some(first) if *first > 0.0 => gradient_norm / first,
            _ => 0.0,
        }
    }
}

/// An accepted point as plain numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SavedPoint {
    /// The control.
    pub m: Vec<f64>,
    /// What the objective saved of the point.
    pub point: Vec<u8>,
    /// Its cost.
    pub cost: f64,
    /// Its derivative (dual), across the set too.
    pub derivative: Vec<f64>,
    /// Norm of the projected gradient.
    pub gradient_norm: f64,
    /// Active bounds.
    pub active: usize,
}

/// Everything a run needs to go on to the bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunState {
    /// Name of the optimiser.
    pub method: String,
    /// What it remembers.
    pub memory: Memory,
    /// Where it stands.
    pub progress: Progress,
    /// The present point.
    pub current: SavedPoint,
    /// A better point met before, in a non-monotone run.
    pub best: Option<SavedPoint>,
}
