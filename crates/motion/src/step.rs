//! [`TimeStepping::advance`](crate::TimeStepping::advance): one stepper for all schemes.

use crate::beginning::check_velocity;
use crate::initial_acceleration::initial_acceleration;
use crate::modal_step::ModalStep;
use crate::modal_step::modal_step;
use crate::points::Points;
use crate::scheme::Scheme;
use crate::supported::supports_motion;
use crate::trajectory::{Step, StepTo, Trajectory};
use nastic_body::contribution::Demand;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::{SolveReport, State};
use nastic_equilibrium::adjoint::inverted;
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::nonlinear::iterate::Stop;
use nastic_equilibrium::search::options::SolveOptions;
use nastic_linear::LinearError;
use std::sync::Arc;

/// Relative difference up to which two lengths of steps are equal.
const LENGTH_TOLERANCE: f64 = 1e-12;

/// A step that was found.
pub(crate) struct SolvedStep {
    pub step: Step,
    pub state: State,
    /// The estimated error of its displacement, of a scheme that has one.
    pub error: Option<Vec<f64>>,
}

/// Parts into which a step without a solution is cut.
pub(crate) const MAX_PARTS: usize = 16;

/// [`TimeStepping::advance`](crate::TimeStepping::advance).
pub(crate) fn advance(
    model: &Model,
    trajectory: &mut Trajectory,
    scheme: &Scheme,
    steps: &[StepTo],
    how: &SolveOptions,
    workspace: &mut Workspace,
) -> Result<(), StateError> {
    check_motion(model, trajectory, scheme)?;
    if trajectory.steps().is_empty() {
        model.moves().check_start(trajectory.end(), how.parallel)?;
    }
    if scheme.is_quasi_static() {
        check_quasi_static(model, trajectory, scheme)?;
    }
    let scheme = Arc::new(scheme.clone());
    let start = scheme.start().cloned().map(Arc::new);
    for to in steps {
        if !(to.dt.is_finite() && to.dt > 0.0) {
            let what = format!("a time step of {} is not positive", to.dt);
            return Err(FemError::Meaningless { what }.into());
        }
        model.checks().check_controls(&to.controls)?;
        let equal = trajectory.steps().last().is_some_and(|last| (last.dt - to.dt).abs() <= LENGTH_TOLERANCE * to.dt);
        let used = start.as_ref().filter(|_| !equal).unwrap_or(&scheme).clone();
        let found = step_or_parts(model, trajectory, used, to, how, workspace)?;
        trajectory.push(found.step, found.state);
    }
    Ok(())
}

/// Whether a motion can continue from there.
pub(crate) fn check_motion(model: &Model, trajectory: &Trajectory, scheme: &Scheme) -> Result<(), StateError> {
    model.checks().check_in_motion()?;
    supports_motion(model, scheme)?;
    let end = trajectory.end();
    model.checks().check_state(end)?;
    model.supports.check_tied("the displacement", &end.u)?;
    check_velocity(model, end)?;
    Ok(model.prescribed_unknowns().check_prescribed(trajectory.end())?)
}

/// What goes without inertia: a body that is held, and no velocity but that of an earlier step of the kind.
fn check_quasi_static(model: &Model, trajectory: &Trajectory, scheme: &Scheme) -> Result<(), StateError> {
    model.checks().check_held()?;
    // what begins later is a part of a recording, of one scheme, which was checked where it began
    let own = trajectory.first() > 0 || trajectory.steps().last().is_some_and(|last| last.scheme.is_quasi_static());
    let mut velocity = trajectory.end().velocity.iter().flat_map(|v| v.iter());
    if !own && velocity.any(|v| *v != 0.0) {
        let what =
            format!("{} without inertia from a body that moves: begin at rest, or take quasi_dynamic", scheme.name());
        return Err(FemError::Meaningless { what }.into());
    }
    Ok(())
}

/// A step; one of a body in contact that has no solution is made as 2, 4, .. steps, and the report counts a cut.
fn step_or_parts(
    model: &Model,
    trajectory: &Trajectory,
    scheme: Arc<Scheme>,
    to: &StepTo,
    how: &SolveOptions,
    workspace: &mut Workspace,
) -> Result<SolvedStep, StateError> {
    let whole = scheme.start().unwrap_or(&scheme);
    let parted = |cut: u32| match model.properties().goes_in_parts() && cut <= MAX_PARTS.ilog2() {
        true => whole.in_parts(1 << cut).map(Arc::new),
        false => None,
    };
    let mut next = parted(1);
    let mut failed = match step(model, trajectory, scheme.clone(), next.is_some(), to, how, workspace) {
        Err(error @ StateError::InStep { .. }) => error,
        done => return done,
    };
    let mut spent = failed.newton();
    for cut in 2.. {
        let Some(parts) = next.filter(|_| !failed.is_final()) else { break };
        next = parted(cut);
        match step(model, trajectory, parts, next.is_some(), to, how, workspace) {
            Ok(mut found) => {
                found.state.report.newton += spent;
                found.state.report.cuts += 1;
                return Ok(found);
            }
            Err(error @ StateError::InStep { .. }) => {
                spent += error.newton();
                failed = if error.is_final() { error } else { failed };
            }
            Err(error) => return Err(error),
        }
    }
    Err(failed)
}

/// `shorter`: a step that fails is replaced by shorter steps.
pub(crate) fn step(
    model: &Model,
    trajectory: &Trajectory,
    scheme: Arc<Scheme>,
    shorter: bool,
    to: &StepTo,
    how: &SolveOptions,
    workspace: &mut Workspace,
) -> Result<SolvedStep, StateError> {
    let (begin, h) = (trajectory.end(), to.dt);
    let before = trajectory.states().len().checked_sub(2).map(|n| &trajectory.states()[n]);
    let history = model.memory().next_history(begin, how.parallel);
    let history = history.map_err(|at| inverted(at, begin))?;
    let started = match scheme.needs_acceleration() && begin.acceleration.is_none() {
        true => Some(Arc::new(initial_acceleration(model, begin, &history, how.parallel)?)),
        false => None,
    };
    let mut points = Points::new(&scheme, h, begin, before, started.as_ref(), model.discretization().dofs());
    let (mut stages, mut work) = (Vec::new(), SolveReport::default());
    let mut modes = None;
    let mut here = begin.clone();
    for stage in &scheme.stages {
        let of_stage = Arc::new(model.memory().history_of_step(&history, stage.time * h));
        let time_step = TimeStep { history: of_stage, ..points.next(&to.controls) };
        let controls = begin.controls.blend(&to.controls, stage.time);
        let options = SolveOptions { near: Some(&here), guess: None, ..how.clone() };
        modes = match scheme.exact_modes() {
            0 => None,
            count => Some(modal_step(model, count, begin, &controls, &time_step, how)?),
        };
        let exact = modes.as_ref().map(|modes: &ModalStep| |step: &mut [f64]| modes.replace(step));
        let replace = exact.as_ref().map(|exact| exact as &dyn Fn(&mut [f64]));
        let found = match scheme.is_linearised() {
            true => model.moves().iterate_once(&controls, begin, &options, &time_step, replace, workspace),
            false => {
                let predicted = points.predict(&time_step, &here);
                let guesses = match model.properties().depends_on_path() {
                    false if model.properties().has_potential() => vec![predicted],
                    _ => {
                        vec![predicted, points.coast(&time_step), model.moves().carried(&here, &controls, how.parallel)]
                    }
                };
                let guess = nearest(model, guesses, &here, &controls, &time_step, how.parallel);
                let options = SolveOptions { guess: guess.as_deref(), ..options };
                model.find(&controls, &options, Some(&time_step), shorter, workspace)
            }
        };
        let mut found = found.map_err(|error| in_step(error, begin.time, h))?;
        found.report.add_work(&work);
        work = found.report;
        points.found(found.u.clone(), &time_step);
        stages.push(found.u.clone());
        here = found;
    }
    let (end, error) = (points.end(), points.error());
    let mut state = here;
    state.u = end.u.unwrap_or(state.u);
    (state.velocity, state.acceleration) = (end.velocity, end.acceleration);
    if let (Some(modes), Some(velocity)) = (&modes, &mut state.velocity) {
        modes.replace_rate(Arc::<Vec<f64>>::make_mut(velocity));
    }
    state.history = Arc::new(model.memory().history_of_step(&history, h));
    (state.controls, state.time) = (Arc::new(to.controls.clone()), begin.time + h);
    if scheme.extrapolates() {
        check_extrapolated(model, &mut state, begin, h, how.parallel)?;
    }
    drop(points);
    Ok(SolvedStep { step: Step { dt: h, scheme, stages, started }, state, error })
}

/// Of some displacements to which a straight move leads from a state the one where the incremental potential of a stage is lowest, if it is
/// lower than there, prescribed components in their places; without a potential, where its free residual is smallest.
fn nearest(
    model: &Model,
    guesses: Vec<Option<Vec<f64>>>,
    than: &State,
    controls: &Controls,
    step: &TimeStep,
    parallel: bool,
) -> Option<Vec<f64>> {
    let energy = model.properties().has_potential();
    let at = Instant { parallel, ..Instant::new(&than.u, controls, 1.0) }.in_step(step);
    let merit = |u: &[f64]| {
        let mut sums = model.evaluate(&Instant { u, ..at }, Demand { energy, force: !energy }).ok()?;
        model.supports.restrict(&mut sums.force);
        Some(if energy { sums.energy } else { model.unknowns().norm(&sums.force) })
    };
    let begin = at.under(&than.controls);
    let reached =
        |u: &[f64]| model.moves().admissible_change(&begin, &Instant { u, ..at }).is_ok_and(|share| share >= 1.0);
    let still = match step.end {
        None => model.prescribed_unknowns().placed(&than.u, controls),
        Some(_) => than.u.to_vec(),
    };
    let mut least = merit(&still).unwrap_or(f64::INFINITY);
    let mut nearest = None;
    for guess in guesses.into_iter().flatten().filter(|u| reached(u)) {
        if let Some(value) = merit(&guess).filter(|value| *value < least) {
            (least, nearest) = (value, Some(guess));
        }
    }
    nearest
}

/// An end that is no equilibrium was not seen by any solve.
fn check_extrapolated(
    model: &Model,
    state: &mut State,
    begin: &State,
    dt: f64,
    parallel: bool,
) -> Result<(), StateError> {
    let at = Instant { parallel, load: 1.0, ..Instant::of(state) };
    if !model
        .moves()
        .admissible_move_of_others(&Instant { u: &begin.u, ..at }, &state.u)
        .is_ok_and(|share| share >= 1.0)
    {
        let stop = Stop::Slow { residual: state.report.residual };
        return Err(in_step(stop.into_error(state.report.newton, begin), begin.time, dt));
    }
    match model.evaluate(&at, Demand { energy: true, force: false }) {
        Ok(sums) => {
            state.report.min_j = state.report.min_j.min(sums.min_j);
            Ok(())
        }
        Err(at) => Err(StateError::EndOfStep { at, time: begin.time, dt, last: Box::new(begin.clone()) }),
    }
}

/// What shorter steps may mend.
fn in_step(error: StateError, time: f64, dt: f64) -> StateError {
    match error {
        StateError::Inadmissible { .. }
        | StateError::NoConvergence { .. }
        | StateError::Linear(LinearError::Indefinite { .. }) => {
            StateError::InStep { time, dt, source: Box::new(error) }
        }
        other => other,
    }
}
