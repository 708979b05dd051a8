//! Surfaces and regions by where they are: a bar that names them so is the bar that names those of its mesh.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

/// Clamped at one end, drawn at the other, of two materials.
const BY_MESH: &str = r#"{ "nastic": 1,
  "mesh": { "boxes": [
    { "name": "a", "size": [1, 1, 1], "cells": [2, 2, 2], "element": "hex8" } ] },
  "materials": [ { "region": "a", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "a.z-", "fix": "all" } ],
  "loads": [ { "surface": "a.z+", "traction": ["1 kPa", "0 Pa", "2 kPa"] } ],
  "probes": [ { "name": "tip", "point": [1, 1, 1] } ] }"#;

/// The same surfaces by direction and by a shape.
const NAMED: &str = r#""surfaces": [ { "name": "foot", "facing": "-z" },
    { "name": "head", "inside": { "box": { "low": [0, 0, 0.99], "high": [1, 1, 1.01] } } } ], "#;

fn tip(case: &str) -> Value {
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Solve, case, &[]).unwrap_or_else(|error| panic!("{error}"));
    outcome.result["probes"]["tip"].clone()
}

fn by_place() -> String {
    let named = with(BY_MESH, r#""materials": "#, &format!("{NAMED}\"materials\": "));
    with(&with(&named, "\"a.z-\"", "\"foot\""), "\"a.z+\"", "\"head\"")
}

#[test]
fn surfaces_by_direction_and_by_shape_are_those_of_the_mesh() {
    let own = tip(BY_MESH);
    assert_eq!(tip(&by_place()), own);
    // both together: of the facets that face up those in a ball about a corner
    let part = r#""inside": { "sphere": { "center": [0, 0, 1], "radius": 0.8 } }, "facing": [0, 0, 1] "#;
    let corner = by_place().replace(r#""inside": { "box": { "low": [0, 0, 0.99], "high": [1, 1, 1.01] } } "#, part);
    assert_ne!(corner, by_place());
    assert_ne!(tip(&corner), own);
    let whole = corner.replace("0.8", "1.5");
    assert_eq!(tip(&whole), own);
}

#[test]
fn regions_by_shape_take_other_materials() {
    let upper = r#""regions": [ { "name": "upper", "inside": { "half_space": { "point": [0, 0, 0.5], "normal": [0, 0, -1] } } },
        { "name": "lower", "inside": { "half_space": { "point": [0, 0, 0.5], "normal": [0, 0, 1] } } } ], "materials": "#;
    let law = |region: &str, young: &str| {
        format!(r#"{{ "region": "{region}", "law": "neo_hooke", "young": "{young}", "poisson": 0.3 }}"#)
    };
    // drawn along z: two springs in a row
    let drawn = with(BY_MESH, "1 kPa", "0 Pa");
    let two = with(&drawn, "\"materials\": ", upper);
    let two = with(&two, &law("a", "100 kPa"), &format!("{}, {}", law("upper", "100 kPa"), law("lower", "50 kPa")));
    let z = |case: &str| tip(case)["displacement"][2].as_f64().unwrap();
    let (stiff, mixed) = (z(&drawn), z(&two));
    assert!(mixed > 1.35 * stiff && mixed < 1.65 * stiff, "{stiff} {mixed}");
    let same = two.replace("50 kPa", "100 kPa");
    assert!((z(&same) / stiff - 1.0).abs() < 1e-9);
}

#[test]
fn places_without_a_facet_and_names_that_are_taken_are_told() {
    for (from, to, words) in [
        ("\"facing\": \"-z\"", "\"facing\": [0, 0, 0]", "surfaces/0/facing: the direction is zero"),
        (", \"facing\": \"-z\"", "", "surfaces/0: a surface needs \"inside\", \"facing\" or both"),
        ("\"low\": [0, 0, 0.99]", "\"low\": [0, 0, 1.005]", "surfaces/1: nothing of the body is there"),
        ("\"name\": \"head\"", "\"name\": \"a.x-\"", "surfaces/1/name: the body has \"a.x-\" already"),
    ] {
        let bad = with(&by_place(), from, to);
        let found = problems(&bad);
        assert!(found.contains(words), "{to}: {found}");
    }
}
