//! Growth in cases: what it takes, what is said of values that leave nothing, where fixed growth is drawn, energies.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

/// A bar that grows freely, of which an end is tracked.
const BAR: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02, 0.02], "cells": [4, 1, 1], "element": "hex8" } },
    "regions": [ { "name": "end", "inside": { "box": { "low": [0.05, 0, 0], "high": [0.1, 0.02, 0.02] } } } ],
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.4 } ],
    "supports": [ { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": "z" } ],
    "actuation": [ { "name": "swell", "kind": "growth", "region": "body" } ],
    "controls": [ { "of": "swell", "space": "uniform", "start": 0.1, "upper": 0.5 } ],
    "costs": [ { "kind": "position", "surface": "x+", "target": { "x": 0.12 } } ],
    "optimizer": { "method": "lbfgs" } }"#;

fn run(command: Command, text: &str) -> Value {
    CaseDirectory::new().run(command, text, &[]).unwrap().result
}

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

#[test]
fn a_bar_grows_to_its_target_and_stores_nothing() {
    let found = run(Command::Optimize, BAR);
    assert!((number(&found, "controls/swell/max") - 0.2).abs() < 1e-5, "{found}");
    assert!((number(&found, "controls/swell/lower") + 0.9).abs() < 1e-12, "{found}");
    let fixed = with(BAR, "\"region\": \"body\" } ]", "\"region\": \"body\", \"growth\": 0.1 } ]");
    let (from, to) = (fixed.find("\"controls\"").unwrap(), fixed.find("\"optimizer\"").unwrap());
    let solved = run(Command::Solve, &format!("{}{}", &fixed[..from], &fixed[to..]));
    assert!(number(&solved, "energy/elastic").abs() < 1e-10 && number(&solved, "min_J") > 1.3, "{solved}");
    // a logarithm keeps it positive by itself
    let by_log = run(Command::Optimize, &with(BAR, "\"start\": 0.1", "\"log\": true, \"start\": 0.1"));
    assert!((number(&by_log, "controls/swell/max") - 0.2).abs() < 1e-5, "{by_log}");
    let said = CaseDirectory::new().text(Command::Check, BAR, &[]);
    assert!(said.contains("start 0.1, within [-0.9, 0.5]"), "{said}");
}

#[test]
fn what_leaves_nothing_is_refused_where_it_stands() {
    let must = "growth must stay above -1";
    let lower = problems(&with(BAR, "\"start\": 0.1", "\"lower\": -1.5, \"start\": 0.1"));
    assert!(lower.contains(&format!("controls/0/lower: {must}")), "{lower}");
    let fixed = with(BAR, "\"region\": \"body\" } ]", "\"region\": \"body\", \"growth\": -1.2 } ]");
    let (from, to) = (fixed.find("\"controls\"").unwrap(), fixed.find("\"costs\"").unwrap());
    let fixed = problems(&format!("{}{}", &fixed[..from], &fixed[to..]));
    assert!(fixed.contains(&format!("actuation/0/growth: {must}")), "{fixed}");
    let pumped = with(
        BAR,
        "\"kind\": \"position\", \"surface\": \"x+\", \"target\": { \"x\": 0.12 }",
        "\"kind\": \"pump_work\"",
    );
    let pumped = problems(&pumped);
    assert!(pumped.contains("does not count that of a growth"), "{pumped}");
}

/// In cells outside of its region it is zero, though the field of the case has values everywhere.
#[test]
fn fixed_growth_is_drawn_where_it_acts() {
    let fixed = with(BAR, "\"region\": \"body\" } ]", "\"region\": \"end\", \"growth\": \"0.1 + X / 1 m\" } ]");
    let (from, to) = (fixed.find("\"controls\"").unwrap(), fixed.find("\"optimizer\"").unwrap());
    let place = CaseDirectory::new();
    place.run(Command::Solve, &format!("{}{}", &fixed[..from], &fixed[to..]), &[]).unwrap();
    let shown = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let growth = shown.cell_data.iter().find(|array| array.name == "swell").unwrap();
    let inside: Vec<bool> = growth.values.iter().map(|value| *value > 0.1).collect();
    assert_eq!(inside, [false, false, true, true], "{:?}", growth.values);
    assert!(growth.values[..2].iter().all(|value| *value == 0.0), "{:?}", growth.values);
}
