//! A motion in case files: a surface held rigid that moves and turns, by fixed values and as controls.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;
use serde_json::Value;

const GRIP: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [40, 10, 10], "cells": [8, 2, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
  "supports": [],
  "actuation": [ { "name": "grip", "kind": "motion", "surface": "x-", "centre": [0, 5, 0],
                   "translation": [1, "2 mm", 3], "rotation": [0, "pi / 2", 0] } ],
  "probes": [ { "name": "end", "point": [40, 0, 10] } ] }"#;

/// The same bar held at its other end, its end turned and shifted so that its middle comes where it is wanted.
const TURNED: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [40, 10, 10], "cells": [8, 2, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "grip", "kind": "motion", "surface": "x+" } ],
  "controls": [ { "of": "grip.translation", "space": "uniform", "start": [-1, 0, 1], "max_norm": 20 },
                { "of": "grip.rotation", "name": "angle", "space": "uniform", "direction": "y", "start": -0.1, "lower": -1.5, "upper": 0.5 } ],
  "costs": [ { "kind": "tracking", "region": "body", "target": ["X - 1", "Y", "Z + 0.008 * X^2"] } ],
  "optimizer": { "method": "lbfgs", "max_iterations": 25, "tolerance": 1e-3 } }"#;

fn result(command: Command, case: &str) -> Value {
    CaseDirectory::new().run(command, case, &[]).unwrap_or_else(|error| panic!("{error}")).result
}

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("no {path}"))
}

/// A free bar goes with its grip: (x, y, z) - c = (40, -5, 10) turns about y to (10, -5, -40).
#[test]
fn a_free_body_goes_with_its_grip() {
    let found = result(Command::Solve, GRIP);
    let expected = [10.0 + 1.0 - 40.0, 2.0, -40.0 + 3.0 - 10.0];
    for (k, expected) in expected.into_iter().enumerate() {
        let moved = number(&found, &format!("probes/end/displacement/{k}"));
        assert!((moved - expected).abs() < 1e-8, "{k}: {moved} instead of {expected}");
    }
    assert!(number(&found, "reactions/grip/0").abs() < 1e-8, "a free body is carried without force");
    let said = CaseDirectory::new().text(Command::Check, GRIP, &[]);
    assert!(said.contains("grip: motion on surface x-; centre (0, 5, 0)"), "{said}");
}

#[test]
fn a_motion_is_a_control() {
    let checked = result(Command::Gradcheck, TURNED);
    assert_eq!(checked["gradcheck"]["passed"], true, "{}", checked["gradcheck"]["verdict"]);
    let found = result(Command::Optimize, TURNED);
    assert_eq!(found["converged"], true, "{}", found["stop"]);
    assert!(number(&found, "cost/total") < 0.06 * number(&found, "start/cost/total"));
    // the target z = 0.008 x^2 rises: about y by a negative angle
    let angle = number(&found, "controls/angle/max");
    assert!(angle < -0.3 && angle > -0.7, "{angle}");
    assert_eq!(
        (&found["controls"]["angle"]["unit"], &found["controls"]["grip.translation"]["unit"]),
        (&"rad".into(), &"mm".into())
    );
    assert!(number(&found, "reactions/grip/2").abs() > 1e-3);
}

#[test]
fn mistakes_about_a_motion_are_told() {
    let cases = [
        (r#""supports": []"#, r#""supports": [ { "surface": "x-", "fix": "x" } ]"#, vec!["supports/0", "grip", "x-"]),
        (r#""surface": "x-""#, r#""surface": "base""#, vec!["actuation/0", "base", "not found"]),
        (r#"[1, "2 mm", 3]"#, r#"["1 N", 0, 0]"#, vec!["actuation/0/translation/0", "a length is wanted"]),
        (r#"[1, "2 mm", 3]"#, r#"["X", 0, 0]"#, vec!["actuation/0/translation", "give numbers"]),
        (r#""centre": [0, 5, 0]"#, r#""center": [0, 5, 0]"#, vec!["actuation/0/center", "centre"]),
    ];
    for (from, to, message) in cases {
        let error = CaseDirectory::new().run(Command::Check, &with(GRIP, from, to), &[]).unwrap_err().to_string();
        assert!(message.iter().all(|words| error.contains(words)), "{to}: {error}");
    }
}
