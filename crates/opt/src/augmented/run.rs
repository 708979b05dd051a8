//! [`AugmentedRun`]: runs of an optimiser, with updates of multipliers and penalty in between.

use super::multipliers::Multipliers;
use super::outer::{AugmentedState, Outer, SavedOuter};
use super::report::ConstraintsReport;
use super::{Augmented, AugmentedLagrangian, Domain};
use crate::constrained::Constrained;
use crate::constrained::Sense;
use crate::failed::Failed;
use crate::objective::Objective;
use crate::observer::{Observer, Reason};
use crate::optimizer::{Optimizer, Options, Unfit};
use crate::run::{Best, Outcome, Run, RunError};
use crate::search::Setting;
use crate::start::Start;
use crate::state::Progress;
use crate::stop::{Stall, Stop, Tolerance};
use nastic_numeric::vector::sub;
use std::fmt;

/// Accuracy of states over the feasibility asked for.
const STATE_ACCURACY_SHARE: f64 = 0.1;
/// First penalty over the cost at the start.
const PENALTY_RATIO: f64 = 10.0;
/// The same of a method that holds the constraints: no multiplier is larger than the penalty there.
const HELD_PENALTY_RATIO: f64 = 1000.0;
/// Decrease of the cost by an inner run, as a share of the cost, up to which the run has converged.
const MAX_STALLED_DECREASE: f64 = 1e-6;

/// A run under constraints: see [`AugmentedLagrangian`]. Stepped, saved and finished as a [`Run`]; without constraints it is one.
pub struct AugmentedRun<O: Constrained> {
    options: AugmentedLagrangian,
    /// Those of the optimiser, which the inner runs have changed ones of.
    own: Options,
    run: Run<Augmented<O>>,
    /// Absent without constraints.
    outer: Option<Outer>,
    ended: Option<Stop>,
}

impl<O: Constrained> fmt::Debug for AugmentedRun<O>
where
    Run<Augmented<O>>: fmt::Debug,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { options, run, outer, .. } = self;
        f.debug_struct("AugmentedRun").field("options", options).field("run", run).field("outer", outer).finish()
    }
}

/// Where a run under constraints ended.
#[derive(Clone, Debug)]
pub struct AugmentedBest<P> {
    /// The point; its `cost` is that of the objective alone, `derivative` and `gradient_norm` are those of the Lagrangian.
    pub best: Best<P>,
    /// Values and multipliers there; without groups where there are no constraints.
    pub constraints: ConstraintsReport,
}

impl<O: Constrained> AugmentedRun<O> {
    pub(super) fn begin(
        options: AugmentedLagrangian,
        optimizer: &dyn Optimizer,
        objective: O,
        domain: Domain,
        start: Start<O::Point>,
    ) -> Result<Self, RunError> {
        let (setting, own, constrained) = setting(&options, optimizer, objective, domain)?;
        let run = Run::begin(optimizer, setting, start)?;
        let mut out = Self { options, own, run, outer: None, ended: None };
        if constrained {
            out.begin_penalty()?;
        }
        Ok(out)
    }

    pub(super) fn resume(
        options: AugmentedLagrangian,
        optimizer: &dyn Optimizer,
        objective: O,
        domain: Domain,
        state: &AugmentedState,
    ) -> Result<Self, RunError> {
        let (mut setting, own, constrained) = setting(&options, optimizer, objective, domain)?;
        let unfit = |why: &str| RunError::Saved(Failed::because(why));
        let outer = match (&state.outer, constrained) {
            (None, false) => None,
            (Some(saved), true) if saved.multipliers.len() == setting.objective.multipliers.values.len() => {
                let multipliers = &mut setting.objective.multipliers;
                multipliers.values.clone_from(&saved.multipliers);
                multipliers.penalty = saved.penalty;
                Some(saved.outer.clone())
            }
            _ => return Err(unfit("it has other constraints")),
        };
        let run = Run::resume(optimizer, setting, &state.run)?;
        let mut out = Self { options, own, run, outer, ended: None };
        out.set_tolerances();
        Ok(out)
    }

    /// Chooses the first penalty and values the start with it.
    fn begin_penalty(&mut self) -> Result<(), RunError> {
        let penalty = self.options.penalty.unwrap_or_else(|| {
            let ratio = if self.run.objective().held { HELD_PENALTY_RATIO } else { PENALTY_RATIO };
            ratio * self.run.cost().abs()
        });
        if !(penalty > 0.0 && penalty.is_finite()) {
            return Err(RunError::NoPenalty { cost: self.run.cost(), penalty });
        }
        let limit = self.limit();
        let of_cost = self.run.gradient_norm();
        self.run.revalue(|o| o.multipliers.penalty = penalty, false).map_err(RunError::Start)?;
        self.outer = Some(Outer {
            first_penalty: penalty,
            first_gradient: if of_cost > 0.0 { of_cost } else { self.run.gradient_norm() },
            measure: f64::INFINITY,
            violation: f64::INFINITY,
            limit,
            ..Outer::default()
        });
        self.set_tolerances();
        Ok(())
    }

    /// Iterations at which the inner run that begins now is to end.
    fn limit(&self) -> usize {
        if self.run.objective().held {
            return self.own.max_iterations;
        }
        let Progress { counts, stage, .. } = self.run.progress();
        let stages = self.run.objective().stages().saturating_sub(*stage).max(1);
        let most = counts.iterations.saturating_add(self.options.inner_iterations.saturating_mul(stages));
        most.min(self.own.max_iterations)
    }

    /// The norm of the projected gradient at which the whole run may end, and the tolerance that it is.
    fn stationary(&self, outer: &Outer) -> (f64, Tolerance) {
        let (relative, absolute) = (self.own.tolerance * outer.first_gradient, self.own.absolute_tolerance);
        if relative >= absolute {
            (relative, Tolerance::Relative(self.own.tolerance))
        } else {
            (absolute, Tolerance::Absolute(absolute))
        }
    }

    fn set_tolerances(&mut self) {
        let Some(outer) = &self.outer else { return };
        let (limit, (absolute, _)) = (outer.limit, self.stationary(outer));
        let options = &mut self.run.setting.options;
        (options.max_iterations, options.absolute_tolerance) = (limit, absolute);
        // A method that holds the constraints goes on to the end of the whole run.
        options.tolerance = if self.run.setting.objective.held { 0.0 } else { self.options.inner_tolerance };
    }

    /// One iteration, the passage to the next stage, an update of the multipliers, or nothing when the run has ended.
    pub fn step(&mut self, observer: &mut dyn Observer<O::Point>) -> Outcome {
        if let Some(stop) = &self.ended {
            return Outcome::Stopped(stop.clone());
        }
        match self.run.step(observer) {
            Outcome::Stopped(stop) if self.outer.is_some() && !stop.is_interrupted() => {
                self.inner_ended(stop, observer)
            }
            outcome => outcome,
        }
    }

    /// Steps until the run ends.
    pub fn run(&mut self, observer: &mut dyn Observer<O::Point>) -> Stop {
        loop {
            if let Outcome::Stopped(stop) = self.step(observer) {
                return stop;
            }
        }
    }

    /// Ends the run, or begins the next inner one.
    fn inner_ended(&mut self, stop: Stop, observer: &mut dyn Observer<O::Point>) -> Outcome {
        let Some(mut outer) = self.outer.take() else { return Outcome::Stopped(stop) };
        let before = outer.clone();
        let c = self.run.objective().objective.constraint_values(self.run.point());
        let settled = !matches!(stop, Stop::MaxIterations { .. });
        let end = self.end(&mut outer, stop, settled, &c);
        if let Some(stop) = end {
            self.outer = Some(outer);
            self.close(&stop);
            return Outcome::Stopped(stop);
        }
        self.run.progress.ends.pop();
        let multipliers = &self.run.objective().multipliers;
        let (values, penalty) = match self.run.objective().held {
            true => (multipliers.values.clone(), outer.stiffen(&self.options, multipliers, &c)),
            false => outer.update(&self.options, multipliers, &c, settled),
        };
        let known = (multipliers.values.clone(), multipliers.penalty);
        let change = |o: &mut Augmented<O>| (o.multipliers.values, o.multipliers.penalty) = (values, penalty);
        outer.limit = self.limit();
        self.outer = Some(outer);
        match self.run.revalue(change, true) {
            Ok(()) => {
                self.set_tolerances();
                let (setting, at) = (&self.run.setting, &self.run.current);
                observer.trial(&setting.tell_accepted(&self.run.progress, at, Reason::Multipliers, 0.0, 0.0));
                Outcome::Iterated
            }
            Err(failed) if failed.is_fatal() => {
                // It stands before the update: point and multipliers belong together, and the next step makes the update again.
                let multipliers = &mut self.run.setting.objective.multipliers;
                (multipliers.values, multipliers.penalty) = known;
                self.outer = Some(before);
                self.run.reopen();
                Outcome::Stopped(Stop::Aborted(failed))
            }
            Err(why) => {
                let stop = Stop::Stalled(Stall::Stage { stage: self.run.progress.stage, why });
                self.ended = Some(stop.clone());
                Outcome::Stopped(stop)
            }
        }
    }

    /// Why the whole run ends where an inner one ended, if it does.
    fn end(&mut self, outer: &mut Outer, stop: Stop, settled: bool, c: &[f64]) -> Option<Stop> {
        let first = outer.first_gradient;
        let (norm, tolerance) = self.stationary(outer);
        let gradient_norm = self.run.gradient_norm();
        let augmented = self.run.objective();
        let measure =
            if augmented.held { augmented.multipliers.violation(c) } else { augmented.multipliers.measure(c) };
        let feasible = measure <= self.options.feasibility;
        let complementary = self.run.is_complementary();
        if feasible && complementary && gradient_norm <= norm {
            return Some(Stop::Converged { gradient_norm, first, tolerance });
        }
        let iterations = self.run.progress().counts.iterations;
        let used_up = iterations >= self.own.max_iterations || outer.updates >= self.options.max_updates;
        if used_up {
            let relative_gradient = if first > 0.0 { gradient_norm / first } else { 0.0 };
            return Some(Stop::MaxIterations { iterations, relative_gradient });
        }
        // The multipliers are right: a further update changes nothing that the optimiser could see.
        if feasible && self.is_final(&stop) {
            return Some(stop);
        }
        if settled && outer.is_infeasible(&self.options, &self.run.objective().multipliers, c) {
            return Some(self.infeasible(outer, c));
        }
        None
    }

    /// Whether an inner run stalled so that another one under the same multipliers would too. One that stagnates measures itself by
    /// its own first steps, and another one starts afresh.
    fn is_final(&self, stop: &Stop) -> bool {
        match stop {
            Stop::Stalled(_) if self.run.objective().held => true,
            Stop::Stalled(Stall::Stagnation { total, .. }) => *total <= MAX_STALLED_DECREASE * self.run.cost().abs(),
            stop => matches!(stop, Stop::Stalled(_)),
        }
    }

    fn infeasible(&mut self, outer: &Outer, c: &[f64]) -> Stop {
        let multipliers = &self.run.objective().multipliers;
        let (violation, penalty) = (multipliers.violation(c), multipliers.penalty / outer.first_penalty);
        let gradient = self.violation_gradient(c).unwrap_or(f64::NAN);
        let (constraint, index) = self.run.objective().multipliers.worst(c);
        Stop::Infeasible { constraint, index, violation, penalty, gradient }
    }

    /// Norm of the projected gradient of half the squared violations.
    fn violation_gradient(&mut self, c: &[f64]) -> Result<f64, Failed> {
        let mut squared = Multipliers::none(self.run.objective().multipliers.groups().to_vec());
        squared.penalty = 1.0;
        let y = squared.slopes(c);
        let (setting, m) = (&self.run.setting, &self.run.current.m);
        let (objective, stage) = (&setting.objective.objective, self.run.progress.stage);
        let mut point = objective.restage(stage, &self.run.current.point)?;
        let mut workspace = O::Workspace::default();
        let all = objective.lagrangian_derivative(&mut point, &y, &mut workspace)?;
        let mut gradient = sub(&all, &objective.derivative(&mut point, &mut workspace)?);
        setting.set.tangent(m, &mut gradient);
        Ok(setting.set.optimality(setting.metric.as_ref(), m, &gradient).norm)
    }

    /// The last stage's entry speaks of all inner runs.
    fn close(&mut self, stop: &Stop) {
        self.ended = Some(stop.clone());
        let Progress { ends, counts, .. } = &mut self.run.progress;
        let Some((last, before)) = ends.split_last_mut() else { return };
        last.iterations = counts.iterations - before.iter().map(|end| end.iterations).sum::<usize>();
        (last.converged, last.why) = (stop.is_converged(), stop.to_string());
    }

    /// Goes on with what earlier evaluations of the same problem left in a workspace, in place of the run's own.
    #[must_use]
    pub fn with_workspace(mut self, workspace: O::Workspace) -> Self {
        self.run = self.run.with_workspace(workspace);
        self
    }

    /// A scheduled checkpoint: as [`Run::checkpoint`].
    pub fn checkpoint(&mut self) -> AugmentedState {
        let run = self.run.checkpoint();
        self.saved(run)
    }

    /// The run as plain numbers: as [`Run::save`].
    pub fn save(&self) -> AugmentedState {
        self.saved(self.run.save())
    }

    fn saved(&self, run: crate::state::RunState) -> AugmentedState {
        let multipliers = &self.run.objective().multipliers;
        let outer = self.outer.clone().map(|outer| SavedOuter {
            outer,
            multipliers: multipliers.values.clone(),
            penalty: multipliers.penalty,
        });
        AugmentedState { run, outer }
    }

    /// Ends the run where it stands, for a reason.
    pub fn finish(mut self, stop: Stop) -> AugmentedBest<O::Point> {
        self.run.settle(&stop);
        let constraints = self.constraints();
        let cost = self.run.objective().objective.value(self.run.point());
        let mut best = self.run.finish(stop);
        best.cost = cost;
        AugmentedBest { best, constraints }
    }

    /// Values and multipliers at the present point.
    pub fn constraints(&self) -> ConstraintsReport {
        let augmented = self.run.objective();
        let c = augmented.objective.constraint_values(self.run.point());
        let slopes = match augmented.held {
            true => augmented.multipliers.per_value(&self.run.current.held.multipliers),
            false => augmented.multipliers.slopes(&c),
        };
        ConstraintsReport::new(&augmented.multipliers, c, slopes, self.outer.as_ref().map_or(0, |outer| outer.updates))
    }

    /// Where the run stands.
    pub fn progress(&self) -> &Progress {
        self.run.progress()
    }

    /// The present control.
    pub fn m(&self) -> &[f64] {
        self.run.m()
    }

    /// The present point.
    pub fn point(&self) -> &O::Point {
        self.run.point()
    }

    /// The best point so far, where that is another one.
    pub fn best_point(&self) -> Option<&O::Point> {
        self.run.best_point()
    }

    /// The present augmented Lagrangian, for example for a [`Taylor`](crate::Taylor) test.
    pub fn augmented(&self) -> &Augmented<O> {
        self.run.objective()
    }
}

/// What the run works on, the optimiser's own options, and whether there are constraints.
fn setting<O: Constrained>(
    options: &AugmentedLagrangian,
    optimizer: &dyn Optimizer,
    objective: O,
    Domain { set, metric, cancel }: Domain,
) -> Result<(Setting<Augmented<O>>, Options, bool), Unfit> {
    let held = optimizer.holds_constraints();
    let augmented = Augmented::new(objective, STATE_ACCURACY_SHARE * options.feasibility, held);
    if let Some(group) = augmented.multipliers.groups().iter().find(|group| held && group.sense == Sense::Equal) {
        return Err(Unfit::Equality { method: optimizer.name(), constraint: group.name.clone() });
    }
    let constrained = !augmented.multipliers.values.is_empty();
    let own = *optimizer.options();
    let mut setting = Setting::new(augmented, set, metric, own);
    setting.cancel = cancel;
    setting.feasibility = options.feasibility;
    setting.gap = own.tolerance.powi(2).max(options.feasibility);
    Ok((setting, own, constrained))
}
