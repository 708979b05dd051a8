//! Families of fibres on the same cells: upper bounds left out, warnings and failures show what the law bears of them together.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, warnings, with};
use nastic_language::schema::Command;
use nastic_run::result::find;
use nastic_run::run::Outcome;
use serde_json::{Value, json};

/// mu = 100 kPa is the bound of one family.
const CASE: &str = r#"{ "nastic": 1,
  "mesh": { "box": { "size": [1.0, 0.5, 0.5], "cells": [2, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "shear": "100 kPa", "bulk": "200 kPa" } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [
    { "name": "a", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] },
    { "name": "b", "kind": "fiber_tension", "region": "body", "direction": [0, 1, 0] } ],
  "controls": [
    { "of": "a", "space": "cell", "lower": "-100 kPa" },
    { "of": "b", "space": "uniform", "lower": "-100 kPa" } ],
  "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X + 0.1", "Y", "Z"] } ] }"#;

fn at_60_degrees() -> String {
    with(CASE, "[0, 1, 0]", "[0.5, 0.8660254037844386, 0]")
}

fn parallel() -> String {
    with(CASE, "[0, 1, 0]", "[1, 0, 0]")
}

fn uppers(case: &str, a: &str, b: &str) -> String {
    let bounded = with(case, r#""space": "cell","#, &format!(r#""space": "cell", "upper": "{a}","#));
    with(&bounded, r#""space": "uniform","#, &format!(r#""space": "uniform", "upper": "{b}","#))
}

fn check(case: &str) -> Outcome {
    CaseDirectory::new().run(Command::Check, case, &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn number(result: &Value, path: &str) -> f64 {
    find(result, path).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

#[test]
fn an_upper_bound_left_out_follows_from_all_families() {
    for (case, joint) in [(CASE.to_owned(), 1e5), (parallel(), 5e4), (at_60_degrees(), 1e5 / 1.5)] {
        let outcome = check(&case);
        let result = &outcome.result;
        assert_eq!(result["warnings"], json!([]));
        for control in ["a", "b"] {
            let upper = number(result, &format!("controls/{control}/upper"));
            assert!((upper / (0.95 * joint) - 1.0).abs() < 1e-12, "{control}: {upper} of {joint}");
        }
        assert!((number(result, "actuation/0/joint_fiber_limit") / joint - 1.0).abs() < 1e-12);
        assert!((number(result, "actuation/1/fiber_limit") / 1e5 - 1.0).abs() < 1e-12);
        assert_eq!(result["actuation"][0]["beside"], json!(["b"]));
    }
}

#[test]
fn bounds_together_beyond_what_the_law_bears() {
    let place = CaseDirectory::new();
    assert_eq!(warnings(&uppers(CASE, "99 kPa", "99 kPa")), "");
    assert_eq!(warnings(&uppers(&at_60_degrees(), "66 kPa", "66 kPa")), "");
    let found = warnings(&uppers(&at_60_degrees(), "70 kPa", "68 kPa"));
    assert!(found.contains("[convexity]") && found.contains("70000 Pa of \"a\" and 68000 Pa of \"b\""), "{found}");
    // one alone beyond it is reported alone
    let alone = warnings(&uppers(&at_60_degrees(), "101 kPa", "68 kPa"));
    assert!(alone.contains("a tension of 101000 Pa exceeds 100000 Pa") && !alone.contains("\"b\""), "{alone}");
    // fixed values count
    let fixed =
        with(&parallel(), r#""direction": [1, 0, 0] } ]"#, r#""direction": [1, 0, 0], "tension": "60 kPa" } ]"#);
    let fixed = with(&fixed, ",\n    { \"of\": \"b\", \"space\": \"uniform\", \"lower\": \"-100 kPa\" }", "");
    let fixed = with(&fixed, r#""space": "cell","#, r#""space": "cell", "upper": "45 kPa","#);
    let found = warnings(&fixed);
    assert!(found.contains("60000 Pa of \"b\" and 45000 Pa of \"a\""), "{found}");
    let text = place.text(Command::Check, &fixed, &[]);
    assert!(text.contains("with that of b on the same cells, all alike, up to 50000 Pa"), "{text}");
}

#[test]
fn a_failure_names_the_families() {
    let case = uppers(&parallel(), "95 kPa", "90 kPa");
    let case = with(&case, r#""space": "cell","#, r#""space": "cell", "start": "95 kPa","#);
    let case = with(&case, r#""space": "uniform","#, r#""space": "uniform", "start": "90 kPa","#);
    let place = CaseDirectory::new();
    let error = place.run(Command::Solve, &case, &[]).unwrap_err().to_string();
    assert!(error.contains("\"a\" reaches 9.5000e4") && error.contains("\"b\", 9.0000e4"), "{error}");
    let bound = &place.json("result.json")["failure"]["convexity_bound"];
    assert_eq!((&bound["actuation"], &bound["beside"]), (&json!("a"), &json!([{ "actuation": "b", "tension": 9e4 }])));
}
