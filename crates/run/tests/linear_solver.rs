//! `linear_solver` in case files: what was chosen serves, and is refused where it does not fit.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use serde_json::{Value, json};

/// A bar that its weight bends.
fn bar(solver: Option<&str>) -> Value {
    let mut case = json!({
        "nastic": 1,
        "mesh": { "box": { "size": [0.6, 0.1, 0.1], "cells": [12, 2, 2], "element": "hex8" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
        "supports": [ { "surface": "x-", "fix": "all" } ],
        "loads": [ { "gravity": [0.0, 0.0, "-0.5 m/s^2"] } ],
        "probes": [ { "name": "tip", "point": [0.6, 0.1, 0.1] } ],
    });
    if let Some(solver) = solver {
        case["linear_solver"] = solver.into();
    }
    case
}

#[test]
fn the_chosen_solver_finds_the_same_state() {
    let [unasked, direct, multigrid] = [None, Some("direct"), Some("multigrid")].map(|solver| {
        let found = CaseDirectory::new().run(Command::Solve, &bar(solver).to_string(), &[]);
        found.unwrap_or_else(|error| panic!("{solver:?}: {error}")).result
    });
    let served = |found: &Value| found["linear_solver"].as_str().map(str::to_owned);
    assert_eq!(served(&multigrid), Some("multigrid".to_owned()));
    assert_eq!(served(&direct), Some("direct".to_owned()));
    assert_eq!(served(&unasked), served(&direct), "a small body");
    assert!(multigrid["multigrid_cycles"].as_u64().unwrap() > 0);
    let tip = |found: &Value| found["probes"]["tip"]["displacement"][2].as_f64().unwrap();
    assert_eq!(tip(&unasked), tip(&direct));
    assert!((tip(&multigrid) - tip(&direct)).abs() < 1e-9 * tip(&direct).abs(), "{} {}", tip(&multigrid), tip(&direct));
}

/// Pivots of a factor are one thing, conjugate gradients that met no negative curvature another.
#[test]
fn how_stability_was_concluded_is_told() {
    for (solver, by_factor, said) in [
        ("direct", true, "stable (no negative pivot of the tangent)"),
        ("multigrid", false, "stable (conjugate gradients met no negative curvature of the tangent; without a factor"),
    ] {
        let place = CaseDirectory::new();
        let text = place.text(Command::Solve, &bar(Some(solver)).to_string(), &[]);
        assert!(text.contains(said), "{text}");
        let result = place.json("result.json");
        assert_eq!((&result["inertia"], &result["inertia_by_factor"]), (&0.into(), &by_factor.into()), "{solver}");
    }
}

#[test]
fn a_solver_that_does_not_fit_is_refused() {
    let mut case = bar(Some("multigrid"));
    case["time"] = json!({ "end": "20 ms", "step": "10 ms", "scheme": "backward_euler", "start": "rest" });
    case["obstacles"] =
        json!([ { "name": "floor", "shape": { "half_space": { "point": [0, 0, -0.01], "normal": [0, 0, 1] } } } ]);
    case["contact"] = json!([ { "name": "side", "surface": "z-", "obstacle": "floor", "friction": 0.3 } ]);
    let message = problems(&case.to_string());
    let refused = "linear_solver: multigrid does not go with a tangent that is not symmetric";
    assert!(message.contains(refused) && message.contains("leave \"linear_solver\" out"), "{message}");
    // a body that nothing holds begins to move from rest
    case["supports"] = json!([]);
    assert!(problems(&case.to_string()).contains(refused));
    let message = problems(&bar(Some("cholesky")).to_string());
    assert!(message.contains("linear_solver") && message.contains("multigrid"), "{message}");
}
