//! `formulation` in case files: every one on every kind of cell, in results, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, problems};
use nastic_fem::Formulation;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::{Command, json_schema};
use nastic_mesh::CellKind;
use nastic_run::console::Console;
use serde_json::{Value, json};

/// A block pushed at its end, of two regions' worth of laws.
fn block(kind: CellKind, formulation: &str) -> Value {
    let dim = kind.dim();
    json!({
        "nastic": 1,
        "mesh": { "box": { "size": &[2.0, 1.0, 1.0][..dim], "cells": &[2, 1, 1][..dim], "element": kind.name() } },
        "materials": [
            { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.4, "formulation": formulation },
            { "region": "body", "law": "fiber_family", "k1": "10 kPa", "k2": 0.5, "dispersion": 0.1, "fiber": &[0.6, 0.8, 0.0][..dim] },
        ],
        "supports": [ { "surface": "x-", "fix": &["x", "y", "z"][..dim] } ],
        "loads": [ { "surface": "x+", "traction": &["1 kPa", "3 kPa", "2 kPa"][..dim] } ],
    })
}

#[test]
fn every_formulation_solves_and_is_shown() {
    for formulation in Formulation::ALL {
        for &kind in formulation.kinds() {
            let (place, case) = (CaseDirectory::new(), block(kind, formulation.name()).to_string());
            let checked = place.run(Command::Check, &case, &[]).unwrap().result;
            let materials = &checked["materials"];
            assert_eq!(materials[0]["formulation"], formulation.name());
            assert_eq!(materials[1]["formulation"], Value::Null, "a law that names none has that of the others");
            let message = checked_lines(&place, &case);
            let shown =
                format!("; formulation {formulation}{}", if formulation.takes_patches(kind) { " over " } else { "\n" });
            assert!(message.contains(&shown), "{kind}: {message}");
            let solved =
                place.run(Command::Solve, &case, &[]).unwrap_or_else(|error| panic!("{formulation} {kind}: {error}"));
            assert!(solved.result["min_J"].as_f64().unwrap() > 0.5, "{formulation} {kind}");
        }
    }
}

/// What `check` prints.
fn checked_lines(place: &CaseDirectory, case: &str) -> String {
    let heard = Heard::default();
    place.run_with(Command::Check, case, &Console::new(heard.clone()), &place.options(&[])).unwrap();
    heard.text()
}

#[test]
fn mistakes_are_told_where_they_stand() {
    let message = |case: Value| problems(&case.to_string());
    let unknown = message(block(CellKind::Hex8, "mean_dilation"));
    assert!(unknown.contains("unknown formulation \"mean_dilation\": did you mean \"mean_dilatation\"?"), "{unknown}");
    let kind = message(block(CellKind::Hex20, "mean_dilatation"));
    assert!(
        kind.contains("materials/0/formulation") && kind.contains("hex8, quad4, tet10, tri6, tet4, tri3"),
        "{kind}"
    );
    let mut two = block(CellKind::Hex8, "mean_dilatation");
    two["materials"][1]["formulation"] = json!("standard");
    let two = message(two);
    assert!(two.contains("materials/1/formulation") && two.contains("choose one"), "{two}");
}

/// Every formulation stands in the schema with what it is for.
#[test]
fn the_schema_has_the_catalogue() {
    let schema = json_schema(&Catalogue::standard());
    let words = schema["$defs"]["Formulation"]["oneOf"].as_array().unwrap();
    let names: Vec<&str> = words.iter().map(|word| word["const"].as_str().unwrap()).collect();
    assert_eq!(names, Formulation::ALL.map(Formulation::name));
    for (word, formulation) in words.iter().zip(Formulation::ALL) {
        let about = word["description"].as_str().unwrap();
        assert!(about.contains(formulation.about()) && about.contains(formulation.kinds()[0].name()), "{about}");
    }
}
