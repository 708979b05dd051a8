//! `nastic optimize`: the main job.

mod outcome;
mod recorder;
mod starts;

use super::check_gradient;
use super::error::{Exit, RunError};
use super::number::{scientific, short};
use super::session::Session;
use super::watched::Watched;
use crate::lower::CaseProblem;
use nastic_control::{EnsembleError, EnsemblePoint};
use nastic_fem::SolveReport;
use nastic_opt::{Best, DEFAULT_ACCURACY, Optimizer, Outcome, Problem as _, Run, Stop, Verdict};
use recorder::Recorder;

/// A run from one start.
pub(super) struct FinishedRun {
    /// Where it began, without its factors.
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
    let start = session.timed("solve", |session| evaluate(session, &session.problem.start));
    let start = start.map_err(|error| session.forward_failed(error))?;
    let derivative = session.timed("adjoint", |session| session.problem.ensemble.try_derivative(&start));
    let derivative = derivative.map_err(|error| session.forward_failed(error))?;
    outcome::write_start(session, &start, &derivative)?;
    if check_gradient::of_start(session, &start, &derivative)? == Verdict::Wrong {
        return Ok(Exit::GradientWrong);
    }
    let began = std::time::Instant::now();
    let starts = starts::run(session, optimizer.as_ref(), (start, derivative))?;
    session.note_time("optimize", began.elapsed().as_secs_f64());
    outcome::report(session, &starts)?;
    Ok(if starts.best().best.stop.is_converged() { Exit::Done } else { Exit::NotConverged })
}

fn evaluate(session: &Session<'_>, m: &[f64]) -> Result<EnsemblePoint, EnsembleError> {
    session.evaluate(m, DEFAULT_ACCURACY)
}

/// Runs the optimiser to its end, from an evaluated start.
fn minimize(
    session: &Session<'_>,
    optimizer: &dyn Optimizer,
    (start, derivative): (EnsemblePoint, Vec<f64>),
    recorder: Recorder<'_>,
) -> Result<FinishedRun, RunError> {
    let problem = &session.problem;
    let (kept, m) = (start.clone().without_factors(), start.m.clone());
    let watched = Watched::new(problem, start, derivative);
    let run = Run::start(optimizer, &watched, &problem.set, problem.ensemble.inner_product(), &m)?;
    let mut run = run.cancelled_by(session.cancel.clone());
    let mut recorder = recorder.of(&watched);
    let stop = loop {
        match run.step(&mut |trial: &nastic_opt::Trial<'_, EnsemblePoint>| recorder.record(trial)) {
            Outcome::Stopped(stop) => break stop,
            Outcome::Iterated | Outcome::Staged(_) => {}
        }
    };
    let work = recorder.finish()?;
    let Best { point, m, cost, derivative, gradient_norm, active, stop, counts, stages } = run.finish(stop);
    let point = point.without_factors();
    let best = Best { point, m, cost, derivative, gradient_norm, active, stop, counts, stages };
    Ok(FinishedRun { start: kept, best, work })
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
    problem.ensemble.try_restage(problem.stages() - 1, start).ok()
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
