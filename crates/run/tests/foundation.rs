//! Elastic foundations in case files, among the supports.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;

const BLOCK: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 10, 10], "cells": [4, 2, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "x-", "foundation": "0.5 N/mm^3", "along": "normal" }, { "surface": "y-", "fix": "y" },
                { "surface": "z-", "fix": ["z"] } ],
  "loads": [ { "surface": "x+", "traction": ["10 kPa", 0, 0] } ],
  "probes": [ { "name": "foot", "point": [0, 5, 5] } ] }"#;

/// 0.01 N/mm^2 over 0.5 N/mm^3: 0.02 mm; the bed pulls with 1 N.
#[test]
fn a_bed_gives_way_by_its_share() {
    let found = CaseDirectory::new().run(Command::Solve, BLOCK, &[]).unwrap().result;
    let number = |path: &str| nastic_run::result::find(&found, path).unwrap().as_f64().unwrap();
    assert!((number("probes/foot/displacement/0") - 0.02).abs() < 1e-9, "{}", found["probes"]);
    assert!((number("contributions/foundation on x-/force_x") + 1.0).abs() < 1e-7, "{}", found["contributions"]);
    // in every direction it holds the body alone
    let alone = with(BLOCK, r#", "along": "normal" }, { "surface": "y-", "fix": "y" }"#, " }");
    let alone = with(&alone, r#""fix": ["z"]"#, r#""foundation": 1"#);
    assert!(CaseDirectory::new().run(Command::Solve, &alone, &[]).is_ok());
}

#[test]
fn mistakes_about_a_foundation_are_told() {
    let cases = [
        (r#", { "surface": "y-", "fix": "y" }"#, "", vec!["supports", "1 rigid motion", "shift along y"]),
        (r#""0.5 N/mm^3""#, r#""0.5 N/mm""#, vec!["supports/0/foundation", "N/m^3"]),
        (r#""0.5 N/mm^3""#, "-1", vec!["supports/0/foundation", "must be positive"]),
        (r#""along": "normal" }"#, r#""fix": "x" }"#, vec!["supports/0/foundation", "a support of its own"]),
        (
            r#""fix": ["z"]"#,
            r#""fix": ["z"], "along": "normal""#,
            vec!["supports/2/along", "belongs to a \"foundation\""],
        ),
        (r#""surface": "x-""#, r#""region": "body""#, vec!["supports/0/foundation", "name one"]),
    ];
    for (from, to, message) in cases {
        let error = CaseDirectory::new().run(Command::Check, &with(BLOCK, from, to), &[]).unwrap_err().to_string();
        assert!(message.iter().all(|words| error.contains(words)), "{to}: {error}");
    }
}
