//! `"stages": "auto"` in case files: the default, what is said of it, what results hold.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

/// The bar towards a longer one; a key more of the distance.
fn case(key: &str) -> String {
    let tracking = r#"{ "kind": "tracking", "surface": "x+", "target": ["X - 0.1", "Y", "Z + 0.1"] }"#;
    let distance = r#"{ "kind": "smoothed_hausdorff", "name": "shape", "phi": { "exponential": { "length": 0.1 } },
      "target": { "box": { "size": [1.05, 0.25, 0.25], "cells": [8, 2, 2], "element": "hex8" } }"#;
    with(BAR, tracking, &format!("{distance}{key} }}"))
}

#[test]
fn they_are_the_default_told_and_kept() {
    let (left_out, auto) = (CaseDirectory::new(), CaseDirectory::new());
    let limit = ["optimizer/max_iterations=4"];
    let first = left_out.run(Command::Optimize, &case(""), &limit).unwrap();
    let second = auto.run(Command::Optimize, &case(r#", "stages": "auto""#), &limit).unwrap();
    let stages = first.result["smoothing"]["shape"].as_array().unwrap();
    let number = |stage: &Value, key: &str| stage[key].as_f64().unwrap();
    assert_eq!(first.result["smoothing"], second.result["smoothing"]);
    assert_eq!(first.result["cost"], second.result["cost"]);
    assert!(stages.len() > 1 && stages.len() == first.result["stages"].as_array().unwrap().len(), "{stages:?}");
    assert!(stages.windows(2).all(|w| number(&w[0], "length") > number(&w[1], "length")));
    assert!(stages.iter().all(|s| (0.1 / number(s, "alpha") - number(s, "length")).abs() < 1e-12));

    // The same, written as a list, is the same run.
    let list: Vec<String> = stages
        .iter()
        .map(|s| format!(r#"{{ "alpha": {}, "beta": {}, "gamma": {} }}"#, s["alpha"], s["beta"], s["gamma"]))
        .collect();
    let written = CaseDirectory::new();
    let third =
        written.run(Command::Optimize, &case(&format!(r#", "stages": [{}]"#, list.join(", "))), &limit).unwrap();
    let (a, b) = (number(&first.result["cost"], "total"), number(&third.result["cost"], "total"));
    assert!((a - b).abs() < 1e-9 * a, "{a} and {b}");

    let message = left_out.text(Command::Check, &case(""), &[]);
    assert!(message.contains("stages      shape: automatic, (alpha, beta, gamma) = ("), "{message}");
    assert!(message.contains(", 16, 8) resolve ") && !message.contains("WARNING"), "{message}");
}

#[test]
fn other_words_are_refused() {
    for stages in [r#""automatic""#, "3"] {
        let message = problems(&case(&format!(r#", "stages": {stages}"#)));
        assert!(message.contains("\"auto\" or a list"), "{message}");
    }
    let message = problems(&case(r#", "stages": []"#));
    assert!(message.contains("at least one stage"), "{message}");
}
