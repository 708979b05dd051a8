//! Loads that change in time: against equilibria, free falls and a table; with the derivative of a motion under them.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use serde_json::Value;

/// A bar of silicone, 100 mm long.
fn case(time: &str, blocks: &str) -> String {
    let time = if time.is_empty() { String::new() } else { format!(r#", "time": {{ {time} }}"#) };
    format!(
        r#"{{ "nastic": 1,
        "mesh": {{ "box": {{ "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3" }} ],
        "probes": [ {{ "name": "tip", "point": [0.1, 0.005, 0.005] }} ]{time}{blocks} }}"#
    )
}

const HELD: &str = r#", "supports": [ { "surface": "x-", "fix": "all" } ]"#;
const STEPS: &str = r#""end": "20 ms", "step": "1 ms", "scheme": "quasi_static""#;

fn traction(z: &str) -> String {
    format!(r#"{HELD}, "loads": [ {{ "surface": "x+", "traction": ["2 kPa * Y / (10 mm)", 0, {z}] }} ]"#)
}

fn tip(result: &Value) -> Vec<f64> {
    result["probes"]["tip"]["displacement"].as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect()
}

fn solve(text: &str) -> Value {
    CaseDirectory::new().run(Command::Solve, text, &[]).unwrap().result
}

/// At every instant the equilibrium under the load of that instant, over the surface as well; a table says the same.
#[test]
fn a_traction_in_time_is_that_of_its_instant() {
    let moved = tip(&solve(&case(STEPS, &traction("\"-50 Pa * sin(t / (20 ms))\""))));
    let still = tip(&solve(&case("", &traction(&format!("\"-50 Pa * {}\"", 1f64.sin())))));
    assert!(moved[2] < -1e-3, "{moved:?}");
    assert!(moved.iter().zip(&still).all(|(a, b)| (a - b).abs() < 1e-8), "{moved:?} {still:?}");
    let place = CaseDirectory::new();
    place.write("load.csv", "t,x,y,z\n0,0,0,0\n0.02,0,0,-40\n");
    let table = format!(
        r#"{HELD}, "loads": [ {{ "surface": "x+", "traction": {{ "file": "load.csv", "columns": ["x", "y", "z"] }} }} ]"#
    );
    let of_table = tip(&place.run(Command::Solve, &case(STEPS, &table), &[]).unwrap().result);
    let formula = r#", "loads": [ { "surface": "x+", "traction": [0, 0, "-40 Pa * t / (20 ms)"] } ]"#;
    let of_formula = tip(&solve(&case(STEPS, &format!("{HELD}{formula}"))));
    assert!(of_table.iter().zip(&of_formula).all(|(a, b)| (a - b).abs() < 1e-12), "{of_table:?} {of_formula:?}");
}

/// A body that a force per volume f t accelerates evenly moves by f t^3/(6 rho), up to the error of the scheme.
#[test]
fn a_body_force_in_time_moves_a_free_body() {
    let force = r#", "loads": [ { "region": "body", "body_force": [0, 0, "1e6 * t / (1 s)"] } ]"#;
    let motion = r#""end": "20 ms", "step": "0.5 ms", "start": "rest""#;
    let found = tip(&solve(&case(motion, force)))[2];
    let exact = 1e6 / 1e3 * 0.02f64.powi(3) / 6.0;
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
}

/// A gravity g t of two materials moves a free body by g t^3/6, whatever their densities; at an instant it is the weight of that instant.
#[test]
fn a_gravity_in_time() {
    let pulled = |z: &str| format!(r#", "loads": [ {{ "gravity": [0, 0, {z}] }} ]"#);
    let motion = r#""end": "20 ms", "step": "0.5 ms", "start": "rest""#;
    let found = tip(&solve(&case(motion, &pulled("\"-400 m/s^2 * t / (1 s)\""))))[2];
    let exact = -400.0 * 0.02f64.powi(3) / 6.0;
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
    let held = |z: &str| format!("{HELD}{}", pulled(z));
    let moved = tip(&solve(&case(STEPS, &held("\"-2 m/s^2 * sin(t / (20 ms))\""))));
    let still = tip(&solve(&case("", &held(&format!("\"-2 m/s^2 * {}\"", 1f64.sin())))));
    assert!(moved[2] < -1e-3, "{moved:?}");
    assert!(moved.iter().zip(&still).all(|(a, b)| (a - b).abs() < 1e-8), "{moved:?} {still:?}");
    let place = CaseDirectory::new();
    place.write("tilt.csv", "t,x,y,z\n0,0,0,0\n0.02,0,0,-1.5\n");
    let table =
        format!(r#"{HELD}, "loads": [ {{ "gravity": {{ "file": "tilt.csv", "columns": ["x", "y", "z"] }} }} ]"#);
    let of_table = tip(&place.run(Command::Solve, &case(STEPS, &table), &[]).unwrap().result);
    let of_formula = tip(&solve(&case(STEPS, &held("\"-1.5 m/s^2 * t / (20 ms)\""))));
    assert!(of_table.iter().zip(&of_formula).all(|(a, b)| (a - b).abs() < 1e-12), "{of_table:?} {of_formula:?}");
    let static_case = problems(&case("", &held("\"-1 m/s^2 * t / (1 s)\"")));
    assert!(static_case.contains("loads/0/gravity/2") && static_case.contains("the case is static"), "{static_case}");
    let in_space = problems(&case("", &held("\"-1 m/s^2 * X / (1 m)\"")));
    assert!(in_space.contains("gravity is the same everywhere"), "{in_space}");
}

/// The derivative by a control beside the load, and the work of actuations, which the load has no part in.
#[test]
fn the_derivative_of_a_motion_under_a_load_in_time_is_right() {
    let blocks = r#", "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
        "controls": [ { "of": "fibers", "space": "cell", "start": "-5 kPa", "lower": "-50 kPa", "upper": 0, "in_time": { "every": "10 ms" } } ],
        "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z + 1 mm"] },
                   { "kind": "actuation_work", "weight": 1 } ]"#;
    for scheme in ["tr_bdf2", "backward_euler"] {
        let motion = format!(r#""end": "20 ms", "step": "2 ms", "scheme": "{scheme}""#);
        let text = case(&motion, &format!("{}{blocks}", traction("\"-50 Pa * sin(t / (5 ms))\"")));
        CaseDirectory::new().run(Command::Gradcheck, &text, &[]).unwrap();
    }
    // without actuation nothing is spent, whatever the load does
    let idle = traction("\"-50 Pa * sin(t / (5 ms))\"") + &blocks.replace("\"-5 kPa\"", "0");
    let result = solve(&case(r#""end": "20 ms", "step": "2 ms""#, &idle));
    assert_eq!(result["cost"]["terms"]["actuation_work"], 0.0, "{}", result["cost"]);
}

#[test]
fn a_load_in_time_is_refused_where_nothing_moves() {
    let formula = problems(&case("", &traction("\"-50 Pa * t / (1 s)\"")));
    assert!(formula.contains("loads/0/traction/2") && formula.contains("the case is static"), "{formula}");
    let table = format!(
        r#"{HELD}, "loads": [ {{ "surface": "x+", "traction": {{ "file": "load.csv", "columns": ["x", "y", "z"] }} }} ]"#
    );
    let table = problems(&case("", &table));
    assert!(table.contains("loads/0/traction") && table.contains("the case is static"), "{table}");
}
