//! `nastic optimize`: the main job.

mod outcome;
mod recorder;

use super::certificate::{Certificate, certify};
use super::error::{Exit, RunError};
use super::number::{scientific, short};
use super::session::Session;
use super::solve::write_target;
use super::watched::Watched;
use crate::result::summary;
use nastic_control::Evaluated;
use nastic_opt::{Best, Optimizer, Outcome, Problem as _, Request, Run, Stop, Verdict};
use recorder::Recorder;
use serde_json::json;

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    session.require(true, true)?;
    if let Some(out) = &session.out {
        out.remove_old_iterations();
    }
    let optimizer = session.problem.optimizer()?;
    let start = session.timed("solve", |session| evaluate_start(session))?;
    let derivative = session.timed("adjoint", |session| session.problem.reduced.derivative_of(&start, None));
    let derivative = derivative.map_err(|error| session.forward_failed(error))?;
    write_target(session)?;
    outcome::write_start(session, &start, &derivative)?;
    let certificate = session.timed("gradient_check", |session| check_gradient(session, &start, &derivative));
    if session.is_cancelled() {
        return Err(RunError::Cancelled);
    }
    let certificate = certificate?;
    if certificate.verdict == Verdict::Wrong {
        return Ok(Exit::GradientWrong);
    }
    let best = minimize(session, optimizer.as_ref(), &start)?;
    outcome::report(session, &start, &best)?;
    Ok(if best.stop.is_converged() { Exit::Done } else { Exit::NotConverged })
}

fn evaluate_start(session: &Session<'_>) -> Result<Evaluated, RunError> {
    session.console.pass("solving at the start control");
    let problem = &session.problem;
    let start = problem.reduced.try_evaluate(&problem.start, &Request::default());
    session.console.clear();
    start.map_err(|error| session.forward_failed(error))
}

/// The short check; what it finds is said and put into the result.
fn check_gradient(session: &mut Session<'_>, start: &Evaluated, derivative: &[f64]) -> Result<Certificate, RunError> {
    session.console.pass("checking the gradient");
    let problem = &session.problem;
    let size = super::gradcheck::size(problem);
    let seed = problem.case.optimizer.seed;
    let base = (start.m.as_slice(), start, derivative);
    let certificate = certify(&problem.reduced, &problem.set, base, size, seed);
    session.console.clear();
    let certificate = match certificate {
        Ok(certificate) => certificate,
        // The run itself will say what it needs a scale for.
        Err(nastic_opt::TaylorError::NoDirection) => {
            Certificate { mismatch: f64::NAN, trials: 0, verdict: Verdict::Undecided, full: None }
        }
        Err(error) => return Err(error.into()),
    };
    let found = match certificate.verdict {
        Verdict::Right if certificate.full.is_none() => format!(
            "right: differences of the cost agree with it to {} ({} trials)",
            scientific(certificate.mismatch, 1),
            certificate.trials
        ),
        Verdict::Undecided => "undecided: the cost hardly changes along a random direction".to_owned(),
        verdict => verdict.to_string(),
    };
    session.console.say(format!("gradient    {found}"));
    if certificate.verdict == Verdict::Wrong {
        if let Some(full) = &certificate.full {
            session.console.say(full);
        }
        session
            .console
            .say("The derivative does not belong to the cost here: nastic gradcheck shows which term is at fault.");
        session
            .console
            .say("A cost with a kink at the start (target and body on the same points) fails this check too.");
    }
    session
        .put("gradient_check", json!({ "verdict": certificate.verdict.to_string(), "mismatch": certificate.mismatch }));
    Ok(certificate)
}

/// Runs the optimiser to its end.
fn minimize(
    session: &mut Session<'_>,
    optimizer: &dyn Optimizer,
    start: &Evaluated,
) -> Result<Best<Evaluated>, RunError> {
    let began = std::time::Instant::now();
    let problem = &session.problem;
    let watched = Watched::new(&problem.reduced, start.clone());
    let metric = problem.reduced.inner_product();
    let run = Run::start(optimizer, &watched, &problem.set, metric, &problem.start)?;
    let mut run = run.cancelled_by(session.cancel.clone());
    let mut recorder = Recorder::new(session, &watched)?;
    recorder.begin(optimizer.name());
    let stop = loop {
        match run.step(&mut |trial: &nastic_opt::Trial<'_, Evaluated>| recorder.record(trial)) {
            Outcome::Stopped(stop) => break stop,
            Outcome::Iterated | Outcome::Staged(_) => {}
        }
    };
    let told = recorder.finish()?;
    let best = run.finish(stop);
    session.put("newton_iterations", json!(told.newton));
    session.put("factorisations", json!(told.factorisations));
    session.put("reused_factorisations", json!(told.reused));
    session.put("back_substitutions", json!(told.back_substitutions));
    session.note_time("optimize", began.elapsed().as_secs_f64());
    Ok(best)
}

/// Why it ended, for people.
pub(super) fn why(stop: &Stop) -> String {
    match stop {
        Stop::Cancelled => "cancelled: what was found so far is kept".to_owned(),
        other => other.to_string(),
    }
}

/// The cost of the start as the last stage values it: what the end can be compared with.
pub(super) fn revalued(session: &Session<'_>, start: &Evaluated) -> Option<Evaluated> {
    use nastic_opt::Objective;
    let last = session.problem.stages() - 1;
    session.problem.reduced.restage(last, start).ok()
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

/// Distance and cost of a point, for the result.
pub(super) fn valued(
    session: &Session<'_>,
    point: &Evaluated,
) -> Result<serde_json::Map<String, serde_json::Value>, RunError> {
    summary::valued(&session.problem, point).map_err(|error| session.forward_failed(error))
}
