//! `history.jsonl`: one line per trial, readable while the run goes on.

use nastic_io::{WriteError, append_to, write_atomically};
use nastic_opt::{Summary, Trial};
use nastic_report::record::{Number, Numbers, TrialRecord};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file, open for further lines, and all that was to be written to it.
#[derive(Debug)]
pub struct History {
    file: File,
    path: PathBuf,
    text: Vec<u8>,
    /// A line could not be written: the file lacks it, or has a part of it.
    broken: bool,
}

impl History {
    /// Begins a history with these lines, in place of an older one.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn create(path: &Path, text: Vec<u8>) -> Result<Self, WriteError> {
        write_atomically(path, |out| out.write_all(&text))?;
        let file = append_to(path)?;
        Ok(Self { file, path: path.to_owned(), text, broken: false })
    }

    /// Adds whole lines in one piece.
    ///
    /// # Errors
    /// The first line that cannot be written, once: an optimisation does not end for it, and [`Self::finish`] tries
    /// again.
    pub fn add(&mut self, lines: &[u8]) -> Result<(), WriteError> {
        self.text.extend(lines);
        if self.broken {
            return Ok(());
        }
        self.file.write_all(lines).map_err(|source| {
            self.broken = true;
            WriteError::System { file: self.path.clone(), source }
        })
    }

    /// All lines so far.
    #[must_use]
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// Ends the history; if a line could not be written, all are written once more.
    ///
    /// # Errors
    /// That failed too.
    pub fn finish(self) -> Result<(), WriteError> {
        if self.broken { write_atomically(&self.path, |out| out.write_all(&self.text)) } else { Ok(()) }
    }
}

/// The line of a trial. Work of a failed trial is what its error reports, null where it reports nothing.
#[must_use]
pub fn line<P>(trial: &Trial<'_, P>, seconds: f64) -> TrialRecord {
    let summary = &trial.summary;
    let count = |name: &str| summary.get(name).map(|value| value as u64).into();
    let known = |name: &str| summary.get(name).map(Number::from).unwrap_or_default();
    TrialRecord {
        trial: trial.trial,
        iteration: trial.iteration,
        stage: trial.stage,
        accepted: trial.accepted,
        reason: trial.reason.to_string(),
        cost: trial.cost.into(),
        terms: Some(terms(summary)),
        gradient_norm: trial.gradient_norm.into(),
        relative_gradient: trial.relative_gradient.into(),
        step: trial.step.into(),
        predicted: trial.predicted.into(),
        newton: count("newton"),
        factorisations: count("factorisations"),
        back_substitutions: count("back_substitutions"),
        min_j: summary.get("min_J").into(),
        active: trial.active,
        seconds: seconds.into(),
        objective: known("objective"),
        violation: known("violation"),
        penalty: known("penalty"),
        ..TrialRecord::default()
    }
}

/// A line of the file.
#[must_use]
pub fn json_line(line: &TrialRecord) -> Vec<u8> {
    // a record has keys that are texts: nothing in it fails
    let mut out = serde_json::to_vec(line).unwrap_or_default();
    out.push(b'\n');
    out
}

fn terms(summary: &Summary) -> Numbers {
    let of = |(name, value): &(String, f64)| Some((name.strip_prefix("terms/")?.to_owned(), (*value).into()));
    summary.0.iter().filter_map(of).collect()
}
