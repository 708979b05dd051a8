//! Numbers as people read them: distances of positions in millimetres, electric fields in kV/mm with their voltage.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::CaseDirectory;
use nastic_language::schema::Command;
use serde_json::Value;

fn page(place: &CaseDirectory) -> String {
    std::fs::read_to_string(place.path("out/report.html")).unwrap()
}

/// On the page as a figure and a curve, in the history for every accepted trial.
#[test]
fn the_distance_of_a_position() {
    let case = r#"{ "nastic": 1,
      "mesh": { "box": { "size": [0.02, 0.004, 0.004], "cells": [3, 1, 1], "element": "hex20" } },
      "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.2 MPa", "poisson": 0.3 } ],
      "supports": [ { "surface": "x-", "fix": "all" } ],
      "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": "x" } ],
      "controls": [ { "of": "fibers", "space": "uniform", "start": "-1 kPa", "lower": "-20 kPa", "upper": 0 } ],
      "costs": [ { "name": "tip", "kind": "position", "surface": "x+", "target": { "x": "19.8 mm" }, "weight": 1e6 } ] }"#;
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, case, &[]).unwrap().result;
    let number = |path: &str| nastic_run::result::find(&found, path).unwrap().as_f64().unwrap();
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<Value> = history.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let distances: Vec<f64> = lines.iter().filter_map(|line| line["position_distance"].as_f64()).collect();
    assert_eq!(distances.len(), lines.iter().filter(|line| line["accepted"] == true).count(), "{history}");
    let start = number("start/figures/tip/position_distance");
    // half the square in mm^2
    assert!((number("start/cost/total") / (0.5e6 * start * start) - 1.0).abs() < 1e-12);
    assert_eq!(distances[0], start);
    assert_eq!(*distances.last().unwrap(), number("figures/tip/position_distance"));
    let page = page(&place);
    let digits: f64 = format!("{:.4e}", 1e3 * start).parse().unwrap();
    let millimetres = format!("at the start {digits} mm");
    assert!(page.contains("Distance of tip from its target") && page.contains(&millimetres), "{millimetres}");
    assert!(page.contains("position from its target"));
}

/// A film of 0.3 mm: 10 kV/mm are 3 kV.
#[test]
fn the_voltage_of_an_electric_field() {
    let case = r#"{ "nastic": 1, "units": "mm",
      "mesh": { "box": { "size": [20, 4, 0.3], "cells": [3, 1, 1], "element": "hex20" } },
      "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.2 MPa", "poisson": 0.3 } ],
      "supports": [ { "surface": "x-", "fix": "all" } ],
      "actuation": [ { "name": "film", "kind": "dielectric", "region": "body", "direction": "z", "relative_permittivity": 3 } ],
      "controls": [ { "of": "film", "space": "uniform", "start": "10 kV/mm", "lower": 0, "upper": "40 kV/mm" } ] }"#;
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, case, &[]).unwrap().result;
    let voltage = &found["controls"]["film"]["voltage"];
    let volts = |key: &str| voltage[key].as_f64().unwrap();
    assert!((volts("min") - 3e3).abs() < 1e-6 && volts("max") == volts("min") && voltage["unit"] == "V", "{voltage}");
    let page = page(&place);
    assert!(page.contains("10 kV/mm") && page.contains("40 kV/mm") && page.contains("3 to 3 kV"), "no kV/mm");
    let said = place.text(Command::Check, case, &[]);
    assert!(said.contains("(3 kV over the film at rest)"), "{said}");
}
