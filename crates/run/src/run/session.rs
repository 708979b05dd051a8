//! What the commands share, as values that are passed on: the input, the destination, the findings; beside them the console.

mod clock;
mod destination;
mod failures;
mod findings;
mod input;
pub(super) mod output_directory;
mod team;

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::options::Options;
use crate::run::progress;
use crate::run::session::clock::Clock;
pub(crate) use crate::run::session::destination::Destination;
pub(crate) use crate::run::session::findings::CommandFindings;
pub(crate) use crate::run::session::input::{CommandInput, evaluate};
use crate::run::session::output_directory::directory;
use nastic_case::lower::CaseProblem;
use nastic_case::part::Share;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_language::schema::Command;
use nastic_language::syntax::{Diagnostics, Document};
use std::sync::Arc;
use std::time::Instant;

/// Relative accuracy of the state at the start; its residual is a hundredth of that.
pub(super) const START_ACCURACY: f64 = 1e-10;

/// A command that was opened. It takes its values apart: time steps change the problem, a refusal the destination.
pub(crate) struct Opened<'c> {
    pub input: CommandInput,
    pub destination: Destination,
    pub console: &'c Console,
    pub findings: CommandFindings,
}

/// What stands fixed while a command runs.
#[derive(Clone, Copy)]
pub(crate) struct CommandContext<'c> {
    pub input: &'c CommandInput,
    pub destination: &'c Destination,
    pub console: &'c Console,
}

impl<'c> Opened<'c> {
    /// Lowers a case that was read; `began` is when that began.
    pub fn open(
        command: Command,
        mut document: Document,
        options: &Options,
        console: &'c Console,
        began: Instant,
    ) -> Result<Self, RunError> {
        // what is not solved may float
        let lower = match &command {
            Command::Modes if options.modes.undeformed => CaseProblem::lower_free,
            _ => CaseProblem::lower,
        };
        let options = &with_method(&command, &document, options);
        apply(&options.set, &mut document, |document| lower(document, Arc::default()).err())?;
        let problem = lower(document, options.cancel.clone())?;
        // Each start of a part has a directory of its own; expectations hold for the result, which is joined.
        let is_part = command == Command::Optimize && matches!(options.share, Share::Part(_));
        let out = directory(&command, &problem, options).filter(|_| !is_part);
        let options = Options { without_expect: options.without_expect || is_part, ..options.clone() };
        let mut opened = Self::on(command, problem, options, console, began);
        opened.input.join_team()?;
        if let Some(path) = out {
            opened.destination.enter(&opened.input, path)?;
        }
        Ok(opened)
    }

    /// A command on a problem that is ready.
    pub fn on(
        command: Command,
        mut problem: CaseProblem,
        options: Options,
        console: &'c Console,
        began: Instant,
    ) -> Self {
        if command.optimizes() {
            problem.refuse_unstable_if_asked();
        }
        progress::watch(&mut problem, console);
        let (mut clock, ordering) = (Clock::new(began), problem.ordering.as_secs_f64());
        clock.note("read", began.elapsed().as_secs_f64() - ordering);
        clock.note("ordering", ordering);
        let (signal, cancel) = (options.cancel.clone(), options.cancel.clone());
        let input = CommandInput { command, problem, options, team: None, cancel, signal };
        let findings = CommandFindings::begin(&input, console, clock);
        Self { input, destination: Destination::default(), console, findings }
    }

    /// What stands fixed from here on, and what is found.
    pub fn parts(&mut self) -> (CommandContext<'_>, &mut CommandFindings) {
        let Self { input, destination, console, findings } = self;
        (CommandContext { input, destination, console }, findings)
    }
}

/// The start controls, as exactly as costs no more than another iteration.
pub(super) fn evaluate_start(
    CommandContext { input, destination, console }: CommandContext<'_>,
    findings: &mut CommandFindings,
    workspace: &mut EnsembleWorkspace,
) -> Result<EnsemblePoint, RunError> {
    let start = &input.problem.start;
    let point = findings.timed(console, "solve", |_| input.evaluate(console, start, START_ACCURACY, workspace));
    point.map_err(|failed| destination.evaluation_failed(input, &failed))
}

/// The options with the method of `identify`, where neither the case nor an override names one: it belongs to the settings that a checkpoint remembers.
fn with_method(command: &Command, document: &Document, options: &Options) -> Options {
    const KEY: &str = "optimizer/method";
    let case = document.json();
    let is_named =
        case.pointer("/optimizer/method").is_some() || options.set.iter().any(|setting| setting.starts_with(KEY));
    // a motion is refused, and not for this method
    let is_wanted = *command == Command::Identify && !is_named && case.get("time").is_none();
    let added = is_wanted.then(|| format!("{KEY}=gauss_newton"));
    Options { set: added.into_iter().chain(options.set.clone()).collect(), ..options.clone() }
}

/// Applies overrides; those that fail are reported with what is wrong with the case besides.
fn apply(
    set: &[String],
    document: &mut Document,
    lower: impl Fn(Document) -> Option<Diagnostics>,
) -> Result<(), Diagnostics> {
    let mut problems = Vec::new();
    for option in set {
        problems.extend(document.set(option).err().iter().flat_map(Diagnostics::list).cloned());
    }
    let others = (!problems.is_empty()).then(|| lower(document.clone())).flatten();
    problems.extend(others.iter().flat_map(Diagnostics::list).cloned());
    Diagnostics::new(problems).into_result()
}

impl From<Exit> for u8 {
    fn from(exit: Exit) -> Self {
        exit.code()
    }
}
