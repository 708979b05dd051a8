//! Motions of several materials and load cases, in plane strain, with lumped masses and in little memory.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, DRIVEN, with};
use nastic_language::schema::Command;
use nastic_run::run::Exit;
use serde_json::Value;

fn run(command: Command, text: &str) -> Value {
    let outcome = CaseDirectory::new().run(command, text, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    outcome.result
}

fn cost(result: &Value) -> f64 {
    result["cost"]["total"].as_f64().unwrap()
}

/// The mean over two materials is that of the two cases by themselves, and so is its derivative.
#[test]
fn scenarios_move_as_the_single_cases() {
    let young = |value: &str| with(DRIVEN, "0.3 MPa", value);
    let both = with(
        DRIVEN,
        r#""probes""#,
        r#""scenarios": [ { "name": "soft", "probability": 0.25, "set": { "materials/0/young": "0.2 MPa" } },
                         { "name": "stiff", "probability": 0.75, "set": { "materials/0/young": "0.4 MPa" } } ], "probes""#,
    );
    let (soft, stiff) = (run(Command::Gradient, &young("0.2 MPa")), run(Command::Gradient, &young("0.4 MPa")));
    let place = CaseDirectory::new();
    let found = place.run(Command::Gradient, &both, &[]).unwrap().result;
    let mean = 0.25 * cost(&soft) + 0.75 * cost(&stiff);
    assert!((cost(&found) / mean - 1.0).abs() < 1e-12, "{} {mean}", cost(&found));
    for (name, single) in [("soft", &soft), ("stiff", &stiff)] {
        let own = &found["scenarios"][name];
        assert_eq!(own["cost"]["total"], single["cost"]["total"], "{name}");
    }
    assert_eq!(
        run(Command::Gradcheck, &both)["gradcheck"]["verdict"],
        run(Command::Gradcheck, DRIVEN)["gradcheck"]["verdict"]
    );
    // each has its own motion
    place.run(Command::Solve, &both, &[]).unwrap();
    let files = place.files();
    for name in ["scenario_000_motion.csv", "scenario_001_motion.csv", "scenario_001_motion.pvd"] {
        assert!(files.iter().any(|file| file == name), "{name}: {files:?}");
    }
}

/// Load cases with motions of their own, and a control that both have.
#[test]
fn load_cases_move_under_their_own_loads() {
    let loads = |z: &str| format!(r#""loads": [ {{ "gravity": [0, 0, "{z} m/s^2"] }} ], "probes""#);
    let cases = r#""load_cases": [ { "name": "up", "loads": [ { "gravity": [0, 0, "9.81 m/s^2"] } ] },
                                  { "name": "down", "loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ] } ], "probes""#;
    let single = |z: &str| run(Command::Gradient, &with(DRIVEN, r#""probes""#, &loads(z)));
    let found = run(Command::Gradient, &with(DRIVEN, r#""probes""#, cases));
    let sum = cost(&single("9.81")) + cost(&single("-9.81"));
    assert!((cost(&found) / sum - 1.0).abs() < 1e-12, "{} {sum}", cost(&found));
}

/// Few states in memory: the same numbers to the bit; what they take is reported by `check`.
#[test]
fn little_memory_gives_the_same_bits() {
    let gradient = |text: &str| {
        let result = run(Command::Gradient, text);
        (result["cost"].to_string(), result["gradient_norm"].to_string(), result["derivative"].to_string())
    };
    let long = with(DRIVEN, r#""step": "1 ms""#, r#""step": "0.2 ms""#);
    let little = with(&long, r#""step": "0.2 ms""#, r#""step": "0.2 ms", "memory": 0.2"#);
    assert_eq!(gradient(&long), gradient(&little));
    let message = CaseDirectory::new().text(Command::Check, &little, &[]);
    assert!(message.contains("computed again"), "{message}");
}

/// Free fall in the plane, exact for schemes of second order, whatever the mass matrix.
#[test]
fn plane_bodies_fall_with_consistent_and_lumped_masses() {
    for mass in ["consistent", "lumped"] {
        let text = format!(
            r#"{{ "nastic": 1,
            "mesh": {{ "box": {{ "size": [0.1, 0.02], "cells": [4, 1], "element": "quad9" }} }},
            "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3" }} ],
            "loads": [ {{ "gravity": [0, "-9.81 m/s^2", 0] }} ],
            "probes": [ {{ "name": "tip", "point": [0.1, 0.01, 0] }} ],
            "time": {{ "end": "50 ms", "step": "5 ms", "start": "rest", "mass": "{mass}" }} }}"#
        );
        let result = run(Command::Solve, &text);
        let u = &result["probes"]["tip"]["displacement"];
        let fallen = u[1].as_f64().unwrap();
        assert!((fallen + 0.5 * 9.81 * 0.05f64.powi(2)).abs() < 1e-11, "{mass}: {u}");
        let kinetic = result["time"]["energies"]["end"]["kinetic"].as_f64().unwrap();
        // 2 kg per metre of depth
        assert!((kinetic / (0.5 * 2.0 * (9.81f64 * 0.05).powi(2)) - 1.0).abs() < 1e-9, "{mass}: {kinetic}");
    }
}
