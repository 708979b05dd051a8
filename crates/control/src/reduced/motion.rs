//! Evaluating a problem in time: the motion, its cost, and the derivative by one reverse sweep.

use super::in_time::Motion;
use super::{Lagrangian, Reduced};
use crate::cost::{CostPoint, Partials};
use crate::error::ControlError;
use crate::evaluated::{AdjointState, Evaluated, MotionRun};
use crate::time::{TrajectoryContext, TrajectoryPartials};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{Begin, Controls, SolveOptions, SolveReport, State, StepTo, Trajectory};
use nastic_numeric::vector::axpy;
use nastic_opt::Request;
use std::sync::Arc;

impl Reduced {
    /// The controls at the points at the n-th instant.
    fn controls_at(&self, motion: &Motion, m: &[f64], n: usize) -> Result<Controls, ControlError> {
        let mut fixed = self.layout.fixed().clone();
        for (actuation, slot, values) in &motion.fixed {
            fixed.set(*actuation, *slot, &values[n])?;
        }
        motion.layout.to_points_over(fixed, &self.layout.at(m, motion.timeline.instants()[n])?)
    }

    /// The motion at m.
    pub(super) fn evaluate_motion(
        &self,
        motion: &Motion,
        m: &[f64],
        how: &Request<'_, Evaluated>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Evaluated, ControlError> {
        workspace.clear();
        let options = self.solve_options(how.accuracy);
        let mut trajectory = self.beginning(motion, m, &options, workspace)?;
        let model = self.solid.model();
        for (n, pair) in motion.timeline.instants().windows(2).enumerate() {
            let to = StepTo { dt: pair[1] - pair[0], controls: self.controls_at(motion, m, n + 1)? };
            model.advance(&mut trajectory, motion.timeline.scheme(), &[to], &options, &mut workspace.solve)?;
        }
        self.forget(workspace);
        let run = MotionRun { trajectory: Arc::new(trajectory), accuracy: how.accuracy };
        self.valued_motion(motion, run, m, how.stage)
    }

    /// The state that a motion under m begins at, an equilibrium to this relative accuracy; `None` of a problem that is not one in time.
    ///
    /// # Errors
    /// A vector of the wrong length; no equilibrium.
    pub fn initial_state(&self, m: &[f64], accuracy: f64) -> Result<Option<State>, ControlError> {
        let Some(motion) = &self.motion else { return Ok(None) };
        self.layout.check(m)?;
        let mut workspace = ReducedWorkspace::default();
        let trajectory = self.beginning(motion, m, &self.solve_options(accuracy), &mut workspace)?;
        Ok(Some(trajectory.end().clone()))
    }

    fn beginning(
        &self,
        motion: &Motion,
        m: &[f64],
        options: &SolveOptions<'_>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Trajectory, ControlError> {
        let controls = self.controls_at(motion, m, 0)?;
        let velocity = motion.timeline.initial_velocity().map(|v| Arc::new(v.to_vec()));
        match motion.timeline.begin() {
            Begin::Equilibrium => {
                let state = self.solid.solve_with(&controls, options, &mut workspace.solve)?;
                self.check_stable(&state)?;
                Ok(Trajectory::from(State { velocity, ..state }))
            }
            Begin::Given => {
                let controls = Arc::new(controls);
                Ok(Trajectory::from_given(State { controls, velocity, ..self.solid.rest() }))
            }
        }
    }

    /// The values of costs and constraints of a motion.
    pub(super) fn valued_motion(
        &self,
        motion: &Motion,
        run: MotionRun,
        m: &[f64],
        stage: usize,
    ) -> Result<Evaluated, ControlError> {
        let context = self.motion_context(motion, &run, (m, stage));
        let mut terms = Vec::new();
        for (k, schedule) in motion.schedules.iter().enumerate() {
            let mut value = 0.0;
            self.for_each_instant((motion, &run), (k, m, stage), |_, weight, point| {
                value += weight * schedule.shape(point.value()).0;
                Ok(())
            })?;
            terms.push(value);
        }
        for cost in &motion.costs {
            terms.push(cost.value(&context)?);
        }
        let state = run.trajectory.end().clone();
        let mut constraint_points = self.constraints_at(&state, m)?;
        let mut constraints: Vec<f64> = constraint_points.iter().flat_map(|point| point.values().to_vec()).collect();
        for rate in &motion.rates {
            constraints.extend(rate.values(&self.layout, m)?);
        }
        if !self.keep_factors {
            constraint_points.clear();
        }
        let mut work = SolveReport::default();
        run.trajectory.states().iter().for_each(|state| work.add_work(&state.report));
        work.solver = state.report.solver;
        let (m, costs, motion) = (m.to_vec(), vec![], Some(run));
        Ok(Evaluated { m, state, motion, terms, constraints, stage, work, costs, constraint_points, adjoint: None })
    }

    fn motion_context<'a>(
        &'a self,
        motion: &'a Motion,
        run: &'a MotionRun,
        (m, stage): (&'a [f64], usize),
    ) -> TrajectoryContext<'a> {
        let (timeline, trajectory) = (&motion.timeline, run.trajectory.as_ref());
        TrajectoryContext { solid: &self.solid, layout: &self.layout, timeline, trajectory, m, stage }
    }

    /// Calls back with each instant at which the k-th cost counts, its weight there, and the evaluated cost.
    fn for_each_instant(
        &self,
        (motion, run): (&Motion, &MotionRun),
        (k, m, stage): (usize, &[f64], usize),
        mut each: impl FnMut(usize, f64, &dyn CostPoint) -> Result<(), ControlError>,
    ) -> Result<(), ControlError> {
        let schedule = &motion.schedules[k];
        for (place, (n, weight)) in schedule.weights.iter().enumerate() {
            let cost = schedule.own.get(place).unwrap_or(&self.costs[k]);
            let state = &run.trajectory.states()[*n];
            let at_instant = self.layout.at(m, motion.timeline.instants()[*n])?;
            let context = self.context(state, &at_instant, stage);
            each(*n, *weight, cost.at(&context)?.as_ref())?;
        }
        Ok(())
    }

    /// Partial derivatives of the cost of a motion (all terms, or one of them).
    pub(super) fn partials_of_motion(
        &self,
        motion: &Motion,
        run: &MotionRun,
        point: &Evaluated,
        term: Option<usize>,
    ) -> Result<TrajectoryPartials, ControlError> {
        let instants = motion.timeline.instants();
        let mut out = TrajectoryPartials::zero(instants.len(), point.m.len());
        let wanted = |k: usize| term.is_none_or(|term| term == k);
        for k in (0..motion.schedules.len()).filter(|k| wanted(*k)) {
            self.for_each_instant((motion, run), (k, &point.m, point.stage), |n, weight, cost| {
                let mut own = Partials::zero(point.state.u.len(), motion.layout.len());
                cost.add_partials(&mut own)?;
                let factor = weight * motion.schedules[k].shape(cost.value()).1;
                self.add_partials_at(&instants[n], factor, &own, (n, &mut out));
                Ok(())
            })?;
        }
        let context = self.motion_context(motion, run, (&point.m, point.stage));
        for (k, cost) in motion.costs.iter().enumerate() {
            if wanted(motion.schedules.len() + k) {
                cost.add_partials(&context, &mut out)?;
            }
        }
        Ok(out)
    }

    /// Adds those of a functional of one instant, times a factor.
    fn add_partials_at(&self, t: &f64, factor: f64, own: &Partials, (n, out): (usize, &mut TrajectoryPartials)) {
        let by_u = &mut out.states[n].u;
        by_u.resize(own.u.len(), 0.0);
        axpy(factor, &own.u, by_u);
        let by_m: Vec<f64> = own.m.iter().map(|d| factor * d).collect();
        self.layout.add_at(*t, &by_m, &mut out.m);
    }

    /// Those of costs and constraints, as `of` weighs them.
    pub(super) fn lagrangian_partials_of_motion(
        &self,
        motion: &Motion,
        run: &MotionRun,
        point: &Evaluated,
        of: Lagrangian<'_>,
    ) -> Result<TrajectoryPartials, ControlError> {
        let mut out = match of.costs {
            true => self.partials_of_motion(motion, run, point, None)?,
            false => TrajectoryPartials::zero(motion.timeline.instants().len(), point.m.len()),
        };
        if of.y.iter().all(|y| *y == 0.0) {
            return Ok(out);
        }
        let constraints = self.constraints_of(point)?;
        let mut at_end = Partials::zero(point.state.u.len(), motion.layout.len());
        let mut used = 0;
        for (constraint, y) in Self::with_weights(&constraints, of.y) {
            constraint.add_partials(y, &mut at_end)?;
            used += y.len();
        }
        self.add_partials_at(&motion.timeline.end(), 1.0, &at_end, (motion.timeline.steps(), &mut out));
        for rate in &motion.rates {
            let len = rate.group(&self.layout)?.len;
            let y = of.y.get(used..used + len).unwrap_or_default();
            rate.add_partials(&self.layout, (&point.m, y), &mut out.m)?;
            used += len;
        }
        Ok(out)
    }

    /// `d/dm` of what has these partials, by one reverse sweep, and the adjoint state at the end.
    pub(super) fn sensitivity_of_motion(
        &self,
        motion: &Motion,
        run: &MotionRun,
        (m, partials): (&[f64], TrajectoryPartials),
        workspace: &mut ReducedWorkspace,
    ) -> Result<(Vec<f64>, Option<AdjointState>), ControlError> {
        let TrajectoryPartials { states, m: mut derivative } = partials;
        let is_zero = |d: &[f64]| d.iter().all(|d| *d == 0.0);
        if states.iter().all(|by| is_zero(&by.u) && is_zero(&by.velocity)) {
            return Ok((derivative, None));
        }
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let swept = self.solid.model().reverse_sweep(&run.trajectory, &states, &how, &mut workspace.solve);
        self.forget(workspace);
        let mut swept = swept?;
        for (t, by_point) in motion.timeline.instants().iter().zip(&swept.controls) {
            let by_instant = motion.layout.control_vjp(&self.layout.at(m, *t)?, by_point);
            self.layout.add_at(*t, &by_instant, &mut derivative);
        }
        let lambda = swept.lambda.pop().unwrap_or_default();
        Ok((derivative, Some(AdjointState { lambda, work: swept.report, multipliers: vec![] })))
    }
}
