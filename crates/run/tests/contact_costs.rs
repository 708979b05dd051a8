//! Slip of contacts as cost and constraint, and bounds from below, in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, problems, with};
use nastic_language::number::short;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::result::find;
use serde_json::Value;

/// A block that a weight pushes along a floor with friction, which moves: as far and fast as controls say.
const DRAGGED: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "loads": [ { "gravity": ["4 m/s^2", 0, "-10 m/s^2"] } ],
  "time": { "end": "80 ms", "step": "4 ms", "scheme": "backward_euler", "start": "rest" },
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, 0], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "feet", "surface": "z-", "obstacle": "floor", "friction": 0.8, "slip_speed": "1 mm/s" } ],
  "controls": [ { "of": "floor.translation", "name": "drag", "direction": [1, 0, 0], "space": "uniform", "in_time": { "every": "20 ms" },
                  "lower": -1, "upper": 1, "start": "0.02 * sin(50 * t / (1 s))" },
                { "of": "feet.friction", "space": "uniform", "lower": 0.2, "upper": 2 },
                { "of": "feet.stiffness", "space": "uniform", "lower": "1 MPa", "upper": "50 MPa" } ],
  "costs": [ { "kind": "contact_slip", "contact": "feet" } ] }"#;

fn number(found: &Value, path: &str) -> f64 {
    find(found, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {found}"))
}

/// The share r of the cone creeps at `1 - sqrt(1 - r)` of the slip speed; what slides, at its speed over it.
#[test]
fn slip_is_told_beside_the_slip_speed() {
    let still = with(DRAGGED, r#""end": "80 ms""#, r#""end": "200 ms""#);
    let still = with(&still, r#""start": "0.02 * sin(50 * t / (1 s))""#, r#""start": 0"#);
    let slip = |friction: &str| {
        let case = with(&still, r#""friction": 0.8"#, &format!(r#""friction": {friction}"#));
        number(&CaseDirectory::new().run(Command::Solve, &case, &[]).unwrap().result, "cost/total")
    };
    let creeps = slip("0.8");
    assert!((creeps - (1.0 - f64::sqrt(0.5))).abs() < 1e-2, "{creeps}");
    // a = 4 - 0.3 * 10 m/s^2, at 200 ms
    let slides = slip("0.3");
    assert!((slides - 200.0).abs() < 5.0, "{slides}");
}

/// By the pose at both ends of steps, the coefficient and the stiffness; of surfaces by what moves them.
#[test]
fn slip_has_exact_derivatives() {
    let at_instants =
        r#"costs=[{ "kind": "contact_slip", "contact": "feet", "exponent": 2, "when": { "at": ["40 ms", "60 ms"] } }]"#;
    for settings in [vec![at_instants], vec!["contact/0/lagged=true"]] {
        let found = CaseDirectory::new().run(Command::Gradcheck, DRAGGED, &settings).unwrap_or_else(|e| panic!("{e}"));
        let found = (found.exit.code(), found.result["gradcheck"].clone());
        assert!(found.0 == 0 && found.1["lowest_order"].as_f64().unwrap() > 1.95, "{settings:?} {}", found.1);
        for test in found.1["tests"].as_array().unwrap() {
            // the slip hardly depends on the stiffness: rounding may leave too few steps to tell
            let faint = test["verdict"] == "undecided" && test["control"] == "feet.stiffness";
            assert!(test["verdict"] == "right" || faint, "{settings:?} {test}");
        }
    }
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/");
    let carry = include_str!("../../../examples/cases/carry.json").replace("../../meshes/", meshes);
    let carry = with(&carry, r#""end": "0.9 s""#, r#""end": "0.4 s""#);
    let settings = [r#"costs=[{ "kind": "contact_slip", "contact": "grip" }]"#];
    let found =
        CaseDirectory::new().run(Command::Gradient, &carry, &settings).unwrap_or_else(|error| panic!("{error}"));
    let verdict = &found.result["gradient_check"]["verdict"];
    assert!(found.exit.code() == 0 && verdict == "right", "{verdict} {}", found.result["derivative_norm"]);
}

/// Friction against the pull of gravity along x, beside the weight: both of the same contact, and exact derivatives by the pose at both ends of steps,
/// the coefficient and the stiffness.
#[test]
fn a_force_along_a_direction_is_that_of_the_contact() {
    let along = |x: f64, z: f64| {
        format!(r#"costs=[{{ "kind": "contact_force", "contact": "feet", "direction": [{x}, 0, {z}] }}]"#)
    };
    let place = CaseDirectory::new();
    let found =
        place.run(Command::Solve, DRAGGED, &[&along(1.2, 1.6)]).unwrap_or_else(|error| panic!("{error}")).result;
    let [x, z] = ["x", "z"].map(|axis| number(&found, &format!("contributions/feet/force_{axis}")));
    let value = number(&found, "cost/total");
    assert!((value - 0.6 * x - 0.8 * z).abs() < 1e-12 * value.abs(), "{value}, {x}, {z}");
    assert!(x < -1e-3 && (z - 0.04).abs() < 0.01, "{x}, {z}");
    assert_eq!(number(&found, "figures/contact_force/force_along"), value);
    let when = along(0.6, 0.8).replace("] }]", r#"], "when": { "at": ["40 ms", "60 ms"] } }]"#);
    let found = place.run(Command::Gradcheck, DRAGGED, &[&when]).unwrap_or_else(|error| panic!("{error}"));
    let checked = found.result["gradcheck"].clone();
    assert!(found.exit.code() == 0 && checked["lowest_order"].as_f64().unwrap() > 1.95, "{checked}");
    for test in checked["tests"].as_array().unwrap() {
        // the force hardly depends on the stiffness: rounding may leave too few steps to tell
        let faint = test["verdict"] == "undecided" && test["control"] == "feet.stiffness";
        assert!(test["verdict"] == "right" || faint, "{test}");
    }
    // a rigid body has unknowns beside those of its nodes
    let rigid = with(DRAGGED, r#""density": "1000 kg/m^3" }"#, r#""density": "1000 kg/m^3", "rigid": true }"#);
    let slides = place.run(Command::Solve, &rigid, &[&when]).unwrap_or_else(|error| panic!("{error}")).result;
    // 111; with independent strains first 474
    assert!(number(&slides, "newton_iterations") < 200.0, "{}", slides["newton_iterations"]);
    let found = place.run(Command::Gradcheck, &rigid, &[&when]).unwrap_or_else(|error| panic!("{error}"));
    assert!(found.exit.code() == 0, "{}", found.result["gradcheck"]);
    let lagged = DRAGGED.replace(r#""friction": 0.8"#, r#""friction": 0.8, "lagged": true"#);
    let said = problems(&lagged.replace(r#""kind": "contact_slip""#, r#""kind": "contact_force", "direction": "z""#));
    assert!(said.contains("costs/0/contact") && said.contains("lagged friction of \"feet\""), "{said}");
    let faces = with(DRAGGED, r#""contact": ["#, r#""contact": [ { "name": "faces", "surface": "z+", "with": "z-" },"#);
    let faces = with(
        &faces,
        r#""kind": "contact_slip", "contact": "feet""#,
        r#""kind": "contact_force", "contact": "faces", "direction": "z""#,
    );
    assert!(problems(&faces).contains("\"faces\" is between surfaces"), "{}", problems(&faces));
}

/// The least change of a friction coefficient that leaves a tenth of its cone: `S = 1 - sqrt(0.1)`, `mu = 4 / (0.9 * 10)`.
#[test]
fn a_margin_to_slipping_is_a_constraint() {
    let bounded = with(
        DRAGGED,
        r#""costs": [ { "kind": "contact_slip", "contact": "feet" } ]"#,
        r#""costs": [ { "kind": "control_norm", "of": "feet.friction" } ],
           "constraints": [ { "cost": { "kind": "contact_slip", "contact": "feet" }, "at_most": 0.683772 } ]"#,
    );
    let controls = r#"controls=[{ "of": "feet.friction", "space": "uniform", "lower": 0.2, "upper": 2 }]"#;
    let case = with(&bounded, r#""end": "80 ms""#, r#""end": "200 ms""#);
    let best =
        CaseDirectory::new().run(Command::Optimize, &case, &[controls, "optimizer/max_iterations=40"]).unwrap().result;
    let friction = number(&best, "controls/feet.friction/max");
    assert!((friction / (4.0 / 9.0) - 1.0).abs() < 1e-2, "{friction} {}", best["constraints"]);
}

/// A ball that would rather leave, and must press with half a newton.
#[test]
fn a_force_is_bounded_from_below() {
    let case = r#"{ "nastic": 1, "units": "mm",
      "mesh": { "box": { "size": [20, 20, 10], "cells": [4, 4, 2], "element": "hex8" } },
      "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
      "supports": [ { "surface": "z-", "fix": "all" } ],
      "obstacles": [ { "name": "ball", "shape": { "sphere": { "center": [10, 10, 25], "radius": 15 } } } ],
      "contact": [ { "name": "dent", "surface": "z+", "obstacle": "ball", "thickness": 0.5 } ],
      "controls": [ { "of": "ball.translation", "name": "depth", "direction": [0, 0, -1], "space": "uniform", "lower": 0, "upper": 3, "start": 1.5 } ],
      "costs": [ { "kind": "position", "point": [10, 10, 10], "target": { "z": 10 } } ],
      "constraints": [ { "name": "press", "cost": { "kind": "contact_force", "contact": "dent" }, "at_least": 0.5 } ] }"#;
    let (place, heard) = (CaseDirectory::new(), Heard::default());
    let options = place.options(&["optimizer/max_iterations=60"]);
    let best = place.run_with(Command::Optimize, case, &Console::new(heard.clone()), &options).unwrap().result;
    let force = number(&best, "contributions/dent/pressing");
    assert!((force - 0.5).abs() < 0.01, "{force} {}", best["constraints"]);
    // the value stands beside its bound
    let told = &best["constraints"]["groups"]["press"];
    assert_eq!((&told["sense"], &told["bound"]), (&"at_least".into(), &0.5.into()));
    assert_eq!(told["functional"].as_f64().unwrap(), force);
    let line = format!("constraints press: {}, at least 0.5: largest violation ", short(force));
    assert!(heard.text().contains(&line), "{line} {}", heard.text());
    let heard = CaseDirectory::new().text(Command::Check, case, &[]);
    assert!(heard.contains("press: at least 0.5"), "{heard}");
    let both = with(case, r#""at_least": 0.5"#, r#""at_least": 0.5, "at_most": 1"#);
    assert!(problems(&both).contains("exactly one of \"at_most\", \"at_least\" and \"equal\""), "{}", problems(&both));
    let slip = with(case, r#""kind": "contact_force""#, r#""kind": "contact_slip""#);
    assert!(problems(&slip).contains("contact_slip: the contact \"dent\" has no friction"), "{}", problems(&slip));
}
