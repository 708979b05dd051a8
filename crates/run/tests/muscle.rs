//! A muscle: the fibres of a fibre tension, with the contraction as the control.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;
use serde_json::Value;

const MUSCLE: &str = r#"{ "nastic": 1,
  "mesh": { "box": { "size": [1.0, 0.1], "cells": [8, 2], "element": "quad9" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "pull", "kind": "muscle", "region": "body", "direction": "x" } ],
  "controls": [ { "of": "pull", "space": "cell", "start": "5 kPa * (Y > 0.05 m)", "upper": "20 kPa" } ],
  "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X - 0.05", "Y + 0.2"] } ],
  "optimizer": { "method": "lbfgs", "max_iterations": 6 } }"#;

fn tension() -> String {
    let case = with(MUSCLE, r#""muscle""#, r#""fiber_tension""#);
    let case = with(&case, r#""start": "5 kPa * (Y > 0.05 m)""#, r#""start": "-5 kPa * (Y > 0.05 m)""#);
    with(&case, r#""upper": "20 kPa""#, r#""lower": "-20 kPa", "upper": 0"#)
}

fn result(command: Command, case: &str) -> Value {
    CaseDirectory::new().run(command, case, &[]).unwrap_or_else(|error| panic!("{error}")).result
}

#[test]
fn it_is_a_tension_with_the_other_sign() {
    let (muscle, tension) = (result(Command::Optimize, MUSCLE), result(Command::Optimize, &tension()));
    let of = |result: &Value, path: &str| nastic_run::result::find(result, path).unwrap().as_f64().unwrap();
    assert!(of(&muscle, "cost/total") < 0.3 * of(&muscle, "start/cost/total"));
    for (path, sign) in [("cost/total", 1.0), ("start/cost/total", 1.0), ("min_J", 1.0)] {
        let (a, b) = (of(&muscle, path), sign * of(&tension, path));
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{path}: {a} and {b}");
    }
    let (most, least) = (of(&muscle, "controls/pull/max"), of(&tension, "controls/pull/min"));
    assert!(most > 1e3 && (most + least).abs() < 1e-6 * most, "{most} and {least}");
    assert_eq!((of(&muscle, "controls/pull/lower"), muscle["warnings"].as_array().unwrap().len()), (0.0, 0));
    assert_eq!(muscle["controls"]["pull"]["slot"], "contraction");
}

#[test]
fn it_only_pulls() {
    let fixed = with(MUSCLE, r#""direction": "x" }"#, r#""direction": "x", "contraction": "-1 kPa" }"#);
    let controls = fixed.find(r#""controls""#).unwrap();
    let costs = fixed.find(r#""costs""#).unwrap();
    let fixed = format!("{}{}", &fixed[..controls], &fixed[costs..]);
    for case in [with(MUSCLE, r#""upper": "20 kPa""#, r#""lower": "-1 kPa", "upper": "20 kPa""#), fixed] {
        let error = CaseDirectory::new().run(Command::Check, &case, &[]).unwrap_err().to_string();
        assert!(error.contains("a muscle only pulls") && error.contains("\"fiber_tension\""), "{error}");
    }
}
