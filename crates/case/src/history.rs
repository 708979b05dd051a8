//! `history.jsonl`: one line per trial, readable while the run goes on.

use nastic_io::WriteError;
use nastic_opt::{Summary, Trial};
use serde_json::{Map, Value, json};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The file, open for further lines.
#[derive(Debug)]
pub struct History {
    file: File,
    path: PathBuf,
    failed: Option<std::io::Error>,
}

impl History {
    /// Begins an empty history.
    ///
    /// # Errors
    /// The file cannot be made.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let file = File::create(path).map_err(|source| WriteError::System { file: path.to_owned(), source })?;
        Ok(Self { file, path: path.to_owned(), failed: None })
    }

    /// Adds a line in one piece. A failure is kept for [`Self::finish`]: an optimisation does not end for it.
    pub fn add(&mut self, line: &Value) {
        if self.failed.is_none() {
            self.failed = self.file.write_all(format!("{line}\n").as_bytes()).err();
        }
    }

    /// Ends the history.
    ///
    /// # Errors
    /// The first line that could not be written.
    pub fn finish(self) -> Result<(), WriteError> {
        match self.failed {
            Some(source) => Err(WriteError::System { file: self.path, source }),
            None => Ok(()),
        }
    }
}

/// The line of a trial. Work of a failed trial is what its error tells of, null where it tells nothing.
#[must_use]
pub fn line<P>(trial: &Trial<'_, P>, seconds: f64) -> Value {
    let summary = &trial.summary;
    let count = |name: &str| summary.get(name).map(|value| value as u64);
    json!({
        "trial": trial.trial,
        "iteration": trial.iteration,
        "stage": trial.stage,
        "accepted": trial.accepted,
        "reason": trial.reason.to_string(),
        "cost": trial.cost,
        "terms": terms(summary),
        "gradient_norm": trial.gradient_norm,
        "step": trial.step,
        "newton": count("newton"),
        "factorisations": count("factorisations"),
        "back_substitutions": count("back_substitutions"),
        "min_J": summary.get("min_J"),
        "active": trial.active,
        "seconds": seconds,
    })
}

fn terms(summary: &Summary) -> Value {
    let own =
        summary.0.iter().filter_map(|(name, value)| Some((name.strip_prefix("terms/")?.to_owned(), json!(value))));
    Value::Object(own.collect::<Map<_, _>>())
}
