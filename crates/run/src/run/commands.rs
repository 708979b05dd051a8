//! The commands on a case.

use crate::console::Console;
use crate::run::conclusion::conclude;
use crate::run::error::RunError;
use crate::run::options::Options;
use crate::run::outcome::Outcome;
use crate::run::session::Opened;
use crate::run::states::States;
use crate::run::{check, gains, gradcheck, gradient, modes, motion, optimize, resumption, solve};
use nastic_case::part::Share;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use std::path::Path;
use std::time::Instant;

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
/// ```no_run
/// use nastic_language::catalogue::Catalogue;
/// use nastic_run::console::Console;
/// use nastic_run::run::{Options, run_with};
/// use nastic_language::schema::Command;
/// use nastic_energy::NeoHooke;
/// use nastic_energy::catalogue::{Made, MaterialRow, Parameter};
///
/// static SILICONE: MaterialRow = MaterialRow::new(
///     "silicone",
///     "neo-Hookean with lambda = 20 mu",
///     &[&[Parameter::number("mu", "Pa", 1e5)]],
///     |given| {
///         let mu = given.number("mu")?;
///         Ok(Made::density(NeoHooke::new(mu.clone(), mu.try_map(|_, mu| Ok(20.0 * mu))?)?))
///     },
/// );
///
/// let catalogue = Catalogue::standard().with_material(&SILICONE);
/// let outcome = run_with(&catalogue, Command::Solve, "case.json".as_ref(), &Options::default(), &Console::silent())?;
/// # Ok::<(), nastic_run::run::RunError>(())
/// ```
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
        let began = Instant::now();
        console.phase("reading");
        let document = Document::open(case)?.with_catalogue(catalogue);
        let opened = Opened::open(command, document, options, console, began)?;
        execute(opened, options).map(|(outcome, _)| outcome)
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
        let opened = Opened::open(command, document, options, console, Instant::now())?;
        execute(opened, options)
    })
}

pub(crate) fn execute(mut opened: Opened<'_>, options: &Options) -> Result<(Outcome, Option<States>), RunError> {
    let exit = match &opened.input.command {
        Command::Check => check::run(&mut opened),
        Command::Solve => motion::may_replace(&mut opened.destination, options.restart)
            .and_then(|()| solve::run(&mut opened, &options.analysis)),
        Command::Modes => modes::run(&mut opened, options.modes),
        Command::Gradient => gradient::run(&mut opened),
        Command::Gradcheck => gradcheck::run(&mut opened),
        Command::Gains => gains::run(&mut opened),
        Command::Optimize | Command::Identify => {
            let optimizer = opened.input.problem.optimizer()?;
            match options.share {
                Share::Whole => optimize::begin(&mut opened, optimizer.as_ref(), options.restart),
                Share::Join => optimize::join(&mut opened, optimizer.as_ref()),
                Share::Part(part) => optimize::run_part(&mut opened, optimizer.as_ref(), part),
            }
        }
    };
    conclude(opened, exit, options.analysis.has_one_state())
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
        let (mut opened, position) = resumption::open(catalogue, directory, options, console)?;
        let exit = match position {
            resumption::Resumed::Motion(checkpoint) => solve::resume(&mut opened, checkpoint),
            resumption::Resumed::Optimization(position) => {
                let optimizer = opened.input.problem.optimizer()?;
                optimize::resume(&mut opened, optimizer.as_ref(), *position)
            }
        };
        conclude(opened, exit, true).map(|(outcome, _)| outcome)
    })
}

/// The case of an optimisation as it was run, from the checkpoint in its output directory.
///
/// # Errors
/// [`RunError::Checkpoint`], as [`resume`].
pub fn case_of(catalogue: &Catalogue, directory: &Path) -> Result<Document, RunError> {
    resumption::read(directory, None)?.1.case.reopen(catalogue, directory)
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
