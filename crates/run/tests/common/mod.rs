//! Small cases for tests of whole commands.

#![allow(dead_code, clippy::unwrap_used, clippy::panic)] // helpers of several tests

use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_language::syntax::{Diagnostics, Document};
use nastic_run::console::Console;
use nastic_run::run::{Options, Outcome, RunError, run};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// A bar of silicone whose fibres are to bring its end to a place.
pub const DRIVEN: &str = r#"{ "nastic": 1, "title": "bar",
  "mesh": { "box": { "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
  "controls": [ { "of": "fibers", "space": "uniform", "lower": "-60 kPa", "upper": 0, "start": "-0.6 MPa * t / (1 s)",
                  "in_time": { "every": "10 ms" } } ],
  "costs": [ { "kind": "position", "surface": "x+", "weight": 1e6, "target": { "x": "0.097" }, "when": "integral" } ],
  "probes": [ { "name": "tip", "point": [0.1, 0.005, 0.005] } ],
  "time": { "end": "20 ms", "step": "1 ms" } }"#;

/// A bar of four hexahedra with a fibre along it, tracked at its end.
pub const BAR: &str = include_str!("../../../language/tests/cases/bar.json");

/// Point arrays of the optimum of [`BAR`].
pub const OPTIMUM_POINTS: [&str; 8] = [
    "displacement",
    "adjoint",
    "tension",
    "gradient_tension",
    "reaction",
    "nodal_cauchy_stress",
    "nodal_mises",
    "target_distance",
];

/// A case beside a directory for its results.
pub struct CaseDirectory {
    pub directory: tempfile::TempDir,
}

impl CaseDirectory {
    pub fn new() -> Self {
        Self { directory: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    /// Runs a command on a case text; results go to "out".
    pub fn run(&self, command: Command, case: &str, set: &[&str]) -> Result<Outcome, RunError> {
        self.run_with(command, case, &Console::silent(), &self.options(set))
    }

    pub fn options(&self, set: &[&str]) -> Options {
        let set = set.iter().map(ToString::to_string).collect();
        Options { out: Some(self.path("out")), threads: Some(2), set, ..Options::default() }
    }

    pub fn run_with(
        &self,
        command: Command,
        case: &str,
        console: &Console,
        options: &Options,
    ) -> Result<Outcome, RunError> {
        let file = self.write("case.json", case);
        let before = self.files_in_out();
        let outcome = run(command, &file, options, console);
        self.new_files_are_listed(&before);
        outcome
    }

    /// Names of all files; no directories and no links.
    fn files_in_out(&self) -> BTreeSet<String> {
        let entries = std::fs::read_dir(self.path("out")).into_iter().flatten().flatten();
        let files = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
        files.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    /// Whatever a command wrote, the list of nastic's files names: a program that is killed leaves nothing that the next one takes
    /// for somebody else's.
    fn new_files_are_listed(&self, before: &BTreeSet<String>) {
        let list = std::fs::read_to_string(self.path("out/.written")).unwrap_or_default();
        for name in self.files_in_out().difference(before).filter(|name| !name.starts_with('.')) {
            assert!(list.lines().any(|line| line.strip_prefix("+ ") == Some(name)), "{name} is not in the list");
        }
    }

    /// What a command says.
    pub fn text(&self, command: Command, case: &str, set: &[&str]) -> String {
        let heard = Heard::default();
        self.run_with(command, case, &Console::new(heard.clone()), &self.options(set)).unwrap();
        heard.text()
    }

    /// Names of the result files, in order; hidden ones are left out.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path("out")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.filter(|name| !name.starts_with('.')).collect();
        names.sort();
        names
    }

    /// A result file as JSON.
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(self.path("out").join(name)).unwrap()).unwrap()
    }
}

/// Keeps what is said.
#[derive(Clone, Default)]
pub struct Heard(Arc<Mutex<Vec<u8>>>);

impl Heard {
    pub fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

impl Write for Heard {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// A text with something replaced, which must occur.
pub fn with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "nothing to replace: {from}");
    text.replacen(from, to, 1)
}

/// The problem of a case text whose file lies in this crate's tests/cases.
pub fn lower(text: &str) -> Result<CaseProblem, Diagnostics> {
    let name = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases/case.json");
    CaseProblem::lower(Document::parse(&name.display().to_string(), text)?, Arc::default())
}

/// What is wrong with a case text, without the path of its file.
pub fn problems(text: &str) -> String {
    strip(&lower(text).err().map(|problems| problems.to_string()).unwrap_or_default())
}

/// What is odd about it.
pub fn warnings(text: &str) -> String {
    let problem = lower(text).unwrap_or_else(|problems| panic!("{problems}"));
    let lines: Vec<String> = problem.warnings.iter().map(ToString::to_string).collect();
    strip(&lines.join("\n"))
}

fn strip(text: &str) -> String {
    let directory = format!("{}/tests/cases/", env!("CARGO_MANIFEST_DIR"));
    text.replace(&directory, "")
}

/// A bar in millimetres with room for more blocks.
pub fn bar_with(more: &str) -> String {
    format!(
        r#"{{ "nastic": 1, "units": "mm",
  "mesh": {{ "box": {{ "size": [20, 4, 4], "cells": [3, 1, 1], "element": "hex20" }} }},
  "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.2 MPa", "poisson": 0.3, "density": "1000 kg/m^3" }} ],
  "supports": [ {{ "surface": "x-", "fix": "all" }} ]{more} }}"#
    )
}

/// The messages of a code in a result.
pub fn messages(found: &serde_json::Value, code: &str) -> Vec<String> {
    let all = found["warnings"].as_array().unwrap().iter().filter(|warning| warning["code"] == code);
    all.map(|warning| warning["message"].as_str().unwrap().to_owned()).collect()
}
