//! Steps whose lengths follow an estimate of their error.

use crate::points::Points;
use crate::scheme::Scheme;
use crate::step::check_motion;
use crate::step::step;
use crate::trajectory::{StepTo, Trajectory};
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_equilibrium::linear_systems::workspace::Workspace;
use nastic_equilibrium::model::Model;
use nastic_equilibrium::search::options::SolveOptions;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Safety factor of the length of a step: the error of the next one is aimed at 0.9^3 of what is allowed.
const ERROR_SAFETY: f64 = 0.9;
/// Smallest ratio of the length of a step to the one before.
const MIN_STEP_RATIO: f64 = 0.2;
/// Largest ratio of the length of a step to the one before.
const MAX_STEP_RATIO: f64 = 2.0;
/// Shortest step, as a share of the whole time.
const MIN_STEP_SHARE: f64 = 1e-9;
/// Length of the first step, as a share of the whole time.
const FIRST_STEP_SHARE: f64 = 1e-3;
/// Steps of a motion.
const MAX_STEPS: usize = 1_000_000;

/// What adaptive steps took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct AdaptiveReport {
    /// Steps of the trajectory.
    pub accepted: usize,
    /// Steps whose error was too large.
    pub rejected: usize,
    /// Steps without a solution.
    pub failed: usize,
}

/// How accurate adaptive steps are to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// The error of the displacement that a step may add at any free node, in the unit of length.
    pub error: f64,
    /// Length of the first step; where it is not given, a thousandth of the whole time.
    pub first: Option<f64>,
    /// The longest step, if there is one: an estimate does not see what happens between the instants of a step.
    pub longest: Option<f64>,
}

/// [`TimeStepping::advance_adaptively`](crate::TimeStepping::advance_adaptively).
pub(crate) fn advance_adaptively(
    model: &Model,
    trajectory: &mut Trajectory,
    scheme: &Scheme,
    goals: (&[f64], Tolerance),
    controls: &dyn Fn(f64) -> Result<Controls, FemError>,
    how: &SolveOptions,
    workspace: &mut Workspace,
) -> Result<AdaptiveReport, StateError> {
    adapt(model, trajectory, &mut |_| (), scheme, goals, controls, (how, workspace))
}

/// [`TimeStepping::find_steps`](crate::TimeStepping::find_steps).
pub(crate) fn find_steps(
    model: &Model,
    trajectory: &mut Trajectory,
    scheme: &Scheme,
    goals: (&[f64], Tolerance),
    controls: &dyn Fn(f64) -> Result<Controls, FemError>,
    how: &SolveOptions,
    workspace: &mut Workspace,
) -> Result<(Vec<f64>, AdaptiveReport), StateError> {
    let mut instants = Vec::new();
    let mut keep_end = |trajectory: &mut Trajectory| {
        instants.push(trajectory.end().time);
        *trajectory = trajectory.tail(scheme);
    };
    let report = adapt(model, trajectory, &mut keep_end, scheme, goals, controls, (how, workspace))?;
    Ok((instants, report))
}

/// [`TimeStepping::last_step_error`](crate::TimeStepping::last_step_error).
pub(crate) fn last_step_error(model: &Model, trajectory: &Trajectory) -> Option<f64> {
    let (states, step) = (trajectory.states(), trajectory.steps().last()?);
    if !step.scheme.estimates_error() {
        return None;
    }
    let begin = states.len().checked_sub(2)?;
    let before = begin.checked_sub(1).map(|n| &states[n]);
    let mut points = Points::new(
        &step.scheme,
        step.dt,
        &states[begin],
        before,
        step.started.as_ref(),
        model.discretization().dofs(),
    );
    for u in &step.stages {
        let at = points.next(&states[begin + 1].controls);
        points.found(u.clone(), &at);
    }
    points.error().map(|error| largest_free(model, error))
}

/// Calls with the trajectory after every step.
fn adapt(
    model: &Model,
    trajectory: &mut Trajectory,
    each: &mut dyn FnMut(&mut Trajectory),
    scheme: &Scheme,
    (instants, tolerance): (&[f64], Tolerance),
    controls: &dyn Fn(f64) -> Result<Controls, FemError>,
    (how, workspace): (&SolveOptions, &mut Workspace),
) -> Result<AdaptiveReport, StateError> {
    check_motion(model, trajectory, scheme)?;
    let begin = trajectory.end().time;
    check(scheme, begin, instants, tolerance)?;
    let mut report = AdaptiveReport::default();
    let whole = instants.last().map_or(0.0, |last| last - begin);
    let (scheme, shortest) = (Arc::new(scheme.clone()), MIN_STEP_SHARE * whole);
    let longest = tolerance.longest.unwrap_or(whole).min(whole);
    let mut h = tolerance.first.unwrap_or(FIRST_STEP_SHARE * whole).min(longest);
    for &goal in instants {
        while goal - trajectory.end().time > shortest {
            let begin = trajectory.end().time;
            let dt = fitting(h, goal - begin);
            let to = StepTo { dt, controls: controls(begin + dt)? };
            model.checks().check_controls(&to.controls)?;
            let mut found = match step(model, trajectory, scheme.clone(), false, &to, how, workspace) {
                Ok(found) => found,
                Err(error) => {
                    let may_help = matches!(error, StateError::InStep { .. } | StateError::EndOfStep { .. });
                    h = MIN_STEP_RATIO * dt;
                    report.failed += 1;
                    if !may_help || h < shortest {
                        return Err(error);
                    }
                    continue;
                }
            };
            let error = largest_free(model, found.error.take().unwrap_or_default());
            let next = dt * (ERROR_SAFETY * (tolerance.error / error).cbrt()).clamp(MIN_STEP_RATIO, MAX_STEP_RATIO);
            if error <= tolerance.error {
                if goal - begin - dt <= shortest {
                    found.state.time = goal; // without the rounding of a sum
                }
                trajectory.push(found.step, found.state);
                each(trajectory);
                report.accepted += 1;
                not_too_many(report.accepted, trajectory.end().time, tolerance)?;
                // a step that was cut to end at an instant says nothing against longer ones
                h = if dt < 0.99 * h { next.max(h) } else { next }.min(longest);
            } else {
                report.rejected += 1;
                h = next;
                out_of_reach(h, shortest, begin, tolerance)?;
            }
        }
    }
    Ok(report)
}

/// The largest norm of a nodal vector at free nodes: what is prescribed has no error.
fn largest_free(model: &Model, mut field: Vec<f64>) -> f64 {
    model.supports.clear(&mut field);
    let norm = |node: &[f64]| node.iter().map(|x| x * x).sum::<f64>().sqrt();
    field.chunks_exact(model.discretization().dim()).map(norm).fold(0.0, f64::max)
}

fn check(scheme: &Scheme, begin: f64, instants: &[f64], tolerance: Tolerance) -> Result<(), FemError> {
    let refuse = |what: String| Err(FemError::Meaningless { what });
    if !scheme.estimates_error() {
        let name = scheme.name();
        return refuse(format!(
            "{name} does not estimate the error of its steps: take tr_bdf2, or steps of given length"
        ));
    }
    if [Some(tolerance.error), tolerance.first, tolerance.longest]
        .into_iter()
        .flatten()
        .any(|x| !(x.is_finite() && x > 0.0))
    {
        return refuse(format!("adaptive steps with {tolerance:?}: take positive numbers"));
    }
    let mut before = begin;
    for &t in instants {
        if !(t.is_finite() && t > before) {
            return refuse(format!("adaptive steps from {before} to {t}: instants increase"));
        }
        before = t;
    }
    Ok(())
}

fn out_of_reach(h: f64, shortest: f64, t: f64, tolerance: Tolerance) -> Result<(), FemError> {
    if h >= shortest {
        return Ok(());
    }
    let what = format!(
        "adaptive steps fall below {shortest:.1e} at t = {t}: an error of {:e} per step is out of reach; allow a larger one",
        tolerance.error
    );
    Err(FemError::Meaningless { what })
}

/// A mistaken unit of a tolerance would take steps for ever.
fn not_too_many(steps: usize, t: f64, tolerance: Tolerance) -> Result<(), FemError> {
    if steps <= MAX_STEPS {
        return Ok(());
    }
    let what = format!(
        "{MAX_STEPS} steps of a motion end at t = {t} already: an error of {:e} per step is very small; allow a larger one",
        tolerance.error
    );
    Err(FemError::Meaningless { what })
}

/// A step of about h that leaves no short rest.
fn fitting(h: f64, rest: f64) -> f64 {
    match rest / h {
        r if r <= 1.01 => rest,
        r if r < 2.0 => 0.5 * rest,
        _ => h,
    }
}
