//! Learned laws in case files: in the case, in files of their own, from `nastic fit`; what is no such network.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, problems, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::fit;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const CASE: &str = r#"{ "nastic": 1,
    "units": "mm",
    "mesh": { "box": { "size": [100, 20, 20], "cells": [4, 1, 1], "element": "hex20" } },
    "materials": [ { "name": "rubber", "region": "body", "law": "convex_network",
        "network": { "inputs": ["I1b", "I2b^1.5"], "layers": [
            { "through": [[0.3, 0], [0.1, 0.2]], "bias": [-0.5, 0.2] },
            { "before": [[0.7, 0.2], [0.1, 0.5]], "bias": [0.1, -0.4] },
            { "through": [[0.2, 0.05]], "before": [[1.1, 0.6]] } ] },
        "scale": "20 kPa", "bulk": "0.4 MPa" } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": ["3 kPa", 0, "-300 Pa"] } ],
    "probes": [ { "name": "tip", "point": [100, 10, 10] } ] }"#;

/// The network of the case, as a program that trains writes it; in Pa.
fn file() -> Value {
    let case: Value = serde_json::from_str(CASE).unwrap();
    let mut network = case["materials"][0]["network"].clone();
    network["nastic_network"] = json!(1);
    network["scale"] = json!(20e3);
    network
}

/// The case with its network in a file.
fn by_file() -> String {
    let mut case: Value = serde_json::from_str(CASE).unwrap();
    case["materials"][0]["network"] = json!("rubber.json");
    case["materials"][0].as_object_mut().unwrap().remove("scale");
    case.to_string()
}

fn tip(result: &Value) -> Vec<f64> {
    result["probes"]["tip"]["displacement"].as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect()
}

fn solve(directory: &CaseDirectory, text: &str, set: &[&str]) -> Vec<f64> {
    tip(&directory.run(Command::Solve, text, set).unwrap().result)
}

#[test]
fn a_network_is_the_same_in_a_case_and_in_a_file() {
    let directory = CaseDirectory::new();
    fs::write(directory.path("rubber.json"), file().to_string()).unwrap();
    let (own, other) = (solve(&directory, CASE, &[]), solve(&directory, &by_file(), &[]));
    assert!(own[2] < -1.0 && own.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-9), "{own:?} {other:?}");
    // a scale beside the file replaces its own
    let stiffer = solve(&directory, &by_file(), &["materials/0/scale=40 kPa"]);
    assert!(stiffer[2] > 0.9 * own[2], "{stiffer:?}");
    let said = directory.text(Command::Check, CASE, &[]);
    assert!(said.contains("convex_network (learned") && said.contains("I1b, I2b^1.5 through 2, 2 units"), "{said}");
    let result = directory.run(Command::Check, CASE, &[]).unwrap().result;
    assert!(result.to_string().contains("\"polyconvex\":true"), "{result}");
}

#[test]
fn the_scale_is_a_control_with_exact_derivatives() {
    let controlled = with(
        CASE,
        "\"probes\"",
        r#""controls": [ { "of": "rubber.scale", "space": "uniform", "lower": "5 kPa", "upper": "80 kPa" } ],
           "costs": [ { "kind": "position", "surface": "x+", "target": { "z": 2 } } ], "probes""#,
    );
    let checked = CaseDirectory::new().run(Command::Gradcheck, &controlled, &[]).unwrap();
    assert_eq!(checked.exit, nastic_run::run::Exit::Done, "{}", checked.result);
}

#[test]
fn plane_strain_and_formulations_take_a_network() {
    let directory = CaseDirectory::new();
    let bulky = "materials/0/bulk=20 MPa";
    for (element, formulation) in
        [("hex20", "linear_dilatation"), ("hex8", "mean_dilatation"), ("tet10", "mean_dilatation")]
    {
        let set = [format!("mesh/box/element={element}"), format!("materials/0/formulation={formulation}")];
        let found = solve(&directory, CASE, &[&set[0], &set[1], bulky]);
        assert!(found[2] < -1.0 && found[2].is_finite(), "{element}: {found:?}");
    }
    let mut plane: Value = serde_json::from_str(CASE).unwrap();
    plane["mesh"]["box"] = json!({ "size": [100, 20], "cells": [4, 1], "element": "quad9" });
    plane["loads"][0]["traction"] = json!(["3 kPa", "-300 Pa"]);
    plane["probes"][0]["point"] = json!([100, 10]);
    let found = solve(&directory, &plane.to_string(), &[]);
    assert!(found[1] < -1.0, "{found:?}");
}

#[test]
fn what_is_no_network_is_told_where_it_stands() {
    for (from, to, place, told) in [
        (
            "[0.1, 0.5]]",
            "[0.1, -0.5]]",
            "materials/0/network/layers/1/before/1/1",
            "it must not be negative: the energy would not be polyconvex",
        ),
        (
            "\"bias\": [0.1, -0.4]",
            "\"bias\": [0.1]",
            "materials/0/network/layers/1/bias",
            "has 1 entries, but 2 are wanted",
        ),
        ("\"I2b^1.5\"", "\"I4b\"", "materials/0/network", "\"I4b\" is one of a fibre, and no \"fiber\" is given"),
        ("\"I2b^1.5\"", "\"I2b\"", "materials/0/network/inputs/1", "unknown input \"I2b\""),
        ("\"I2b^1.5\"", "\"I2\"", "materials/0/network/inputs", "free of the change of volume"),
        ("\"scale\": \"20 kPa\", ", "", "materials/0", "missing key \"scale\""),
        (
            "\"bulk\": \"0.4 MPa\"",
            "\"bulk\": \"0.4 MPa\", \"fiber\": \"x\"",
            "materials/0/network",
            "no input of the network is one of fibres",
        ),
        ("\"scale\": \"20 kPa\"", "\"scale\": \"-20 kPa\"", "materials/0/scale", "scale = -2e-2"),
        (
            "\"before\": [[1.1, 0.6]]",
            "\"befor\": [[1.1, 0.6]]",
            "materials/0/network/layers/2/befor",
            "did you mean \"before\"?",
        ),
    ] {
        let found = problems(&with(CASE, from, to));
        assert!(found.contains(place) && found.contains(told), "{to}:\n{found}");
    }
}

#[test]
fn what_is_wrong_in_a_file_is_told_by_its_line() {
    let directory = CaseDirectory::new();
    let told = |text: &str| {
        fs::write(directory.path("rubber.json"), text).unwrap();
        let error = directory.run(Command::Check, &by_file(), &[]).unwrap_err();
        format!("{error:?}")
    };
    let text = "{ \"nastic_network\": 1, \"scale\": 1e5, \"inputs\": [\"I1b\"],\n  \"layers\": [ { \"through\": [[-0.5]] } ] }";
    let error = told(text);
    assert!(
        error.contains("rubber.json:2:30: layers/0/through/0/0") && error.contains("must not be negative"),
        "{error}"
    );
    assert!(told(&text.replace("work\": 1", "work\": 2")).contains("version 2 of the format is not known: it is 1"));
    assert!(told(&text.replace("\"scale\": 1e5, ", "")).contains("missing key \\\"scale\\\""));
    assert!(told("{ \"a\": NaN }").contains("rubber.json:1:"));
    fs::remove_file(directory.path("rubber.json")).unwrap();
    assert!(format!("{:?}", directory.run(Command::Check, &by_file(), &[]).unwrap_err()).contains("cannot be read"));
}

/// Two tests of a rubber of W = 0.4 MPa (I1b - 3) + 0.02 MPa (I2b^1.5 - 3 sqrt 3).
fn write_data(directory: &Path, tests: &Value) {
    let table = |name: &str, of: &dyn Fn(f64) -> f64| {
        let rows: String = (1..24).map(|k| 1.0 + 0.05 * f64::from(k)).map(|l| format!("{l},{}\n", of(l))).collect();
        fs::write(directory.join(name), format!("stretch,nominal_stress [MPa]\n{rows}")).unwrap();
    };
    table("bar.csv", &|l| 0.8 * (l - l.powi(-2)) + 0.06 * (2.0 * l + l.powi(-2)).sqrt() * (1.0 - l.powi(-3)));
    let second = |l: f64| 0.06 * (l.powi(4) + 2.0 * l.powi(-2)).sqrt() * (l.powi(3) - l.powi(-3));
    table("sheet.csv", &|l| 0.8 * (l - l.powi(-5)) + second(l));
    let data = json!({ "nastic_fit": 1, "tests": tests, "laws": ["neo_hooke", "convex_network_1x4"], "bulk": "20 MPa", "starts": 3 });
    fs::write(directory.join("data.json"), data.to_string()).unwrap();
}

#[test]
fn a_fitted_network_is_written_judged_and_solved() {
    let directory = CaseDirectory::new();
    let (bar, sheet) =
        (json!({ "kind": "uniaxial", "file": "bar.csv" }), json!({ "kind": "equibiaxial", "file": "sheet.csv" }));
    let mut held_out = sheet.clone();
    held_out["held_out"] = json!(true);
    let path = directory.directory.path();
    let found = |tests: Value| {
        write_data(path, &tests);
        let heard = Heard::default();
        let console = Console::new(heard.clone());
        let found = fit(&path.join("data.json"), Some(path.join("fitted")), &console).unwrap().result;
        (found, heard.text())
    };
    let (result, text) = found(json!([bar, held_out]));
    assert_eq!(result["seen"]["missing"], json!(["equibiaxial", "planar"]));
    assert!(
        text.contains("WARNING: no test of kind equibiaxial, planar, and the others have seen I1 3.0000 to"),
        "{text}"
    );
    let network = result["laws"].as_array().unwrap().iter().find(|law| law["law"] == "convex_network_1x4").unwrap();
    assert!(network["r_squared"]["bar"].as_f64().unwrap() > 0.9999, "{}", network["r_squared"]);
    // what it was not trained on is judged, and another thing
    let unseen = network["r_squared"]["sheet"].as_f64().unwrap();
    assert_eq!(network["points"], 23);
    let (both, text) = found(json!([bar, sheet]));
    let network = both["laws"].as_array().unwrap().iter().find(|law| law["law"] == "convex_network_1x4").unwrap();
    assert_eq!(network["points"], 46);
    assert!(network["r_squared"]["sheet"].as_f64().unwrap() > 0.99, "{} {unseen}", network["r_squared"]);
    assert!(
        text.contains("no test of kind planar") && text.contains("16 numbers: fit_convex_network_1x4.json"),
        "{text}"
    );
    // the file and the block are the same material
    let mut case: Value = serde_json::from_str(CASE).unwrap();
    let own = |case: &Value| solve(&directory, &case.to_string(), &[]);
    case["materials"] = network["materials"].clone();
    let pasted = own(&case);
    case["materials"][0]["network"] = json!("fitted/fit_convex_network_1x4.json");
    case["materials"][0].as_object_mut().unwrap().remove("scale");
    let read = own(&case);
    assert!(
        pasted[0] > 0.1 && pasted.iter().zip(&read).all(|(a, b)| (a - b).abs() < 1e-6 * pasted[0]),
        "{pasted:?} {read:?}"
    );
    // the modulus at rest is 0.904 MPa
    let scale =
        serde_json::from_str::<Value>(&fs::read_to_string(path.join("fitted/fit_convex_network_1x4.json")).unwrap())
            .unwrap()["scale"]
            .as_f64()
            .unwrap();
    assert!((scale / 0.904e6 - 1.0).abs() < 0.2, "{scale}");
}
