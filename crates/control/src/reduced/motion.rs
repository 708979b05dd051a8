//! Evaluating a problem in time: the motion and its cost.

use super::Reduced;
use super::in_time::Motion;
use super::instant::AtInstant;
use super::motion_progress::{InstantValues, Progress};
use crate::cost::{Cost, DistanceInTime, FigureKind};
use crate::evaluated::{Evaluated, SolvedStates};
use crate::time::{MotionObserver, StepUnderWay, TrajectoryContext};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{
    Begin, Controls, Recording, SolveOptions, SolveReport, State, StateError, StepTo, TimeStepping, Trajectory,
};
use nastic_fields::ControlError;
use nastic_opt::Request;
use std::sync::Arc;

/// Instants of a motion at which what moves it is looked at before any step; every step looks again.
const INSTANTS: usize = 200;

impl Reduced {
    /// The step to the n-th instant.
    pub(super) fn step_to(&self, motion: &Motion, m: &[f64], n: usize) -> Result<StepTo, ControlError> {
        let instants = motion.timeline.instants();
        let before = n.checked_sub(1).map_or(0.0, |before| instants[before]);
        let of_instant = self.layout.at(m, instants[n])?;
        Ok(StepTo { dt: instants[n] - before, controls: self.controls_at(motion, &of_instant, n)? })
    }

    /// The controls at the points at the n-th instant, under the control vector of that instant.
    pub(super) fn controls_at(&self, motion: &Motion, of_instant: &[f64], n: usize) -> Result<Controls, ControlError> {
        let mut fixed = self.layout.fixed().clone();
        motion.fixed.iter().try_for_each(|values| values.put(n, &mut fixed))?;
        motion.layout.to_points_over(fixed, of_instant)
    }

    /// Whether what moves supports and obstacles may be what it is at m, of a motion at its instants, of many at two hundred, as every solve asks:
    /// before any is made.
    ///
    /// # Errors
    /// The first that may not; controls of the wrong length.
    pub fn check_own_controls(&self, m: &[f64]) -> Result<(), ControlError> {
        self.layout.check(m)?;
        // those of contributions that check theirs are no fields over cells, but for a mass
        let model = self.solid.model();
        if !model.energies().follows_design() && model.controllable().iter().all(|own| own.cells.is_some()) {
            return Ok(());
        }
        let check = |controls: Controls| {
            Ok(self.solid.model().prescribed_unknowns().check_own_controls(&controls).map_err(StateError::from)?)
        };
        match &self.motion {
            None => check(self.layout.to_points(m)?),
            Some(motion) => {
                let last = motion.timeline.steps();
                let some = (0..last).step_by(last.div_ceil(INSTANTS).max(1)).chain([last]);
                some.into_iter().try_for_each(|n| check(self.step_to(motion, m, n)?.controls))
            }
        }
    }

    /// The motion at m.
    pub(super) fn evaluate_motion(
        &self,
        motion: &Motion,
        m: &[f64],
        how: &Request<'_, Evaluated>,
        observer: Option<&dyn MotionObserver>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Evaluated, ControlError> {
        let resumed = observer.and_then(MotionObserver::resume);
        let (mut found, from) = match &resumed {
            Some(bytes) => {
                let lens: Vec<usize> = self.constraints.iter().map(|constraint| constraint.group().len).collect();
                let read = Progress::from_bytes(bytes, motion, &self.solid, &lens);
                let (found, from) = read.map_err(|error| ControlError::Cost { what: error.to_string() })?;
                (found, Some(from))
            }
            None => (Progress::new(motion), None),
        };
        // the first steps of a scheme over two may have an estimate where others have none
        let estimates = motion.timeline.scheme().estimates_error();
        let is_resumable = !motion.costs.iter().any(|cost| cost.needs_states());
        let options = self.solve_options(how.accuracy);
        let recording = self.run_motion(motion, m, &options, from, workspace, &mut |n, recording| {
            let part = recording.part();
            found.add(part, estimates.then(|| self.solid.model().last_step_error(part)).flatten());
            self.add_values(motion, &self.at_state(n, part.end(), (m, how.stage))?, &mut found.values)?;
            let Some(observer) = observer else { return Ok(()) };
            observer.reached(n, part.end())?;
            if is_resumable && (recording.begins_anew() || n == motion.timeline.steps()) {
                observer.resumable(n, &|| found.to_bytes(part, motion.timeline.scheme()));
            }
            Ok(())
        })?;
        let Progress { values, mut work, min_j, error } = found;
        work.solver = recording.part().end().report.solver;
        let solved = SolvedStates { recording, accuracy: how.accuracy, min_j, error, resumed: resumed.is_some() };
        self.valued_motion(motion, solved, work, m, how.stage, values)
    }

    /// Runs it from t = 0, or from the end of a part of it, and calls at every state.
    fn run_motion(
        &self,
        motion: &Motion,
        m: &[f64],
        options: &SolveOptions<'_>,
        from: Option<Trajectory>,
        workspace: &mut ReducedWorkspace,
        each: &mut dyn FnMut(usize, &Recording) -> Result<(), ControlError>,
    ) -> Result<Recording, ControlError> {
        workspace.clear();
        let model = self.solid.model();
        let is_new = from.is_none();
        let part = from.map_or_else(|| self.beginning(motion, m, options, workspace), Ok)?;
        let done = part.first() + part.states().len() - 1;
        let mut recording = Recording::new(part, motion.timeline.scheme().clone(), self.checkpoints(motion)?);
        if is_new {
            each(0, &recording)?;
        }
        for n in done + 1..=motion.timeline.steps() {
            let to = self.step_to(motion, m, n)?;
            if let Some(steps) = &self.steps {
                let (of, instants) = (motion.timeline.steps(), motion.timeline.instants());
                steps.0(&StepUnderWay { done: n - 1, of, time: instants[n], end: motion.timeline.end() });
            }
            recording.advance(model, &to, options, &mut workspace.solve)?;
            each(n, &recording)?;
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

    pub(super) fn beginning(
        &self,
        motion: &Motion,
        m: &[f64],
        options: &SolveOptions<'_>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Trajectory, ControlError> {
        let controls = self.step_to(motion, m, 0)?.controls;
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
        let solved = &point.solved;
        match &self.motion {
            Some(motion) if solved.resumed || !solved.recording.keeps_all() => {
                let each = &mut |n: usize, recording: &Recording| each(n, recording.part().end());
                // a run that is being cancelled still writes what it found
                let options = SolveOptions { cancel: None, ..self.solve_options(solved.accuracy) };
                self.run_motion(motion, &point.m, &options, None, &mut ReducedWorkspace::default(), each).map(drop)
            }
            _ => point.states().iter().enumerate().try_for_each(|(n, state)| each(n, state)),
        }
    }

    /// By term of states the distances from the target over the instants at which it counts, of terms that have one point and its target; nothing of
    /// others, and empty of a static problem. A motion that keeps few of its states runs once more.
    ///
    /// # Errors
    /// A cost that is not defined in a state.
    pub fn distances_in_time(&self, point: &Evaluated) -> Result<Vec<Option<DistanceInTime>>, ControlError> {
        let Some(motion) = &self.motion else { return Ok(Vec::new()) };
        let mut all: Vec<Vec<f64>> = vec![Vec::new(); self.costs.len()];
        let mut counting = InstantValues::new(motion).counting;
        // what counts at the end alone is in the figures of the state
        let at_end = |k: usize| matches!(motion.schedules[k].weights[..], [(n, _)] if n + 1 == counting.len());
        let wanted: Vec<bool> = (0..all.len()).map(|k| self.costs[k].has_position() && !at_end(k)).collect();
        counting.iter_mut().for_each(|places| places.retain(|(k, _)| wanted[*k]));
        if wanted.contains(&true) {
            self.for_each_state(point, &mut |n, state| {
                let at = self.at_state(n, state, (&point.m, point.stage))?;
                for &(k, place) in &counting[n] {
                    let figures = at.cost(self.scheduled(motion, k, place))?.figures()?;
                    let own = figures.into_iter().filter(|one| one.kind == FigureKind::PositionDistance);
                    all[k].extend(own.map(|one| one.value));
                }
                Ok(())
            })?;
        }
        Ok(all.iter().map(|distances| DistanceInTime::of(distances)).collect())
    }

    /// The values of a motion in another stage.
    pub(super) fn restage_motion(
        &self,
        motion: &Motion,
        point: &Evaluated,
        stage: usize,
    ) -> Result<Evaluated, ControlError> {
        let mut values = InstantValues::new(motion);
        let m = point.m.as_slice();
        self.for_each_state(point, &mut |n, state| {
            self.add_values(motion, &self.at_state(n, state, (m, stage))?, &mut values)
        })?;
        self.valued_motion(motion, point.solved.clone(), point.work, m, stage, values)
    }

    /// The values of costs and constraints of a motion.
    fn valued_motion(
        &self,
        motion: &Motion,
        solved: SolvedStates,
        work: SolveReport,
        m: &[f64],
        stage: usize,
        values: InstantValues,
    ) -> Result<Evaluated, ControlError> {
        let mut terms = values.terms(motion);
        let context = self.motion_context(motion, &solved, m, stage);
        for cost in &motion.costs {
            terms.push(cost.value(&context)?);
        }
        let mut constraints = values.constraints.concat();
        for rate in &motion.rates {
            constraints.extend(rate.values(&self.layout, m)?);
        }
        let (m, costs, constraint_points) = (m.to_vec(), vec![], vec![]);
        Ok(Evaluated { m, solved, terms, constraints, stage, work, costs, constraint_points, adjoint: None })
    }

    pub(super) fn motion_context<'a>(
        &'a self,
        motion: &'a Motion,
        solved: &'a SolvedStates,
        m: &'a [f64],
        stage: usize,
    ) -> TrajectoryContext<'a> {
        let (timeline, trajectory) = (&motion.timeline, solved.recording.part());
        TrajectoryContext { solid: &self.solid, layout: &self.layout, timeline, trajectory, m, stage }
    }

    /// The values of all costs that count in a state, and of the constraints that hold there.
    fn add_values(&self, motion: &Motion, at: &AtInstant, into: &mut InstantValues) -> Result<(), ControlError> {
        for (k, place) in into.counting[at.n].clone() {
            into.values[k][place] = at.cost(self.scheduled(motion, k, place))?.value();
        }
        for (k, own) in into.constraints.iter_mut().enumerate() {
            if motion.constrained_at[k].binary_search(&at.n).is_ok() {
                own.extend(at.constraint(k)?.values());
            }
        }
        Ok(())
    }

    /// The k-th cost term as it is at a place of its schedule.
    pub(super) fn scheduled<'a>(&'a self, motion: &'a Motion, k: usize, place: usize) -> &'a dyn Cost {
        motion.schedules[k].own.get(place).unwrap_or(&self.costs[k]).as_ref()
    }
}
