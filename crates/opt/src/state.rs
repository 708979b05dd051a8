//! A run as plain numbers: what a checkpoint holds.

use crate::failed::Failed;
use crate::held::Held;
use crate::method::Memory;
use crate::objective::{Objective, Request};
use crate::run::Best;
use crate::saved::Saved;
use serde::{Deserialize, Serialize};
use std::convert::Infallible;

/// What a run has done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// Consecutive steps whose predicted decrease was below the rounding of the cost.
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    /// The constraints that the method holds itself.
    pub held: Held,
}

/// Everything a run needs to continue with the same bits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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

impl Saved for RunState {
    const KIND: &'static str = "nastic-run-4";
}

impl<P> Best<P> {
    /// The same result with what becomes of its point.
    ///
    /// # Errors
    /// Those of `of`.
    pub fn try_map<Q, E>(self, of: impl FnOnce(P) -> Result<Q, E>) -> Result<Best<Q>, E> {
        let Self { m, point, stage, cost, derivative, gradient_norm, active, stop, counts, stages, certificate } = self;
        let point = of(point)?;
        Ok(Best { m, point, stage, cost, derivative, gradient_norm, active, stop, counts, stages, certificate })
    }

    /// The same result with its point as [`Objective::save`] writes it.
    pub fn saved<O: Objective<Point = P>>(&self, objective: &O) -> Best<Vec<u8>>
    where
        P: Clone,
    {
        let Ok(saved) = self.clone().try_map(|point| Ok::<_, Infallible>(objective.save(&point)));
        saved
    }
}

/// A result whose point is as [`Objective::save`] writes it: it can be saved, without its certificate.
impl Best<Vec<u8>> {
    /// The result with its point as a value, of the same problem.
    ///
    /// # Errors
    /// As [`Objective::load`].
    pub fn restored<O: Objective>(self, objective: &O) -> Result<Best<O::Point>, Failed> {
        let (m, how) = (self.m.clone(), Request { stage: self.stage, ..Request::default() });
        self.try_map(|point| objective.load(&m, &point, &how))
    }
}

impl Saved for Best<Vec<u8>> {
    const KIND: &'static str = "nastic-best-3";
}
