//! The shape of the body in cases: what it takes, what is refused, what results have of it.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

/// A beam that is drawn straight and heavy, and of which the mould is asked for that its weight makes straight.
const BEAM: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02], "cells": [10, 2], "element": "quad8" } },
    "regions": [ { "name": "end", "inside": { "box": { "low": [0.05, 0, -1], "high": [0.1, 0.02, 1] } } } ],
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.4, "density": "1100 kg/m^3" } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "gravity": [0, "-9.81 m/s^2"] } ],
    "actuation": [ { "name": "mould", "kind": "shape", "region": "body",
                     "modes": { "bow": [0, "(X / 0.1 m)^2"], "bow3": [0, "(X / 0.1 m)^3"] } } ],
    "controls": [ { "of": "mould.bow", "space": "uniform", "lower": "-50 mm", "upper": "50 mm" },
                  { "of": "mould.bow3", "space": "uniform", "start": "1 mm", "lower": "-50 mm", "upper": "50 mm" } ],
    "costs": [ { "kind": "tracking", "surface": "y+", "target": ["X", "Y"], "weight": 1e6 } ],
    "optimizer": { "method": "gauss_newton", "tolerance": 1e-8 } }"#;

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

#[test]
fn a_mould_is_found_and_told_of() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, BEAM, &[]).unwrap().result;
    let flat = number(&found, "cost/total");
    let sag = number(
        &CaseDirectory::new().run(Command::Solve, &with(BEAM, "\"start\": \"1 mm\", ", ""), &[]).unwrap().result,
        "cost/total",
    );
    assert!(flat < 0.1 * sag, "{flat} of {sag}");
    let [least, distortion] =
        ["least_det_G", "distortion"].map(|key| number(&found, &format!("contributions/mould/{key}")));
    assert!((least - 1.0).abs() < 1e-6 && distortion > 1.01 && distortion < 1.5, "{least} {distortion}");
    let shown = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
    let array = |name: &str| shown.point_data.iter().find(|array| array.name == name).unwrap().values.clone();
    let (mould, moved) = (array("mould"), array("displacement"));
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(most(&mould) > 2.0 * most(&moved), "{} {}", most(&mould), most(&moved));
    // the tip of the mould is the sum of both amplitudes
    let amplitudes = number(&found, "controls/mould.bow/max") + number(&found, "controls/mould.bow3/max");
    assert!((most(&mould) - amplitudes.abs()).abs() < 1e-9, "{amplitudes}");
}

/// What is written and what is said of it.
#[test]
fn bad_shapes_are_refused_where_they_stand() {
    let modes = r#""modes": { "bow": [0, "(X / 0.1 m)^2"], "bow3": [0, "(X / 0.1 m)^3"] }"#;
    let cases = [
        (
            with(BEAM, "\"bow\": [0, \"(X / 0.1 m)^2\"]", "\"bow\": [0, \"1 - X / 0.1 m\"]"),
            "actuation/0/modes",
            "but x- holds it where it is drawn: let the mode be 0 there",
        ),
        (
            with(BEAM, "\"kind\": \"shape\", \"region\": \"body\"", "\"kind\": \"shape\", \"region\": \"end\""),
            "actuation/0",
            "where cells outside of",
        ),
        (
            with(BEAM, "\"start\": \"1 mm\"", "\"in_time\": { \"every\": \"1 s\" }"),
            "controls/1/in_time",
            "does not change in time",
        ),
        (
            with(BEAM, "\"of\": \"mould.bow\", \"space\": \"uniform\"", "\"of\": \"mould.bow\", \"space\": \"node\""),
            "controls/0/space",
            "take the space \"uniform\"",
        ),
        (with(BEAM, "mould.bow3\", \"space", "mould.bov\", \"space"), "controls/1/of", "mould.bow"),
        (with(BEAM, modes, "\"modes\": {}"), "actuation/0/modes", "at least one field is needed"),
        (with(BEAM, modes, &modes.replace("(X / 0.1 m)^2", "X")), "actuation/0/modes/bow", "m"),
        (
            with(BEAM, modes, &format!("{modes}, \"least_volume\": 1.5")),
            "actuation/0/least_volume",
            "at least 0 and below 1",
        ),
        (
            with(BEAM, "\"gravity\": [0, \"-9.81 m/s^2\"]", "\"gravity\": [0, \"-9.81 m/s^2 * t / 1 s\"]")
                .replace("\"optimizer\"", "\"time\": { \"end\": \"1 s\", \"step\": \"0.1 s\" }, \"optimizer\"")
                .replace("gauss_newton", "lbfgs"),
            "gravity",
            "does not follow the shape",
        ),
    ];
    for (k, (text, at, expected)) in cases.iter().enumerate() {
        let said = problems(text);
        assert!(said.contains(at) && said.contains(expected), "{k}: {said}");
    }
    let shorter = BEAM.replace("\"bow3\": [0, \"(X / 0.1 m)^3\"]", "\"bow3\": [\"X / 0.1 m\", 0]");
    let said = problems(&with(&shorter, "\"start\": \"1 mm\"", "\"start\": \"-95 mm\"").replace("-50 mm", "-99 mm"));
    assert!(said.contains("bow3") || said.contains("controls/1"), "{said}");
    assert!(said.contains("of their volume than the least share"), "{said}");
    let started = with(&shorter, "\"start\": \"1 mm\", \"lower\": \"-50 mm\"", "\"start\": \"-95 mm\"");
    let said = problems(&started);
    assert!(
        said.contains("leaves 0.05 of the volume of cell") && said.contains("more than 0.1 must be left"),
        "{said}"
    );
    let alone = with(BEAM, &BEAM[BEAM.find("\"controls\"").unwrap()..BEAM.find("\"costs\"").unwrap()], "");
    assert!(
        problems(&alone).contains("changes no shape: give a control { \"of\": \"mould.bow\""),
        "{}",
        problems(&alone)
    );
}

/// A dead load keeps the force of the drawn body, and `check` says so.
#[test]
fn a_dead_load_on_a_changing_surface_is_told_of() {
    let loaded = with(BEAM, "\"gravity\": [0, \"-9.81 m/s^2\"]", "\"surface\": \"y+\", \"traction\": [0, \"-10 Pa\"]");
    let said = CaseDirectory::new().text(Command::Check, &loaded, &[]);
    assert!(said.contains("that per area of the drawn body, whatever \"mould\" makes of its shape"), "{said}");
    let said = CaseDirectory::new().text(Command::Check, BEAM, &[]);
    assert!(!said.contains("of the drawn body, whatever"), "{said}");
}
