//! A run of an optimiser: the loop that all methods share.

mod begin;
mod certify;
mod stage;

use crate::admissible::Outside;
use crate::certificate::Certificate;
use crate::failed::Failed;
use crate::method::Method;
use crate::objective::Objective;
use crate::observer::{Observer, Reason};
use crate::optimizer::Unfit;
use crate::search::{Iterate, Setting};
use crate::state::{Counts, Progress, RunState, SavedPoint, StageEnd};
use crate::stop::Stop;
use crate::taylor::TaylorError;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// Why a run could not begin or continue.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RunError {
    /// The start is not admissible.
    #[error("the start is not admissible: {0}")]
    Outside(#[from] Outside),
    /// The inner product belongs to another space.
    #[error("the control has {control} components, its inner product {metric}")]
    Lengths {
        /// Components of the start.
        control: usize,
        /// Components of the inner product.
        metric: usize,
    },
    /// There is nothing to control.
    #[error("the control has no component")]
    Empty,
    /// No cost, or no derivative, at the start.
    #[error("the start could not be evaluated: {0}")]
    Start(#[source] Failed),
    /// The inner product could not be built.
    #[error("the inner product of the controls could not be built: {0}")]
    InnerProduct(#[source] Failed),
    /// No scale for the length of the first step.
    #[error(
        "nothing tells how long a first step should be: the set is unbounded and the cost at the start is zero; bound the control or begin elsewhere"
    )]
    NoScale,
    /// Stages that the problem does not have.
    #[error("stages {first}..{end} of a problem with {stages}: ask for some of 0..{stages}")]
    Stages {
        /// First stage asked for.
        first: usize,
        /// End of those asked for.
        end: usize,
        /// How many there are.
        stages: usize,
    },
    /// No first penalty of the constraints.
    #[error(
        "nothing tells how large the first penalty of the constraints should be: the cost at the start is {cost:e}, the penalty {penalty:e}; \
         start where the cost is not zero (a program may give a penalty > 0 in the unit of the cost)"
    )]
    NoPenalty {
        /// The cost at the start.
        cost: f64,
        /// The penalty.
        penalty: f64,
    },
    /// The derivative does not belong to the cost.
    #[error(
        "the derivative at the start does not belong to the cost, so nothing was optimised: {0}. Taylor::test shows where; a cost \
         with a kink at the start is refused too: start elsewhere; gradient_check(false) runs anyway"
    )]
    Derivative(Box<Certificate>),
    /// The derivative at the start could not be checked.
    #[error("the derivative at the start could not be checked: {0}; gradient_check(false) runs without")]
    Check(#[source] TaylorError),
    /// A method that is not made for the set or the constraints.
    #[error(transparent)]
    Unfit(#[from] Unfit),
    /// A saved run of another problem.
    #[error("the saved run does not fit: {0}")]
    Saved(#[source] Failed),
}

/// The result of a call of [`Run::step`].
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// An iteration.
    Iterated,
    /// The passage to this stage, from the same control.
    Staged(usize),
    /// The run has terminated; further calls do nothing (after a cancellation that was withdrawn they continue).
    Stopped(Stop),
}

/// The result of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Best<P> {
    /// The control.
    pub m: Vec<f64>,
    /// The evaluated point.
    pub point: P,
    /// The continuation stage of its cost: the last one, unless the run terminated before.
    pub stage: usize,
    /// The cost of that stage.
    pub cost: f64,
    /// Its derivative (dual, tangential part).
    pub derivative: Vec<f64>,
    /// Norm of the projected gradient in the metric.
    pub gradient_norm: f64,
    /// Active bounds.
    pub active: usize,
    /// Why the run terminated.
    pub stop: Stop,
    /// The work.
    pub counts: Counts,
    /// How each stage terminated.
    pub stages: Vec<StageEnd>,
    /// The gradient check at the start, where one was made; it is not saved.
    #[serde(skip)]
    pub certificate: Option<Certificate>,
}

/// A run of an optimiser. It owns its problem (which may be a reference or an [`Arc`]), its set, its inner product and the
/// [workspace](Objective::Workspace) of its evaluations. Between two calls of [`Run::step`] it can be inspected and saved.
#[derive(Debug)]
pub struct Run<O: Objective> {
    pub(crate) setting: Setting<O>,
    name: &'static str,
    method: Box<dyn Method>,
    workspace: O::Workspace,
    pub(crate) progress: Progress,
    pub(crate) current: Iterate<O::Point>,
    /// An earlier point of this stage that is better than the present one.
    best: Option<Iterate<O::Point>>,
    ended: Option<Stop>,
}

impl<O: Objective> Run<O> {
    /// Continues with a workspace of earlier evaluations of the same problem, in place of the run's own.
    #[must_use]
    pub fn with_workspace(mut self, workspace: O::Workspace) -> Self {
        self.workspace = workspace;
        self
    }

    /// A scheduled checkpoint: empties the workspace, then [saves](Self::save) the run. [`Run::load`] starts with an empty
    /// workspace too, so a run that continues from here and one that is loaded give the same bits.
    pub fn checkpoint(&mut self) -> RunState {
        self.workspace = O::Workspace::default();
        self.save()
    }

    /// The run as plain numbers, without its workspace, so that a loaded run agrees with this one within the accuracy of
    /// states; with [`checkpoint`](Self::checkpoint) it has the same bits. After a cancelled or aborted step the run is in the state
    /// before that step: its trials will be repeated.
    pub fn save(&self) -> RunState {
        let saved = |at: &Iterate<O::Point>| SavedPoint {
            m: at.m.clone(),
            point: self.setting.objective.save(&at.point),
            cost: at.cost,
            derivative: at.whole_derivative.clone(),
            gradient_norm: at.gradient_norm,
            active: at.active,
            held: at.held.clone(),
        };
        RunState {
            method: self.name.to_string(),
            memory: self.method.save(),
            progress: self.progress.clone(),
            current: saved(&self.current),
            best: self.best.as_ref().map(saved),
        }
    }

    /// A flag that stops the run before its next trial.
    #[must_use]
    pub fn cancelled_by(mut self, flag: Arc<AtomicBool>) -> Self {
        self.setting.cancel = Some(flag);
        self
    }

    /// One iteration, or the passage to the next stage, or nothing when the run has terminated.
    pub fn step(&mut self, observer: &mut dyn Observer<O::Point>) -> Outcome {
        self.announce(observer);
        if let Some(stop) = &self.ended {
            return Outcome::Stopped(stop.clone());
        }
        if let Err(stop) = self.setting.check_cancelled() {
            return Outcome::Stopped(stop);
        }
        if let Some(stop) = self.stage_over()
            && !self.turned_back(&stop)
        {
            return self.end_stage(stop, observer);
        }
        match self.iterate(observer) {
            Ok(()) => Outcome::Iterated,
            Err(stop) if stop.is_interrupted() => Outcome::Stopped(stop),
            Err(stop) => self.end_stage(stop, observer),
        }
    }

    /// Steps until the run ends.
    pub fn minimize(mut self, observer: &mut dyn Observer<O::Point>) -> Best<O::Point> {
        let stop = self.run(observer);
        self.finish(stop)
    }

    /// Steps until the run terminates, and returns the reason; [`finish`](Self::finish) gives the result.
    pub fn run(&mut self, observer: &mut dyn Observer<O::Point>) -> Stop {
        loop {
            if let Outcome::Stopped(stop) = self.step(observer) {
                return stop;
            }
        }
    }

    /// Terminates the run at its present point, for a reason.
    pub fn finish(mut self, stop: Stop) -> Best<O::Point> {
        self.settle(&stop);
        let Iterate { m, point, cost, derivative, gradient_norm, active, .. } = self.current;
        let Progress { counts, ends: stages, stage, .. } = self.progress;
        Best { m, point, stage, cost, derivative, gradient_norm, active, stop, counts, stages, certificate: None }
    }

    /// The result of a stage: the point that met the tolerance, else the best one.
    pub(crate) fn settle(&mut self, stop: &Stop) {
        if !stop.is_converged() {
            self.take_best();
        }
        self.best = None;
    }

    /// Goes back to the best point of the stage.
    fn take_best(&mut self) {
        if let Some(best) = self.best.take_if(|best| best.cost < self.current.cost) {
            self.current = best;
        }
        self.best = None;
    }

    /// The problem.
    pub fn objective(&self) -> &O {
        &self.setting.objective
    }

    /// The workspace of the evaluations.
    pub fn workspace(&self) -> &O::Workspace {
        &self.workspace
    }

    /// The present control.
    pub fn m(&self) -> &[f64] {
        &self.current.m
    }

    /// The present point.
    pub fn point(&self) -> &O::Point {
        &self.current.point
    }

    /// The best point so far, where that is another one.
    pub fn best_point(&self) -> Option<&O::Point> {
        self.best.as_ref().map(|best| &best.point)
    }

    /// The present cost.
    pub fn cost(&self) -> f64 {
        self.current.cost
    }

    /// Norm of the projected gradient in the metric.
    pub fn gradient_norm(&self) -> f64 {
        self.current.gradient_norm
    }

    /// The progress of the run.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Shows the observer the start, once.
    fn announce(&mut self, observer: &mut dyn Observer<O::Point>) {
        if !self.progress.announced {
            self.progress.announced = true;
            observer.trial(&self.setting.tell_accepted(&self.progress, &self.current, Reason::Start, 0.0, 0.0));
        }
    }

    fn iterate(&mut self, observer: &mut dyn Observer<O::Point>) -> Result<(), Stop> {
        let (before, memory) = (self.progress.counts, self.method.save());
        let method = self.method.as_mut();
        let found = self.setting.search(method, &self.current, &mut self.progress, &mut self.workspace, observer);
        let found = found.inspect_err(|stop| {
            if stop.is_interrupted() {
                self.progress.counts = before;
                self.method.load(&memory);
            }
        })?;
        let (from, to) = (self.setting.here(&self.current), self.setting.here(&found.next));
        self.method.accepted(&from, &to, found.fraction, found.trials);
        let flat = found.predicted.abs() <= 10.0 * f64::EPSILON * self.current.cost.abs();
        self.progress.flat = if flat { self.progress.flat + 1 } else { 0 };
        self.progress.counts.iterations += 1;
        let best = self.best.as_ref().map_or(self.current.cost, |best| best.cost);
        let old = std::mem::replace(&mut self.current, found.next);
        if self.current.cost <= best {
            self.best = None;
        } else if self.best.is_none() {
            self.best = Some(old);
        }
        self.progress.costs.push(self.current.cost.min(best));
        self.progress.gradients.push(self.current.gradient_norm);
        Ok(())
    }
}
