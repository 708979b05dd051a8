//! What a terminal shows while a command runs. The terminal is one of the program `script` (util-linux); without it the test says so and passes.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, text};
use std::process::{Command, Stdio};

/// A bar that fibres pull.
const MOTION: &str = r#"{ "nastic": 1, "title": "bar",
  "mesh": { "box": { "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
  "controls": [ { "of": "fibers", "space": "uniform", "lower": "-60 kPa", "upper": 0, "start": "-0.6 MPa * t / (1 s)",
                  "in_time": { "every": "10 ms" } } ],
  "costs": [ { "kind": "position", "surface": "x+", "weight": 1e6, "target": { "x": "0.097" }, "when": "integral" } ],
  "time": { "end": "20 ms", "step": "1 ms" } }"#;

/// The lines that a terminal showed one after the other, those that passed and those that stayed; nothing without a terminal.
fn seen(place: &CaseDirectory, arguments: &[&str]) -> Option<Vec<String>> {
    let quoted: Vec<String> = arguments.iter().map(|one| format!("'{one}'")).collect();
    let command = format!("'{}' {}", env!("CARGO_BIN_EXE_nastic"), quoted.join(" "));
    let mut script = Command::new("script");
    script.args(["-qefc", &command, "/dev/null"]).current_dir(place.path("")).stdin(Stdio::null());
    let Ok(output) = script.output() else {
        println!("SKIPPED: no program `script`");
        return None;
    };
    let shown = text(&output.stdout);
    assert!([Some(0), Some(4)].contains(&output.status.code()), "{}: {shown}", output.status);
    let lines = shown.split("\r\x1b[K").flat_map(|part| part.split("\r\n"));
    Some(lines.map(|line| line.replace("\x1b[?7l", "").replace("\x1b[?7h", "")).collect())
}

/// The first line that has all of these, in this order.
fn find<'l>(lines: &'l [String], wanted: &[&str]) -> &'l str {
    let has = |line: &&String| {
        let mut rest = line.as_str();
        wanted.iter().all(|one| rest.find(one).map(|at| rest = &rest[at + one.len()..]).is_some())
    };
    lines.iter().find(has).unwrap_or_else(|| panic!("{wanted:?} in {lines:#?}"))
}

#[test]
fn a_terminal_shows_phase_step_time_and_what_is_left() {
    let place = CaseDirectory::new(MOTION);
    let Some(lines) = seen(&place, &["solve", "case.json"]) else { return };
    let solve = ["s so far, about ", " left; solving: load 1.0000, Newton iteration ", ", residual "];
    find(&lines, &[&["motion: step 7 of 20, t = 0.007 of 0.02 s, "], &solve[..]].concat());
    assert!(find(&lines, &["motion: step 1 of 20, t = 0.001 of 0.02 s, "]).contains("solving: "), "{lines:#?}");
    // what passed is gone at the end
    assert!(lines.last().is_some_and(String::is_empty), "{lines:#?}");
    let at = lines.iter().position(|line| line.starts_with("results     ")).unwrap();
    assert!(lines[at..].iter().all(|line| !line.contains("so far")), "{lines:#?}");

    let lines = seen(&place, &["optimize", "case.json", "--set", "optimizer/max_iterations=3"]).unwrap();
    find(&lines, &["solving at the start: step 3 of 20, t = 0.003 of 0.02 s, "]);
    find(&lines, &["gradient check: step 20 of 20, t = 0.02 of 0.02 s, "]);
    find(&lines, &["iteration 2 of 3, trial ", ", cost ", " so far", ": step 5 of 20, t = 0.005 of 0.02 s; solving: "]);

    let lines =
        seen(&place, &["sweep", "case.json", "--command", "solve", "--set", "materials/0/poisson=0.2,0.3"]).unwrap();
    find(&lines, &["[............] run 1 of 2: poisson=0.2"]);
    find(
        &lines,
        &["[######......] run 2 of 2: poisson=0.3; motion: step 4 of 20, ", " so far, about ", " left; solving: "],
    );
}

#[test]
fn a_terminal_shows_how_many_scenarios_are_done() {
    let scenarios: Vec<String> = (0..4).map(|k| format!(r#"{{ "name": "s{k}", "probability": 0.25 }}"#)).collect();
    let more = format!(r#""scenarios": [ {} ], "output""#, scenarios.join(", "));
    let place = CaseDirectory::new(&BAR.replacen(r#""output""#, &more, 1));
    let Some(lines) = seen(&place, &["solve", "case.json"]) else { return };
    find(&lines, &["solving at the start, ", " so far; [######......] scenarios: 2 of 4, s", " has cost "]);
    find(&lines, &["[############] scenarios: 4 of 4, "]);
}

/// Where there is no terminal commands that are done within a minute say nothing beside what they are asked for.
#[test]
fn logs_of_short_commands_have_no_progress() {
    let place = CaseDirectory::new(MOTION);
    let output = place.nastic(&["solve", "case.json"]);
    assert_eq!(text(&output.stderr), "");
    assert!(!text(&output.stdout).contains("so far"), "{}", text(&output.stdout));
}
