//! Shapes by the nodes of the skin in cases: what they take, what is refused, what results have of them.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use serde_json::Value;

/// A heavy beam that is drawn straight, the upper side of which is sought beside the tension of its fibres such that it hangs most.
const BEAM: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.02], "cells": [10, 2], "element": "quad8" } },
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.4, "density": "1100 kg/m^3" } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "gravity": [0, "-9.81 m/s^2"] } ],
    "actuation": [ { "name": "back", "kind": "free_shape", "region": "body", "surface": "y+", "keep": "y-", "filter": "10 mm" },
                   { "name": "fibre", "kind": "fiber_tension", "region": "body", "direction": [1, 0] } ],
    "controls": [ { "of": "back", "space": "node", "start": "-1 mm * X / 0.1 m", "lower": "-18 mm", "upper": "5 mm" },
                  { "of": "fibre", "space": "uniform", "lower": "-2 kPa", "upper": 0 } ],
    "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, 1] } ],
    "constraints": [ { "name": "volume", "cost": { "kind": "shape_shrinkage", "exponent": 32 }, "at_most": 2 } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 60, "tolerance": 1e-4 } }"#;

fn number(result: &Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).unwrap().as_f64().unwrap()
}

/// The constraint holds det G off the bound that refuses states; the shape is written by node.
#[test]
fn a_shape_is_found_above_a_share_of_its_volume() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, BEAM, &[]).unwrap().result;
    let drawn = CaseDirectory::new()
        .run(Command::Solve, &with(BEAM, "\"start\": \"-1 mm * X / 0.1 m\", ", ""), &[])
        .unwrap()
        .result;
    assert!(number(&found, "cost/total") < 1.8 * number(&drawn, "cost/total"), "{found}");
    let [least, distortion] =
        ["least_det_G", "distortion"].map(|key| number(&found, &format!("contributions/back/{key}")));
    assert!(least > 0.4 && least < 0.6 && distortion > 1.05, "{least} {distortion}");
    let shown = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
    let back = shown.point_data.iter().find(|array| array.name == "back").unwrap().values.clone();
    let mesh = nastic_mesh::rectangle([0.1, 0.02], [10, 2], nastic_mesh::CellKind::Quad8).unwrap();
    for (x, s) in mesh.points().iter().zip(back.chunks_exact(3)) {
        let stays = x[0] == 0.0 || x[1] == 0.0;
        assert!(!stays || s.iter().all(|s| *s == 0.0), "{x:?} {s:?}");
    }
    assert!(back.iter().any(|s| s.abs() > 2e-3));
}

#[test]
fn derivatives_of_a_free_shape_are_right() {
    let place = CaseDirectory::new();
    let checked = place.run(Command::Gradcheck, BEAM, &[]).unwrap().result;
    assert!(number(&checked, "gradcheck/lowest_order") > 1.95, "{checked}");
    assert!(number(&checked, "gradcheck/second/lowest_order") > 2.95, "{checked}");
}

/// A beam that is held at both ends, whose back starts higher at one of them: drawn is the symmetric part. A plane across which nodes have no images is refused.
#[test]
fn a_skin_is_symmetric_where_it_shall_be() {
    let symmetric = |beam: &str| with(beam, "\"space\": \"node\"", "\"space\": \"node\", \"symmetry\": [\"x\"]");
    let held = with(BEAM, "\"supports\": [ { \"surface\": \"x-\"", "\"supports\": [ { \"surface\": [\"x-\", \"x+\"]");
    let held = symmetric(&with(&held, "\"surface\": \"x+\", \"direction\"", "\"surface\": \"y-\", \"direction\""));
    let place = CaseDirectory::new();
    let checked = place.run(Command::Gradcheck, &held, &[]).unwrap().result;
    assert!(number(&checked, "gradcheck/lowest_order") > 1.95, "{checked}");
    place.run(Command::Solve, &held, &[]).unwrap();
    let shown = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let back = shown.point_array("back").unwrap();
    let image_of = |x: &[f64; 3]| {
        let is_there = |y: &&[f64; 3]| (y[0] + x[0] - 0.1).abs() < 1e-9 && (y[1] - x[1]).abs() < 1e-9;
        shown.mesh.points().iter().position(|y| is_there(&y)).unwrap()
    };
    for (node, x) in shown.mesh.points().iter().enumerate() {
        let (own, image) = (back.at(node), back.at(image_of(x)));
        assert!((own[0] + image[0]).abs() < 1e-9 && (own[1] - image[1]).abs() < 1e-9, "{x:?} {own:?} {image:?}");
    }
    let largest = back.values.iter().fold(0.0, |largest: f64, s| largest.max(s.abs()));
    assert!((0.3e-3..0.6e-3).contains(&largest), "{largest}");
    let said = problems(&with(&symmetric(BEAM), "[\"x\"]", "[{ \"point\": [0.03, 0], \"normal\": [1, 0] }]"));
    assert!(said.contains("controls/0/symmetry/0") && said.contains("has no mirror image"), "{said}");
}

/// What is written and what is said of it.
#[test]
fn bad_skins_are_refused_where_they_stand() {
    let gravity = r#"{ "gravity": [0, "-9.81 m/s^2"] }"#;
    let traction = r#"{ "surface": "y+", "traction": [0, "-10 Pa"] }"#;
    let controls = &BEAM[BEAM.find("\"controls\"").unwrap()..BEAM.find("\"costs\"").unwrap()];
    let cases = [
        (
            with(BEAM, "\"surface\": \"y+\"", "\"surface\": \"x-\""),
            "controls/0",
            "cannot move \"x-\": x- holds all of its nodes where they are drawn",
        ),
        (
            with(BEAM, "\"filter\": \"10 mm\"", "\"filter\": \"1 mm\""),
            "controls/0",
            "shorter than the distance of the nodes of its skin",
        ),
        (with(BEAM, gravity, traction), "controls/0", "has a dead traction"),
        (with(BEAM, "\"filter\": \"10 mm\"", "\"filter\": \"-1 mm\""), "actuation/0/filter", "positive"),
        (with(BEAM, "\"surface\": \"y+\"", "\"surface\": \"y*\""), "actuation/0", "y*"),
        (with(BEAM, "\"space\": \"node\"", "\"space\": \"cell\""), "controls/0", "\"cell\""),
        (
            with(BEAM, "\"space\": \"node\"", "\"space\": \"node\", \"filter\": \"5 mm\""),
            "controls/0/filter",
            "by the \"filter\" of its actuation",
        ),
        (
            with(
                BEAM,
                "\"start\": \"-1 mm * X / 0.1 m\", \"lower\": \"-18 mm\"",
                "\"start\": \"-25 mm\", \"lower\": \"-30 mm\"",
            ),
            "controls/0/start",
            "of the volume of cell",
        ),
        (with(BEAM, "\"keep\": \"y-\"", "\"displacement\": \"1 mm\""), "actuation/0/displacement", "\"start\""),
        (
            with(
                BEAM,
                "\"name\": \"fibre\", \"kind\"",
                "\"name\": \"more\", \"kind\": \"free_shape\", \"region\": \"body\", \"surface\": \"y-\", \"filter\": \"10 mm\" }, { \"name\": \"fibre\", \"kind\"",
            ),
            "actuation",
            "changes no shape: give a control { \"of\": \"more\", \"space\": \"node\" }",
        ),
        (with(BEAM, controls, ""), "actuation/0", "changes no shape"),
    ];
    for (k, (text, at, expected)) in cases.iter().enumerate() {
        let said = problems(text);
        assert!(said.contains(at) && said.contains(expected), "{k}: {said}");
    }
    let shrinkage = with(
        BEAM,
        "\"kind\": \"free_shape\", \"region\": \"body\", \"surface\": \"y+\", \"keep\": \"y-\", \"filter\": \"10 mm\"",
        "\"kind\": \"fiber_tension\", \"region\": \"body\", \"direction\": [0, 1]",
    )
    .replace(
        "\"start\": \"-1 mm * X / 0.1 m\", \"lower\": \"-18 mm\", \"upper\": \"5 mm\"",
        "\"lower\": -1, \"upper\": 0",
    );
    let said = problems(&shrinkage);
    assert!(said.contains("constraints/0") && said.contains("the shape of the body does not change"), "{said}");
    let forced = with(BEAM, gravity, r#"{ "region": "body", "body_force": [0, "-10 N/m^3"] }"#);
    let said = CaseDirectory::new().text(Command::Check, &forced, &[]);
    assert!(said.contains("that per volume of the drawn body, whatever \"back\" makes of its shape"), "{said}");
}
