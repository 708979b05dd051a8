//! A run of an optimiser: the loop that all methods share.

mod certify;
mod stage;

use crate::admissible::{Admissible, Outside};
use crate::inner_product::InnerProduct;
use crate::method::Method;
use crate::objective::{Failed, Objective, Request};
use crate::observer::{Observer, Reason};
use crate::optimizer::Optimizer;
use crate::search::{Iterate, Setting};
use crate::state::{Counts, Progress, RunState, SavedPoint, StageEnd};
use crate::stop::Stop;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use thiserror::Error;

/// Why a run could not begin or go on.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RunError {
    /// The start is not admissible.
    #[error("the start is not admissible: {0}")]
    Outside(#[from] Outside),
    /// The inner product is of another space.
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
    Start(Failed),
    /// Nothing tells how long a first step should be.
    #[error(
        "nothing tells how long a first step should be: the set is unbounded and the cost at the start is zero; bound the control or begin elsewhere"
    )]
    NoScale,
    /// A saved run of another problem.
    #[error("the saved run does not fit: {0}")]
    Saved(String),
}

/// What a call of [`Run::step`] did.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// An iteration.
    Iterated,
    /// It went on to this stage, from the same control.
    Staged(usize),
    /// The run has ended; further calls do nothing (but go on after a cancellation that was taken back).
    Stopped(Stop),
}

/// Where a run ended.
#[derive(Clone, Debug)]
pub struct Best<P> {
    /// The control.
    pub m: Vec<f64>,
    /// The evaluated point.
    pub point: P,
    /// The cost, as the last stage values it.
    pub cost: f64,
    /// Its derivative (dual, tangential part).
    pub derivative: Vec<f64>,
    /// Norm of the projected gradient in the metric.
    pub gradient_norm: f64,
    /// Active bounds.
    pub active: usize,
    /// Why the run ended.
    pub stop: Stop,
    /// What it took.
    pub counts: Counts,
    /// How each stage ended.
    pub stages: Vec<StageEnd>,
}

/// A run under way. Between two calls of [`Run::step`] it can be looked at and saved.
#[derive(Debug)]
pub struct Run<'a, O: Objective> {
    setting: Setting<'a, O>,
    name: &'static str,
    method: Box<dyn Method>,
    progress: Progress,
    current: Iterate<O::Point>,
    /// A better point than the present one, met before in this stage.
    best: Option<Iterate<O::Point>>,
    ended: Option<Stop>,
}

impl<'a, O: Objective> Run<'a, O> {
    /// Begins a run at `start`, which is evaluated.
    ///
    /// # Errors
    /// A start that is not admissible or cannot be evaluated, or sizes that do not agree.
    pub fn start(
        optimizer: &dyn Optimizer,
        objective: &'a O,
        set: &'a dyn Admissible,
        metric: &'a dyn InnerProduct,
        start: &[f64],
    ) -> Result<Self, RunError> {
        let setting = Setting { objective, set, metric, options: *optimizer.options(), cancel: None };
        check(&setting, start)?;
        let (point, cost) = setting
            .evaluate(start, &Request { near: None, accuracy: setting.options.accuracy, stage: 0 })
            .map_err(RunError::Start)?;
        let current = setting.differentiate(start.to_vec(), point, cost).map_err(|(_, f)| RunError::Start(f))?;
        let progress = Progress { counts: Counts { derivatives: 1, ..Counts::default() }, ..Progress::default() };
        let (name, method) = (optimizer.name(), optimizer.method());
        let mut run = Self { setting, name, method, progress, current, best: None, ended: None };
        run.begin_stage(None)?;
        Ok(run)
    }

    /// Takes up a saved run of the same problem, set, metric and optimiser.
    ///
    /// # Errors
    /// A saved run that does not fit, or whose points cannot be had again.
    pub fn load(
        optimizer: &dyn Optimizer,
        objective: &'a O,
        set: &'a dyn Admissible,
        metric: &'a dyn InnerProduct,
        state: &RunState,
    ) -> Result<Self, RunError> {
        let setting = Setting { objective, set, metric, options: *optimizer.options(), cancel: None };
        let (name, mut method) = (optimizer.name(), optimizer.method());
        if state.method != name {
            return Err(RunError::Saved(format!("it is of \"{}\", not of \"{name}\"", state.method)));
        }
        let n = state.current.m.len();
        if state.memory.vectors.iter().any(|v| name == "lbfgs" && v.len() != n) || !method.load(&state.memory) {
            return Err(RunError::Saved(format!("its memory is not one of \"{name}\" with these options")));
        }
        if state.progress.stage >= objective.stages() || state.progress.gradients.is_empty() {
            return Err(RunError::Saved(format!("there is no stage {}", state.progress.stage)));
        }
        let stage = state.progress.stage;
        let current = revive(&setting, &state.current, stage)?;
        let best = state.best.as_ref().map(|best| revive(&setting, best, stage)).transpose()?;
        Ok(Self { setting, name, method, progress: state.progress.clone(), current, best, ended: None })
    }

    /// The run as plain numbers. After a cancelled step it stands before that step: trials made in it will be made again.
    pub fn save(&self) -> RunState {
        let saved = |at: &Iterate<O::Point>| SavedPoint {
            m: at.m.clone(),
            point: self.setting.objective.save(&at.point),
            cost: at.cost,
            derivative: at.derivative.clone(),
            gradient_norm: at.gradient_norm,
            active: at.active,
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

    /// One iteration, or the passage to the next stage, or nothing when the run has ended.
    pub fn step(&mut self, observer: &mut dyn Observer<O::Point>) -> Outcome {
        self.announce(observer);
        if let Some(stop) = &self.ended {
            return Outcome::Stopped(stop.clone());
        }
        if self.setting.is_cancelled() {
            return Outcome::Stopped(Stop::Cancelled);
        }
        if let Some(stop) = self.stage_over()
            && !self.turned_back(&stop)
        {
            return self.end_stage(stop, observer);
        }
        match self.iterate(observer) {
            Ok(()) => Outcome::Iterated,
            Err(Stop::Cancelled) => Outcome::Stopped(Stop::Cancelled),
            Err(stop) => self.end_stage(stop, observer),
        }
    }

    /// Steps until the run ends.
    pub fn minimize(mut self, observer: &mut dyn Observer<O::Point>) -> Best<O::Point> {
        loop {
            if let Outcome::Stopped(stop) = self.step(observer) {
                return self.finish(stop);
            }
        }
    }

    /// Ends the run where it stands, for a reason.
    pub fn finish(mut self, stop: Stop) -> Best<O::Point> {
        self.settle(&stop);
        let Iterate { m, point, cost, derivative, gradient_norm, active } = self.current;
        let Progress { counts, ends: stages, .. } = self.progress;
        Best { m, point, cost, derivative, gradient_norm, active, stop, counts, stages }
    }

    /// Where a stage ends: at the point that met the tolerance, else at the best one.
    fn settle(&mut self, stop: &Stop) {
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

    /// The present control.
    pub fn m(&self) -> &[f64] {
        &self.current.m
    }

    /// The present point.
    pub fn point(&self) -> &O::Point {
        &self.current.point
    }

    /// The present cost.
    pub fn cost(&self) -> f64 {
        self.current.cost
    }

    /// Norm of the projected gradient in the metric.
    pub fn gradient_norm(&self) -> f64 {
        self.current.gradient_norm
    }

    /// Where the run stands.
    pub fn progress(&self) -> &Progress {
        &self.progress
    }

    /// Tells the observer of the start, once.
    fn announce(&mut self, observer: &mut dyn Observer<O::Point>) {
        if !self.progress.announced {
            self.progress.announced = true;
            observer.trial(&self.setting.tell_accepted(&self.progress, &self.current, Reason::Start, 0.0, 0.0));
        }
    }

    fn iterate(&mut self, observer: &mut dyn Observer<O::Point>) -> Result<(), Stop> {
        let (before, memory) = (self.progress.counts, self.method.save());
        let found = self.setting.search(self.method.as_mut(), &self.current, &mut self.progress, observer);
        let found = found.inspect_err(|stop| {
            if *stop == Stop::Cancelled {
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

/// Whether a control may be evaluated at all.
fn check<O: Objective>(setting: &Setting<'_, O>, m: &[f64]) -> Result<(), RunError> {
    if m.is_empty() {
        return Err(RunError::Empty);
    }
    if m.len() != setting.metric.len() {
        return Err(RunError::Lengths { control: m.len(), metric: setting.metric.len() });
    }
    Ok(setting.set.check(m)?)
}

/// An accepted point from its saved numbers.
fn revive<O: Objective>(
    setting: &Setting<'_, O>,
    saved: &SavedPoint,
    stage: usize,
) -> Result<Iterate<O::Point>, RunError> {
    check(setting, &saved.m)?;
    if saved.derivative.len() != saved.m.len() {
        return Err(RunError::Saved("its derivative is of another length".into()));
    }
    let how = Request { near: None, accuracy: setting.options.accuracy, stage };
    let loaded = setting.objective.load(&saved.m, &saved.point, &how);
    let point = loaded.map_err(|failed| RunError::Saved(failed.why))?;
    let SavedPoint { m, derivative, .. } = saved.clone();
    let (cost, gradient_norm, active) = (saved.cost, saved.gradient_norm, saved.active);
    Ok(Iterate { m, point, cost, derivative, gradient_norm, active })
}
