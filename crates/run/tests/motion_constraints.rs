//! Constraints that hold at instants of a motion, in case files and results.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options};
use serde_json::Value;

/// Nodes of the arm's end.
const NODES: u64 = 6;

/// The end of an arm is to be 80 mm high at T/2 and 65 mm at T, below a ceiling at 75 mm.
const CEILING: &str = r#"{ "nastic": 1, "title": "arm", "units": "mm",
  "mesh": { "box": { "size": [500, 50, 50], "cells": [4, 1, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
  "controls": [ { "of": "fibers", "space": { "grid": [1, 1, 1] }, "lower": "-40 kPa", "upper": "40 kPa", "start": "-4 Pa * Z / (1 mm)",
                  "in_time": { "every": "50 ms" }, "rate": "20 MPa / 1 s" } ],
  "costs": [ { "kind": "position", "surface": "x+", "target": { "z": "65 mm" } },
             { "kind": "position", "surface": "x+", "target": { "z": "80 mm" }, "when": { "at": "100 ms" } } ],
  "constraints": [ { "name": "ceiling", "obstacle": { "surface": "x+", "shape": { "half_space": { "point": [0, 0, 75], "normal": [0, 0, -1] } } } } ],
  "probes": [ { "name": "edge", "point": [500, 0, 50] } ],
  "optimizer": { "method": "lbfgs", "max_iterations": 200, "tolerance": 1e-2 },
  "time": { "end": "200 ms", "step": "10 ms", "scheme": "bdf2" } }"#;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// The largest entry of the column of `motion.csv`, and its instant.
fn largest(place: &CaseDirectory, column: &str) -> (f64, f64) {
    let text = std::fs::read_to_string(place.path("out/motion.csv")).unwrap();
    let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let k = head.iter().position(|name| name.starts_with(column)).unwrap();
    let entries = rows.map(|row| (row[k].parse::<f64>().unwrap(), row[0].parse::<f64>().unwrap()));
    entries.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// A ceiling holds all the time unless the case says otherwise, and the result has a value for every node and instant.
#[test]
fn a_ceiling_holds_all_the_time() {
    let run = |text: &str| {
        let (place, heard) = (CaseDirectory::new(), Heard::default());
        let found = place.run_with(Command::Optimize, text, &Console::new(heard.clone()), &place.options(&[])).unwrap();
        assert_eq!(found.exit, Exit::Done, "{}", heard.text());
        (found.result, heard.text(), largest(&place, "edge.z"))
    };
    let (held, text, (height, _)) = run(CEILING);
    let ceiling = &held["constraints"]["groups"]["ceiling"];
    assert_eq!(ceiling["count"], NODES * 21, "{ceiling}");
    assert!(ceiling["active"].as_u64().unwrap() > 0 && number(&held["constraints"]["violation"]) <= 1e-8, "{ceiling}");
    assert!(height <= 25.0 + 1e-5, "{height}");
    let touching = ceiling["touching"].as_array().unwrap();
    assert!(touching.iter().any(|one| one["index"].as_u64().unwrap() < NODES * 20), "before the end: {ceiling}");
    let worst = &ceiling["worst"];
    for one in touching {
        let (index, t) = (one["index"].as_u64().unwrap(), number(&one["t"]));
        assert!((t - 0.01 * (index / NODES) as f64).abs() < 1e-12 && one["node"].is_u64(), "{one}");
    }
    let instant = (worst["index"].as_u64().unwrap() / NODES) as f64;
    assert!((number(&worst["t"]) - 0.01 * instant).abs() < 1e-12, "{worst}");
    assert!((number(&worst["position"][2]) - 75.0).abs() < 1e-3, "{worst}");
    let between = &ceiling["between_nodes"];
    assert!(number(&between["distance"]) > -1e-3 && between["t"].is_number(), "{between}");
    assert!(text.contains("\nconstraints ceiling: largest violation "), "{text}");
    // the limited rate stands behind it
    assert_eq!(held["constraints"]["groups"]["rate_fibers"]["count"], 4 * 8);
    assert!(text.contains("rate_fibers: largest violation "), "{text}");

    let at_end = with(CEILING, r#""name": "ceiling","#, r#""name": "ceiling", "when": "end","#);
    let (found, _, (height, t)) = run(&at_end);
    let ceiling = &found["constraints"]["groups"]["ceiling"];
    assert_eq!((&ceiling["count"], &ceiling["t"]), (&NODES.into(), &serde_json::json!([0.2])));
    assert!(height > 35.0 && t < 0.2, "{height} at {t}");
}

/// Of several materials each has its own groups, in the order of the members.
#[test]
fn every_member_has_its_groups() {
    let both = with(
        CEILING,
        r#""probes""#,
        r#""scenarios": [ { "name": "soft", "probability": 0.5, "set": { "materials/0/young": "0.09 MPa" } },
                         { "name": "stiff", "probability": 0.5, "set": { "materials/0/young": "0.11 MPa" } } ], "probes""#,
    );
    let when = r#""name": "ceiling", "when": { "at": ["0.1 s", "50 ms"] },"#;
    let found = CaseDirectory::new().run(
        Command::Optimize,
        &with(&both, r#""name": "ceiling","#, when),
        &["optimizer/max_iterations=2"],
    );
    let groups = found.unwrap().result["constraints"]["groups"].clone();
    for name in ["soft", "stiff"] {
        let ceiling = &groups[format!("{name}/ceiling")];
        assert_eq!((&ceiling["count"], &ceiling["unit"]), (&Value::from(2 * NODES), &Value::from("mm")), "{groups:#}");
        let t = number(&ceiling["worst"]["t"]);
        assert!((t - 0.1).abs() < 1e-9 || (t - 0.05).abs() < 1e-9, "{ceiling}");
        let rate = &groups[format!("{name}/rate_fibers")];
        assert_eq!((&rate["count"], &rate["unit"]), (&Value::from(32), &Value::Null), "{groups:#}");
    }
}

/// An option that does not go with motions is refused, and what the last run found stays.
#[test]
fn a_refused_option_removes_nothing() {
    let place = CaseDirectory::new();
    assert_eq!(place.run(Command::Solve, CEILING, &[]).unwrap().exit, Exit::Done);
    let before = place.files();
    assert!(before.iter().any(|file| file == "motion.csv"), "{before:?}");
    let options = Options { analysis: Analysis::Modes(4), ..place.options(&[]) };
    place.run_with(Command::Solve, CEILING, &Console::silent(), &options).unwrap_err();
    assert_eq!((place.files(), &place.json("result.json")["exit"]), (before, &0.into()));
}

/// Constraints of all instants have a Taylor test, as the costs do.
#[test]
fn constraints_of_motions_have_taylor_tests() {
    let found = CaseDirectory::new().run(Command::Gradcheck, CEILING, &[]).unwrap().result;
    let tests = found["gradcheck"]["tests"].as_array().unwrap();
    let test = tests.iter().find(|test| test["term"] == "constraint ceiling").unwrap();
    assert_eq!(test["verdict"], "right", "{test:#}");
}

#[test]
fn mistakes_about_instants_are_told() {
    let message = |text: &str| {
        CaseDirectory::new().run(Command::Check, text, &[]).err().map_or_else(String::new, |e| e.to_string())
    };
    let held = |block: &str| {
        let at = CEILING.find(r#""constraints": ["#).unwrap();
        let end = CEILING[at..].find("],\n").unwrap() + at;
        format!("{}\"constraints\": [ {block} {}", &CEILING[..at], &CEILING[end..])
    };
    let near = r#"{ "kind": "position", "surface": "x+", "target": { "z": "40 mm" } }"#;
    assert_eq!(message(&held(&format!(r#"{{ "cost": {near}, "at_most": 1, "when": "always" }}"#))), "");
    let inside = r#"{ "kind": "position", "surface": "x+", "target": { "z": "40 mm" }, "when": "integral" }"#;
    let text = message(&held(&format!(r#"{{ "cost": {inside}, "at_most": 1 }}"#)));
    assert!(text.contains("\"when\" belongs beside \"cost\""), "{text}");
    let text = message(&held(&format!(r#"{{ "cost": {near}, "at_most": 1, "when": {{ "at": "13 ms" }} }}"#)));
    assert!(text.contains("constraints/0/when") && text.contains("the nearest one is 0.01"), "{text}");
    let text = message(&held(r#"{ "cost": { "kind": "kinetic_energy" }, "at_most": 1 }"#));
    assert!(text.contains("one of the whole motion"), "{text}");
    let text = message(&held(&format!(r#"{{ "cost": {near}, "at_most": 1, "when": "integral" }}"#)));
    assert!(text.contains("always"), "{text}");
    let always = with(CEILING, r#""name": "ceiling","#, r#""name": "ceiling", "when": "always","#);
    let still = with(&always, r#""time": { "end": "200 ms", "step": "10 ms", "scheme": "bdf2" }"#, r#""output": {}"#);
    let text = message(&still);
    assert!(text.contains("constraints/0/when: the case is static"), "{text}");
}

/// With a tolerance steps lead through the instants of constraints.
#[test]
fn steps_that_are_found_lead_through_its_instants() {
    let found_steps = with(CEILING, r#""step": "10 ms", "scheme": "bdf2""#, r#""tolerance": "5 mm""#);
    let held = with(&found_steps, r#""name": "ceiling","#, r#""name": "ceiling", "when": { "at": "37 ms" },"#);
    let found = CaseDirectory::new().run(Command::Optimize, &held, &["optimizer/max_iterations=1"]).unwrap();
    let worst = &found.result["constraints"]["groups"]["ceiling"]["worst"];
    assert!((number(&worst["t"]) - 0.037).abs() < 1e-9, "{worst}");
}
