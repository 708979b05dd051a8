//! [`CommandFindings`]: what a command has found so far.

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::progress;
use crate::run::session::clock::Clock;
use crate::run::session::destination::Destination;
use crate::run::session::input::CommandInput;
use crate::run::states::Shown;
use crate::run::terminal::say_warning;
use nastic_case::lower::CaseMember;
use nastic_case::warning::Warning;
use nastic_control::AdaptiveSteps;
use nastic_ensemble::EnsemblePoint;
use nastic_fem::peak_memory;
use nastic_io::Fingerprint;
use nastic_language::number;
use nastic_language::quantity::Dimension;
use nastic_report::record::{DiscretizationRecord, RunRecord, StateRecord, UnitsRecord, VersionsRecord};
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::smoothing;
use nastic_result::warning_record::warning_record;
use std::time::Instant;

/// What a command has found so far.
pub(crate) struct CommandFindings {
    /// The result as it stands.
    pub record: RunRecord,
    /// What deserves attention, as far as it is known.
    pub warnings: Vec<Warning>,
    /// The states that were found.
    pub shown: Option<Shown>,
    /// Of a case with a tolerance of time steps those of every member, once they were found.
    pub steps: Vec<AdaptiveSteps>,
    pub clock: Clock,
    /// Whether an optimisation came to its end; its checkpoint says so once the results are written.
    pub ended: bool,
    /// Whether something ended the command that has nothing to do with the case: a stop that was requested, a lack of memory.
    pub interrupted: bool,
}

impl CommandFindings {
    /// The head of every result, and of what is said.
    pub fn begin(input: &CommandInput, console: &Console, clock: Clock) -> Self {
        let problem = &input.problem;
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
        let command = input.command.name();
        console.say(match &title {
            Some(title) => format!("case        {path}: {title}"),
            None => format!("case        {path}"),
        });
        let (mesh, dofs) = (problem.mesh(), problem.solid().discretization().dofs());
        let body = format!("{}, {} unknowns", number::count(mesh.cells(), "cell"), number::grouped(dofs));
        console.say(format!(
            "body        {}: {body}, {} control values",
            mesh.name(),
            number::grouped(problem.start.len())
        ));
        for note in &notes {
            console.say(format!("note        {note}"));
        }
        for line in smoothing::automatic(problem) {
            console.say(format!("stages      {line}"));
        }
        let discretization = DiscretizationRecord {
            dimensions: mesh.dim(),
            cells: mesh.cells(),
            nodes: mesh.points().len(),
            unknowns: dofs,
        };
        let record = RunRecord {
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
            smoothing: smoothing::record(problem),
            ..RunRecord::default()
        };
        let (warnings, shown, steps) = (Vec::new(), None, Vec::new());
        let mut findings = Self { record, warnings, shown, steps, clock, ended: false, interrupted: false };
        problem.warnings.iter().for_each(|warning| findings.warn(console, warning.clone()));
        findings
    }

    /// Says a warning, and keeps it for the result.
    pub fn warn(&mut self, console: &Console, warning: Warning) {
        say_warning(console, &warning);
        self.warnings.push(warning);
    }

    /// The same of several.
    pub fn warn_all(&mut self, console: &Console, warnings: impl IntoIterator<Item = Warning>) {
        warnings.into_iter().for_each(|warning| self.warn(console, warning));
    }

    /// Looks into the states of an evaluated control, says what deserves attention there and keeps it for the result;
    /// `what` names the states.
    pub fn inspect(
        &mut self,
        input: &CommandInput,
        console: &Console,
        what: &str,
        point: &EnsemblePoint,
    ) -> Vec<Inspection> {
        let (found, warnings) = self.timed(console, "inspect", |_| input.look_into(console, what, point));
        self.warnings.extend(warnings);
        found
    }

    /// Codes of the warnings so far, for a picture: empty without any.
    pub fn warned(&self) -> String {
        let mut codes: Vec<&str> = self.warnings.iter().map(|warning| warning.kind.code).collect();
        codes.sort_unstable();
        codes.dedup();
        if codes.is_empty() { String::new() } else { format!("; WARNING: {}", codes.join(", ")) }
    }

    /// The entries of a member; of a plain case those of the result itself.
    pub fn entries_of(&mut self, member: CaseMember<'_>) -> &mut StateRecord {
        self.record.state.member_mut(member.scenario(), member.load_case())
    }

    /// Adds names to the list of files of the result.
    pub fn list_files(&mut self, names: Vec<String>) {
        let files = self.record.files.get_or_insert_default();
        for name in names {
            if !files.contains(&name) {
                files.push(name);
            }
        }
    }

    /// Writes files of the results, where there is a directory for them, and says their names.
    pub fn write(
        &mut self,
        console: &Console,
        destination: &Destination,
        write: impl FnOnce(&mut Self, &Directory) -> Result<Vec<String>, RunError>,
    ) -> Result<(), RunError> {
        let write = |own: &mut Self| destination.results().map(|out| write(own, out)).transpose();
        let files = self.timed(console, "write", write)?;
        files.into_iter().for_each(|files| self.say_files(console, files));
        Ok(())
    }

    /// Puts the names of files into the result and says them, the first of many.
    pub fn say_files(&mut self, console: &Console, files: Vec<String>) {
        const NAMED: usize = 9;
        let more = if files.len() > NAMED { format!(" and {} more", files.len() - NAMED) } else { String::new() };
        let said: Vec<&str> = files.iter().take(NAMED).map(String::as_str).collect();
        console.say(format!("files       result.json, {}{more}", said.join(", ")));
        self.list_files(files);
    }

    /// Puts warnings and exit code into the result.
    pub fn close(&mut self, exit: Exit) {
        self.record.warnings = self.warnings.iter().map(warning_record).collect();
        self.record.exit = Some(exit.code());
        self.record.interrupted = self.interrupted.then_some(true);
    }

    /// Does something, and notes how long it took.
    pub fn timed<T>(&mut self, console: &Console, phase: &'static str, work: impl FnOnce(&mut Self) -> T) -> T {
        let began = Instant::now();
        console.phase(progress::words(phase));
        let out = work(self);
        self.clock.note(phase, began.elapsed().as_secs_f64());
        out
    }

    /// Puts the times into the result.
    pub fn finish_clock(&mut self) {
        self.record.seconds = self.clock.seconds().collect();
        self.record.peak_memory = peak_memory().into();
    }
}
