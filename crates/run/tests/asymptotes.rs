//! The method of moving asymptotes in case files: designs within their volume, functionals of the state, checkpoints, messages for mistakes.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, lower, problems, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_opt::{Constrained, Objective, Request};
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, resume};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A cantilever whose density is unknown, under one of two loads at a time; in two stages.
const CANTILEVER: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.04], "cells": [10, 4], "element": "quad4" } },
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3,
                     "design": [ { "name": "rho", "kind": "density", "least": 1e-3 } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": [0, "-500 Pa"] } ],
    "controls": [ { "of": "rho", "space": "cell", "start": 0.5, "filter": "10 mm", "projection": { "sharpness": [1, 4] } } ],
    "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, -1], "weight": 1e4 } ],
    "constraints": [ { "name": "volume", "cost": { "kind": "design_volume", "of": "rho" }, "at_most": 0.5 } ],
    "optimizer": { "method": "mma", "max_iterations": 60, "tolerance": 1e-3 },
    "output": { "directory": "out", "checkpoint": 3 } }"#;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// The volume is used up and kept, at about the cost of multipliers around `lbfgs`: both find local minima.
#[test]
fn a_design_keeps_its_volume() {
    let (place, heard) = (CaseDirectory::new(), Heard::default());
    let options = place.options(&[]);
    let found = place.run_with(Command::Optimize, CANTILEVER, &Console::new(heard.clone()), &options).unwrap().result;
    let said = heard.text();
    assert!(said.contains("optimizer   mma, at most 60 iterations"), "{said}");
    assert!(said.contains("stage 2 of 2, asymptotes begin anew"), "{said}");
    let volume = &found["constraints"]["groups"]["volume"];
    assert!(number(&found["constraints"]["violation"]) <= 1e-8, "{volume}");
    assert!((number(&volume["functional"]) - 0.5).abs() < 1e-4, "{volume}");
    assert!(number(&volume["multipliers"][0]) > 0.0, "{volume}");
    let start = CaseDirectory::new().run(Command::Solve, CANTILEVER, &[]).unwrap().result;
    let multipliers =
        CaseDirectory::new().run(Command::Optimize, CANTILEVER, &["optimizer/method=lbfgs"]).unwrap().result;
    let cost = |result: &Value| number(&result["cost"]["total"]);
    let costs = [cost(&start), cost(&multipliers), cost(&found)];
    println!("costs at the start, by lbfgs, by mma: {costs:?}; {} {}", found["stop"], multipliers["stop"]);
    assert!(costs[2] < 0.5 * costs[0] && costs[2] < 1.1 * costs[1], "{costs:?}");
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<Value> = history.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(lines.iter().any(|line| line["reason"] == "conservative"), "{history}");
    // Within a stage the volume stays kept once it is.
    let kept: Vec<f64> =
        lines.iter().filter(|line| line["reason"] == "conservative").map(|line| number(&line["violation"])).collect();
    assert!(kept.iter().filter(|violation| **violation > 1e-8).count() <= 2, "{kept:?}");
}

/// Interrupted in the second stage and resumed, by another number of threads: the same bits.
#[test]
fn resumed_to_the_bit() {
    struct Watch(Arc<AtomicBool>);
    impl std::io::Write for Watch {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            if std::str::from_utf8(bytes).unwrap().contains("stage 2 of 2") {
                self.0.store(true, Ordering::Relaxed);
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let short = ["optimizer/max_iterations=16", "optimizer/stage_tolerance=1e-9"];
    let (whole, pieces) = (CaseDirectory::new(), CaseDirectory::new());
    let uninterrupted = whole.run(Command::Optimize, CANTILEVER, &short).unwrap();
    let options = pieces.options(&short);
    let watch = Console::new(Watch(options.cancel.clone()));
    let broken = pieces.run_with(Command::Optimize, CANTILEVER, &watch, &options).unwrap();
    assert_eq!(broken.exit, Exit::NotConverged);
    for threads in [1, 2] {
        let options = Options { threads: Some(threads), ..Options::default() };
        let resumed = resume(&Catalogue::standard(), &pieces.path("out"), &options, &Console::silent()).unwrap();
        assert!(threads == 2 || number(&resumed.result["resumed"]["iteration"]) > 0.0);
        for key in ["constraints", "cost", "controls", "iterations", "trials", "stop"] {
            assert_eq!(resumed.result[key], uninterrupted.result[key], "{key}");
        }
    }
}

/// Stops when something is said, and keeps all that is.
struct Stop {
    at: &'static str,
    cancel: Arc<AtomicBool>,
    heard: Heard,
}

impl std::io::Write for Stop {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if std::str::from_utf8(bytes).unwrap().contains(self.at) {
            self.cancel.store(true, Ordering::Relaxed);
        }
        self.heard.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// What a run that was interrupted began with is told as far as the stage values it, and no number that is none.
#[test]
fn an_interrupted_stage_has_the_numbers_that_there_are() {
    for (at, stages, start) in [("    4 ", 1, true), ("stage 2 of 2", 2, false)] {
        let (place, heard) = (CaseDirectory::new(), Heard::default());
        let options = place.options(&["optimizer/max_iterations=16", "optimizer/stage_tolerance=1e-9"]);
        let console = Console::new(Stop { at, cancel: options.cancel.clone(), heard: heard.clone() });
        let found = place.run_with(Command::Optimize, CANTILEVER, &console, &options).unwrap().result;
        let said = heard.text();
        let cost = said.lines().find(|line| line.starts_with("cost ")).unwrap();
        assert!(!said.contains("NaN") && cost.contains("->") == start, "{said}");
        let all = found["stages"].as_array().unwrap();
        let iterations: f64 = all.iter().map(|stage| number(&stage["iterations"])).sum();
        assert!(all.len() == stages && iterations == number(&found["iterations"]), "{all:?}");
        assert_eq!(all[stages - 1]["converged"], false, "{all:?}");
        assert_eq!(found["start"]["cost"]["total"].is_number(), start, "{}", found["start"]);
    }
}

/// Rows of constraints of several load cases are those of sums with unit weights, whether they depend on the state or not; only those that
/// do take a solve.
#[test]
fn every_constraint_has_a_derivative_of_its_own() {
    let cases = r#""load_cases": [ { "name": "down" }, { "name": "up", "set": { "loads/0/traction": [0, "300 Pa"] } } ], "constraints": ["#;
    let limit =
        r#"{ "cost": { "kind": "displacement", "surface": "x+", "direction": [0, -1] }, "at_most": "1e-4 m^3" }, "#;
    let case = with(CANTILEVER, "\"constraints\": [", &format!("{cases} {}", limit.replace("\"1e-4 m^3\"", "1e-4")));
    let problem = lower(&case).unwrap();
    let (ensemble, mut workspace) = (&problem.ensemble, Default::default());
    let mut point = ensemble.evaluate(&problem.start, &Request::default(), &mut workspace).unwrap();
    let before: Vec<usize> = point.work().iter().map(|work| work.back_substitutions).collect();
    let rows = ensemble.constraint_derivatives(&mut point, &mut workspace).unwrap();
    let after: Vec<usize> = point.work().iter().map(|work| work.back_substitutions).collect();
    assert_eq!(rows.len(), 4);
    // an adjoint for each load case's displacement, none for its volume
    let more: Vec<usize> = before.iter().zip(&after).map(|(before, after)| after - before).collect();
    assert!(more.len() == 2 && more[0] > 0 && more[0] == more[1], "{before:?} {after:?}");
    let volumes = lower(CANTILEVER).unwrap();
    let mut alone = volumes.ensemble.evaluate(&volumes.start, &Request::default(), &mut Default::default()).unwrap();
    let before = alone.work();
    assert_eq!(volumes.ensemble.constraint_derivatives(&mut alone, &mut Default::default()).unwrap().len(), 1);
    assert_eq!(alone.work(), before);
    for (k, row) in rows.iter().enumerate() {
        let y: Vec<f64> = (0..4).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
        let sum = ensemble.constraint_derivative(&point, &y, &mut workspace).unwrap();
        let size = sum.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        assert!(size > 0.0 && row.iter().zip(&sum).all(|(a, b)| (a - b).abs() <= 1e-10 * size), "{k}");
    }
    assert_eq!(rows[1], rows[3]);
    assert_ne!(rows[0], rows[2]);
}

#[test]
fn what_the_method_is_not_made_for() {
    let optimizer = |keys: &str| with(CANTILEVER, "\"method\": \"mma\",", keys);
    assert_eq!(problems(&optimizer("\"method\": \"mma\", \"move_limit\": 0.1, \"asymptote_distance\": 0.3,")), "");
    for (case, words) in [
        (
            optimizer("\"method\": \"lbfgs\", \"move_limit\": 0.1,"),
            "optimizer/move_limit: \"lbfgs\" has no asymptotes: leave this out, or take \"mma\"",
        ),
        (
            with(CANTILEVER, "\"at_most\"", "\"equal\""),
            "constraints/0/equal: \"mma\" holds bounds from one side: give \"at_most\" or \"at_least\", or take \"lbfgs\"",
        ),
        (
            magnet("\"max_norm\": \"100 mT\""),
            "controls/0/max_norm: \"mma\" takes controls between bounds alone: give \"lower\" and \"upper\" of every component",
        ),
        (
            magnet("\"lower\": [\"-1 T\", \"-1 T\"]"),
            "controls/0: \"mma\" changes a control by a share of the range between its bounds: give both \"lower\" and \"upper\"",
        ),
    ] {
        let said = problems(&case);
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(problems(&magnet("\"norm\": \"100 mT\"")), "");
    assert_eq!(problems(&magnet("\"lower\": [\"-1 T\", \"-1 T\"], \"upper\": [\"1 T\", \"1 T\"]")), "");
}

fn magnet(allowed: &str) -> String {
    format!(
        r#"{{ "nastic": 1, "mesh": {{ "box": {{ "size": [0.1, 0.01], "cells": [10, 1], "element": "quad4" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 }} ],
        "supports": [ {{ "surface": "x-", "fix": "all" }} ],
        "actuation": [ {{ "name": "magnet", "kind": "magnet", "region": "body", "field": [0, "5 mT"] }} ],
        "controls": [ {{ "of": "magnet.remanence", "space": "cell", "start": ["100 mT", 0], {allowed} }} ],
        "costs": [ {{ "kind": "displacement", "surface": "x+", "direction": [0, -1], "weight": 1e4 }} ],
        "optimizer": {{ "method": "mma" }} }}"#
    )
}
