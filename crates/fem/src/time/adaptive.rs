//! [`Model::advance_adaptively`]: steps whose lengths follow an estimate of their error; [`Model::find_steps`]: their lengths alone.

use crate::contributions::controls::Controls;
use crate::error::{FemError, StateError};
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::workspace::Workspace;
use crate::time::points::Points;
use crate::time::scheme::Scheme;
use crate::time::trajectory::{StepTo, Trajectory};
use std::sync::Arc;

/// The error of the next step is aimed at 0.9^3 of what is allowed; lengths change by at most these factors.
const SAFETY: f64 = 0.9;
const SHRINK: f64 = 0.2;
const GROW: f64 = 2.0;
/// Shorter steps, as a share of the whole time, are given up.
const SHORTEST: f64 = 1e-9;
/// The first step, likewise.
const FIRST: f64 = 1e-3;
/// No motion takes more steps.
const MOST_STEPS: usize = 1_000_000;

/// What adaptive steps took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
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

impl Model {
    /// Goes on from the end of a trajectory through given instants, by steps as long as the estimated error of each allows: at every
    /// node at most `tolerance.error`. `controls(t)` are those at an instant; between the ends of a step they are linear. A step
    /// without a solution is tried again shorter. The trajectory is then one like any other: its adjoint takes the lengths as data.
    ///
    /// The error of a step of TR-BDF2 is estimated by `h (-v_n + 2 v* - v)/6`, v* the velocity in its middle (Bank et al., IEEE Trans.
    /// Electron Devices 32, 1985), and goes like h^3; steps change by the factor `0.9 (tolerance/error)^(1/3)`.
    ///
    /// # Errors
    /// A scheme without an estimate, a tolerance that is not positive, instants that do not increase; a [`StateError`] where steps
    /// would have to be shorter than 1e-9 of the whole time, with the steps before in the trajectory.
    pub fn advance_adaptively(
        &self,
        trajectory: &mut Trajectory,
        scheme: &Scheme,
        goals: (&[f64], Tolerance),
        controls: &dyn Fn(f64) -> Result<Controls, FemError>,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<AdaptiveReport, StateError> {
        self.adapt((trajectory, &mut |_| ()), scheme, goals, controls, (how, workspace))
    }

    /// The instants that [`advance_adaptively`](Self::advance_adaptively) leads through, and what they took. The trajectory keeps its end
    /// alone: the steps of a long motion, in the memory of two.
    ///
    /// # Errors
    /// As there; the trajectory then ends where the motion failed.
    pub fn find_steps(
        &self,
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
        let report = self.adapt((trajectory, &mut keep_end), scheme, goals, controls, (how, workspace))?;
        Ok((instants, report))
    }

    /// The estimated error that the last step of a trajectory has added to the displacement, the largest at any free node; none of a scheme
    /// without an estimate, and where no step was made.
    pub fn last_step_error(&self, trajectory: &Trajectory) -> Option<f64> {
        let (states, step) = (trajectory.states(), trajectory.steps().last()?);
        if !step.scheme.estimates_error() {
            return None;
        }
        let begin = states.len().checked_sub(2)?;
        let before = begin.checked_sub(1).map(|n| &states[n]);
        let mut points = Points::new(
            &step.scheme,
            step.dt,
            (&states[begin], before),
            step.started.as_ref(),
            self.discretization().dofs(),
        );
        for u in &step.stages {
            let at = points.next(&states[begin + 1].controls);
            points.found(u.clone(), &at);
        }
        points.error().map(|error| self.largest_free(error))
    }

    /// Calls with the trajectory after every step.
    fn adapt(
        &self,
        (trajectory, each): (&mut Trajectory, &mut dyn FnMut(&mut Trajectory)),
        scheme: &Scheme,
        (instants, tolerance): (&[f64], Tolerance),
        controls: &dyn Fn(f64) -> Result<Controls, FemError>,
        (how, workspace): (&SolveOptions, &mut Workspace),
    ) -> Result<AdaptiveReport, StateError> {
        self.check_motion(trajectory, scheme)?;
        let begin = trajectory.end().time;
        check(scheme, begin, instants, tolerance)?;
        let mut report = AdaptiveReport::default();
        let whole = instants.last().map_or(0.0, |last| last - begin);
        let (scheme, shortest) = (Arc::new(scheme.clone()), SHORTEST * whole);
        let longest = tolerance.longest.unwrap_or(whole).min(whole);
        let mut h = tolerance.first.unwrap_or(FIRST * whole).min(longest);
        for &goal in instants {
            while goal - trajectory.end().time > shortest {
                let begin = trajectory.end().time;
                let dt = fitting(h, goal - begin);
                let to = StepTo { dt, controls: controls(begin + dt)? };
                self.check_controls(&to.controls)?;
                let mut found = match self.step(trajectory, (scheme.clone(), false), &to, how, workspace) {
                    Ok(found) => found,
                    Err(error) => {
                        let may_help = matches!(error, StateError::InStep { .. } | StateError::EndOfStep { .. });
                        h = SHRINK * dt;
                        report.failed += 1;
                        if !may_help || h < shortest {
                            return Err(error);
                        }
                        continue;
                    }
                };
                let error = self.largest_free(found.error.take().unwrap_or_default());
                let next = dt * (SAFETY * (tolerance.error / error).cbrt()).clamp(SHRINK, GROW);
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
    fn largest_free(&self, mut field: Vec<f64>) -> f64 {
        self.supports.clear(&mut field);
        let norm = |node: &[f64]| node.iter().map(|x| x * x).sum::<f64>().sqrt();
        field.chunks_exact(self.discretization().dim()).map(norm).fold(0.0, f64::max)
    }
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
    if steps <= MOST_STEPS {
        return Ok(());
    }
    let what = format!(
        "{MOST_STEPS} steps of a motion end at t = {t} already: an error of {:e} per step is very small; allow a larger one",
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
