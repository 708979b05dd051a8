//! Dielectric bodies and electrodes in cases: results by voltage and by charge, derivatives, mistakes.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_case::lower::CaseProblem;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_opt::Taylor;
use std::sync::Arc;

/// A strip of two layers in millimetres, the lower one between a ground and an electrode that is a layer of cells.
const STRIP: &str = r#"{ "nastic": 1, "units": "mm",
    "mesh": { "box": { "size": [8, 0.6], "cells": [16, 4], "element": "quad8" } },
    "regions": [ { "name": "layer", "inside": { "box": { "low": [1, 0.29, -1], "high": [6, 0.46, 1] } } } ],
    "surfaces": [ { "name": "below", "inside": { "box": { "low": [0.9, -0.1, -1], "high": [6.1, 0.01, 1] } } } ],
    "materials": [ { "region": "body", "law": "neo_hooke_isochoric", "shear": "100 kPa", "bulk": "1 MPa" } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "actuation": [ { "name": "rubber", "kind": "dielectric_body", "region": "body", "relative_permittivity": 3, "breakdown": "80 kV/mm" },
                   { "name": "fibre", "kind": "muscle", "region": "body", "direction": [1, 0, 0] } ],
    "electrodes": [ { "name": "ground", "surface": "below", "voltage": 0 }, { "name": "inner", "region": "layer" } ],
    "controls": [ { "of": "inner", "space": "uniform", "start": "3 kV", "lower": "1 kV", "upper": "6 kV" },
                  { "of": "fibre", "space": "uniform", "start": "1 kPa", "lower": "0.1 kPa", "upper": "5 kPa" } ],
    "costs": [ { "kind": "tracking", "surface": "y+", "target": ["X", "Y + 0.02 * X * X / (1 mm)"] } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 6, "tolerance": 1e-9 } }"#;

const DRIVEN: &str = r#""name": "inner", "region": "layer""#;
const CONTROLS: &str = r#"{ "of": "inner", "space": "uniform", "start": "3 kV", "lower": "1 kV", "upper": "6 kV" },"#;

fn number(result: &serde_json::Value, path: &str) -> f64 {
    result.pointer(path).and_then(serde_json::Value::as_f64).unwrap_or_else(|| panic!("no {path} in {result}"))
}

/// The charge that a voltage gives leads back to it; results are in V and C, whatever the case's units.
#[test]
fn voltage_and_charge_lead_to_one_state() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, STRIP, &[]).unwrap().result;
    let of = |name: &str, what: &str| number(&found, &format!("/contributions/{name}/{what}"));
    let (voltage, charge) = (of("inner", "voltage"), of("inner", "charge"));
    assert!((voltage / 3e3 - 1.0).abs() < 1e-12, "{voltage}");
    assert!((of("inner", "capacitance") / (charge / voltage) - 1.0).abs() < 1e-12);
    assert!((of("ground", "charge") / charge + 1.0).abs() < 1e-9);
    // per millimetre of depth: 3 eps0 a/d of 5 mm over 0.3 mm, and what leaves at the edges
    let plates = 3.0 * 8.854e-15 * 5.0 / 0.3;
    assert!(charge / voltage > plates && charge / voltage < 1.2 * plates, "{charge} {voltage} {plates}");
    // in N mm
    assert!((of("rubber", "electric_energy") / (500.0 * charge * voltage) - 1.0).abs() < 1e-9, "{found}");
    assert_eq!(found["inertia"].as_u64(), Some(0), "{found}");
    let shown = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let potential = shown.point_data.iter().find(|array| array.name == "potential").unwrap();
    let most = potential.values.iter().copied().fold(0.0_f64, f64::max);
    assert!((most / voltage - 1.0).abs() < 1e-3, "{most}");
    let charged =
        STRIP.replace(DRIVEN, &format!("{DRIVEN}, \"charge\": \"{} nC\"", 1e9 * charge)).replace(CONTROLS, "");
    let same = CaseDirectory::new().run(Command::Solve, &charged, &[]).unwrap().result;
    assert!((number(&same, "/contributions/inner/voltage") / voltage - 1.0).abs() < 1e-6, "{same}");
    let tracked = |found: &serde_json::Value| number(found, "/cost/total");
    assert!((tracked(&same) / tracked(&found) - 1.0).abs() < 1e-6);
}

#[test]
fn derivatives_of_a_case_have_their_orders() {
    let place = CaseDirectory::new();
    let name = place.path("case.json").display().to_string();
    let lowered = CaseProblem::lower(Document::parse(&name, STRIP).unwrap(), Arc::default()).unwrap();
    let taylor = Taylor { directions: 2, second: true, ..Taylor::default() };
    let report = taylor.test(&lowered.ensemble, &lowered.set, &lowered.start).unwrap();
    assert!(report.passed(), "{report}");
    for direction in &report.directions {
        assert!(direction.order1 > 1.95 && direction.second.as_ref().unwrap().order > 2.95, "{direction:?}");
    }
    let found = place.run(Command::Optimize, STRIP, &[]).unwrap().result;
    let [start, end] = [&found["start"], &found].map(|state| number(state, "/cost/total"));
    assert!(end < 0.9 * start, "{start} {end}");
}

/// Every mistake in a sentence, at its place.
#[test]
fn mistakes_about_electrodes_are_told() {
    let drive = |keys: &str| STRIP.replace(DRIVEN, &format!("{DRIVEN}, {keys}")).replace(CONTROLS, "");
    let ground = "\"surface\": \"below\", \"voltage\": 0";
    let rows = [
        (drive("\"floating\": true, \"voltage\": \"1 kV\""), "electrodes/1/voltage: a floating electrode"),
        (
            drive("\"charge\": \"1 nC\", \"voltage\": \"1 kV\""),
            "electrodes/1/charge: an electrode has a \"voltage\" or",
        ),
        (drive("\"voltage\": 3000"), "electrodes/1/voltage: a plain number is in the case's units here, in "),
        (drive("\"voltage\": \"3 nC\""), "electrodes/1/voltage: "),
        (STRIP.replace(CONTROLS, ""), "electrodes/1: nothing drives \"inner\""),
        (with(STRIP, DRIVEN, "\"name\": \"inner\""), "electrodes/1: exactly one of"),
        (with(STRIP, DRIVEN, &format!("{DRIVEN}, \"nodes\": \"below\"")), "electrodes/1: exactly one of"),
        (
            with(STRIP, DRIVEN, &format!("{DRIVEN}, \"floating\": true")),
            "electrodes/1/floating: it floats, and a control",
        ),
        (with(STRIP, "\"of\": \"inner\"", "\"of\": \"iner\""), "no actuation \"iner\": did you mean \"inner\"?"),
        (with(STRIP, "\"surface\": \"below\", \"voltage\": 0", "\"region\": \"layer\", \"voltage\": 0"), "share node"),
        (
            with(STRIP, ground, "\"surface\": \"below\", \"floating\": true")
                .replace(DRIVEN, &format!("{DRIVEN}, \"charge\": \"1 nC\""))
                .replace(CONTROLS, ""),
            "electrodes: nothing determines the potential",
        ),
        (
            with(
                STRIP,
                "\"dielectric_body\", \"region\": \"body\", \"relative_permittivity\": 3, \"breakdown\": \"80 kV/mm\"",
                "\"turgor\", \"region\": \"body\", \"pressure\": \"1 Pa\"",
            ),
            "electrodes/0: electrodes are of a body with a potential",
        ),
        (
            with(STRIP, "\"relative_permittivity\": 3", "\"relative_permittivity\": 0.5"),
            "actuation/0/relative_permittivity: ",
        ),
        (
            with(STRIP, "\"costs\"", "\"linear_solver\": \"multigrid\", \"costs\""),
            "linear_solver: multigrid does not go with rubber",
        ),
    ];
    for (case, expected) in rows {
        let told = common::problems(&case);
        assert!(told.contains(expected), "{expected}: {told}");
    }
}

/// What does not go with a field is refused by name.
#[test]
fn commands_that_do_not_go_with_a_field_say_so() {
    let moving = STRIP.replace("\"costs\"", "\"time\": { \"end\": \"10 ms\", \"step\": \"1 ms\" }, \"costs\"");
    let moving = moving.replace("\"bulk\": \"1 MPa\"", "\"bulk\": \"1 MPa\", \"density\": \"1000 kg/m^3\"");
    let heavy = STRIP.replace("\"bulk\": \"1 MPa\"", "\"bulk\": \"1 MPa\", \"density\": \"1000 kg/m^3\"");
    for (command, case) in [(Command::Modes, heavy.as_str()), (Command::Solve, moving.as_str())] {
        let told = CaseDirectory::new().run(command, case, &[]).map(drop).unwrap_err().to_string();
        assert!(told.contains("potential"), "{told}");
    }
}

/// Beyond breakdown there is a warning.
#[test]
fn a_body_beyond_its_breakdown_strength_is_warned_about() {
    let weak = with(STRIP, "80 kV/mm", "5 kV/mm");
    let found = CaseDirectory::new().run(Command::Solve, &weak, &[]).unwrap().result;
    let warned = found["warnings"].to_string();
    assert!(warned.contains("rubber: the true field reaches") && warned.contains("unbounded_energy"), "{warned}");
}
