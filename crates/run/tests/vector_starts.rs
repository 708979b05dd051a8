//! Vector controls that begin at an array of a file: its mean over the part of each unknown, component by component.

#![allow(clippy::unwrap_used)] // a test may

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;

const CELLS: &str = r#""space": "cell", "start": ["50 mT + 20 mT * X / 1 m", "30 mT - 10 mT * X / 1 m", 0]"#;
const MAGNET: &str = r#"{ "nastic": 1, "mesh": { "box": { "size": [1, 0.1], "cells": [10, 1], "element": "quad9" } },
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0 } ],
    "supports": [ { "surface": "x-", "fix": ["x", "y"] } ],
    "actuation": [ { "name": "magnet", "kind": "magnet", "region": "body", "field": [0, "5 mT"] } ],
    "controls": [ { "of": "magnet.remanence", "name": "design",
        "space": "cell", "start": ["50 mT + 20 mT * X / 1 m", "30 mT - 10 mT * X / 1 m", 0] } ] }"#;

#[test]
fn one_vector_for_all_begins_at_the_mean_of_an_array() {
    let place = CaseDirectory::new();
    place.run(Command::Solve, MAGNET, &[]).unwrap();
    std::fs::copy(place.path("out/start.vtu"), place.path("field.vtu")).unwrap();
    let uniform = r#""space": "uniform", "start": { "file": "field.vtu", "array": "design" }"#;
    let result = place.run(Command::Solve, &with(MAGNET, CELLS, uniform), &[]).unwrap().result;
    // (60, 25, 0) mT in the middle of the bar
    for key in ["min", "max"] {
        let length = result["controls"]["design"][key].as_f64().unwrap();
        assert!((length - 0.065).abs() < 1e-12, "{key}: {length}, {}", result["controls"]);
    }
}
