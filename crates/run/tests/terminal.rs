//! What the terminal says beside the table of trials.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, Heard};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::Options;

#[test]
fn distances_from_the_target_are_told_with_their_unit() {
    let place = CaseDirectory::new();
    let said = place.text(Command::Optimize, BAR, &[]);
    let line = said.lines().find(|line| line.starts_with("distance    tracking: root mean square ")).unwrap();
    let result = place.json("result.json");
    for (key, from) in [("root_mean_square", &result["start"]), ("largest", &result)] {
        let value = from["tracking"]["tracking"][key].as_f64().unwrap();
        let shown = format!("{value:.3e}").replace("e-", "e-0");
        assert!(line.contains(&shown), "{shown} in {line}");
    }
    assert!(line.ends_with(" m"), "{line}");
    assert!(said.contains(" Pa, "), "controls have units:\n{said}");
}

#[test]
fn columns_are_explained_on_request() {
    let place = CaseDirectory::new();
    let heard = Heard::default();
    let options = Options { explain: true, ..place.options(&["optimizer/max_iterations=1"]) };
    place.run_with(Command::Optimize, BAR, &Console::new(heard.clone()), &options).unwrap();
    let said = heard.text();
    let header = said.lines().find(|line| line.trim_start().starts_with("trial  iter")).unwrap();
    let two = header.replace("min J", "min_J");
    for column in two.split_whitespace() {
        let column = column.replace('_', " ");
        assert!(said.lines().any(|line| line.starts_with(&format!("{column:<12}"))), "{column} in\n{said}");
    }
    assert!(!place.text(Command::Optimize, BAR, &[]).contains("number of the trial"));
}

#[test]
fn a_body_at_rest_is_called_so() {
    let place = CaseDirectory::new();
    let rest = "equilibrium the state of rest";
    assert!(place.text(Command::Solve, BAR, &["controls/0/start=0"]).contains(rest));
    assert!(!place.text(Command::Solve, BAR, &[]).contains(rest));
}

#[test]
fn the_passing_line_tells_how_far_an_optimisation_is() {
    let place = CaseDirectory::new();
    let passing = Heard::default();
    let console = Console::silent().with_passing(passing.clone());
    place.run_with(Command::Optimize, BAR, &console, &place.options(&["optimizer/max_iterations=3"])).unwrap();
    let said = passing.text();
    let first = said.find("iteration 1 of 3, trial 1, ").unwrap_or_else(|| panic!("{said}"));
    assert!(said[first..].contains("ms so far; solving: load 1.0000, Newton iteration "), "{said}");
    let third = said.find("iteration 3 of 3, trial ").unwrap_or_else(|| panic!("{said}"));
    assert!(said[third..].contains(" to the limit; solving: "), "{said}");
    // what comes after the optimisation is none of its iterations
    assert!(!said.contains("iteration 4 of 3"), "{said}");
}

#[test]
fn a_case_is_told_how_long_it_takes() {
    let place = CaseDirectory::new();
    let said = place.text(Command::Check, BAR, &["optimizer/max_iterations=7"]);
    assert!(said.contains("duration    the tangent at rest, assembled and factorised: "), "{said}");
    assert!(said.contains(", 7 iterations "), "{said}");
    let said = place.text(Command::Check, BAR, &["linear_solver=multigrid"]);
    assert!(said.contains("duration    a Newton iteration by multigrid, from a box of 98553 unknowns: "), "{said}");
    assert!(said.contains("estimated for some four Newton iterations a trial: "), "{said}");
    let target = r#"{ "kind": "smoothed_hausdorff", "target": { "box": { "size": [1.0, 0.25, 0.25], "cells": [2, 1, 1], "element": "hex8" } },
        "phi": { "exponential": { "length": "0.5 m" } }, "stages": [ { "alpha": 1, "beta": 4, "gamma": 4 } ], "quadrature": 2 }"#;
    let said = place.text(Command::Check, BAR, &[&format!("costs/0={target}")]);
    assert!(
        said.contains("smoothed_hausdorff 32 points of the body and 16 of the target, 0.001 million pairs"),
        "{said}"
    );
}

#[test]
fn time_and_memory_are_told_at_the_end() {
    let place = CaseDirectory::new();
    let said = place.text(Command::Solve, BAR, &[]);
    let line = said.lines().last().unwrap();
    assert!(line.starts_with("time        "), "{line}");
    let peak = place.json("result.json")["peak_memory"].as_u64();
    if cfg!(target_os = "linux") {
        let peak = peak.unwrap();
        assert!((1_000_000..100_000_000_000).contains(&peak), "{peak}");
        assert!(line.ends_with(" MB of memory"), "{line}");
    }
}
