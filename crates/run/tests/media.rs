//! Voids with a medium, from a case file.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;

/// A C whose arms meet: its mouth is pressed together; the arms have a density.
const PRESSED: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [1.1, 0.5], "cells": [11, 5], "element": "quad9" } },
    "regions": [
        { "name": "spine", "inside": { "box": { "low": [-1, -1, -1], "high": [0.1, 1, 1] } } },
        { "name": "lower", "inside": { "box": { "low": [0.1, -1, -1], "high": [1.0, 0.1, 1] } } },
        { "name": "upper", "inside": { "box": { "low": [0.1, 0.4, -1], "high": [1.0, 1, 1] } } },
        { "name": "slot", "inside": { "box": { "low": [0.1, 0.1, -1], "high": [1.0, 0.4, 1] } } },
        { "name": "behind", "inside": { "box": { "low": [1.0, -1, -1], "high": [2, 1, 1] } } } ],
    "surfaces": [ { "name": "tip", "facing": [0, 1], "inside": { "box": { "low": [0.85, 0.4, -1], "high": [1.01, 1, 1] } } } ],
    "materials": [
        { "region": ["spine", "lower", "upper"], "law": "neo_hooke_isochoric", "mu": 0.4, "kappa": 1.6, "design": [ { "name": "rho", "kind": "density", "least": 0.01 } ] },
        { "region": ["slot", "behind"], "law": "neo_hooke_isochoric", "mu": 8e-7, "kappa": 3e-6 } ],
    "media": [ { "name": "void", "region": ["slot", "behind"], "stiffness": 4e-3 } ],
    "supports": [ { "surface": "x-", "fix": "all" }, { "surface": "tip", "displacement": { "y": -0.38 } } ],
    "controls": [ { "of": "rho", "space": "region", "start": 0.8 } ],
    "costs": [ { "kind": "reaction", "surface": "tip", "direction": [0, -1], "force": 1e-4 } ] }"#;

#[test]
fn forces_through_a_void_have_exact_derivatives_by_densities() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Gradcheck, PRESSED, &[]).unwrap().result;
    assert!(found["gradcheck"]["verdict"].as_str().is_some_and(|verdict| verdict.starts_with("right")), "{found}");
    let solved = place.run(Command::Solve, PRESSED, &[]).unwrap().result;
    assert!(solved["contributions"]["void"]["energy"].as_f64().is_some_and(|energy| energy > 0.0), "{solved}");
    let told = common::messages(&solved, "medium");
    assert!(told.len() == 1 && told[0].contains("\"void\" stores "), "{told:?}");
    let soft = place.run(Command::Solve, PRESSED, &["media/0/stiffness=2e-4"]).unwrap().result;
    assert_eq!(common::messages(&soft, "medium"), Vec::<String>::new());
}

/// On linear triangles the medium holds patches of cells together.
#[test]
fn media_on_linear_triangles_have_exact_derivatives() {
    let linear = with(&with(PRESSED, "\"quad9\"", "\"tri3\""), "\"cells\": [11, 5]", "\"cells\": [22, 10]");
    let place = CaseDirectory::new();
    let found = place.run(Command::Gradcheck, &linear, &["supports/1/displacement/y=-0.25"]).unwrap().result;
    assert!(found["gradcheck"]["verdict"].as_str().is_some_and(|verdict| verdict.starts_with("right")), "{found}");
    let solved = place.run(Command::Solve, &linear, &["supports/1/displacement/y=-0.25"]).unwrap().result;
    assert!(solved["contributions"]["void"]["energy"].as_f64().is_some_and(|energy| energy > 0.0), "{solved}");
}

#[test]
fn media_of_another_kind_are_refused() {
    let refused = |case: &str| common::problems(case);
    let none = refused(&with(PRESSED, "\"stiffness\": 4e-3", "\"stiffness\": 0"));
    assert!(none.contains("media/0: void has a stiffness of 0; it must be positive"), "{none}");
    let misplaced = refused(&with(PRESSED, "\"media\":", "\"medium\":"));
    assert!(misplaced.contains("a medium stands in \"media\""), "{misplaced}");
}
