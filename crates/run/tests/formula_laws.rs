//! Laws whose energy is a formula, in case files: solves, parameters by scenario and over the body, messages for mistakes.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

const FORMULA: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02, 0.02], "cells": [4, 1, 1], "element": "hex20" } },
    "materials": [ { "region": "body", "law": "formula",
        "energy": "mu1 * (I1 - 3) + mu2 * (I2 - 3) + mu3 * (J - 1)^2 - 2 * (mu1 + 2 * mu2) * log(J)",
        "parameters": { "mu1": "20 kPa", "mu2": "5 kPa", "mu3": "0.2 MPa" } } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": ["3 kPa", 0, "-300 Pa"] } ],
    "probes": [ { "name": "tip", "point": [0.1, 0.01, 0.01] } ] }"#;

const FIBER: &str = r#""energy": "c * (exp(b * E_ff^2) - 1) + mu / 2 * (I1 - 3 - 2 * log(J)) + k / 2 * (J - 1)^2",
    "parameters": { "c": "2 kPa", "b": 8, "mu": "10 kPa", "k": "0.1 MPa" }, "fiber": [1, 0, 0]"#;

fn fibers() -> String {
    let from = FORMULA.find("\"energy\"").unwrap();
    let to = FORMULA[from..].find(" } ],").unwrap() + from;
    format!("{}{FIBER}{}", &FORMULA[..from], &FORMULA[to..])
}

fn tip(result: &Value) -> Vec<f64> {
    result["probes"]["tip"]["displacement"].as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect()
}

fn solve(text: &str, set: &[&str]) -> Value {
    CaseDirectory::new().run(Command::Solve, text, set).unwrap().result
}

#[test]
fn a_formula_of_mooney_and_rivlin_solves_as_their_law() {
    let formula = solve(FORMULA, &[]);
    let from = FORMULA.find("\"law\"").unwrap();
    let to = FORMULA[from..].find("} } ],").unwrap() + from;
    let built_in = r#""law": "mooney_rivlin", "mu1": "20 kPa", "mu2": "5 kPa", "mu3": "0.2 MPa" "#;
    let built_in = solve(&format!("{}{built_in}{}", &FORMULA[..from], &FORMULA[to + 2..]), &[]);
    let (a, b) = (tip(&formula), tip(&built_in));
    assert!(a[2] < -1e-3 && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12 * 0.1), "{a:?} {b:?}");
    assert_eq!(formula["solve"]["newton"], built_in["solve"]["newton"]);
}

#[test]
fn parameters_are_set_by_their_names() {
    let softer = tip(&solve(FORMULA, &["materials/0/parameters/mu1=10 kPa"]));
    let written = tip(&solve(&with(FORMULA, "\"mu1\": \"20 kPa\"", "\"mu1\": \"10 kPa\""), &[]));
    assert_eq!(softer, written);
    assert!(softer[0] > 1.2 * tip(&solve(FORMULA, &[]))[0]);
    // over the body: twice as stiff behind its middle
    let varying = tip(&solve(FORMULA, &["materials/0/parameters/mu1=20 kPa * (1 + (X > 50 mm))"]));
    assert!(varying[2] > tip(&solve(FORMULA, &[]))[2] && varying[2] < 0.0);
    let scenarios = with(
        FORMULA,
        "\"probes\"",
        r#""scenarios": [ { "name": "soft", "set": { "materials/0/parameters/mu1": "10 kPa" } }, { "name": "stiff" } ], "probes""#,
    );
    let result = solve(&scenarios, &[]);
    assert_eq!(tip(&result["scenarios"]["soft"]), softer, "{result}");
}

#[test]
fn fibres_stiffen_along_themselves() {
    let (with_fibers, without) = (tip(&solve(&fibers(), &[])), tip(&solve(&fibers(), &["materials/0/parameters/c=0"])));
    assert!(with_fibers[0] > 0.0 && with_fibers[0] < 0.9 * without[0], "{with_fibers:?} {without:?}");
    let said = CaseDirectory::new().text(Command::Check, &fibers(), &[]);
    assert!(said.contains("formula (an energy as a formula") && said.contains("c = 2 kPa"), "{said}");
}

#[test]
fn mistakes_in_formulas_are_told_where_they_stand() {
    for (from, to, place, told) in [
        ("mu1 * (I1", "mu4 * (I1", "materials/0/energy", "unknown name \"mu4\": did you mean \"mu1\"?"),
        ("\"mu3\": \"0.2 MPa\"", "\"mu3\": \"0.2 mm\"", "materials/0/energy", "cannot be added"),
        ("\"mu1\":", "\"mm\":", "materials/0/parameters/mm", "is a unit or a function"),
        ("(I1 - 3)", "(I1 - 2)", "materials/0/energy", "at rest, F = I, where an energy is 0"),
        ("- 2 * (mu1", "- 3 * (mu1", "materials/0/energy", "which must be free of stress: subtract"),
        (
            "\"mu3\": \"0.2 MPa\"",
            "\"mu3\": \"0.2 MPa\", \"c\": 3",
            "materials/0/energy",
            "does not name the parameter c",
        ),
        (
            "\"mu3\": \"0.2 MPa\" }",
            "\"mu3\": \"0.2 MPa\" }, \"fiber\": [1, 0, 0]",
            "materials/0/energy",
            "remove the direction",
        ),
        (
            "\"law\": \"formula\",",
            "\"law\": \"formula\", \"energie\": 3,",
            "materials/0/energie",
            "did you mean \"energy\"?",
        ),
    ] {
        let found = problems(&with(FORMULA, from, to));
        assert!(found.contains(place) && found.contains(told), "{to}:\n{found}");
    }
    let nameless = problems(&with(&fibers(), "\"fiber\": [1, 0, 0]", "\"density\": \"1000 kg/m^3\""));
    assert!(nameless.contains("give its direction, as \"fiber\": [1, 0, 0]"), "{nameless}");
}
