//! Families of fibres that add to the law of a matrix.
#![allow(clippy::unwrap_used)] // a test may

use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Options, Outcome, RunError, run};
use serde_json::{Value, json};

fn family(direction: [f64; 3]) -> Value {
    json!({ "region": "body", "law": "fiber_family", "k1": "50 kPa", "k2": 0.8, "dispersion": 0.1, "fiber": direction })
}

fn solve(materials: Value) -> Result<Outcome, RunError> {
    let case = json!({
        "nastic": 1,
        "units": "mm",
        "mesh": { "box": { "size": [20, 10, 10], "cells": [2, 1, 1], "element": "hex20" } },
        "materials": materials,
        "supports": [{ "surface": "x-", "fix": "all" }],
        "loads": [{ "surface": "x+", "traction": ["20 kPa", 0, 0] }],
        "probes": [{ "name": "tip", "point": [20, 5, 5] }],
    });
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("case.json");
    std::fs::write(&file, case.to_string()).unwrap();
    run(Command::Solve, &file, &Options { in_memory: true, ..Options::default() }, &Console::silent())
}

/// Two families beside a matrix are the law that has both, and stiffen it.
#[test]
fn two_families_in_a_matrix() {
    let tip = |materials: Value| {
        let found = solve(materials).unwrap().result;
        assert_eq!(found["warnings"], json!([]));
        found["probes"]["tip"]["displacement"][0].as_f64().unwrap()
    };
    let matrix = json!({ "region": "body", "law": "neo_hooke_isochoric", "shear": "70 kPa", "bulk": "1 MPa" });
    let (a, b) = ([0.8, 0.6, 0.0], [0.8, -0.6, 0.0]);
    let [bare, one, both] =
        [json!([matrix]), json!([matrix, family(a)]), json!([matrix, family(a), family(b)])].map(tip);
    assert!(bare > 1.02 * one && one > 1.02 * both, "{bare} {one} {both}");
    let whole = tip(json!([{
        "region": "body", "law": "holzapfel_gasser_ogden", "mu": "70 kPa", "bulk": "1 MPa", "k1": "50 kPa", "k2": 0.8,
        "dispersion": 0.1, "fiber": a, "fiber2": b,
    }]));
    assert!((whole / both - 1.0).abs() < 1e-6, "{whole} {both}");
}

#[test]
fn fibers_without_a_matrix_are_refused() {
    let error = solve(json!([family([1.0, 0.0, 0.0])])).unwrap_err().to_string();
    assert!(
        error.contains("materials/0/law: \"fiber_family\" adds to the law of a matrix, and 2 of its cells have none"),
        "{error}"
    );
}
