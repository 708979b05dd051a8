//! Rigid regions in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use nastic_run::result::find;
use serde_json::Value;

/// A block of 4 g that falls half a millimetre on a floor.
const BLOCK: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3", "rigid": true } ],
  "loads": [ { "gravity": ["2 m/s^2", 0, "-10 m/s^2"] } ],
  "time": { "end": "200 ms", "step": "4 ms", "scheme": "backward_euler", "start": "rest", "output": "40 ms" },
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, -0.5], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "feet", "surface": "z-", "obstacle": "floor", "friction": 0.3, "slip_speed": "1 mm/s" } ],
  "costs": [ { "name": "far", "kind": "position", "region": "body", "target": { "x": 12 } } ],
  "controls": [ { "of": "feet.friction", "space": "uniform", "lower": 0.01, "upper": 1 } ],
  "probes": [ { "name": "corner", "point": [20, 20, 10] }, { "name": "foot", "point": [0, 0, 0] } ] }"#;

fn number(found: &Value, path: &str) -> f64 {
    find(found, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {found}"))
}

#[test]
fn a_rigid_block_falls_and_stays_what_it_is() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, BLOCK, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let weight = 4e-3 * 10.0;
    let force = number(&found, "contributions/feet/force_z");
    assert!((force - weight).abs() < 1e-3 * weight, "{force}");
    let at = |name: &str| -> Vec<f64> {
        let place = |k: usize| number(&found, &format!("probes/{name}/displacement/{k}"));
        (0..3).map(place).collect()
    };
    let rest = [20.0, 20.0, 10.0];
    let apart: f64 = at("corner").iter().zip(at("foot")).zip(rest).map(|((a, b), x)| (a - b + x).powi(2)).sum();
    assert!((apart.sqrt() - 30.0).abs() < 1e-9, "{apart}");
    assert!((number(&found, "contributions/body/translation_z") - at("corner")[2]).abs() < 1e-3);
    let checked = place.run(Command::Check, BLOCK, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    assert_eq!(checked["materials"][0]["rigid"], true, "{checked}");
    let heard = place.text(Command::Check, BLOCK, &[]);
    assert!(heard.contains("; rigid; density"), "{heard}");
    let columns = std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap();
    assert!(columns.lines().next().unwrap().contains("body.rotation_z"), "{columns}");
}

#[test]
fn the_derivative_by_its_friction_is_right() {
    let heard = CaseDirectory::new().text(Command::Gradient, BLOCK, &[]);
    assert!(heard.contains("gradient    right"), "{heard}");
}

#[test]
fn what_a_rigid_region_does_not_go_with_is_told_at_its_place() {
    let held = with(BLOCK, r#""loads""#, r#""supports": [ { "surface": "z+", "fix": ["x"] } ], "loads""#);
    let said = problems(&held);
    assert!(said.contains("materials/0/rigid") && said.contains("\"z+\" holds node"), "{said}");
    let muscle = r#""actuation": [ { "name": "pull", "kind": "fiber_tension", "region": "body", "direction": "x", "tension": "1 kPa" } ], "loads""#;
    let said = problems(&with(BLOCK, r#""loads""#, muscle));
    assert!(said.contains("materials/0/rigid") && said.contains("\"pull\" acts in this region alone"), "{said}");
    let word = with(BLOCK, r#""rigid": true"#, r#""rigid": "yes""#);
    assert!(problems(&word).contains("materials/0/rigid"), "{}", problems(&word));
    let multigrid = with(BLOCK, r#""loads""#, r#""linear_solver": "multigrid", "loads""#);
    assert!(problems(&multigrid).contains("rigid bodies"), "{}", problems(&multigrid));
}
