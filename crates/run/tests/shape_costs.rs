//! Costs of positions, directions, curvatures and stretches in case files: an optimisation under a bound on the stretch, and mistakes.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common::CaseDirectory;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, run};
use std::path::PathBuf;

const CASE: &str = r#"{ "nastic": 1, "units": "mm",
    "mesh": { "box": { "size": [40, 6], "cells": [16, 2], "element": "quad9" } },
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.4 } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "actuation": [ { "name": "fibre", "kind": "fiber_tension", "region": "body", "direction": [1, 0] } ],
    "controls": [ { "of": "fibre", "space": "cell", "start": "5 kPa", "lower": 0, "upper": "80 kPa" } ],
    "costs": [
      { "name": "tip", "kind": "position", "point": [40, 3], "target": { "y": 10 }, "weight": 1 },
      { "name": "end", "kind": "orientation", "surface": "x+", "direction": [0.8, 0.6] },
      { "name": "line", "kind": "curvature", "line": [[4, 3], [12, 3], [20, 3], [28, 3], [36, 3]], "curvature": "1 / 60 mm", "weight": 100 } ],
    "constraints": [ { "name": "stretch", "cost": { "kind": "largest_stretch" }, "at_most": 1.01 } ],
    "optimizer": { "max_iterations": 150 } }"#;

fn write(name: &str, text: &str) -> PathBuf {
    let directory = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("shape_costs").join(name);
    std::fs::create_dir_all(&directory).unwrap();
    let path = directory.join("case.json");
    std::fs::write(&path, text).unwrap();
    path
}

fn optimize(name: &str, text: &str) -> serde_json::Value {
    let path = write(name, text);
    let options = Options { out: Some(path.with_file_name("out")), restart: true, ..Options::default() };
    let outcome = run(Command::Optimize, &path, &options, &Console::silent()).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    outcome.result
}

#[test]
fn a_strip_is_lifted_turned_and_bent_within_a_bound_on_its_stretch() {
    let result = optimize("lifted", CASE);
    let figure = |result: &serde_json::Value, term: &str, key: &str| result["figures"][term][key].as_f64().unwrap();
    assert!(result["cost"]["total"].as_f64() < result["start"]["cost"]["total"].as_f64().map(|cost| 0.2 * cost));
    let start = &result["start"];
    for (term, key) in [("tip", "position_distance"), ("end", "angle")] {
        assert!(figure(&result, term, key) < 0.8 * figure(start, term, key), "{term}: {}", result["figures"]);
    }
    assert!(figure(&result, "line", "mean_curvature") > 0.5 / 60.0, "{}", result["figures"]);
    assert!(result["constraints"]["violation"].as_f64().unwrap() < 1e-4, "{}", result["constraints"]);
    let free = optimize("free", &CASE.replace("1.01", "3"));
    assert!(free["cost"]["total"].as_f64() < result["cost"]["total"].as_f64(), "the bound is not active");
}

/// A bound on the compliance keeps fibres under tension that the position alone would relax.
#[test]
fn a_bound_on_the_compliance_keeps_a_stiffness() {
    let compliant = CASE.replace(
        "\"largest_stretch\" }, \"at_most\": 1.01",
        "\"compliance\", \"surface\": \"x+\", \"direction\": [0, 1] }, \"at_most\": 1e6",
    );
    let probe =
        |result: &serde_json::Value| result["constraints"]["groups"]["stretch"]["largest"].as_f64().unwrap() + 1e6;
    let free = probe(&optimize("soft", &compliant));
    let bound = 0.97 * free;
    let stiff = compliant.replace("\"at_most\": 1e6", &format!("\"at_most\": {bound}"));
    let result = optimize("stiff", &stiff);
    assert!(result["constraints"]["violation"].as_f64().unwrap() < 1e-4, "{}", result["constraints"]);
}

#[test]
fn mistakes_are_told_where_they_are() {
    let mistakes = [
        ("{ \"y\": 10 }", "{ }", ["costs/0/target", "at least one coordinate"]),
        ("{ \"y\": 10 }", "{ \"z\": 10 }", ["costs/0/target", "no component z"]),
        ("[40, 3]", "[41, 3]", ["costs/0/point", "nearest point"]),
        ("[0.8, 0.6]", "[0, 0]", ["costs/1/direction", ""]),
        ("\"x+\", \"direction\"", "\"tip\", \"direction\"", ["costs/1/surface", "\"tip\""]),
        ("[12, 3]", "[12, 33]", ["costs/2/line/1", "outside the body"]),
        ("\"1 / 60 mm\"", "\"60 mm\"", ["costs/2/curvature", "a curvature (1 over a length) is wanted"]),
        ("\"largest_stretch\"", "\"largest_stretch\", \"exponent\": 99", ["constraints/0/cost/exponent", "1 to 32"]),
    ];
    let compliance = "\"compliance\", \"surface\": \"x+\", \"direction\": [0, 1]";
    let newton = CASE.replace("\"max_iterations\"", "\"method\": \"gauss_newton\", \"max_iterations\"");
    let path = write("second", &newton.replacen("\"largest_stretch\"", compliance, 1));
    let refused = run(Command::Check, &path, &Options::default(), &Console::silent()).err().unwrap().to_string();
    assert!(refused.contains("constraints/0/cost") && refused.contains("no second derivatives"), "{refused}");
    let bed = "\"supports\": [ { \"surface\": \"y-\", \"foundation\": \"1 kPa / 1 mm\" }, ";
    let bedded = CASE.replacen("\"supports\": [ ", bed, 1);
    let path = write("bed", &bedded.replacen("\"largest_stretch\"", "\"pump_work\"", 1));
    let refused = run(Command::Check, &path, &Options::default(), &Console::silent()).err().unwrap().to_string();
    assert!(refused.contains("foundation on y-") && refused.contains("is not counted"), "{refused}");
    for (k, (from, to, wanted)) in mistakes.iter().enumerate() {
        assert!(CASE.contains(from), "{from}");
        let path = write(&format!("mistake_{k}"), &CASE.replacen(from, to, 1));
        let refused = run(Command::Check, &path, &Options::default(), &Console::silent());
        let Err(error) = refused else { panic!("{to} is accepted") };
        let text = error.to_string();
        assert!(wanted.iter().all(|part| text.contains(part)), "{to}: {text}");
    }
}

/// The error of an adjoint counts beside the energy norms of both solutions, a million times the derivative here: an adjoint known to 1e-9 left
/// 4e-4 of it, an order of 1.04.
#[test]
fn a_cable_and_the_compliance_of_an_incompressible_strip() {
    const STRIP: &str = r#"{ "nastic": 1, "title": "strip",
      "mesh": { "box": { "size": [0.1497679879458257, 0.014716274303207866], "cells": [7, 1], "element": "quad9" } },
      "materials": [ { "region": "body", "law": "gent", "mu": 37289.82534633326, "jm": 6.720112650528391, "bulk": 6611508.615086686,
                       "formulation": "linear_dilatation" } ],
      "supports": [ { "surface": "x-", "fix": "all" } ],
      "actuation": [ { "name": "cable", "kind": "tendon", "spacing": 0.02139542684940367,
                       "points": [[0, 0.014716274303207866], [0.04279085369880734, 0], [0.14976798794582566, 0.014716274303207866]] } ],
      "controls": [ { "of": "cable", "space": "uniform", "start": 47.34961766723281, "lower": 0, "upper": 946.9923533446563 } ],
      "costs": [ { "kind": "compliance", "surface": "x+", "direction": [0.15282378154997436, 0.9882534552394774, 0] } ] }"#;
    for set in ["controls/0/start=40", "controls/0/start=47.34961766723281", "materials/0/bulk=1e7"] {
        let found = CaseDirectory::new().run(Command::Gradcheck, STRIP, &[set]).unwrap();
        assert_eq!(found.exit, Exit::Done, "{set}: {}", found.result);
        let order = found.result["gradcheck"]["lowest_order"].as_f64().unwrap();
        assert!((1.98..2.02).contains(&order), "{set}: {order}");
    }
}
