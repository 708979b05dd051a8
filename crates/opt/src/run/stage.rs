//! Where a stage of a run begins and ends.

use super::{Outcome, Run, RunError};
use crate::failed::Failed;
use crate::objective::Objective;
use crate::observer::{Observer, Reason};
use crate::optimizer::Options;
use crate::search::Iterate;
use crate::state::{Progress, StageEnd};
use crate::stop::{Stall, Stop, Tolerance};
use nastic_numeric::vector::sub;

/// Consecutive flat steps that end a stage.
const MAX_FLAT_STEPS: usize = 3;

impl<O: Objective> Run<O> {
    pub(super) fn is_last_stage(&self) -> bool {
        self.progress.stage + 1 >= self.setting.stages.end
    }

    /// Whether the present stage is to end before another iteration.
    pub(super) fn stage_over(&self) -> Option<Stop> {
        let Options { tolerance, absolute_tolerance, stage_tolerance, max_iterations, window, stagnation, .. } =
            self.setting.options;
        let Progress { counts, stage, stage_began, costs, gradients, flat, .. } = &self.progress;
        let tolerance = if self.is_last_stage() { tolerance } else { tolerance.max(stage_tolerance) };
        let (gradient_norm, first) = (self.current.gradient_norm, gradients[0]);
        let met = self.is_complementary();
        if met && gradient_norm <= tolerance * first {
            return Some(Stop::Converged { gradient_norm, first, tolerance: Tolerance::Relative(tolerance) });
        }
        if met && self.is_last_stage() && gradient_norm <= absolute_tolerance {
            return Some(Stop::Converged { gradient_norm, first, tolerance: Tolerance::Absolute(absolute_tolerance) });
        }
        let relative_gradient = self.progress.relative(gradient_norm);
        if *flat >= MAX_FLAT_STEPS {
            let (cost, predicted) = (self.current.cost, 10.0 * f64::EPSILON * self.current.cost.abs());
            return Some(Stop::Stalled(Stall::Flat { cost, predicted, relative_gradient }));
        }
        let done = counts.iterations - stage_began;
        let left = self.setting.stages.end.saturating_sub(*stage).max(1);
        if done >= max_iterations.saturating_sub(*stage_began).div_ceil(left) {
            return Some(Stop::MaxIterations { iterations: counts.iterations, relative_gradient });
        }
        if done > window {
            let (decrease, mut total) = (costs[done - window] - costs[done], costs[0] - costs[done]);
            if !self.current.held.is_empty() {
                // What the penalty of a violation at the start fell by says nothing of the cost.
                total = total.min(self.current.cost.abs());
            }
            let least = |part: &[f64]| part.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            let (old, new) = gradients.split_at(done + 1 - window);
            if window > 0 && decrease <= stagnation * total && least(new) >= least(old) {
                return Some(Stop::Stalled(Stall::Stagnation { window, decrease, total, relative_gradient }));
            }
        }
        None
    }

    /// Whether constraints that the method holds are met, and used up where they have multipliers: the cost is of second order in the gradient, and so
    /// is what their slack may win.
    pub(crate) fn is_complementary(&self) -> bool {
        let (held, setting) = (&self.current.held, &self.setting);
        let of_stage = if self.is_last_stage() { 0.0 } else { setting.options.stage_tolerance.powi(2) };
        let cost = held.without_penalty(self.current.cost, &held.values).abs();
        held.unmet() <= setting.feasibility && held.gap() <= setting.gap.max(of_stage) * cost
    }

    /// A non-monotone run may meet the tolerance at a point that is clearly worse than one it has seen: then it goes on
    /// from that one.
    pub(super) fn turned_back(&mut self, stop: &Stop) -> bool {
        let Some(best) = &self.best else { return false };
        let fall = self.progress.costs[0] - best.cost;
        if !stop.is_converged() || self.current.cost - best.cost <= 1e-6 * fall {
            return false;
        }
        self.take_best();
        match self.first_step(None) {
            Some(step) => self.method.restart(step, self.current.cost),
            None => return false,
        }
        true
    }

    pub(super) fn end_stage(&mut self, stop: Stop, observer: &mut dyn Observer<O::Point>) -> Outcome {
        self.settle(&stop);
        let Progress { counts, stage, stage_began, .. } = &self.progress;
        let (stage, iterations) = (*stage, counts.iterations - stage_began);
        self.progress.ends.push(StageEnd { stage, iterations, converged: stop.is_converged(), why: stop.to_string() });
        if self.is_last_stage() {
            self.ended = Some(stop.clone());
            return Outcome::Stopped(stop);
        }
        match self.enter(stage + 1) {
            Ok(()) => {
                observer.trial(&self.setting.tell_accepted(&self.progress, &self.current, Reason::Stage, 0.0, 0.0));
                Outcome::Staged(stage + 1)
            }
            Err(failed) if failed.is_fatal() => {
                self.progress.ends.pop();
                Outcome::Stopped(Stop::Aborted(failed))
            }
            Err(failed) => {
                let stop = Stop::Stalled(Stall::Stage { stage: stage + 1, why: failed });
                self.ended = Some(stop.clone());
                Outcome::Stopped(stop)
            }
        }
    }

    /// The same control and state under the next stage's value; nothing changes if that fails.
    fn enter(&mut self, stage: usize) -> Result<(), Failed> {
        let next = self.valued(stage)?;
        self.progress.stage = stage;
        self.progress.counts.trials += 1;
        self.begin_at(next)
    }

    /// The same control and state under the value that `change` gives the objective, as a new stage begins; `counts` says whether
    /// that is a trial. The change stays if the new value cannot be had.
    pub(crate) fn revalue(&mut self, change: impl FnOnce(&mut O), counts: bool) -> Result<(), Failed> {
        change(&mut self.setting.objective);
        let next = self.valued(self.progress.stage)?;
        self.progress.counts.trials += usize::from(counts);
        self.ended = None;
        self.begin_at(next)
    }

    /// A run that has ended finds its end again.
    pub(crate) fn reopen(&mut self) {
        self.ended = None;
    }

    /// The present control as a stage values it, with its derivative.
    fn valued(&mut self, stage: usize) -> Result<Iterate<O::Point>, Failed> {
        let point = self.setting.objective.restage(stage, &self.current.point)?;
        let cost = self.setting.finite_cost(&point)?;
        let next =
            self.setting.differentiate(self.current.m.clone(), point, cost, self.method.as_ref(), &mut self.workspace);
        next.map_err(|(_, failed)| failed)
    }

    fn begin_at(&mut self, next: Iterate<O::Point>) -> Result<(), Failed> {
        let travel = self.setting.metric.norm(&sub(&self.current.m, &self.progress.stage_start));
        self.current = next;
        self.progress.counts.derivatives += 1;
        self.begin_stage(Some(travel).filter(|travel| *travel > 0.0)).map_err(Failed::new)
    }

    pub(super) fn begin_stage(&mut self, travel: Option<f64>) -> Result<(), RunError> {
        let step = self.first_step(travel).ok_or(RunError::NoScale)?;
        self.method.restart(step, self.current.cost);
        self.progress.stage_began = self.progress.counts.iterations;
        self.progress.stage_start.clone_from(&self.current.m);
        self.progress.costs = vec![self.current.cost];
        self.progress.gradients = vec![self.current.gradient_norm];
        self.progress.flat = 0;
        Ok(())
    }

    /// The length t of a first step -t gradient: the shortest of what the set's extent, a linear model of a cost that
    /// is not negative, and the distance covered in the previous stage suggest.
    fn first_step(&self, travel: Option<f64>) -> Option<f64> {
        let gradient = self.current.gradient_norm;
        if gradient == 0.0 {
            return Some(1.0);
        }
        let share = self.setting.options.first_move;
        let extent = self.setting.metric.norm(&self.setting.set.extent(&self.current.m));
        let linear = self.current.cost.abs() / gradient;
        let lengths = [share * extent, linear, travel.map_or(0.0, |travel| share * travel)];
        let usable = lengths.into_iter().filter(|length| *length > 0.0 && length.is_finite());
        usable.reduce(f64::min).map(|length| length / gradient)
    }
}
