//! One iteration: trials along a method's path until one is accepted.

use crate::admissible::Admissible;
use crate::failed::Failed;
use crate::held::Held;
use crate::hessian::ProductsAt;
use crate::inner_product::InnerProduct;
use crate::line_search::LineSearch;
use crate::method::{Current, Judgement, Method, Proposed, Tried};
use crate::objective::{Budget, Objective, Request};
use crate::observer::{Observer, Reason, Trial};
use crate::optimizer::Options;
use crate::state::Progress;
use crate::stop::{Stall, Stop};
use crate::summary::Summary;
use nastic_numeric::vector::{dot, sub};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What stays the same throughout a run.
#[derive(Debug)]
pub(crate) struct Setting<O> {
    pub objective: O,
    pub set: Arc<dyn Admissible>,
    pub metric: Arc<dyn InnerProduct>,
    pub options: Options,
    /// Largest violation of constraints that the method holds itself at which a run may converge.
    pub feasibility: f64,
    /// The same of their gap, as a share of the cost.
    pub gap: f64,
    /// Continuation stages to run.
    pub stages: Range<usize>,
    pub cancel: Option<Arc<AtomicBool>>,
}

/// An accepted point.
#[derive(Clone, Debug)]
pub(crate) struct Iterate<P> {
    pub m: Vec<f64>,
    pub point: P,
    pub cost: f64,
    /// Tangential part; of the Lagrangian, where the method holds constraints.
    pub derivative: Vec<f64>,
    /// Across the set too.
    pub whole_derivative: Vec<f64>,
    pub gradient_norm: f64,
    pub active: usize,
    pub held: Held,
}

/// An accepted trial and how it was found.
pub(crate) struct AcceptedTrial<P> {
    pub next: Iterate<P>,
    pub fraction: f64,
    pub trials: usize,
    pub predicted: f64,
}

impl<O: Objective> Setting<O> {
    /// All stages of the objective, never cancelled.
    pub fn new(objective: O, set: Arc<dyn Admissible>, metric: Arc<dyn InnerProduct>, options: Options) -> Self {
        let stages = 0..objective.stages();
        Self { objective, set, metric, options, feasibility: 0.0, gap: 0.0, stages, cancel: None }
    }

    /// Ends the run where its flag is raised, or that of any who run together.
    pub fn check_cancelled(&self) -> Result<(), Stop> {
        let here = self.cancel.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed));
        match self.objective.any(here) {
            Ok(false) => Ok(()),
            Ok(true) => Err(Stop::Cancelled),
            Err(failed) => Err(Stop::Aborted(failed)),
        }
    }

    /// A failure, unless it ends the run here or with any who run together: who has failed fatally makes no further call that they would wait in.
    pub fn unless_fatal(&self, failed: Failed) -> Result<Failed, Stop> {
        match self.objective.any(failed.is_fatal()) {
            Ok(false) => Ok(failed),
            Err(lost) if !failed.is_fatal() => Err(Stop::Aborted(lost)),
            _ => Err(Stop::Aborted(failed)),
        }
    }

    pub fn finite_cost(&self, point: &O::Point) -> Result<f64, Failed> {
        let cost = self.objective.value(point);
        if cost.is_finite() { Ok(cost) } else { Err(Failed::because(format!("the cost is {cost}"))) }
    }

    /// Takes the derivative at an evaluated trial, which makes it an iterate; with those of the constraints that the method holds, and its multipliers.
    pub fn differentiate(
        &self,
        m: Vec<f64>,
        mut point: O::Point,
        cost: f64,
        method: &dyn Method,
        workspace: &mut O::Workspace,
    ) -> Result<Iterate<O::Point>, (O::Point, Failed)> {
        let held = match self.objective.held(&mut point, workspace) {
            Ok(Some(held)) => held,
            Ok(None) => {
                return match self.objective.derivative(&mut point, workspace) {
                    Ok(derivative) => self.iterate_of(m, point, cost, derivative),
                    Err(failed) => Err((point, failed)),
                };
            }
            Err(failed) => return Err((point, failed)),
        };
        let whole = [&held.cost_derivative].into_iter().chain(&held.rows);
        if let Some(odd) = whole.into_iter().find(|row| row.len() != m.len() || row.iter().any(|d| !d.is_finite())) {
            let why = format!("a derivative of {} components for {} controls, or no numbers", odd.len(), m.len());
            return Err((point, Failed::because(why)));
        }
        let (set, metric) = (self.set.as_ref(), self.metric.as_ref());
        let here = Current { set, metric, m: &m, cost, derivative: &held.cost_derivative, held: &held };
        let multipliers = method.multipliers(&here);
        let held = Held { multipliers, ..held };
        let iterate = self.iterate_of(m, point, cost, held.lagrangian())?;
        Ok(Iterate { held, ..iterate })
    }

    /// An evaluated trial with its derivative.
    pub fn iterate_of(
        &self,
        m: Vec<f64>,
        point: O::Point,
        cost: f64,
        whole_derivative: Vec<f64>,
    ) -> Result<Iterate<O::Point>, (O::Point, Failed)> {
        if whole_derivative.len() != m.len() {
            let why = format!("{} components for {} controls", whole_derivative.len(), m.len());
            return Err((point, Failed::because(why)));
        }
        if let Some(i) = whole_derivative.iter().position(|d| !d.is_finite()) {
            let why = format!("component {i} is {}", whole_derivative[i]);
            return Err((point, Failed::because(why)));
        }
        let mut derivative = whole_derivative.clone();
        self.set.tangent(&m, &mut derivative);
        let optimality = self.set.optimality(self.metric.as_ref(), &m, &derivative);
        let (gradient_norm, active) = (optimality.norm, optimality.active);
        let held = Held::default();
        Ok(Iterate { m, point, cost, derivative, whole_derivative, gradient_norm, active, held })
    }

    pub fn here<'s>(&'s self, at: &'s Iterate<O::Point>) -> Current<'s> {
        let (set, metric) = (self.set.as_ref(), self.metric.as_ref());
        Current { set, metric, m: &at.m, cost: at.cost, derivative: &at.derivative, held: &at.held }
    }

    /// Finds the next point from `at`, reporting every trial to the observer.
    pub fn search(
        &self,
        method: &mut dyn Method,
        at: &Iterate<O::Point>,
        progress: &mut Progress,
        workspace: &mut O::Workspace,
        observer: &mut dyn Observer<O::Point>,
    ) -> Result<AcceptedTrial<O::Point>, Stop> {
        let mut line = Line { fraction: 1.0, trials: 0, failed: 0, shortest: f64::INFINITY, last: "none".into() };
        loop {
            let mut hessian = ProductsAt {
                objective: &self.objective,
                set: self.set.as_ref(),
                m: &at.m,
                whole_derivative: &at.whole_derivative,
                point: &at.point,
                workspace: &mut *workspace,
                count: &mut progress.counts.products,
            };
            method.prepare(&self.here(at), &mut hessian).map_err(|why| match why.is_fatal() {
                true => Stop::Aborted(why),
                false => Stop::Stalled(Stall::SecondDerivatives { why }),
            })?;
            line.fraction = 1.0;
            match self.search_line(method, at, progress, workspace, observer, &mut line)? {
                Ok(found) => return Ok(found),
                Err(_) if method.recover() => {}
                Err(predicted) => return Err(self.stalled(at, progress, &line, predicted)),
            }
        }
    }

    /// Backtracks from a prepared direction. The inner error is the predicted change of the whole step.
    fn search_line(
        &self,
        method: &mut dyn Method,
        at: &Iterate<O::Point>,
        progress: &mut Progress,
        workspace: &mut O::Workspace,
        observer: &mut dyn Observer<O::Point>,
        line: &mut Line,
    ) -> Result<Result<AcceptedTrial<O::Point>, f64>, Stop> {
        let rules = &self.options.line_search;
        let here = self.here(at);
        let invisible = 0.25 * f64::EPSILON * at.cost.abs();
        let how = self.request(at, progress);
        let mut promised = None;
        let mut tried: Option<Vec<f64>> = None;
        let limit = line.trials + rules.max_trials;
        while line.trials < limit {
            self.check_cancelled()?;
            let m = method.trial(&here, line.fraction);
            let linear = dot(&at.derivative, &sub(&m, &at.m));
            let predicted = method.promise(&here, &Proposed { m: &m, fraction: line.fraction, linear });
            let whole = *promised.get_or_insert(predicted);
            let first_look = whole == predicted;
            if m == at.m || (!first_look && predicted.abs() <= invisible) || line.fraction < 1e-30 {
                break;
            }
            // A shorter step that the set bends back to the same control is no new trial.
            let again = tried.as_ref() == Some(&m);
            if again || predicted >= 0.0 || self.set.check(&m).is_err() {
                line.fraction *= rules.longest;
                continue;
            }
            let length = self.metric.norm(&sub(&m, &at.m));
            line.trials += 1;
            tried = Some(m.clone());
            line.shortest = line.shortest.min(length);
            progress.counts.trials += 1;
            let trial = Step { m, step: method.step(line.fraction), length, predicted: linear };
            let evaluated = self.objective.evaluate(&trial.m, &how, workspace);
            let (point, cost) = match evaluated.and_then(|point| self.finite_cost(&point).map(|cost| (point, cost))) {
                Ok(evaluated) => evaluated,
                Err(failed) => {
                    let failed = self.unless_fatal(failed)?;
                    let factor = rules.fall_back(&failed);
                    let reason = Reason::Failed(failed);
                    line.reject(&reason, true, factor);
                    progress.counts.failed += 1;
                    observer.trial(&self.trial_line(progress, at, trial.parts(None, None, reason)));
                    continue;
                }
            };
            let values = self.objective.held_values(&point);
            let of = Proposed { m: &trial.m, fraction: line.fraction, linear };
            // Rounding is allowed for where the whole step predicts little more than that, not where backtracking led there.
            let slack = Some(method.slack(at.cost)).filter(|slack| whole.abs() <= 100.0 * slack).unwrap_or(0.0);
            let outcome = Tried { of, cost, values: &values, slack };
            let reason = match self.verdict(&*method, &here, &outcome) {
                Ok(reason) => reason,
                Err(refused) => {
                    let jump = self.objective.jump(&at.point, &point, workspace);
                    if jump.is_none() {
                        method.refused(&here, &outcome);
                    }
                    let reason = line.come_back(rules, jump, [at.cost, predicted, cost], refused)?;
                    let parts = trial.parts(Some(&point), Some(cost), reason);
                    observer.trial(&self.trial_line(progress, at, parts));
                    continue;
                }
            };
            progress.counts.derivatives += 1;
            match self.differentiate(trial.m.clone(), point, cost, &*method, workspace) {
                Ok(next) => {
                    let accepted = self.tell_accepted(progress, &next, reason, trial.step, length);
                    observer.trial(&Trial { predicted: Some(linear), ..accepted });
                    return Ok(Ok(AcceptedTrial { next, fraction: line.fraction, trials: line.trials, predicted }));
                }
                Err((point, failed)) => {
                    let failed = self.unless_fatal(failed)?;
                    let reason = Reason::DerivativeFailed(failed);
                    line.reject(&reason, true, rules.after_failure);
                    progress.counts.failed += 1;
                    observer.trial(&self.trial_line(progress, at, trial.parts(Some(&point), Some(cost), reason)));
                }
            }
        }
        Ok(Err(promised.unwrap_or(0.0)))
    }

    /// Whether a trial is accepted, by the method's own test or Armijo's.
    fn verdict(&self, method: &dyn Method, here: &Current<'_>, tried: &Tried<'_>) -> Result<Reason, Reason> {
        match method.judge(here, tried) {
            Judgement::Armijo => {
                let (rules, predicted, reference) =
                    (&self.options.line_search, tried.of.linear, method.reference(here.cost));
                match rules.accepts(reference, predicted, tried.slack, tried.cost) {
                    true => Ok(Reason::Armijo),
                    false => Err(Reason::NoDecrease { wanted: reference + rules.armijo * predicted }),
                }
            }
            Judgement::Taken => Ok(Reason::Conservative),
            Judgement::Underestimated { constraint, model, found } => {
                Err(Reason::Underestimated { constraint, model, found })
            }
        }
    }

    /// What is asked of the objective in a line from `at`.
    fn request<'p>(&self, at: &'p Iterate<O::Point>, progress: &Progress) -> Request<'p, O::Point> {
        Request {
            near: Some(&at.point),
            accuracy: self.options.accuracy_at(progress.relative(at.gradient_norm)),
            stage: progress.stage,
            budget: Budget::Times(self.options.patience),
        }
    }

    fn stalled(&self, at: &Iterate<O::Point>, progress: &Progress, line: &Line, predicted: f64) -> Stop {
        let relative_gradient = progress.relative(at.gradient_norm);
        let flat = predicted.abs() <= 10.0 * f64::EPSILON * at.cost.abs();
        Stop::Stalled(if flat || line.trials == 0 {
            Stall::Flat { cost: at.cost, predicted, relative_gradient }
        } else {
            let (trials, failed, shortest, last) = (line.trials, line.failed, line.shortest, line.last.clone());
            Stall::LineSearch { trials, failed, shortest, last, relative_gradient }
        })
    }

    /// A history line of a trial that was not accepted from `at`.
    fn trial_line<'t>(
        &self,
        progress: &Progress,
        at: &Iterate<O::Point>,
        parts: TrialParts<'t, O::Point>,
    ) -> Trial<'t, O::Point> {
        let summary = match (parts.point, &parts.reason) {
            (Some(point), _) => self.objective.summary(point),
            (None, Reason::Failed(failed)) => failed.work().clone(),
            (None, _) => Summary::default(),
        };
        Trial {
            trial: progress.counts.trials,
            iteration: progress.counts.iterations,
            stage: progress.stage,
            accepted: false,
            reason: parts.reason,
            cost: parts.cost,
            gradient_norm: at.gradient_norm,
            relative_gradient: progress.relative(at.gradient_norm),
            step: parts.step,
            length: parts.length,
            predicted: parts.predicted,
            active: at.active,
            active_share: at.active as f64 / at.m.len() as f64,
            summary,
            m: parts.m,
            point: parts.point,
            derivative: None,
        }
    }

    /// A history line of an accepted point.
    pub fn tell_accepted<'t>(
        &self,
        progress: &Progress,
        next: &'t Iterate<O::Point>,
        reason: Reason,
        step: f64,
        length: f64,
    ) -> Trial<'t, O::Point> {
        let iteration = progress.counts.iterations + usize::from(reason.is_step());
        let parts = TrialParts {
            m: &next.m,
            point: Some(&next.point),
            cost: Some(next.cost),
            reason,
            step,
            length,
            predicted: None,
        };
        let derivative = Some(next.derivative.as_slice());
        Trial { accepted: true, iteration, derivative, ..self.trial_line(progress, next, parts) }
    }
}

/// A step that is tried.
struct Step {
    m: Vec<f64>,
    step: f64,
    length: f64,
    predicted: f64,
}

impl Step {
    fn parts<'t, P>(&'t self, point: Option<&'t P>, cost: Option<f64>, reason: Reason) -> TrialParts<'t, P> {
        let (step, length) = (self.step, self.length);
        TrialParts { m: &self.m, point, cost, reason, step, length, predicted: Some(self.predicted) }
    }
}

/// The changing parts of a history line.
struct TrialParts<'t, P> {
    m: &'t [f64],
    point: Option<&'t P>,
    cost: Option<f64>,
    reason: Reason,
    step: f64,
    length: f64,
    predicted: Option<f64>,
}

/// Where a line search stands.
struct Line {
    fraction: f64,
    trials: usize,
    failed: usize,
    shortest: f64,
    last: String,
}

impl Line {
    /// Shortens the step after a trial whose cost was not low enough, and says why it was not; what ends a run ends it.
    fn come_back(
        &mut self,
        rules: &LineSearch,
        jump: Option<Failed>,
        costs: [f64; 3],
        refused: Reason,
    ) -> Result<Reason, Stop> {
        if let Some(fatal) = jump.as_ref().filter(|failed| failed.is_fatal()) {
            return Err(Stop::Aborted(fatal.clone()));
        }
        // A model that was made more conservative makes a shorter step of the same fraction.
        let factor = match (&jump, &refused) {
            (None, Reason::Underestimated { .. }) => 1.0,
            _ => rules.come_back(jump.as_ref(), costs),
        };
        let reason = jump.map_or(refused, Reason::OtherBranch);
        self.reject(&reason, false, factor);
        Ok(reason)
    }

    fn reject(&mut self, reason: &Reason, failed: bool, factor: f64) {
        self.last = reason.to_string();
        self.failed += usize::from(failed);
        self.fraction *= factor;
    }
}
