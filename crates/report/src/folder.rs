//! [`ResultFolder`]: the files of a run.

use crate::error::ReportError;
use crate::record::{RunRecord, TrialRecord};
use nastic_io::{read_lines, read_snapshot};
use nastic_mesh::{Polyline, Snapshot};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// What a run left behind, as far as a page shows it.
#[derive(Debug)]
pub(crate) struct ResultFolder {
    path: PathBuf,
    /// `result.json`.
    pub result: RunRecord,
    /// The lines of `history.jsonl`, if the run wrote any.
    pub history: Vec<TrialRecord>,
    /// `case.json`: the case with its overrides.
    pub case: Option<String>,
}

impl ResultFolder {
    pub fn open(path: &Path) -> Result<Self, ReportError> {
        let missing = || ReportError::Missing { directory: path.to_owned() };
        let mut folder = Self { path: path.to_owned(), result: RunRecord::default(), history: Vec::new(), case: None };
        let text = folder.text("result.json")?.ok_or_else(missing)?;
        folder.result = folder.json("result.json", &text)?;
        if folder.wrote("history.jsonl") {
            let text = folder.text("history.jsonl")?.unwrap_or_default();
            folder.history =
                text.lines().map(|line| folder.json("history.jsonl", line)).collect::<Result<_, ReportError>>()?;
        }
        if folder.wrote("case.json") {
            folder.case = folder.text("case.json")?;
        }
        Ok(folder)
    }

    /// Whether the run wrote this file: one of an earlier run in the same directory is not taken for its own.
    pub fn wrote(&self, name: &str) -> bool {
        self.result.files.iter().flatten().any(|file| file == name)
    }

    /// The files that the run wrote whose names begin and end so, in order.
    pub fn series(&self, beginning: &str, ending: &str) -> Vec<String> {
        let is_number = |middle: &str| !middle.is_empty() && middle.bytes().all(|byte| byte.is_ascii_digit());
        let fits = |file: &&String| {
            file.strip_prefix(beginning).and_then(|rest| rest.strip_suffix(ending)).is_some_and(is_number)
        };
        let mut found: Vec<String> = self.result.files.iter().flatten().filter(fits).cloned().collect();
        found.sort();
        found
    }

    /// The text of a file; nothing where there is none.
    pub fn text(&self, name: &str) -> Result<Option<String>, ReportError> {
        let bytes = self.bytes(name)?;
        let of = |bytes: Vec<u8>| String::from_utf8(bytes).map_err(|_| self.content(name, "not UTF-8".to_owned()));
        bytes.map(of).transpose()
    }

    /// The bytes of a file; nothing where there is none.
    pub fn bytes(&self, name: &str) -> Result<Option<Vec<u8>>, ReportError> {
        let file = self.path.join(name);
        match std::fs::read(&file) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(source) if source.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(source) => Err(ReportError::Read { file, source }),
        }
    }

    /// The body and the arrays of a VTU file.
    pub fn snapshot(&self, name: &str) -> Result<Snapshot, ReportError> {
        Ok(read_snapshot(self.path.join(name))?)
    }

    /// The lines of a VTU file.
    pub fn lines(&self, name: &str) -> Result<Vec<Polyline>, ReportError> {
        Ok(read_lines(self.path.join(name))?)
    }

    /// The written states of a motion and their instants, as a PVD file lists them; none where there is no such file.
    pub fn instants(&self, name: &str) -> Result<Vec<(String, f64)>, ReportError> {
        fn attribute<'a>(line: &'a str, key: &str) -> Option<&'a str> {
            line.split_once(key)?.1.strip_prefix("=\"")?.split('"').next()
        }
        let text = if self.wrote(name) { self.text(name)?.unwrap_or_default() } else { String::new() };
        let of = |line: &str| {
            let t: f64 = attribute(line, "timestep")?.parse().ok()?;
            let file = attribute(line, "file").filter(|_| attribute(line, "part") == Some("0"))?;
            Some((file.to_owned(), t))
        };
        Ok(text.lines().filter_map(of).collect())
    }

    /// The error of a file that does not hold what it should.
    pub fn content(&self, name: &str, what: String) -> ReportError {
        ReportError::Content { file: self.path.join(name), what }
    }

    fn json<T: DeserializeOwned>(&self, name: &str, text: &str) -> Result<T, ReportError> {
        serde_json::from_str(text).map_err(|error| self.content(name, format!("not JSON: {error}")))
    }
}
