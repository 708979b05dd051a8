//! Directions of fibres as controls: their derivatives beside others, a field of them by limited memory and by moving asymptotes, the bound of tensions whose fibres may turn.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;
use serde_json::Value;

/// A strip whose muscle fibres lie aslant and may turn.
const STRIP: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.03, 0.006], "cells": [10, 2], "element": "quad9" } },
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.4 } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "actuation": [ { "name": "muscle", "kind": "muscle", "region": "body", "direction": [0.8, 0.6, 0], "contraction": "20 kPa" } ],
    "controls": [ { "of": "muscle.direction", "space": "node", "norm": 1, "filter": "3 mm" } ],
    "costs": [ { "kind": "position", "surface": "x+", "target": { "y": 0.006 }, "weight": 1e6 } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 60 } }"#;

fn run(command: Command, text: &str) -> Value {
    CaseDirectory::new().run(command, text, &[]).unwrap().result
}

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

/// First and second, of directions alone, beside contractions and beside a density in front of the fibres.
#[test]
fn derivatives_by_directions_have_their_orders() {
    let contraction = r#"{ "of": "muscle", "space": "cell", "start": "20 kPa", "upper": "40 kPa" },
        { "of": "muscle.direction""#;
    let both = with(STRIP, r#", "contraction": "20 kPa""#, "");
    let both = with(&both, r#"{ "of": "muscle.direction""#, contraction);
    let scaled = with(
        STRIP,
        r#""contraction": "20 kPa""#,
        r#""contraction": "20 kPa", "design": [ { "name": "rho", "kind": "factor" } ]"#,
    );
    let rho = r#"{ "of": "rho", "space": "cell", "start": "0.8 - 4 * X / (1 m)", "lower": 0.1 },
        { "of": "muscle.direction""#;
    let scaled = with(&scaled, r#"{ "of": "muscle.direction""#, rho);
    for case in [STRIP, &both, &scaled] {
        let found = run(Command::Gradcheck, case);
        assert!(number(&found, "gradcheck/lowest_order") > 1.95, "{found}");
        assert!(number(&found, "gradcheck/second/lowest_order") > 2.95, "{found}");
    }
}

/// The end is lifted to where it is asked for, by vectors of one length; moving asymptotes move their components between minus and plus that.
#[test]
fn fibres_turn_until_the_end_is_lifted() {
    for method in ["lbfgs", "gauss_newton", "mma"] {
        let place = CaseDirectory::new();
        let found = place.run(Command::Optimize, &with(STRIP, "lbfgs", method), &[]).unwrap().result;
        let (first, last) = (number(&found, "start/cost/total"), number(&found, "cost/total"));
        assert!(last < 1e-3 * first, "{method}: {first} to {last}");
        let shown = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
        let field =
            shown.point_data.iter().chain(&shown.cell_data).find(|array| array.name == "muscle.direction").unwrap();
        let lengths = || field.values.chunks(3).map(|d| d[0].hypot(d[1]));
        assert!(lengths().all(|length| length > 0.5 && length < 1.0 + 1e-9), "{method}: {:?}", field.values);
        assert!(field.values.chunks(3).any(|d| d[0] * 0.8 + d[1] * 0.6 < 0.99), "{method}");
    }
}

/// Of tensions the least bound of all directions is the default; a larger one is told as one along written fibres is.
#[test]
fn tensions_of_fibres_that_turn_have_a_bound() {
    let text = with(STRIP, r#""name": "muscle", "kind": "muscle""#, r#""name": "fibres", "kind": "fiber_tension""#);
    let text = with(&with(&text, "contraction", "tension"), "muscle.direction", "fibres.direction");
    let driven = with(&text, r#", "tension": "20 kPa""#, "");
    let control = r#"{ "of": "fibres", "space": "uniform", "lower": 0 }, { "of": "fibres.direction""#;
    let checked = run(Command::Check, &with(&driven, r#"{ "of": "fibres.direction""#, control));
    let bound = 0.95 * 100e3 / (2.0 * 1.4);
    assert!((number(&checked, "controls/fibres/upper") / bound - 1.0).abs() < 1e-12, "{checked}");
    let told = run(Command::Solve, &text)["warnings"].to_string();
    assert!(!told.contains("convexity"), "{told}");
    // beyond it the cause of the failure is named
    let failed =
        CaseDirectory::new().run(Command::Solve, &with(&text, "20 kPa", "40 kPa"), &[]).unwrap_err().to_string();
    assert!(failed.contains("\"fibres\"") && failed.contains("3.571"), "{failed}");
}
