//! Small optimisations to mesh.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // helpers of tests

use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_remesh::{RemeshError, RemeshRequest, Remeshed, remesh};
use nastic_report::console::Console;
use nastic_run::run::{Exit, Options, Outcome, run};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A bar that is drawn to the right: its stretch does not depend on its height. The design is the lower half of it.
pub const BAR: &str = r#"{ "nastic": 1, "units": "mm",
    "mesh": { "box": { "size": [20, 8], "cells": [10, 5], "element": "quad4" } },
    "materials": [ { "name": "soft", "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0,
                     "design": [ { "name": "rho", "kind": "density", "least": 0.01 } ] } ],
    "supports": [ { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" } ],
    "loads": [ { "surface": "x+", "traction": ["1 kPa", 0] } ],
    "controls": [ { "of": "rho", "space": "cell", "start": "1 - Y/8" } ],
    "costs": [ { "kind": "displacement", "surface": "x+", "direction": [1, 0] }, { "kind": "greyness", "of": "rho" } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 0 } }"#;

pub fn with(case: &str, old: &str, new: &str) -> String {
    assert!(case.contains(old), "{old}");
    case.replace(old, new)
}

pub struct Place {
    directory: tempfile::TempDir,
}

impl Place {
    /// The results of a command on a case, in the directory `out`.
    pub fn of(command: Command, case: &str) -> Self {
        let place = Self { directory: tempfile::tempdir().unwrap() };
        place.run(command, "case.json", case);
        place
    }

    pub fn run(&self, command: Command, name: &str, case: &str) -> Outcome {
        std::fs::write(self.path(name), case).unwrap();
        let options = Options { out: Some(self.path("out")), no_report: true, ..Options::default() };
        run(command, &self.path(name), &options, &Console::silent()).unwrap()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn request(&self) -> RemeshRequest {
        let options = Options { no_report: true, ..Options::default() };
        RemeshRequest {
            directory: self.path("out"),
            size: None,
            out: Some(self.path("new")),
            gmsh: "gmsh".into(),
            options,
        }
    }

    pub fn remesh(&self) -> Remeshed {
        let (remeshed, exit) = remesh(&Catalogue::standard(), &self.request(), &Console::silent()).unwrap();
        assert_eq!(exit, Exit::Done);
        remeshed
    }

    pub fn refused(&self, request: &RemeshRequest) -> RemeshError {
        remesh(&Catalogue::standard(), request, &Console::silent()).unwrap_err()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }
}

/// The cost of a case by itself.
pub fn cost_of(case: &Path) -> f64 {
    let options = Options { in_memory: true, ..Options::default() };
    let outcome = run(Command::Solve, case, &options, &Console::silent()).unwrap();
    outcome.result["cost"]["total"].as_f64().unwrap()
}

/// Whether Gmsh is there; required where `$NASTIC_PYTHON` is set, whose directory `scripts/test.sh` puts on the path.
pub fn has_gmsh() -> bool {
    let output = std::process::Command::new("gmsh").arg("--version").output();
    let found = output.is_ok_and(|output| output.status.success());
    assert!(found || std::env::var_os("NASTIC_PYTHON").is_none(), "NASTIC_PYTHON is set, but no gmsh is on the path");
    if !found {
        println!("SKIPPED: no gmsh on the path; pip install gmsh");
    }
    found
}
