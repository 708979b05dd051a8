//! Evaluating a problem in time: the motion and its cost.

use super::Reduced;
use super::in_time::Motion;
use crate::cost::CostPoint;
use crate::error::ControlError;
use crate::evaluated::{Evaluated, MotionRun};
use crate::time::TrajectoryContext;
use crate::workspace::ReducedWorkspace;
use nastic_fem::{Begin, Controls, Recording, SolveOptions, SolveReport, State, StepTo, Trajectory};
use nastic_opt::Request;
use std::sync::Arc;

/// What is told of a state: its number, and itself.
pub(super) type Each<'a> = dyn FnMut(usize, &State) -> Result<(), ControlError> + 'a;

impl Reduced {
    /// The step to the n-th instant.
    pub(super) fn step_to(&self, motion: &Motion, m: &[f64], n: usize) -> Result<StepTo, ControlError> {
        let instants = motion.timeline.instants();
        let before = n.checked_sub(1).map_or(0.0, |before| instants[before]);
        Ok(StepTo { dt: instants[n] - before, controls: self.controls_at(motion, m, n)? })
    }

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
        let mut values = InstantValues::new(motion);
        let (mut work, mut min_j) = (SolveReport::default(), f64::INFINITY);
        let recording = self.run_motion(motion, (m, how.accuracy), workspace, &mut |n, state| {
            work.add_work(&state.report);
            min_j = min_j.min(state.report.min_j);
            self.add_values(motion, (n, state), (m, how.stage), &mut values)
        })?;
        let run = MotionRun { recording, accuracy: how.accuracy, min_j };
        let state = run.recording.part().end().clone();
        work.solver = state.report.solver;
        self.valued_motion(motion, (run, state, work), (m, how.stage), values)
    }

    /// Runs it from t = 0 and tells of every state.
    fn run_motion(
        &self,
        motion: &Motion,
        (m, accuracy): (&[f64], f64),
        workspace: &mut ReducedWorkspace,
        each: &mut Each<'_>,
    ) -> Result<Recording, ControlError> {
        workspace.clear();
        let options = self.solve_options(accuracy);
        let begin = self.beginning(motion, m, &options, workspace)?;
        each(0, begin.end())?;
        let model = self.solid.model();
        let mut recording = Recording::new(begin, motion.timeline.scheme().clone(), self.checkpoints(motion)?);
        for n in 1..=motion.timeline.steps() {
            let to = self.step_to(motion, m, n)?;
            recording.advance(model, &to, &options, &mut workspace.solve)?;
            each(n, recording.part().end())?;
        }
        self.forget(workspace);
        Ok(recording)
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

    /// Calls with the number of every state of a point, from the first to the last, and with the state. A motion that keeps few of them
    /// runs once more.
    ///
    /// # Errors
    /// What `each` returns.
    pub fn for_each_state(
        &self,
        point: &Evaluated,
        each: &mut dyn FnMut(usize, &State) -> Result<(), ControlError>,
    ) -> Result<(), ControlError> {
        match (&self.motion, &point.motion) {
            (Some(motion), Some(run)) if !run.recording.keeps_all() => {
                self.run_motion(motion, (&point.m, run.accuracy), &mut ReducedWorkspace::default(), each).map(drop)
            }
            _ => point.states().iter().enumerate().try_for_each(|(n, state)| each(n, state)),
        }
    }

    /// The values of a motion in another stage.
    pub(super) fn restage_motion(
        &self,
        motion: &Motion,
        run: &MotionRun,
        point: &Evaluated,
        stage: usize,
    ) -> Result<Evaluated, ControlError> {
        let mut values = InstantValues::new(motion);
        let at = (point.m.as_slice(), stage);
        self.for_each_state(point, &mut |n, state| self.add_values(motion, (n, state), at, &mut values))?;
        self.valued_motion(motion, (run.clone(), point.state.clone(), point.work), at, values)
    }

    /// The values of costs and constraints of a motion.
    fn valued_motion(
        &self,
        motion: &Motion,
        (run, state, work): (MotionRun, State, SolveReport),
        (m, stage): (&[f64], usize),
        values: InstantValues,
    ) -> Result<Evaluated, ControlError> {
        let mut terms = values.terms(motion);
        let context = self.motion_context(motion, &run, (m, stage));
        for cost in &motion.costs {
            terms.push(cost.value(&context)?);
        }
        let mut constraint_points = self.constraints_at(&state, m)?;
        let mut constraints: Vec<f64> = constraint_points.iter().flat_map(|point| point.values().to_vec()).collect();
        for rate in &motion.rates {
            constraints.extend(rate.values(&self.layout, m)?);
        }
        if !self.keep_factors {
            constraint_points.clear();
        }
        let (m, costs, motion) = (m.to_vec(), vec![], Some(run));
        Ok(Evaluated { m, state, motion, terms, constraints, stage, work, costs, constraint_points, adjoint: None })
    }

    pub(super) fn motion_context<'a>(
        &'a self,
        motion: &'a Motion,
        run: &'a MotionRun,
        (m, stage): (&'a [f64], usize),
    ) -> TrajectoryContext<'a> {
        let (timeline, trajectory) = (&motion.timeline, run.recording.part());
        TrajectoryContext { solid: &self.solid, layout: &self.layout, timeline, trajectory, m, stage }
    }

    /// The values of all costs that count in a state.
    fn add_values(
        &self,
        motion: &Motion,
        at: (usize, &State),
        (m, stage): (&[f64], usize),
        into: &mut InstantValues,
    ) -> Result<(), ControlError> {
        for place in into.counting[at.0].clone() {
            self.cost_point(motion, place, at, (m, stage), &mut |cost| {
                into.values[place.0][place.1] = cost.value();
                Ok(())
            })?;
        }
        Ok(())
    }

    /// Calls with a cost that counts in a state, evaluated there.
    pub(super) fn cost_point(
        &self,
        motion: &Motion,
        (k, place): (usize, usize),
        (n, state): (usize, &State),
        (m, stage): (&[f64], usize),
        call: &mut dyn FnMut(&dyn CostPoint) -> Result<(), ControlError>,
    ) -> Result<(), ControlError> {
        let cost = motion.schedules[k].own.get(place).unwrap_or(&self.costs[k]);
        let at_instant = self.layout.at(m, motion.timeline.instants()[n])?;
        let context = self.context(state, &at_instant, stage);
        call(cost.at(&context)?.as_ref())
    }
}

/// For each instant the costs that count there, each with its place among the instants of that cost.
pub(super) fn counting(motion: &Motion) -> Vec<Vec<(usize, usize)>> {
    let mut counting = vec![Vec::new(); motion.timeline.instants().len()];
    for (k, schedule) in motion.schedules.iter().enumerate() {
        schedule.weights.iter().enumerate().for_each(|(place, (n, _))| counting[*n].push((k, place)));
    }
    counting
}

/// Values of the costs of states, by cost and place.
struct InstantValues {
    counting: Vec<Vec<(usize, usize)>>,
    values: Vec<Vec<f64>>,
}

impl InstantValues {
    fn new(motion: &Motion) -> Self {
        let values = motion.schedules.iter().map(|schedule| vec![0.0; schedule.weights.len()]).collect();
        InstantValues { counting: counting(motion), values }
    }

    /// Their sums over the motion.
    fn terms(&self, motion: &Motion) -> Vec<f64> {
        let sum = |(schedule, values): (&crate::time::Schedule, &Vec<f64>)| {
            schedule.weights.iter().zip(values).fold(0.0, |sum, ((_, weight), j)| sum + weight * schedule.shape(*j).0)
        };
        motion.schedules.iter().zip(&self.values).map(sum).collect()
    }
}
