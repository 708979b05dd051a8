//! The commands, as functions of a library: `check`, `solve`, `modes`, `gradient`, `gradcheck`, `optimize`, `resume`, `sweep`.
//!
//! ```no_run
//! use nastic_case::console::Console;
//! use nastic_case::run::{Options, run};
//! use nastic_case::schema::Command;
//!
//! let outcome = run(Command::Solve, "case.json".as_ref(), &Options::default(), &Console::silent())?;
//! println!("{}", outcome.result["probes"]["tip"]["displacement"]);
//! # Ok::<(), nastic_case::run::RunError>(())
//! ```

mod analysis;
mod case_record;
mod check;
mod check_gradient;
mod describe;
mod ensemble_progress;
mod error;
mod fit;
mod gradcheck;
mod gradient;
mod modes;
mod motion;
pub(crate) mod number;
mod on_trial;
mod optimize;
mod pace;
mod report;
mod resume;
mod session;
mod solve;
mod spectrum_request;
mod states;
mod study;
mod sweep;
mod time_steps;

pub use analysis::Analysis;
pub use error::{Exit, RunError};
pub use fit::{FitOutcome, fit};
pub use gradcheck::{GradientTest, test_gradient};
pub use modes::ModesRequest;
pub use on_trial::OnTrial;
pub use report::report;
pub use spectrum_request::{SpectrumRefusal, SpectrumRequest};
pub use states::{ShowError, States};
pub use study::{ControlSet, Optimum, Study, StudyError};
pub use sweep::{Sweep, SweepOutcome, sweep};

pub(crate) use number::short;
pub(crate) use pace::Pace;

use crate::catalogue::Catalogue;
use crate::console::Console;
use crate::result::{Missed, expectation, failure};
use crate::schema::Command;
use crate::syntax::Document;
use crate::warning::Warning;
use nastic_control::ControlError;
use serde_json::{Value, json};
use session::Session;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// What a user may choose beside the case.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Directory of all results; that of the case if absent.
    pub out: Option<PathBuf>,
    /// Whether nothing is written unless `out` says where, by any command.
    pub in_memory: bool,
    /// Number of threads; all processors if absent. Results do not depend on it.
    pub threads: Option<usize>,
    /// Overrides `path=value`, in order.
    pub set: Vec<String>,
    /// Whether warnings make a command fail, with [`Exit::Warned`].
    pub strict: bool,
    /// Whether the page of results, `report.html`, is left out.
    pub no_report: bool,
    /// Whether the case's `expect` is left aside: it holds for the case as it is written.
    pub without_expect: bool,
    /// Whether `solve` and `optimize` may replace the checkpoint of a run that was interrupted, or one that cannot be read.
    pub restart: bool,
    /// Whether the columns of the table of trials are explained above it.
    pub explain: bool,
    /// What `solve` computes.
    pub analysis: Analysis,
    /// What `modes` computes.
    pub modes: ModesRequest,
    /// Eigenpairs of the reduced Hessian at the optimum of `optimize`.
    pub spectrum: Option<SpectrumRequest>,
    /// Told of every trial of an optimisation.
    pub on_trial: OnTrial,
    /// Once raised, the command stops as soon as it can, keeping what it has.
    pub cancel: Arc<AtomicBool>,
}

/// What a command found.
#[derive(Clone, PartialEq, Debug)]
pub struct Outcome {
    /// How it ended.
    pub exit: Exit,
    /// The content of `result.json`.
    pub result: Value,
    /// Expectations of the case that were not met.
    pub missed: Vec<Missed>,
}

/// Runs a command on a case file.
///
/// # Errors
/// A [`RunError`], which knows its exit code. A failed gradient check, a stop before convergence and missed expectations
/// are no errors: see [`Outcome::exit`].
pub fn run(command: Command, case: &Path, options: &Options, console: &Console) -> Result<Outcome, RunError> {
    run_with(&Catalogue::standard(), command, case, options, console)
}

/// As [`run`], with the names of a catalogue of one's own.
///
/// # Errors
/// As [`run`].
pub fn run_with(
    catalogue: &Catalogue,
    command: Command,
    case: &Path,
    options: &Options,
    console: &Console,
) -> Result<Outcome, RunError> {
    thread_pool(options.threads)?.install(|| {
        let session = Session::open(catalogue, command, case, options, console)?;
        execute(session, options).map(|(outcome, _)| outcome)
    })
}

/// Runs a command on a case that was read or made by a program; also the states that it found, as values: of `solve` and `gradient` those
/// at the start controls, of `optimize` the best. None of the commands that have no such state (`check`, `gradcheck`, a path).
///
/// # Errors
/// As [`run`].
pub fn run_document(
    command: Command,
    document: Document,
    options: &Options,
    console: &Console,
) -> Result<(Outcome, Option<States>), RunError> {
    thread_pool(options.threads)?.install(|| {
        let session = Session::open_document(command, document, options, console, Instant::now())?;
        execute(session, options)
    })
}

fn execute(mut session: Session<'_>, options: &Options) -> Result<(Outcome, Option<States>), RunError> {
    let exit = match &session.command {
        Command::Check => check::run(&mut session),
        Command::Solve => motion::may_replace(&mut session, options.restart)
            .and_then(|()| solve::run(&mut session, &options.analysis)),
        Command::Modes => modes::run(&mut session, options.modes),
        Command::Gradient => gradient::run(&mut session),
        Command::Gradcheck => gradcheck::run(&mut session),
        Command::Optimize => {
            let optimizer = session.problem.optimizer()?;
            optimize::begin(&mut session, optimizer.as_ref(), options.restart)
        }
    };
    conclude(session, exit, options.analysis.has_one_state())
}

/// Goes on with an optimisation, or with the motion of a `solve` that was stopped, from the last checkpoint in its output directory. The result is that of [`run`] without
/// interruption, to the bit but for times and the entry `resumed`. Directory and overrides are those of the checkpoint: `out` and `set` of
/// the options are not looked at.
///
/// # Errors
/// [`RunError::Checkpoint`]: there is no checkpoint, it is damaged, or the case has changed since; and as [`run`].
pub fn resume(
    catalogue: &Catalogue,
    directory: &Path,
    options: &Options,
    console: &Console,
) -> Result<Outcome, RunError> {
    thread_pool(options.threads)?.install(|| {
        let (mut session, position) = resume::open(catalogue, directory, options.cancel.clone(), console)?;
        session.strict = options.strict;
        session.report = !options.no_report;
        session.explain = options.explain;
        session.spectrum = options.spectrum;
        session.on_trial = options.on_trial.clone();
        let exit = match position {
            resume::Place::Motion(checkpoint) => solve::resume(&mut session, checkpoint),
            resume::Place::Optimization(position) => {
                let optimizer = session.problem.optimizer()?;
                optimize::resume(&mut session, optimizer.as_ref(), position)
            }
        };
        conclude(session, exit, true).map(|(outcome, _)| outcome)
    })
}

/// The threads of a command, all processors if `None`. What the environment limits (memory) is read before anything is done.
///
/// # Errors
/// [`RunError::MemoryLimit`], [`RunError::Threads`].
pub fn thread_pool(threads: Option<usize>) -> Result<rayon::ThreadPool, RunError> {
    nastic_fem::memory_limit()?;
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = threads {
        pool = pool.num_threads(threads);
    }
    pool.build().map_err(|error| RunError::Threads(error.to_string()))
}

fn conclude(
    session: Session<'_>,
    exit: Result<Exit, RunError>,
    usual: bool,
) -> Result<(Outcome, Option<States>), RunError> {
    session.console.clear();
    match exit {
        Ok(exit) => close(session, exit, usual),
        Err(error) => {
            note_failure(session, &error);
            Err(error)
        }
    }
}

/// What went wrong takes the place of a result, so that no older one is taken for it.
fn note_failure(mut session: Session<'_>, error: &RunError) {
    session.finish_clock();
    let warnings: Vec<Value> = session.warnings.iter().map(Warning::json).collect();
    session.put("warnings", json!(warnings));
    session.put("error", json!(error.to_string()));
    session.put("exit", json!(error.exit().code()));
    if let RunError::Forward { member, error, file } = error.cause() {
        if file.is_some() {
            let mut files = session.result_value()["files"].as_array().cloned().unwrap_or_default();
            files.push(json!("failure.vtu"));
            session.put("files", json!(files));
        }
        if let ControlError::State(state) = error.as_ref() {
            let one = session.problem.members().find(|one| one.name() == *member);
            let entry = one.map(|one| failure::entries(one, state));
            session.put("failure", json!(entry));
        }
    }
    // The error itself is what the caller hears of.
    let _ = report::write_result(&mut session);
}

/// Wall time and memory.
fn say_effort(session: &Session<'_>) {
    let result = session.result_value();
    let seconds = result["seconds"]["total"].as_f64().unwrap_or(f64::NAN);
    let memory = match result["peak_memory"].as_u64() {
        Some(bytes) => format!(", at most {:.0} MB of memory", bytes as f64 / 1e6),
        None => String::new(),
    };
    session.console.say(format!("time        {}{memory}", nastic_report::duration(seconds)));
}

/// Judges expectations and writes the result.
fn close(mut session: Session<'_>, exit: Exit, usual: bool) -> Result<(Outcome, Option<States>), RunError> {
    let mut exit = exit;
    session.finish_clock();
    let expect = &session.problem.case.expect;
    // What was interrupted is not held to its expectations.
    let expect = if session.is_cancelled() || !session.expect { &Default::default() } else { expect };
    let (checked, missed) = expectation::judge(expect, &session.command, usual, &session.result_value());
    for miss in &missed {
        session.console.say(format!("MISSED      {miss}"));
    }
    if checked > 0 && missed.is_empty() {
        session.console.say(format!("expect      {checked} of {checked} values as expected"));
    }
    let misses: Vec<Value> =
        missed.iter().map(|m| json!({ "path": m.path, "found": m.found, "expected": m.expected })).collect();
    session.put("expect", json!({ "checked": checked, "missed": misses }));
    if !missed.is_empty() && matches!(exit, Exit::Done | Exit::NotConverged) {
        exit = Exit::ExpectMissed;
    }
    let warnings: Vec<Value> = session.warnings.iter().map(Warning::json).collect();
    if session.strict && !warnings.is_empty() && exit == Exit::Done {
        session
            .console
            .say(format!("strict      {} under --strict: exit code 8", number::count(warnings.len(), "warning")));
        exit = Exit::Warned;
    }
    session.put("warnings", json!(warnings));
    session.put("exit", json!(exit.code()));
    report::write_result(&mut session)?;
    optimize::record_end(&session)?;
    motion::record_end(&session)?;
    if let Some(out) = &session.out {
        session.console.say(format!("results     {}", out.path().display()));
        let page = out.file(nastic_report::FILE);
        if page.exists() {
            session.console.say(format!("page        {}", page.display()));
        }
    }
    say_effort(&session);
    let outcome = Outcome { exit, result: session.result_value(), missed };
    let Session { problem, shown, .. } = session;
    Ok((outcome, shown.map(|shown| States::new(problem, shown))))
}
