//! Surfaces that move in time, in case files: by given values and as controls.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use nastic_run::run::Exit;
use serde_json::Value;

/// A bar of silicone, 100 mm long, on a base.
fn case(time: &str, base: &str, blocks: &str) -> String {
    format!(
        r#"{{ "nastic": 1,
        "mesh": {{ "box": {{ "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3" }} ],
        "probes": [ {{ "name": "tip", "point": [0.1, 0.005, 0.005] }}, {{ "name": "foot", "point": [0, 0.005, 0.005] }} ],
        "time": {{ "end": "20 ms", "step": "1 ms"{time} }},
        "actuation": [ {{ "name": "base", "kind": "motion", "surface": "x-"{base} }} ]{blocks} }}"#
    )
}

fn moved(result: &Value, probe: &str) -> Vec<f64> {
    result["probes"][probe]["displacement"].as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect()
}

fn solve(place: &CaseDirectory, text: &str) -> Value {
    place.run(Command::Solve, text, &[]).unwrap().result
}

/// The same motion by formulas, from a table and as controls in time.
#[test]
fn formulas_tables_and_controls_move_a_base_alike() {
    let place = CaseDirectory::new();
    let formulas =
        r#", "translation": [0, 0, "0.2 m/s * max(t - 5 ms, 0)"], "rotation": [0, "10 * max(t - 5 ms, 0) / (1 s)", 0]"#;
    place.write("base.csv", "t,z,rz,x\n0,0,0,0\n0.005,0,0,0\n0.02,0.003,0.15,0\n");
    let table = r#", "translation": { "file": "base.csv", "columns": ["x", "x", "z"] },
        "rotation": { "file": "base.csv", "columns": ["x", "rz", "x"] }"#;
    let controls = r#", "controls": [
        { "of": "base.translation", "space": "uniform", "start": [0, 0, "0.2 m/s * max(t - 5 ms, 0)"], "max_norm": 1, "in_time": { "every": "5 ms" } },
        { "of": "base.rotation", "space": "uniform", "direction": "y", "start": "10 * max(t - 5 ms, 0) / (1 s)", "lower": -1, "upper": 1,
          "in_time": { "every": "5 ms" } } ]"#;
    let given = solve(&place, &case("", formulas, ""));
    let angle: f64 = 0.15;
    // the foot lies in the middle of the surface, about which it turns; a free end follows later
    let (foot, tip) = (moved(&given, "foot"), moved(&given, "tip"));
    assert!(foot.iter().zip([0.0, 0.0, 0.003]).all(|(u, exact)| (u - exact).abs() < 1e-12), "{foot:?}");
    assert!(tip[2].abs() < 0.5 * (0.1 * angle.sin() - 0.003), "{tip:?}");
    for text in [case("", table, ""), case("", "", controls)] {
        let other = moved(&solve(&place, &text), "tip");
        assert!(tip.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-12), "{tip:?} {other:?}");
    }
}

/// A bar that begins with the speed of its base flies along with it: held nodes keep the velocity that is given.
#[test]
fn a_base_begins_with_the_velocity_of_the_case() {
    for scheme in ["tr_bdf2", "trapezoidal", "implicit_midpoint"] {
        let time = format!(r#", "start": "rest", "scheme": "{scheme}", "velocity": ["2 m/s", 0, 0]"#);
        let result = solve(&CaseDirectory::new(), &case(&time, r#", "translation": ["2 m/s * t", 0, 0]"#, ""));
        let tip = moved(&result, "tip");
        assert!((tip[0] - 0.04).abs() < 1e-12 && tip[1].abs() < 1e-12, "{scheme}: {tip:?}");
    }
}

#[test]
fn controls_of_a_base_in_time_have_a_right_gradient() {
    let blocks = r#", "controls": [
        { "of": "base.translation", "space": "uniform", "start": ["1 m/s * t", 0, "0.5 m/s * t"], "max_norm": 0.1, "rate": "3 m/s",
          "in_time": { "every": "5 ms" } },
        { "of": "base.rotation", "name": "turn", "space": "uniform", "direction": "y", "start": "5 * t / (1 s)", "lower": -1, "upper": 1,
          "in_time": { "every": "10 ms" } } ],
      "costs": [
        { "kind": "position", "surface": "x+", "weight": 1e4, "target": { "z": "0.02 m" } },
        { "kind": "kinetic_energy", "weight": 10 },
        { "kind": "control_rate", "of": "turn", "weight": 1e-3 } ]"#;
    let place = CaseDirectory::new();
    let text = case("", "", blocks);
    let outcome = place.run(Command::Gradcheck, &text, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    let optimum = place.run(Command::Optimize, &text, &["optimizer/max_iterations=5"]).unwrap().result;
    assert!(optimum["cost"]["total"].as_f64() < optimum["start"]["cost"]["total"].as_f64());
}

#[test]
fn what_a_base_cannot_do_in_time_is_told() {
    let elsewhere = case(r#", "start": "rest""#, r#", "translation": ["1 mm", 0, 0]"#, "");
    let error = problems(&elsewhere);
    assert!(
        error.contains("actuation/0/translation: is not zero at t = 0") && error.contains("equilibrium"),
        "{error}"
    );
    let controlled = r#", "controls": [ { "of": "base.translation", "space": "uniform", "max_norm": 1, "in_time": { "every": "5 ms" } } ],
        "costs": [ { "kind": "actuation_work" } ]"#;
    let found = problems(&case("", "", controlled));
    assert!(found.contains("base.translation") && found.contains("\"control_rate\""), "{found}");
    // the control of a base may not be elsewhere than a body at rest
    let bounded = |upper: &str| {
        let control = format!(
            r#", "controls": [ {{ "of": "base.translation", "space": "uniform", "direction": "z", "lower": 0, "upper": {upper}, "in_time": {{ "every": "5 ms" }} }} ]"#
        );
        problems(&case(r#", "start": "rest""#, "", &control))
    };
    assert!(bounded("0.01").contains("controls/0: may move its surface away at t = 0"), "{}", bounded("0.01"));
    assert_eq!(bounded(r#""1 m/s * t""#), "");
    // the length of a translation is one
    let length = |most: &str| {
        problems(&case(
            "",
            "",
            &format!(
                r#", "controls": [ {{ "of": "base.translation", "space": "uniform", "max_norm": "{most}", "in_time": {{ "every": "5 ms" }} }} ]"#
            ),
        ))
    };
    assert_eq!(length("20 mm"), "");
    assert!(
        length("20 mT").contains("controls/0/max_norm: ") && length("20 mT").contains("length"),
        "{}",
        length("20 mT")
    );
    assert!(length("20 mm * (X > 0)").contains("depends on X, Y or Z"), "{}", length("20 mm * (X > 0)"));
    let found = problems(&case("", r#", "translation": ["1 m * X * t / (1 m * 1 s)", 0, 0]"#, ""));
    assert!(found.contains("has one translation: give numbers"), "{found}");
}

/// Steps that were found for a tolerance keep it: the nodes that are held count neither when they are found nor when the result is judged.
#[test]
fn steps_of_a_tolerance_keep_it_beside_a_surface_that_moves() {
    let text = case("", r#", "translation": [0, 0, "3 mm * sin(600 * t / (1 s)) * min(t / (5 ms), 1)"]"#, "");
    let text = text.replace(r#""step": "1 ms""#, r#""tolerance": "5 um""#);
    let result = solve(&CaseDirectory::new(), &text);
    let error = result["time"]["step_error"]["largest"].as_f64();
    assert!(error.is_some_and(|error| error > 0.0 && error <= 5e-6), "{}", result["time"]);
}

#[test]
fn what_does_not_go_with_a_motion_is_told_before_it_begins() {
    let moves = r#", "translation": [0, 0, "1 m/s * t"]"#;
    let found = problems(&case(r#", "scheme": "siere""#, moves, ""));
    assert!(found.contains("time/scheme: siere does not go with \"base\""), "{found}");
    let viscous = case(r#", "scheme": "siere""#, "", "")
        .replace(r#""poisson": 0.3"#, r#""poisson": 0.3, "maxwell": [ { "shear": "10 kPa", "relaxation": "5 ms" } ]"#);
    assert!(
        problems(&viscous).contains("time/scheme: siere does not go with \"viscous laws\""),
        "{}",
        problems(&viscous)
    );
    let away = problems(&case(r#", "start": "rest""#, r#", "translation": [0, 0, "1 mm * cos(t / (1 s))"]"#, ""));
    assert!(away.contains("actuation/0/translation: is not zero at t = 0"), "{away}");
    let knots = r#", "controls": [ { "of": "base.translation", "space": "uniform", "direction": "z", "lower": 0, "upper": "1 m/s * t",
        "in_time": { "every": "1e-15 s" } } ]"#;
    let found = problems(&case("", "", knots).replace(r#""step": "1 ms""#, r#""tolerance": "5 um""#));
    assert!(found.contains("controls/0/in_time/every: more than 1000000 knots"), "{found}");
}
