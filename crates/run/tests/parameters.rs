//! Numbers of materials as controls: moduli found again from where a tip went, by their logarithms, by region, of a formula; messages for mistakes.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Options};
use serde_json::Value;

/// A bar of 0.1 m whose end sinks under its load as one of 300 kPa and 0.4 does; the control begins at 200 kPa.
const MODULUS: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02, 0.02], "cells": [6, 1, 1], "element": "hex20" } },
    "materials": [ { "name": "rubber", "region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.4 } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": ["1 kPa", 0, "-400 Pa"] } ],
    "controls": [ { "of": "rubber.young", "space": "uniform", "log": true, "start": "200 kPa", "lower": "50 kPa", "upper": "1 MPa" } ],
    "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z"] } ],
    "probes": [ { "name": "tip", "point": [0.1, 0.01, 0.01] } ],
    "optimizer": { "method": "lbfgs" } }"#;

fn run(command: Command, text: &str) -> Value {
    CaseDirectory::new().run(command, text, &[]).unwrap().result
}

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

/// The case that aims at where its tip goes with the moduli as they are written.
fn aimed(text: &str) -> String {
    let from = text.find("\"controls\"").unwrap();
    let to = text.find("\"probes\"").unwrap();
    let tip =
        run(Command::Solve, &format!("{}{}", &text[..from], &text[to..]))["probes"]["tip"]["displacement"].clone();
    let cost =
        format!(r#""costs": [ {{ "kind": "position", "point": [0.1, 0.01, 0.01], "target": {} }} ]"#, place(&tip));
    let costs = text.find("\"costs\"").unwrap();
    format!("{}{cost}, {}", &text[..costs], &text[to..])
}

fn place(tip: &Value) -> String {
    let u: Vec<f64> = tip.as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect();
    format!(r#"{{ "x": {:?}, "y": {:?}, "z": {:?} }}"#, 0.1 + u[0], 0.01 + u[1], 0.01 + u[2])
}

#[test]
fn a_modulus_is_found_again_and_results_have_its_value() {
    let case = aimed(MODULUS);
    let found = run(Command::Optimize, &case);
    assert!((number(&found, "controls/rubber.young/min") / 3e5 - 1.0).abs() < 1e-4, "{found}");
    let bounds = [number(&found, "controls/rubber.young/lower"), number(&found, "controls/rubber.young/upper")];
    assert_eq!((bounds, found["controls"]["rubber.young"]["unit"].as_str()), ([5e4, 1e6], Some("Pa")));
    let said = CaseDirectory::new().text(Command::Check, &case, &[]);
    assert!(said.contains("rubber.young: by uniform, 1 unknown by their logarithms, start 200000 Pa"), "{said}");
    // an upper bound alone, of one that a logarithm keeps positive
    CaseDirectory::new().text(Command::Check, &with(&case, r#""lower": "50 kPa", "#, ""), &[]);
    // without "start" it begins at the material's own value
    let own = CaseDirectory::new().text(Command::Check, &with(&case, r#""start": "200 kPa", "#, ""), &[]);
    assert!(own.contains("start 300000 Pa"), "{own}");
}

/// The derivative by the logarithm is E times that by E, and the gradient check passes with both, of a formula too.
#[test]
fn derivatives_are_those_by_the_unknown() {
    let case = aimed(MODULUS);
    let plain = with(&case, r#""log": true, "#, "");
    let of = |case: &str| number(&run(Command::Gradient, case), "derivative_norm/euclidean");
    let (log, plain_one) = (of(&case), of(&plain));
    assert!((log / (2e5 * plain_one) - 1.0).abs() < 1e-9, "{log} {plain_one}");
    let formula = with(
        &case,
        r#""law": "neo_hooke", "young": "300 kPa", "poisson": 0.4"#,
        r#""law": "formula", "energy": "mu / 2 * (I1 - 3 - 2 * log(J)) + la / 2 * (J - 1)^2", "parameters": { "mu": "100 kPa", "la": "400 kPa" }"#,
    );
    let formula = with(&formula, "rubber.young", "rubber.mu");
    for case in [case, plain, formula] {
        let checked = run(Command::Gradcheck, &case);
        assert_eq!(checked["gradcheck"]["passed"], true, "{checked}");
    }
}

/// A network of two layers as a formula, its weights one number each for the whole body: derivatives by all of them at once pass their check.
#[test]
fn weights_of_a_network_are_controls() {
    let (mut energy, mut parameters, mut controls) =
        ("k/2 * (J - 1)^2".to_owned(), r#""k": "1 MPa""#.to_owned(), vec![]);
    for (n, (a, b, w)) in [("0.9", "0.3", "120 kPa"), ("0.4", "0.8", "60 kPa")].iter().enumerate() {
        energy += &format!(" + w{n} * (log(1 + exp(a{n} * (I1 / J^(2/3) - 3) + b{n} * (I2 / J^(4/3) - 3))) - log(2))");
        parameters += &format!(r#", "a{n}": {a}, "b{n}": {b}, "w{n}": "{w}""#);
        controls.extend(
            ["a", "b", "w"]
                .map(|weight| format!(r#"{{ "of": "rubber.{weight}{n}", "space": "uniform", "log": true }}"#)),
        );
    }
    let network = format!(r#""law": "formula", "energy": "{energy}", "parameters": {{ {parameters} }}"#);
    let case = with(&aimed(MODULUS), r#""law": "neo_hooke", "young": "300 kPa", "poisson": 0.4"#, &network);
    let one = r#"{ "of": "rubber.young", "space": "uniform", "log": true, "start": "200 kPa", "lower": "50 kPa", "upper": "1 MPa" }"#;
    let checked = run(Command::Gradcheck, &with(&case, one, &controls.join(", ")));
    assert_eq!(checked["gradcheck"]["passed"], true, "{checked}");
}

/// Arrays have the values; gradients and records of iterations too, each what its name says.
#[test]
fn arrays_have_values_and_gradients_those_of_logarithms() {
    let place = CaseDirectory::new();
    let every = with(&aimed(MODULUS), r#""optimizer""#, r#""output": { "every": 1, "directory": "out" }, "optimizer""#);
    place.run(Command::Optimize, &every, &[]).unwrap();
    let range = |file: &str, array: &str| -> (f64, f64) {
        let read = nastic_io::read_array(place.path("out").join(file), array).unwrap();
        read.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
    };
    let close =
        |(low, high): (f64, f64), value: f64| (low / value - 1.0).abs() < 1e-6 && (high / value - 1.0).abs() < 1e-6;
    assert!(close(range("start.vtu", "rubber.young"), 2e5) && close(range("iteration_0000.vtu", "rubber.young"), 2e5));
    let (low, high) = range("start.vtu", "gradient_rubber.young");
    assert!(low == high && low < 0.0, "{low} {high}");
}

#[test]
fn ramps_are_of_loads_and_corners_of_bounds_are_looked_at() {
    let place = CaseDirectory::new();
    let options = Options { analysis: Analysis::Ramp("rubber.young=100 kPa:1 MPa:3".to_owned()), ..place.options(&[]) };
    let error = place.run_with(Command::Solve, MODULUS, &Console::silent(), &options).unwrap_err().to_string();
    assert!(error.contains("is a number of the body, which loads do not change"), "{error}");
    let two = with(MODULUS, r#""young": "300 kPa", "poisson": 0.4"#, r#""shear": "100 kPa", "bulk": "400 kPa""#);
    let two = with(
        &two,
        r#"{ "of": "rubber.young", "space": "uniform", "log": true, "start": "200 kPa", "lower": "50 kPa", "upper": "1 MPa" }"#,
        r#"{ "of": "rubber.shear", "space": "uniform", "lower": "50 kPa", "upper": "500 kPa" },
           { "of": "rubber.bulk", "space": "uniform", "lower": "100 kPa", "upper": "1 MPa" }"#,
    );
    let said = CaseDirectory::new().text(Command::Check, &two, &[]);
    assert!(
        said.contains("within the bounds of its controls, at shear = 500000, bulk = 100000, its law does not hold"),
        "{said}"
    );
}

#[test]
fn mistakes_are_told_where_they_stand() {
    for (from, to, told) in [
        ("rubber.young", "rubber.yuong", "no number of a material \"rubber.yuong\": did you mean \"rubber.young\"?"),
        ("rubber.young", "rubber.mu", "no number of a material \"rubber.mu\""),
        ("\"name\": \"rubber\", ", "", "no actuation \"rubber.young\""),
        ("\"name\": \"rubber\"", "\"name\": \"rub.ber\"", "a name must not contain \".\""),
        ("\"lower\": \"50 kPa\"", "\"lower\": \"-50 kPa\"", "has no logarithm"),
        ("\"lower\": \"50 kPa\"", "\"lower\": \"50 mm\"", "50 mm"),
        ("\"log\": true, \"start\": \"200 kPa\", \"lower\": \"50 kPa\", ", "", "needs a \"lower\" bound"),
        (
            "\"of\": \"rubber.young\", \"space\": \"uniform\", \"log\": true, \"start\": \"200 kPa\", \"lower\": \"50 kPa\", \"upper\": \"1 MPa\"",
            "\"of\": \"rubber.poisson\", \"space\": \"uniform\", \"lower\": 0.1, \"upper\": 0.6",
            "the bounds leave what its law admits: neo_hooke: poisson = 6e-1, but it must lie in [0, 1/2)",
        ),
        (
            "\"neo_hooke\", \"young\": \"300 kPa\", \"poisson\": 0.4",
            "\"gent\", \"mu\": \"100 kPa\", \"jm\": 30, \"bulk\": \"1 MPa\"",
            "no number of a material",
        ),
    ] {
        let error = CaseDirectory::new().run(Command::Check, &with(MODULUS, from, to), &[]).unwrap_err().to_string();
        assert!(error.contains(told), "{from} -> {to}: {error}");
    }
    let gent = with(
        MODULUS,
        "\"neo_hooke\", \"young\": \"300 kPa\", \"poisson\": 0.4",
        "\"gent\", \"mu\": \"100 kPa\", \"jm\": 30, \"bulk\": \"1 MPa\"",
    );
    let gent = with(
        &gent,
        "rubber.young\", \"space\": \"uniform\", \"log\": true, \"start\": \"200 kPa\", \"lower\": \"50 kPa\", \"upper\": \"1 MPa\"",
        "rubber.jm\", \"space\": \"uniform\", \"lower\": 20, \"upper\": 40",
    );
    let error = CaseDirectory::new().run(Command::Check, &gent, &[]).unwrap_err().to_string();
    assert!(error.contains("\"jm\" of gent cannot be an unknown: bulk, mu can"), "{error}");
    let varied = with(
        MODULUS,
        "\"probes\"",
        r#""scenarios": [ { "name": "soft", "set": { "materials/0/young": "200 kPa" } }, { "name": "stiff" } ], "probes""#,
    );
    let error = CaseDirectory::new().run(Command::Check, &varied, &[]).unwrap_err().to_string();
    assert!(error.contains("varies from scenario to scenario"), "{error}");
}
