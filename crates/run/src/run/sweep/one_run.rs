//! [`OneRun`]: a run of a sweep: kept if it was made before, made or gone on with if not, and what it left.

use crate::console::Console;
use crate::run::commands::{resume, run_with};
use crate::run::error::{Exit, RunError};
use crate::run::options::Options;
use crate::run::outcome::Outcome;
use crate::run::resumption;
use nastic_case::output_names::OutputNames;
use nastic_io::Fingerprint;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_report::record::{RunRecord, VersionsRecord};
use nastic_result::files::Directory;
use std::path::Path;

const RESULT: &str = "result.json";

/// A run of a sweep.
pub(super) struct OneRun<'s> {
    pub command: &'s Command,
    pub case: &'s Path,
    /// Its directory.
    pub directory: &'s Path,
    /// The case with its values.
    pub document: Document,
}

/// What it left: its exit code, why it failed, its result.
pub(super) struct Left {
    pub exit: Exit,
    pub error: Option<String>,
    pub record: RunRecord,
}

/// Why there is no result.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Absent {
    /// None, or none of a run that has come to its end.
    NotMade,
    /// A finished one, but of another command, case or version of the program.
    Other,
}

/// How a result came about, or why there is none.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    /// Made now.
    Made {
        /// From the checkpoint of a run that was interrupted on.
        resumed: bool,
        /// Not to its end: a stop was requested, or there was too little memory.
        interrupted: bool,
    },
    /// There before.
    Kept,
    /// Another process works on the run.
    Elsewhere,
}

impl OneRun<'_> {
    /// What a finished run of the same command on the same case by the same version of the program has left; the case is the same
    /// if it and all files that it names are, by their hash. A run that was interrupted, or that could not write its files, is not finished.
    pub fn finished(&self, strict: bool) -> Result<Left, Absent> {
        let record = read(self.directory).filter(|record| record.interrupted.is_none()).ok_or(Absent::NotMade)?;
        let exit = record.exit.and_then(Exit::of_code).filter(|exit| *exit != Exit::NotWritten);
        let exit = exit.ok_or(Absent::NotMade)?;
        let files: Vec<_> = record.inputs.iter().flatten().map(|file| self.document.resolve(file)).collect();
        let same = record.command == self.command.name()
            && record.versions.nastic == env!("CARGO_PKG_VERSION")
            && record.case_hash == Fingerprint::of(&self.document.canonical(), &files);
        if !same {
            return Err(Absent::Other);
        }
        Ok(Left { exit: exit.under(strict, record.warnings.len()), error: None, record })
    }

    /// Makes the run, or goes on with one that was interrupted.
    pub fn make(&self, options: &Options, console: &Console) -> (Left, Origin) {
        let resumed = !options.restart && resumption::is_interrupted(self.directory, self.command, &self.document);
        let catalogue = self.document.catalogue();
        let ran = match resumed {
            true => resume(catalogue, self.directory, options, console),
            false => run_with(catalogue, self.command.clone(), self.case, options, console),
        };
        self.left(ran, resumed)
    }

    /// What is known of a run now: what it wrote, which is what later processes find.
    fn left(&self, ran: Result<Outcome, RunError>, resumed: bool) -> (Left, Origin) {
        let error = match ran {
            Ok(Outcome { exit, record, .. }) => {
                let record = read(self.directory).unwrap_or(record);
                let interrupted = record.interrupted.is_some();
                return (Left { exit, error: None, record }, Origin::Made { resumed, interrupted });
            }
            Err(error) => error,
        };
        let error = match &error {
            RunError::Input(_) => self.note_refusal(&error).err().unwrap_or(error),
            _ => error,
        };
        let (exit, text) = (error.exit(), error.to_string());
        // A run that could not begin leaves the directory as it is, with the result of another run.
        let record = read(self.directory).filter(|record| record.error.as_ref() == Some(&text)).unwrap_or_default();
        let origin = match error {
            RunError::InUse { .. } => Origin::Elsewhere,
            _ => Origin::Made { resumed, interrupted: record.interrupted.is_some() },
        };
        (Left { exit, error: Some(text), record }, origin)
    }

    /// A run that its values make invalid writes nothing; its result says so to those who join the table.
    fn note_refusal(&self, error: &RunError) -> Result<(), RunError> {
        let out = Directory::claim(self.directory.to_owned(), OutputNames::of(&[RESULT]), [self.case])?;
        let record = RunRecord {
            command: self.command.name().to_owned(),
            case: Some(self.document.name().to_owned()),
            case_hash: Fingerprint::of(&self.document.canonical(), &[] as &[&Path]),
            versions: VersionsRecord { nastic: env!("CARGO_PKG_VERSION").to_owned(), case: None },
            error: Some(error.to_string()),
            exit: Some(error.exit().code()),
            ..RunRecord::default()
        };
        Ok(out.write_json(RESULT, &record)?)
    }
}

/// The result in a directory, if it can be read.
fn read(directory: &Path) -> Option<RunRecord> {
    serde_json::from_slice(&std::fs::read(directory.join(RESULT)).ok()?).ok()
}
