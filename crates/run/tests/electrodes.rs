//! Electrodes as designs of dielectric films: the field s E, layout and voltage together, stiffeners on a film.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_opt::Taylor;
use std::sync::Arc;

/// Two layers: a film whose electrodes and voltage are sought, and above it one whose density is.
const FILM: &str = r#"{ "nastic": 1, "units": "mm",
    "mesh": { "box": { "size": [8, 0.6], "cells": [12, 2], "element": "quad8" } },
    "regions": [ { "name": "film", "inside": { "box": { "low": [0, 0, -1], "high": [8, 0.3, 1] } } },
                 { "name": "cover", "inside": { "box": { "low": [0, 0.3, -1], "high": [8, 0.6, 1] } } } ],
    "materials": [ { "region": "film", "law": "neo_hooke_isochoric", "shear": "100 kPa", "bulk": "1 MPa" },
                   { "region": "cover", "law": "neo_hooke_isochoric", "shear": "100 kPa", "bulk": "1 MPa",
                     "design": [ { "name": "rho", "kind": "density", "least": 0.01 } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "actuation": [ { "name": "voltage", "kind": "dielectric", "region": "film", "direction": [0, 1, 0], "relative_permittivity": 3,
                     "design": [ { "name": "electrode", "kind": "electrode" } ] } ],
    "controls": [ { "of": "electrode", "space": "cell", "start": "0.3 + 0.04 * X / (1 mm)", "filter": "0.8 mm", "projection": { "sharpness": 2 } },
                  { "of": "voltage", "space": "uniform", "start": "12 kV/mm", "lower": 0, "upper": "30 kV/mm" },
                  { "of": "rho", "space": "cell", "start": "0.9 - 0.05 * X / (1 mm)", "filter": "0.8 mm" } ],
    "costs": [ { "kind": "tracking", "surface": "y+", "target": ["X", "Y + 0.02 * X * X / (1 mm)"] },
               { "kind": "design_volume", "of": "electrode", "weight": 0.01 } ],
    "constraints": [ { "cost": { "kind": "design_volume", "of": "rho" }, "at_most": 0.8 } ],
    "optimizer": { "method": "mma", "max_iterations": 6, "tolerance": 1e-9 } }"#;

#[test]
fn derivatives_by_electrodes_and_voltage_have_their_orders() {
    let place = CaseDirectory::new();
    let name = place.path("case.json").display().to_string();
    let lowered = CaseProblem::lower(Document::parse(&name, FILM).unwrap(), Arc::default()).unwrap();
    let taylor = Taylor { directions: 2, second: true, ..Taylor::default() };
    let report = taylor.test(&lowered.ensemble, &lowered.set, &lowered.start).unwrap();
    assert!(report.passed(), "{report}");
    for direction in &report.directions {
        assert!(direction.order1 > 1.95 && direction.second.as_ref().unwrap().order > 2.95, "{direction:?}");
    }
}

/// E0 = s E: half an electrode at twice the voltage is a whole one.
#[test]
fn an_electrode_is_a_share_of_the_field() {
    let plain = with(
        FILM,
        "\"0.3 + 0.04 * X / (1 mm)\", \"filter\": \"0.8 mm\", \"projection\": { \"sharpness\": 2 }",
        "SHARE",
    );
    let energy = |share: f64, field: &str| {
        let case = plain.replace("SHARE", &share.to_string()).replace("\"12 kV/mm\"", &format!("\"{field}\""));
        let found = CaseDirectory::new().run(Command::Solve, &case, &[]).unwrap().result;
        found["cost"]["terms"]["tracking"].as_f64().unwrap()
    };
    let [whole, half, less] = [energy(1.0, "10 kV/mm"), energy(0.5, "20 kV/mm"), energy(0.5, "10 kV/mm")];
    assert!((half / whole - 1.0).abs() < 1e-9, "{half} {whole}");
    assert!((less / whole - 1.0).abs() > 0.01, "{less} {whole}");
}

/// Layout, voltage and stiffeners in one optimisation; electrodes are cut and solved once more.
#[test]
fn electrodes_voltage_and_stiffeners_are_sought_together() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, FILM, &[]).unwrap().result;
    let [start, end] = [&found["start"], &found].map(|state| state["cost"]["total"].as_f64().unwrap());
    assert!(end < 0.5 * start, "{start} {end}");
    assert!(found["cut_cost"].as_f64().is_some_and(|cut| cut > 0.0 && cut != end), "{found}");
    let controls = &found["controls"];
    assert!(controls["rho"]["volume"].as_f64().unwrap() < 0.8 + 1e-3, "{controls}");
    assert!(controls["voltage"]["voltage"]["max"].as_f64().is_some_and(|volts| volts > 1e3), "{controls}");
    for name in ["design_electrode.stl", "design_electrode_rest.stl", "design.3mf"] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
}

#[test]
fn electrodes_of_what_is_no_film_are_refused() {
    let fibers = with(
        FILM,
        "\"dielectric\", \"region\": \"film\", \"direction\": [0, 1, 0], \"relative_permittivity\": 3",
        "\"fiber_tension\", \"region\": \"film\", \"direction\": [0, 1, 0]",
    );
    let told = common::problems(&fibers);
    let expected =
        "actuation/0/design/0/kind: electrodes cover a \"dielectric\", not a \"fiber_tension\": take \"factor\"";
    assert!(told.contains(expected), "{told}");
    let material = with(FILM, "\"kind\": \"density\", \"least\": 0.01", "\"kind\": \"electrode\"");
    assert!(common::problems(&material).contains("materials/1/design/0/kind: electrodes cover a \"dielectric\""));
}

/// The true field is that of s E: none without electrodes, half of it behind half of one.
#[test]
fn the_true_field_is_that_of_electrodes() {
    let plain = with(
        FILM,
        "\"0.3 + 0.04 * X / (1 mm)\", \"filter\": \"0.8 mm\", \"projection\": { \"sharpness\": 2 }",
        "SHARE",
    );
    let field = |share: &str| {
        let place = CaseDirectory::new();
        place.run(Command::Solve, &plain.replace("SHARE", share).replace("12 kV/mm", "1 kV/mm"), &[]).unwrap();
        let shown = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
        let array = shown.cell_data.iter().find(|array| array.name == "true_field_voltage").unwrap();
        array.values.iter().copied().filter(|value| value.is_finite()).fold(0.0_f64, f64::max)
    };
    let [none, half, whole] = ["0", "0.5", "1"].map(field);
    assert!(none == 0.0 && (half / whole - 0.5).abs() < 0.01, "{none} {half} {whole}");
}
