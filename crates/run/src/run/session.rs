//! What the commands share: the case at hand, the place for results, the console, the result.

mod clock;
mod destination;
mod failures;
pub(super) mod findings;
pub(super) mod input;
pub(super) mod output_directory;
mod place;
mod team;

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::options::Options;
use crate::run::progress;
use crate::run::session::clock::Clock;
use crate::run::session::destination::Destination;
use crate::run::session::findings::CommandFindings;
use crate::run::session::input::CommandInput;
use crate::run::session::output_directory::directory;
use nastic_case::lower::CaseProblem;
use nastic_case::part::Share;
use nastic_case::warning::Warning;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_fem::peak_memory;
use nastic_io::Fingerprint;
use nastic_language::catalogue::Catalogue;
use nastic_language::number;
use nastic_language::quantity::Dimension;
use nastic_language::schema::Command;
use nastic_language::syntax::{Diagnostics, Document};
use nastic_opt::{Budget, Failed, Objective, Request};
use nastic_report::record::{DiscretizationRecord, RunRecord, StateRecord, UnitsRecord, VersionsRecord};
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::smoothing;
use nastic_result::warning_record::warning_record;
use std::path::Path;
use std::sync::{Arc, atomic::Ordering};
use std::time::Instant;

/// Relative accuracy of the state at the start; its residual is a hundredth of that.
pub(super) const START_ACCURACY: f64 = 1e-10;
/// Newton iterations after which the search of an equilibrium ends: hundreds are many.
const MOST_ITERATIONS: usize = 4000;

/// A command under way.
pub(crate) struct Session<'c> {
    pub input: CommandInput,
    pub destination: Destination,
    pub console: &'c Console,
    pub findings: CommandFindings,
}

impl<'c> Session<'c> {
    /// Reads and lowers the case.
    pub fn open(
        catalogue: &Catalogue,
        command: Command,
        path: &Path,
        options: &Options,
        console: &'c Console,
    ) -> Result<Self, RunError> {
        let began = Instant::now();
        console.phase("reading");
        let document = Document::open(path)?.with_catalogue(catalogue);
        Self::open_document(command, document, options, console, began)
    }

    /// Lowers a case that was read; `began` is when that began.
    pub fn open_document(
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
        apply(&options.set, &mut document, |document| lower(document, Arc::default()).err())?;
        let problem = lower(document, options.cancel.clone())?;
        let mut session = Self::on(command, problem, options.clone(), console, began);
        // Each start of a part has a directory of its own.
        let is_part = session.input.command == Command::Optimize && matches!(options.share, Share::Part(_));
        let out = directory(&session.input.command, &session.input.problem, options).filter(|_| !is_part);
        session.join_team(options)?;
        if let Some(path) = out {
            session.enter(path)?;
        }
        Ok(session)
    }

    /// Goes on with a command whose case was read and whose directory is claimed.
    pub fn resume(
        command: Command,
        document: Document,
        set: Vec<String>,
        directory: &Path,
        out: Option<Directory>,
        options: &Options,
        console: &'c Console,
    ) -> Result<Self, RunError> {
        let began = Instant::now();
        console.phase("reading");
        let problem = CaseProblem::lower(document, options.cancel.clone())?;
        let own = Options { set, ..options.clone() };
        let mut session = Self::on(command, problem, own, console, began);
        session.go_on_in(out, directory)?;
        session.join_team(options)?;
        Ok(session)
    }

    /// A command on a problem that is ready.
    pub fn on(
        command: Command,
        mut problem: CaseProblem,
        options: Options,
        console: &'c Console,
        began: Instant,
    ) -> Self {
        if command == Command::Optimize {
            problem.refuse_unstable_if_asked();
        }
        progress::watch(&mut problem, console);
        let (mut clock, ordering) = (Clock::new(began), problem.ordering.as_secs_f64());
        clock.note("read", began.elapsed().as_secs_f64() - ordering);
        clock.note("ordering", ordering);
        let (signal, cancel) = (options.cancel.clone(), options.cancel.clone());
        let input = CommandInput { command, problem, options, team: None, cancel, signal };
        let mut session =
            Self { input, destination: Destination::default(), console, findings: CommandFindings::new(clock) };
        session.introduce();
        session
    }

    /// The head of every result, and of what is said.
    fn introduce(&mut self) {
        let problem = &self.input.problem;
        let path = problem.document.name().to_owned();
        let case = &problem.case;
        let hash = Fingerprint::of(&problem.document.canonical(), &problem.files);
        let directory = problem.document.resolve("");
        let inputs = problem.files.iter().map(|file| file.strip_prefix(&directory).unwrap_or(file));
        let inputs = inputs.map(|file| file.display().to_string()).collect();
        let title = case.title.clone();
        let units = problem.units();
        let versions = VersionsRecord { nastic: env!("CARGO_PKG_VERSION").to_owned(), case: Some(case.nastic) };
        let labels = UnitsRecord {
            length: units.length().symbol.to_owned(),
            force: units.force().symbol.to_owned(),
            time: units.time().symbol.to_owned(),
            field: units.field().symbol.to_owned(),
            pressure: units.label(Dimension::PRESSURE),
        };
        let notes = problem.notes.clone();
        let command = self.input.command.name();
        self.console.say(match &title {
            Some(title) => format!("case        {path}: {title}"),
            None => format!("case        {path}"),
        });
        let (mesh, dofs) = (problem.mesh(), problem.solid().discretization().dofs());
        let body = format!("{}, {} unknowns", number::count(mesh.cells(), "cell"), number::grouped(dofs));
        self.console.say(format!(
            "body        {}: {body}, {} control values",
            mesh.name(),
            number::grouped(problem.start.len())
        ));
        for note in &notes {
            self.console.say(format!("note        {note}"));
        }
        for line in smoothing::automatic(&self.input.problem) {
            self.console.say(format!("stages      {line}"));
        }
        let discretization = DiscretizationRecord {
            dimensions: mesh.dim(),
            cells: mesh.cells(),
            nodes: mesh.points().len(),
            unknowns: dofs,
        };
        self.findings.record = RunRecord {
            command: command.to_owned(),
            discretization: Some(discretization),
            case: Some(path),
            title: title.into(),
            case_hash: hash,
            inputs: Some(inputs),
            versions,
            units: labels,
            threads: Some(rayon::current_num_threads()),
            notes: Some(notes),
            smoothing: smoothing::record(&self.input.problem),
            ..RunRecord::default()
        };
        for warning in self.input.problem.warnings.clone() {
            self.warn(warning);
        }
    }

    /// Says a warning, and keeps it for the result.
    pub fn warn(&mut self, warning: Warning) {
        say_warning(self.console, &warning);
        self.findings.warnings.push(warning);
    }

    /// Looks into the states of an evaluated control, says what deserves attention there and keeps it for the result;
    /// `what` names the states.
    pub fn inspect(&mut self, what: &str, point: &EnsemblePoint) -> Vec<Inspection> {
        let (found, warnings) = self.timed("inspect", |session| session.look_into(session.console, what, point));
        self.findings.warnings.extend(warnings);
        found
    }

    /// Looks into the states and says what deserves attention there; the caller keeps the warnings.
    pub fn look_into(&self, console: &Console, what: &str, point: &EnsemblePoint) -> (Vec<Inspection>, Vec<Warning>) {
        let found = Inspection::of_point(&self.input.problem, point);
        let members = self.input.problem.members().zip(&found);
        let warnings: Vec<Warning> = members.flat_map(|(member, found)| found.warnings(member, what)).collect();
        warnings.iter().for_each(|warning| say_warning(console, warning));
        (found, warnings)
    }

    /// Codes of the warnings so far, for a picture: empty without any.
    pub fn warned(&self) -> String {
        let mut codes: Vec<&str> = self.findings.warnings.iter().map(|warning| warning.kind.code).collect();
        codes.sort_unstable();
        codes.dedup();
        if codes.is_empty() { String::new() } else { format!("; WARNING: {}", codes.join(", ")) }
    }

    /// The entries of a member; of a plain case those of the result itself.
    pub fn entries_of(&mut self, index: usize) -> &mut StateRecord {
        let member = self.input.problem.member(index);
        self.findings.record.state.member_mut(member.scenario(), member.load_case())
    }

    /// Puts warnings and exit code into the result.
    pub fn close(&mut self, exit: Exit) {
        self.findings.record.warnings = self.findings.warnings.iter().map(warning_record).collect();
        self.findings.record.exit = Some(exit.code());
        self.findings.record.interrupted = self.findings.interrupted.then_some(true);
    }

    /// Does something, and notes how long it took.
    pub fn timed<T>(&mut self, phase: &'static str, work: impl FnOnce(&mut Self) -> T) -> T {
        let began = Instant::now();
        self.console.phase(progress::words(phase));
        let out = work(self);
        self.findings.clock.note(phase, began.elapsed().as_secs_f64());
        out
    }

    /// Puts the times into the result.
    pub fn finish_clock(&mut self) {
        self.findings.record.seconds = self.findings.clock.seconds().collect();
        self.findings.record.peak_memory = peak_memory().into();
    }

    /// The ensemble at a control vector: the one way every command comes by its states.
    pub fn evaluate(
        &self,
        m: &[f64],
        accuracy: f64,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<EnsemblePoint, Failed> {
        let budget = if self.input.problem.is_motion() { Budget::Unlimited } else { Budget::Of(MOST_ITERATIONS) };
        let how = Request { accuracy, budget, ..Request::default() };
        let point = self.input.problem.ensemble.evaluate(m, &how, workspace);
        self.console.clear();
        point
    }

    /// The start controls, as exactly as costs no more than another iteration.
    pub fn evaluate_start(&mut self, workspace: &mut EnsembleWorkspace) -> Result<EnsemblePoint, RunError> {
        let point =
            self.timed("solve", |session| session.evaluate(&session.input.problem.start, START_ACCURACY, workspace));
        point.map_err(|failed| self.evaluation_failed(&failed))
    }

    /// Whether a stop was requested.
    pub fn is_cancelled(&self) -> bool {
        self.input.cancel.load(Ordering::Relaxed)
    }

    /// What this command needs and the case lacks.
    pub fn require(&self, controls: bool, costs: bool) -> Result<(), RunError> {
        let command = self.input.command.name();
        if controls && self.input.problem.start.is_empty() {
            let message = format!("\"{command}\" needs controls, and the case has none");
            return Err(self.input.problem.complain("controls", message).into());
        }
        if costs && !self.input.problem.has_costs() {
            let message = format!("\"{command}\" needs costs, and the case has none");
            return Err(self.input.problem.complain("costs", message).into());
        }
        if controls && costs { Ok(self.input.problem.check_adjoint()?) } else { Ok(()) }
    }
}

/// Says a warning; the caller keeps it.
pub(super) fn say_warning(console: &Console, warning: &Warning) {
    console.say(format!("WARNING     {warning}"));
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
