//! `nastic optimize`: the main job; `nastic resume` goes on with it.

mod advice;
pub(crate) mod branch_changes;
mod cut;
mod identification;
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

use crate::run::error::{Exit, RunError};
use crate::run::optimize::branch_changes::place;
use crate::run::optimize::minimization::Minimization;
use crate::run::optimize::outcome::Reported;
use crate::run::optimize::starts::Starts;
use crate::run::optimize::starts::journal::{Journal, SharedJournal};
use crate::run::optimize::starts::start_run::{Begun, Phase, StartRun};
use crate::run::session::{CommandContext, CommandFindings, CommandInput, Destination, Opened};
use crate::run::{check_gradient, constraints, time_steps};
use crate::saved::checkpoint::{Place, Position, interrupted};
use crate::saved::{checkpoint, motion_checkpoint};
use nastic_case::warning::{INPUT, Warning};
use nastic_ensemble::EnsembleWorkspace;
use nastic_opt::{DEFAULT_ACCURACY, Objective, Optimizer, Verdict};
use nastic_report::record::{GradientCheckRecord, ResumedRecord};
use std::path::PathBuf;
use std::time::Instant;

/// An optimisation from its start; `restart`: also where one that was interrupted lies in its directory.
pub(super) fn begin(opened: &mut Opened<'_>, optimizer: &dyn Optimizer, restart: bool) -> Result<Exit, RunError> {
    let Opened { input, destination, .. } = opened;
    input.require(true, true).and_then(|()| check(input)).map_err(|error| destination.refuse(error))?;
    may_replace(destination, restart)?;
    run(opened, optimizer)
}

/// Refuses what is known to be impossible before anything is solved.
fn check(input: &CommandInput) -> Result<(), RunError> {
    spectrum::check(input).and_then(|()| identification::check(input))
}

/// Whether the checkpoint in the directory of the results, if any, may be replaced. If not what lies there stays as it is: nothing is written.
fn may_replace(destination: &mut Destination, restart: bool) -> Result<(), RunError> {
    if let (Some(out), false) = (&destination.out, restart) {
        let found = interrupted(out.path()).map_err(RunError::UnreadableCheckpoint);
        let directory = out.path().to_owned();
        let refused = found.and_then(|found| match found {
            None => Ok(()),
            Some((_, iteration)) => Err(RunError::Interrupted { directory, iteration }),
        });
        refused.map_err(|error| destination.refuse(error))?;
    }
    crate::run::motion::may_replace(destination, restart)
}

/// Removes what an earlier run in the directory left.
fn make_room(context: CommandContext<'_>, findings: &mut CommandFindings) -> Result<(), RunError> {
    let CommandContext { input, destination, .. } = context;
    crate::run::report::remove_earlier(input, destination)?;
    if let Some(out) = &destination.out {
        out.remove_old_iterations();
        // It belongs to an earlier command, and would stand beside the files of this one.
        out.remove("result.json")?;
        out.remove(motion_checkpoint::NAME)?;
    }
    warn_of_own_files(context, findings);
    Ok(())
}

fn run(opened: &mut Opened<'_>, optimizer: &dyn Optimizer) -> Result<Exit, RunError> {
    opened.input.require(true, true)?;
    time_steps::find(opened)?;
    let (context, findings) = opened.parts();
    make_room(context, findings)?;
    let journal = SharedJournal::new(Journal::begin(context)?);
    context.input.meet()?;
    let Some((begun, gradient_check)) = first_start(context, findings)? else { return Ok(Exit::GradientWrong) };
    let mut all = vec![StartRun { index: 0, phase: Phase::Evaluated(Box::new(begun)) }];
    all.extend((1..context.input.problem.case.optimizer.starts).map(StartRun::waiting));
    let position = Position { gradient_check, starts: all, ..Position::default() };
    let (began, mut starts) = (Instant::now(), Starts::default());
    let ran = starts.run(Minimization::new(context, optimizer, &journal), position, false);
    conclude(opened, starts, ran, journal, began)
}

/// The start as written, evaluated, with its gradient check; `None` if that says that the gradient is wrong.
fn first_start(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
) -> Result<Option<(Begun, GradientCheckRecord)>, RunError> {
    let CommandContext { input, destination, console } = context;
    let mut workspace = EnsembleWorkspace::default();
    let start = &input.problem.start;
    let start = findings.timed(console, "solve", |_| input.evaluate(console, start, DEFAULT_ACCURACY, &mut workspace));
    let mut point = start.map_err(|failed| destination.evaluation_failed(input, &failed))?;
    let derivative =
        findings.timed(console, "adjoint", |_| input.problem.ensemble.derivative(&mut point, &mut workspace));
    let derivative = derivative.map_err(|failed| destination.evaluation_failed(input, &failed))?;
    let (place, mut warnings) = (place(&input.problem, 0), vec![]);
    let mut shown = Ok(());
    if let Some(whole) = input.whole(destination, &point)? {
        let inspected = findings.timed(console, "inspect", |_| input.look_into(console, &place, &whole));
        shown = outcome::write_start(&input.problem, destination, &whole, &derivative, &inspected.0);
        warnings = inspected.1;
    }
    let checked =
        shown.and_then(|()| check_gradient::of_start(input, console, findings, &point, &derivative, &mut workspace));
    let right = checked.as_ref().is_ok_and(|certificate| certificate.verdict != Verdict::Wrong);
    if !right {
        findings.warnings.extend(warnings);
        return checked.map(|_| None);
    }
    let check = check_gradient::record(&checked?);
    spectrum::check_products(input, &point, &mut workspace)?;
    Ok(Some((Begun { point, derivative, workspace, warnings }, check)))
}

/// A file of the output directory that the case reads is another one once the optimisation has written it.
fn warn_of_own_files(context: CommandContext<'_>, findings: &mut CommandFindings) {
    let CommandContext { input, destination, console } = context;
    let Some(Ok(out)) = destination.out.as_ref().map(|out| out.path().canonicalize()) else { return };
    let is_own = |file: &PathBuf| file.canonicalize().is_ok_and(|file| file.parent() == Some(&out));
    let own: Vec<PathBuf> = input.problem.files.iter().filter(|file| is_own(file)).cloned().collect();
    for file in own {
        let file = file.display();
        let message = format!(
            "the case reads {file} of its own output directory: once it is written again nastic resume will refuse the \
             case; choose another directory with --out"
        );
        findings.warn(console, Warning::new(&INPUT, message));
    }
}

/// Goes on from a checkpoint.
pub(super) fn resume(
    opened: &mut Opened<'_>,
    optimizer: &dyn Optimizer,
    position: Option<Position>,
) -> Result<Exit, RunError> {
    check(&opened.input)?;
    let from = position.as_ref().map_or(Place { start: 0, iteration: 0 }, Position::place);
    opened.findings.record.resumed =
        ResumedRecord { start: Some(from.start), iteration: Some(from.iteration), ..ResumedRecord::default() };
    // Nothing was evaluated yet.
    let Some(position) = position else { return run(opened, optimizer) };
    time_steps::find(opened)?;
    let (context, findings) = opened.parts();
    warn_of_own_files(context, findings);
    findings.record.gradient_check = position.gradient_check.clone();
    context.input.meet()?;
    let journal = SharedJournal::new(Journal::resume(context, &position)?);
    // until it has something of its own
    opened.destination.leaves_results = true;
    let (began, mut starts) = (Instant::now(), Starts::default());
    let ran = starts.run(Minimization::new(opened.parts().0, optimizer, &journal), position, true);
    conclude(opened, starts, ran, journal, began)
}

/// Reports what was found, then what could not be written on the way.
fn conclude(
    opened: &mut Opened<'_>,
    mut starts: Starts,
    ran: Result<(), RunError>,
    journal: SharedJournal,
    began: Instant,
) -> Result<Exit, RunError> {
    let Opened { input, destination, findings, .. } = opened;
    findings.clock.note("optimize", began.elapsed().as_secs_f64());
    // They were said: the result has them, however the runs ended.
    findings.warnings.append(&mut starts.warnings);
    ran?;
    let written = journal.lock().written();
    destination.leaves_results =
        starts.interrupted && journal.lock().is_behind() && outcome::has_results(input, destination);
    if !destination.leaves_results {
        journal.lock().write_iterates();
    }
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    let unwritten = journal.lock().finish(starts.interrupted);
    findings.interrupted = starts.interrupted;
    let resumable = written.filter(|_| starts.interrupted);
    let minima = minima::warn_of_minima(&input.problem, &mut starts);
    let Some((index, ended)) = starts.best.take() else { return Err(RunError::Cancelled) };
    if starts.entries.len() > 1 {
        findings.record.optimum.minima = Some(minima);
    }
    let done = ended.best.stop.is_converged() && !starts.interrupted;
    let exit = if done { Exit::Done } else { Exit::NotConverged };
    if input.team_of_starts().is_some() && !input.leads() {
        return Ok(exit);
    }
    let begin = outcome::revalued(input, destination, &ended)?;
    let Some(ended) = input.whole_run(destination, &ended)? else {
        // what the first rank reports is its own; what it evaluates for that takes all
        if !starts.interrupted {
            run_warnings::verify(context, &ended)?;
            spectrum::find(input, console, findings, &ended.best)?;
        }
        return Ok(exit);
    };
    let constraints = constraints::look_at(input, destination, &ended.constraints, &ended.best.point)?;
    run_warnings::warn(context, findings, &ended, &constraints, starts.interrupted)?;
    let diagnosis = if starts.interrupted { None } else { spectrum::find(input, console, findings, &ended.best)? };
    let identified =
        if starts.interrupted { None } else { identification::find(input, console, findings, &ended.best)? };
    let (begin, diagnosis, identified) = (begin.as_ref(), diagnosis.as_ref(), identified.as_ref());
    let (known, starts_run) = (constraints.as_slice(), starts.entries.as_slice());
    let all = Reported { index, ended: &ended, begin, known, diagnosis, identified, starts: starts_run, resumable };
    let reported = outcome::report(context, findings, &all);
    let reported = reported.and_then(|found| unwritten.map(|()| found));
    if let (Err(error), Some(written)) = (&reported, written)
        && error.exit() == Exit::NotWritten
        && !starts.interrupted
    {
        outcome::say_how_to_resume(context, written);
    }
    let found = reported?;
    if destination.leaves_results {
        let stays = "stopped before it had come as far as the program before, whose results stay";
        console.say(format!("{:<12}{stays}", ""));
    }
    outcome::show(&input.problem, findings, ended, found);
    if let Some(why) = starts.aborted {
        console.say(format!("failed      {why}"));
        findings.record.error = Some(why);
        return Ok(Exit::ForwardFailed);
    }
    findings.ended = !starts.interrupted;
    Ok(exit)
}

/// Records in the checkpoint that the optimisation has ended, if so. That comes last: a program that is killed before all results
/// are written was interrupted.
pub(super) fn record_end(destination: &Destination, findings: &CommandFindings) -> Result<(), RunError> {
    match &destination.out {
        Some(out) if findings.ended => checkpoint::record_end(out, true),
        _ => Ok(()),
    }
}
