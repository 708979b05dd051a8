//! `nastic optimize`: the main job.

mod doubts;
mod outcome;
mod recorder;
mod starts;

use super::check_gradient;
use super::error::{Exit, RunError};
use super::number::{scientific, short};
use super::session::Session;
use crate::lower::CaseProblem;
use nastic_control::{EnsemblePoint, EnsembleWorkspace};
use nastic_fem::SolveReport;
use nastic_opt::{
    Best, DEFAULT_ACCURACY, EvaluatedStart, Failed, Objective, Optimizer, Outcome, Problem as _, Run, Stop, Verdict,
};
use recorder::Recorder;
use std::sync::Arc;

/// A run from one start.
pub(super) struct FinishedRun {
    /// Where it began.
    start: EnsemblePoint,
    best: Best<EnsemblePoint>,
    /// Work of all trials, by member.
    work: Vec<SolveReport>,
}

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    session.require(true, true)?;
    if let Some(out) = &session.out {
        out.remove_old_iterations();
    }
    let optimizer = session.problem.optimizer()?;
    let mut workspace = EnsembleWorkspace::default();
    let start = session.timed("solve", |session| evaluate(session, &session.problem.start, &mut workspace));
    let mut point = start.map_err(|failed| session.evaluation_failed(&failed))?;
    let derivative =
        session.timed("adjoint", |session| session.problem.ensemble.derivative(&mut point, &mut workspace));
    let derivative = derivative.map_err(|failed| session.evaluation_failed(&failed))?;
    outcome::write_start(session, &point, &derivative)?;
    let verdict = check_gradient::of_start(session, &point, &derivative, &mut workspace)?;
    let begun = Begun { point, derivative, workspace };
    if verdict == Verdict::Wrong {
        return Ok(Exit::GradientWrong);
    }
    let began = std::time::Instant::now();
    let starts = starts::run(session, optimizer.as_ref(), begun)?;
    session.note_time("optimize", began.elapsed().as_secs_f64());
    doubts::warn(session, starts.best());
    outcome::report(session, &starts)?;
    Ok(if starts.best().best.stop.is_converged() { Exit::Done } else { Exit::NotConverged })
}

/// An evaluated start.
pub(super) struct Begun {
    point: EnsemblePoint,
    derivative: Vec<f64>,
    workspace: EnsembleWorkspace,
}

fn evaluate(session: &Session<'_>, m: &[f64], workspace: &mut EnsembleWorkspace) -> Result<EnsemblePoint, Failed> {
    session.evaluate(m, DEFAULT_ACCURACY, workspace)
}

/// Runs the optimiser to its end, from an evaluated start.
fn minimize(
    session: &Session<'_>,
    optimizer: &dyn Optimizer,
    begun: Begun,
    mut recorder: Recorder<'_>,
) -> Result<FinishedRun, RunError> {
    let problem = &session.problem;
    let Begun { point, derivative, workspace } = begun;
    let kept = point.clone();
    let metric = problem.ensemble.inner_product().map_err(nastic_opt::RunError::InnerProduct)?;
    let start = EvaluatedStart { m: point.m.clone(), point, derivative: Some(derivative) };
    let run = Run::start(optimizer, &problem.ensemble, Arc::new(problem.set.clone()), metric, start)?;
    let mut run = run.with_workspace(workspace).cancelled_by(session.cancel.clone());
    let stop = loop {
        match run.step(&mut |trial: &nastic_opt::Trial<'_, EnsemblePoint>| recorder.record(trial)) {
            Outcome::Stopped(stop) => break stop,
            Outcome::Iterated | Outcome::Staged(_) => {}
        }
    };
    let work = recorder.finish()?;
    Ok(FinishedRun { start: kept, best: run.finish(stop), work })
}

/// Why it ended, for people.
pub(super) fn why(stop: &Stop) -> String {
    match stop {
        Stop::Cancelled => "cancelled: what was found so far is kept".to_owned(),
        other => other.to_string(),
    }
}

/// The start as the last stage values it: what the end can be compared with.
fn revalued(problem: &CaseProblem, start: &EnsemblePoint) -> Option<EnsemblePoint> {
    problem.ensemble.restage(problem.stages() - 1, start).ok()
}

/// "1.2e-03 -> 4.5e-06, a factor of 267"
pub(super) fn fall(from: f64, to: f64) -> String {
    let factor =
        if to > 0.0 && from > to { format!(", a factor of {}", short(round(from / to))) } else { String::new() };
    format!("{} -> {}{factor}", scientific(from, 6), scientific(to, 6))
}

/// Three digits.
fn round(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
