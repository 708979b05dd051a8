//! Starts in processes of their own: each leaves a checkpoint in a directory of its own; of these the optimisation is joined.

use crate::run::error::{Exit, RunError};
use crate::run::optimize::minimization::Minimization;
use crate::run::optimize::starts::journal::{Journal, SharedJournal};
use crate::run::optimize::starts::round::{RoundEnd, failed};
use crate::run::optimize::starts::start_run::{Phase, StartRun};
use crate::run::optimize::starts::table::{failed_entry, seed};
use crate::run::optimize::starts::{Starts, restored_best, saved_best};
use crate::run::optimize::{conclude, first_start, make_room, may_replace, spectrum};
use crate::run::session::output_directory::{directory, usual_directory};
use crate::run::session::{CommandContext, CommandFindings, CommandInput, Opened};
use crate::run::time_steps;
use crate::saved;
use crate::saved::CheckpointError;
use crate::saved::case_record::CaseRecord;
use crate::saved::checkpoint::{Checkpoint, Position, record_end};
use nastic_case::lower::CaseProblem;
use nastic_case::part::Part;
use nastic_io::{WriteError, write_atomically};
use nastic_language::number::count;
use nastic_numeric::format::scientific;
use nastic_opt::{Constrained as _, Optimizer, early_stopping};
use nastic_report::record::{GradientCheckRecord, StartRecord};
use nastic_result::files::Directory;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Files of a start that are not those of the optimisation under the same name.
const OWN: [&str; 2] = [saved::NAME, "history.jsonl"];

/// The directory of a start in that of the optimisation.
fn directory_of(out: &Path, index: usize) -> PathBuf {
    out.join(format!("start_{index}"))
}

/// What must hold of starts that do not know of each other.
fn check(input: &CommandInput, optimizer: &dyn Optimizer) -> Result<(), RunError> {
    let (problem, options) = (&input.problem, &input.problem.case.optimizer);
    if options.starts < 2 {
        let message = "--part and --join divide the starts of an optimisation, and the case has one: --set optimizer/starts=8 makes eight";
        return Err(problem.complain("optimizer/starts", message.to_owned()).into());
    }
    let compares = problem.ensemble.constraints().is_empty();
    if options.early_stopping && compares && early_stopping::limit(0) < optimizer.options().max_iterations {
        let message = "starts in processes of their own are not compared on the way: --part and --join need \
                       --set optimizer/early_stopping=false";
        return Err(problem.complain("optimizer/early_stopping", message.to_owned()).into());
    }
    input.require(true, true)
}

/// Runs the starts of a part one after the other, each in a directory of its own in that of the optimisation. Those that have ended are
/// kept, unless the options say `restart`. The exit code says whether all have ended.
pub(in crate::run) fn run_part(
    opened: &mut Opened<'_>,
    optimizer: &dyn Optimizer,
    part: Part,
) -> Result<Exit, RunError> {
    check(&opened.input, optimizer)?;
    time_steps::find(opened)?;
    let input = &opened.input;
    let named = directory(&input.command, &input.problem, &input.options);
    let out = named.unwrap_or_else(|| usual_directory(&input.problem));
    let starts = input.problem.case.optimizer.starts;
    let (mut exit, mut entries) = (Exit::Done, Vec::new());
    for index in (0..starts).filter(|index| part.has(*index)) {
        let ran = match opened.input.is_cancelled() {
            true => Err(RunError::Cancelled),
            false => run_one(opened, optimizer, index, &directory_of(&out, index)),
        };
        // The lock is that of the start.
        opened.destination.leave();
        let (own, end) = match ran {
            Ok(One { exit, entry, how }) => {
                let end = format!("{}{how}", described(&entry));
                entries.push(entry);
                (exit, end)
            }
            Err(error) => (error.exit(), error.to_string()),
        };
        exit = exit.worst(own);
        opened.console.say(format!("{:<12}start {} of {starts}: {end}", "ended", index + 1));
    }
    opened.console.say(format!("part {part:<7}--join makes the result when all parts are done"));
    opened.findings.record.optimum.starts = Some(entries);
    opened.findings.interrupted = exit != Exit::Done;
    Ok(exit)
}

/// "cost 1.2e-3 after 25 iterations", or why it failed.
fn described(entry: &StartRecord) -> String {
    let iterations = count(entry.iterations.unwrap_or_default(), "iteration");
    match *entry.cost {
        Some(cost) => format!("cost {} after {iterations}", scientific(cost, 6)),
        None => format!("failed: {}", entry.failed.as_deref().unwrap_or_default()),
    }
}

/// What became of a start.
struct One {
    exit: Exit,
    entry: StartRecord,
    /// How it came about, where it was not run from its beginning.
    how: &'static str,
}

/// Runs a start, or goes on with it, until it has ended.
fn run_one(
    opened: &mut Opened<'_>,
    optimizer: &dyn Optimizer,
    index: usize,
    directory: &Path,
) -> Result<One, RunError> {
    let Opened { input, destination, .. } = opened;
    destination.enter(input, directory.to_owned())?;
    let restart = input.options.restart;
    let known = if restart { None } else { read(input, directory) };
    if let Some(start) = known.as_ref().and_then(|known| known.starts.get(index))
        && let Phase::Ended(ended) = &start.phase
    {
        return Ok(One { exit: Exit::Done, entry: ended.entry.clone(), how: "; kept" });
    }
    if known.is_none() {
        may_replace(destination, restart)?;
    }
    let (context, findings) = opened.parts();
    let (position, journal, resumed) = match known {
        Some(position) => {
            let journal = Journal::resume(context, &position)?;
            (position, journal, true)
        }
        None => {
            make_room(context, findings)?;
            let journal = Journal::begin(context)?;
            let Some(position) = alone(context, findings, index)? else {
                let entry = failed_entry(seed(&context.input.problem, index), "its gradient is wrong");
                return Ok(One { exit: Exit::GradientWrong, entry, how: "" });
            };
            (position, journal, false)
        }
    };
    let journal = SharedJournal::new(journal);
    let mut starts = Starts::default();
    starts.run(Minimization::new(context, optimizer, &journal), position, resumed)?;
    let exit = match (starts.interrupted, starts.aborted.is_some()) {
        (_, true) => Exit::ForwardFailed,
        (true, _) => Exit::NotConverged,
        (false, _) => Exit::Done,
    };
    if exit == Exit::Done {
        // Whatever the schedule is: the end is what others read.
        journal.lock().save(&context.input.problem.ensemble);
    }
    journal.lock().write_iterates();
    journal.lock().finish(exit != Exit::Done)?;
    if let (Some(out), Exit::Done) = (&context.destination.out, exit) {
        record_end(out, true)?;
    }
    let entry = starts.entries.into_iter().nth(index).unwrap_or_default();
    Ok(One { exit, entry, how: if resumed { "; went on from its checkpoint" } else { "" } })
}

/// The beginning of one start without the others; `None` if the gradient at the start as written is wrong.
fn alone(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    index: usize,
) -> Result<Option<Position>, RunError> {
    let (phase, gradient_check) = match index {
        0 => match first_start(context, findings)? {
            Some((begun, check)) => (Phase::Evaluated(Box::new(begun)), check),
            None => return Ok(None),
        },
        // The others are evaluated, and their gradients checked, as they begin.
        _ => (Phase::Waiting, GradientCheckRecord::default()),
    };
    let problem = &context.input.problem;
    let all = 0..problem.case.optimizer.starts;
    let mut starts: Vec<StartRun> = all.map(|other| absent(problem, other, "left to another process")).collect();
    starts[index].phase = phase;
    Ok(Some(Position { gradient_check, starts, ..Position::default() }))
}

fn absent(problem: &CaseProblem, index: usize, why: &str) -> StartRun {
    failed(index, vec![], failed_entry(seed(problem, index), why))
}

/// Where the run in a directory stands, if it is of this case and version of the program.
fn read(input: &CommandInput, directory: &Path) -> Option<Position> {
    let Checkpoint { case, position, .. } = Checkpoint::read(directory, &|members| 0..members).ok()?;
    position.filter(|_| case.is_same(&CaseRecord::of(&input.problem, &input.options.set)))
}

/// Makes the result of all starts from those that have ended in directories of their own: that of one process.
pub(in crate::run) fn join(opened: &mut Opened<'_>, optimizer: &dyn Optimizer) -> Result<Exit, RunError> {
    let Opened { input, destination, .. } = opened;
    check(input, optimizer).and_then(|()| spectrum::check(input)).map_err(|error| destination.refuse(error))?;
    may_replace(destination, input.options.restart)?;
    let Some(out) = destination.out.clone() else {
        let message = "the starts to join are in a directory: say which".to_owned();
        return Err(input.problem.complain("output/directory", message).into());
    };
    let (position, missing) = collect(input, &out).map_err(|error| destination.refuse(error))?;
    time_steps::find(opened)?;
    let (context, findings) = opened.parts();
    let CommandContext { input, console, .. } = context;
    make_room(context, findings)?;
    let starts = position.starts.len();
    for index in (0..starts).filter(|index| !missing.contains(index)) {
        take_over(&directory_of(out.path(), index), &out)?;
    }
    console.say(format!("joined      {} of {}", starts - missing.len(), count(starts, "start")));
    for index in &missing {
        console.say(format!("missing     start {} of {starts}: no finished run in start_{index}", index + 1));
    }
    findings.record.gradient_check = position.gradient_check.clone();
    let journal = SharedJournal::new(Journal::begin(context)?);
    let (began, mut joined) = (Instant::now(), Starts::default());
    let ran = joined.run(Minimization::new(context, optimizer, &journal), position, true);
    match missing.is_empty() {
        true if input.problem.case.output.checkpoint > 0 => journal.lock().save(&input.problem.ensemble),
        true => {}
        false => out.remove(saved::NAME)?,
    }
    let exit = conclude(opened, joined, ran, journal, began)?;
    Ok(if missing.is_empty() { exit } else { exit.worst(Exit::NotConverged) })
}

/// All starts that have ended, with the best of them, and the numbers of the others.
fn collect(input: &CommandInput, out: &Directory) -> Result<(Position, Vec<usize>), RunError> {
    let (mut missing, mut found) = (Vec::new(), RoundEnd::default());
    let (mut gradient_check, mut starts) = (GradientCheckRecord::default(), Vec::new());
    for index in 0..input.problem.case.optimizer.starts {
        let directory = directory_of(out.path(), index);
        let ended = |position: &Position| position.starts.get(index).is_some_and(StartRun::has_ended);
        let Some(position) = read(input, &directory).filter(ended) else {
            missing.push(index);
            starts.push(absent(&input.problem, index, "missing: it has no finished run"));
            continue;
        };
        if index == 0 {
            gradient_check = position.gradient_check;
        }
        starts.extend(position.starts.into_iter().nth(index));
        if let Some(best) = position.best {
            let file = directory.join(saved::NAME);
            let unfit = |failed: nastic_opt::Failed| CheckpointError::Content { file, what: failed.to_string() };
            found.add(index, restored_best(&input.problem, best).map_err(unfit)?.1);
        }
    }
    if missing.contains(&0) {
        // Without it one process has no result either.
        return Err(RunError::NothingToJoin { directory: out.path().to_owned() });
    }
    let best = found.best.as_ref().map(|best| saved_best(&input.problem, best));
    Ok((Position { gradient_check, best, starts, ..Position::default() }, missing))
}

/// Copies the files of a start.
fn take_over(directory: &Path, out: &Directory) -> Result<(), RunError> {
    let fail = |source| WriteError::System { file: directory.to_owned(), source };
    for entry in std::fs::read_dir(directory).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if out.has(&name) && !OWN.contains(&name.as_str()) {
            write_atomically(out.own(&name)?, |to| {
                std::io::copy(&mut std::fs::File::open(entry.path())?, to).map(drop)
            })?;
        }
    }
    Ok(())
}
