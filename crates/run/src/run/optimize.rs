//! `nastic optimize`: the main job; `nastic resume` goes on with it.

mod advice;
pub(crate) mod branch_changes;
mod limit_advice;
pub(crate) mod met_limits;
mod minima;
mod minimization;
mod ordered_output;
mod outcome;
mod recorder;
mod run_warnings;
mod spectrum;
pub(crate) mod starts;

pub(super) use crate::run::optimize::starts::parts::{join, run_part};

use crate::run::check_gradient;
use crate::run::error::{Exit, RunError};
use crate::run::optimize::branch_changes::place;
use crate::run::optimize::minimization::evaluate;
use crate::run::optimize::starts::Starts;
use crate::run::optimize::starts::journal::{Journal, SharedJournal};
use crate::run::optimize::starts::start_run::{Begun, Phase, StartRun};
use crate::run::session::Session;
use crate::saved::checkpoint::{Place, Position, interrupted};
use crate::saved::{checkpoint, motion_checkpoint};
use nastic_case::warning::{INPUT, Warning};
use nastic_ensemble::EnsembleWorkspace;
use nastic_opt::{Objective, Optimizer, Verdict};
use nastic_report::record::{GradientCheckRecord, ResumedRecord};
use std::path::PathBuf;
use std::time::Instant;

/// An optimisation from its start; `restart`: also where one that was interrupted lies in its directory.
pub(super) fn begin(session: &mut Session<'_>, optimizer: &dyn Optimizer, restart: bool) -> Result<Exit, RunError> {
    session.require(true, true).and_then(|()| spectrum::check(session)).map_err(|error| session.refuse(error))?;
    may_replace(session, restart)?;
    run(session, optimizer)
}

/// Whether the checkpoint in the directory of the results, if any, may be replaced. If not what lies there stays as it is: nothing is written.
fn may_replace(session: &mut Session<'_>, restart: bool) -> Result<(), RunError> {
    if let (Some(out), false) = (&session.destination.out, restart) {
        let found = interrupted(out.path()).map_err(RunError::UnreadableCheckpoint);
        let directory = out.path().to_owned();
        let refused = found.and_then(|found| match found {
            None => Ok(()),
            Some((_, iteration)) => Err(RunError::Interrupted { directory, iteration }),
        });
        refused.map_err(|error| session.refuse(error))?;
    }
    crate::run::motion::may_replace(session, restart)
}

/// Removes what an earlier run in the directory left.
fn make_room(session: &mut Session<'_>) -> Result<(), RunError> {
    crate::run::report::remove_earlier(session)?;
    if let Some(out) = &session.destination.out {
        out.remove_old_iterations();
        // It belongs to an earlier command, and would stand beside the files of this one.
        out.remove("result.json")?;
        out.remove(motion_checkpoint::NAME)?;
    }
    warn_of_own_files(session);
    Ok(())
}

fn run(session: &mut Session<'_>, optimizer: &dyn Optimizer) -> Result<Exit, RunError> {
    session.require(true, true)?;
    session.find_steps()?;
    make_room(session)?;
    let journal = SharedJournal::new(Journal::begin(session)?);
    session.meet()?;
    let Some((begun, gradient_check)) = first_start(session)? else { return Ok(Exit::GradientWrong) };
    let mut all = vec![StartRun { index: 0, phase: Phase::Evaluated(Box::new(begun)) }];
    all.extend((1..session.input.problem.case.optimizer.starts).map(StartRun::waiting));
    let position = Position { gradient_check, starts: all, ..Position::default() };
    let (began, mut starts) = (Instant::now(), Starts::default());
    let ran = starts.run(session, optimizer, position, &journal, false);
    conclude(session, starts, ran, journal, began)
}

/// The start as written, evaluated, with its gradient check; `None` if that says that the gradient is wrong.
fn first_start(session: &mut Session<'_>) -> Result<Option<(Begun, GradientCheckRecord)>, RunError> {
    let mut workspace = EnsembleWorkspace::default();
    let start = session.timed("solve", |session| evaluate(session, &session.input.problem.start, &mut workspace));
    let mut point = start.map_err(|failed| session.evaluation_failed(&failed))?;
    let derivative =
        session.timed("adjoint", |session| session.input.problem.ensemble.derivative(&mut point, &mut workspace));
    let derivative = derivative.map_err(|failed| session.evaluation_failed(&failed))?;
    let (place, mut warnings) = (place(&session.input.problem, 0), vec![]);
    let mut shown = Ok(());
    if let Some(whole) = session.whole(&point)? {
        let inspected = session.timed("inspect", |session| session.look_into(session.console, &place, &whole));
        shown = outcome::write_start(session, &whole, &derivative, &inspected.0);
        warnings = inspected.1;
    }
    let checked = shown.and_then(|()| check_gradient::of_start(session, &point, &derivative, &mut workspace));
    let right = checked.as_ref().is_ok_and(|certificate| certificate.verdict != Verdict::Wrong);
    if !right {
        session.findings.warnings.extend(warnings);
        return checked.map(|_| None);
    }
    let check = check_gradient::record(&checked?);
    spectrum::check_products(session, &point, &mut workspace)?;
    Ok(Some((Begun { point, derivative, workspace, warnings }, check)))
}

/// A file of the output directory that the case reads is another one once the optimisation has written it.
fn warn_of_own_files(session: &mut Session<'_>) {
    let Some(Ok(out)) = session.destination.out.as_ref().map(|out| out.path().canonicalize()) else { return };
    let is_own = |file: &PathBuf| file.canonicalize().is_ok_and(|file| file.parent() == Some(&out));
    let own: Vec<PathBuf> = session.input.problem.files.iter().filter(|file| is_own(file)).cloned().collect();
    for file in own {
        let file = file.display();
        let message = format!(
            "the case reads {file} of its own output directory: once it is written again nastic resume will refuse the \
             case; choose another directory with --out"
        );
        session.warn(Warning::new(&INPUT, message));
    }
}

/// Goes on from a checkpoint.
pub(super) fn resume(
    session: &mut Session<'_>,
    optimizer: &dyn Optimizer,
    position: Option<Position>,
) -> Result<Exit, RunError> {
    spectrum::check(session)?;
    let from = position.as_ref().map_or(Place { start: 0, iteration: 0 }, Position::place);
    session.findings.record.resumed =
        ResumedRecord { start: Some(from.start), iteration: Some(from.iteration), ..ResumedRecord::default() };
    // Nothing was evaluated yet.
    let Some(position) = position else { return run(session, optimizer) };
    session.find_steps()?;
    warn_of_own_files(session);
    session.findings.record.gradient_check = position.gradient_check.clone();
    session.meet()?;
    let journal = SharedJournal::new(Journal::resume(session, &position)?);
    // until it has something of its own
    session.destination.leaves_results = true;
    let began = Instant::now();
    let mut starts = Starts::default();
    let ran = starts.run(session, optimizer, position, &journal, true);
    conclude(session, starts, ran, journal, began)
}

/// Reports what was found, then what could not be written on the way.
fn conclude(
    session: &mut Session<'_>,
    mut starts: Starts,
    ran: Result<(), RunError>,
    journal: SharedJournal,
    began: Instant,
) -> Result<Exit, RunError> {
    session.findings.clock.note("optimize", began.elapsed().as_secs_f64());
    // They were said: the result has them, however the runs ended.
    session.findings.warnings.append(&mut starts.warnings);
    ran?;
    let written = journal.lock().written();
    session.destination.leaves_results =
        starts.interrupted && journal.lock().is_behind() && outcome::has_results(session);
    if !session.destination.leaves_results {
        journal.lock().write_iterates();
    }
    let unwritten = journal.lock().finish(starts.interrupted);
    session.findings.interrupted = starts.interrupted;
    let resumable = written.filter(|_| starts.interrupted);
    let minima = minima::warn_of_minima(&session.input.problem, &mut starts);
    let Some((index, ended)) = starts.best.take() else { return Err(RunError::Cancelled) };
    if starts.entries.len() > 1 {
        session.findings.record.optimum.minima = Some(minima);
    }
    let done = ended.best.stop.is_converged() && !starts.interrupted;
    let exit = if done { Exit::Done } else { Exit::NotConverged };
    if session.team_of_starts().is_some() && !session.leads() {
        return Ok(exit);
    }
    let begin = outcome::revalued(session, &ended)?;
    let Some(ended) = session.whole_run(&ended)? else {
        // what the first rank reports is its own; what it evaluates for that takes all
        if !starts.interrupted {
            run_warnings::verify(session, &ended)?;
            spectrum::find(session, &ended.best)?;
        }
        return Ok(exit);
    };
    let constraints = session.look_at_constraints(&ended.constraints, &ended.best.point)?;
    run_warnings::warn(session, &ended, &constraints, starts.interrupted)?;
    let diagnosis = if starts.interrupted { None } else { spectrum::find(session, &ended.best)? };
    let found = (index, (&ended, begin.as_ref()), constraints.as_slice(), diagnosis.as_ref());
    let reported = outcome::report(session, found, &starts.entries, resumable);
    let reported = reported.and_then(|found| unwritten.map(|()| found));
    if let (Err(error), Some(written)) = (&reported, written)
        && error.exit() == Exit::NotWritten
        && !starts.interrupted
    {
        outcome::say_how_to_resume(session, written);
    }
    let found = reported?;
    if session.destination.leaves_results {
        let stays = "stopped before it had come as far as the program before, whose results stay";
        session.console.say(format!("{:<12}{stays}", ""));
    }
    outcome::show(session, ended, found);
    if let Some(why) = starts.aborted {
        session.console.say(format!("failed      {why}"));
        session.findings.record.error = Some(why);
        return Ok(Exit::ForwardFailed);
    }
    session.findings.ended = !starts.interrupted;
    Ok(exit)
}

/// Records in the checkpoint that the optimisation has ended, if so. That comes last: a program that is killed before all results
/// are written was interrupted.
pub(super) fn record_end(session: &Session<'_>) -> Result<(), RunError> {
    match &session.destination.out {
        Some(out) if session.findings.ended => checkpoint::record_end(out, true),
        _ => Ok(()),
    }
}
