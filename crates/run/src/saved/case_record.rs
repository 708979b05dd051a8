//! [`CaseRecord`]: the case of an optimisation as a checkpoint remembers it.

use crate::run::error::RunError;
use crate::saved::CheckpointError;
use nastic_case::lower::CaseProblem;
use nastic_io::Fingerprint;
use nastic_language::catalogue::Catalogue;
use nastic_language::syntax::Document;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Differences between two cases that are reported; further ones are counted.
const SHOWN: usize = 5;

/// Where a case came from and what it said.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub(crate) struct CaseRecord {
    /// Version of the program that ran it.
    pub program: String,
    /// The case file as it was named.
    name: String,
    /// Its absolute path.
    path: String,
    /// Overrides, in order.
    pub settings: Vec<String>,
    /// The case with its overrides.
    canonical: String,
    /// Absolute path and hash of every file it named.
    files: Vec<(String, String)>,
    /// Whether a program made the problem: there is no case file to read again.
    of_program: bool,
}

impl CaseRecord {
    pub fn of(problem: &CaseProblem, settings: &[String]) -> Self {
        let name = problem.document.name().to_owned();
        let files = problem.files.iter().map(|file| (absolute(file).display().to_string(), Fingerprint::of_file(file)));
        Self {
            program: env!("CARGO_PKG_VERSION").to_owned(),
            path: absolute(Path::new(&name)).display().to_string(),
            name,
            settings: settings.to_vec(),
            canonical: problem.document.canonical(),
            files: files.collect(),
            of_program: problem.case_file().is_none(),
        }
    }

    /// Reads the case again, if neither it nor a file it names has changed; `directory` is that of the checkpoint.
    pub fn reopen(&self, catalogue: &Catalogue, directory: &Path) -> Result<Document, RunError> {
        if self.of_program {
            return Err(CheckpointError::OfProgram { directory: directory.to_owned() }.into());
        }
        let mut document = Document::open(&self.file())?.with_catalogue(catalogue);
        for setting in &self.settings {
            document.set(setting)?;
        }
        let mut what = self.differences(&document);
        for (file, hash) in &self.files {
            match Path::new(file).is_file() {
                false => what.push(format!("{file} is missing")),
                true if Fingerprint::of_file(Path::new(file)) != *hash => {
                    what.push(format!("{file} has other content"))
                }
                true => {}
            }
        }
        if what.is_empty() {
            return Ok(document);
        }
        Err(CheckpointError::Changed { directory: directory.to_owned(), what }.into())
    }

    /// Whether both are of the same case and version of the program: the same text with overrides, and files of the same content, wherever they lie.
    pub fn is_same(&self, other: &Self) -> bool {
        let hashes = |record: &Self| record.files.iter().map(|(_, hash)| hash.clone()).collect::<Vec<_>>();
        self.program == other.program && self.canonical == other.canonical && hashes(self) == hashes(other)
    }

    /// Whether it is that of a case: the same version of the program, file and text. Files that it names may have changed.
    pub fn is_of(&self, document: &Document) -> bool {
        self.program == env!("CARGO_PKG_VERSION")
            && Path::new(&self.path) == absolute(Path::new(document.name()))
            && self.canonical == document.canonical()
    }

    /// Whether a program's problem is the one that this record is of, as far as it can be written down.
    pub fn check(&self, problem: &CaseProblem, directory: &Path) -> Result<(), CheckpointError> {
        let what = self.differences(&problem.document);
        if what.is_empty() { Ok(()) } else { Err(CheckpointError::Changed { directory: directory.to_owned(), what }) }
    }

    /// The case file as it was named, where that name still means it, so that messages are the same; else its absolute
    /// path.
    fn file(&self) -> PathBuf {
        let (name, path) = (Path::new(&self.name), Path::new(&self.path));
        match (name.canonicalize(), path.canonicalize()) {
            (Ok(a), Ok(b)) if a == b => name.to_owned(),
            _ => path.to_owned(),
        }
    }

    fn differences(&self, document: &Document) -> Vec<String> {
        let canonical = document.canonical();
        if canonical == self.canonical {
            return vec![];
        }
        let mut out = Vec::new();
        match (serde_json::from_str(&self.canonical), serde_json::from_str(&canonical)) {
            (Ok(old), Ok(new)) => compare("", Some(&old), Some(&new), &mut out),
            _ => out.push("its text".to_owned()),
        }
        if out.is_empty() {
            out.push("the order of its keys".to_owned());
        }
        if out.len() > SHOWN {
            let more = out.len() - SHOWN;
            out.truncate(SHOWN);
            out.push(format!("{more} more"));
        }
        out
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// Notes every value in which two trees differ, by its path.
fn compare(at: &str, old: Option<&Value>, new: Option<&Value>, out: &mut Vec<String>) {
    let join = |key: &str| if at.is_empty() { key.to_owned() } else { format!("{at}/{key}") };
    match (old, new) {
        (Some(Value::Object(a)), Some(Value::Object(b))) => {
            a.iter().for_each(|(key, value)| compare(&join(key), Some(value), b.get(key), out));
            b.iter().filter(|(key, _)| !a.contains_key(*key)).for_each(|(key, value)| {
                compare(&join(key), None, Some(value), out);
            });
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) if a.len() == b.len() => {
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&join(&k.to_string()), Some(a), Some(b), out);
            }
        }
        (Some(old), Some(new)) if old != new => out.push(format!("{at} was {old}, is {new}")),
        (Some(old), None) => out.push(format!("{at} was {old}, is left out")),
        (None, Some(new)) => out.push(format!("{at} was left out, is {new}")),
        _ => {}
    }
}
