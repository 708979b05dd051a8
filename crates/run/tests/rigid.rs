//! Rigid regions in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard, problems, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::result::find;
use serde_json::Value;

/// A block of 4 g that falls half a millimetre on a floor.
const BLOCK: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3", "rigid": true } ],
  "loads": [ { "gravity": ["2 m/s^2", 0, "-10 m/s^2"] } ],
  "time": { "end": "200 ms", "step": "4 ms", "scheme": "backward_euler", "start": "rest", "output": "40 ms" },
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, -0.5], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "feet", "surface": "z-", "obstacle": "floor", "friction": 0.3, "slip_speed": "1 mm/s" } ],
  "costs": [ { "name": "far", "kind": "position", "region": "body", "target": { "x": 12 } } ],
  "controls": [ { "of": "feet.friction", "space": "uniform", "lower": 0.01, "upper": 1 } ],
  "probes": [ { "name": "corner", "point": [20, 20, 10] }, { "name": "foot", "point": [0, 0, 0] } ] }"#;

fn number(found: &Value, path: &str) -> f64 {
    find(found, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {found}"))
}

/// Half of a block, held in its plane of symmetry, that an oblique weight drags over a floor, or topples where friction is large.
const HALF: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 10, 20], "cells": [2, 1, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3", "rigid": true } ],
  "loads": [ { "gravity": ["12 m/s^2", 0, "-10 m/s^2"] } ],
  "supports": [ { "surface": "y-", "fix": "y" } ],
  "time": { "end": "80 ms", "step": "4 ms", "scheme": "backward_euler", "start": "rest" },
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, 0], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "feet", "surface": ["z-", "x+", "z+", "x-"], "obstacle": "floor", "friction": 0.8, "slip_speed": "1 mm/s" } ],
  "controls": [ { "of": "feet.friction", "space": "uniform", "lower": 0.2, "upper": 2 } ],
  "costs": [ { "kind": "contact_slip", "contact": "feet" } ] }"#;

/// Steps begin at extrapolated displacements, and one factor serves where nothing changes: 39 iterations and 2 factorisations. From the displacement before,
/// on the residual of the constraints, there were 391 and 297. The sliding block is 0.5 (g_x - mu g_z) t^2 away, but for the slip speed; the toppling one turns about its edge.
#[test]
fn a_rigid_block_slides_and_topples_in_few_iterations() {
    let place = CaseDirectory::new();
    let solve = |case: &str| place.run(Command::Solve, case, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let slid = solve(HALF);
    assert!(number(&slid, "newton_iterations") < 80.0, "{}", slid["newton_iterations"]);
    assert!(number(&slid, "factorisations") < 10.0, "{}", slid["factorisations"]);
    // backward Euler: v_n = a t_n, u_n = a dt^2 n (n + 1)/2, without what the first step loses while it sticks
    let expected = 1e3 * 4.0 * 0.004_f64.powi(2) * 210.0;
    let moved = number(&slid, "contributions/body/translation_x");
    assert!((moved - expected).abs() < 0.03 * expected, "{moved} {expected}");
    let toppled = solve(&with(HALF, r#""friction": 0.8"#, r#""friction": 1.5"#));
    assert!(number(&toppled, "contributions/body/rotation_y") > 0.02, "{}", toppled["contributions"]["body"]);
    assert!(number(&toppled, "newton_iterations") < 300.0, "{}", toppled["newton_iterations"]);
}

#[test]
fn a_rigid_block_falls_and_stays_what_it_is() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, BLOCK, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let weight = 4e-3 * 10.0;
    let force = number(&found, "contributions/feet/force_z");
    assert!((force - weight).abs() < 1e-3 * weight, "{force}");
    let at = |name: &str| -> Vec<f64> {
        let place = |k: usize| number(&found, &format!("probes/{name}/displacement/{k}"));
        (0..3).map(place).collect()
    };
    let rest = [20.0, 20.0, 10.0];
    let apart: f64 = at("corner").iter().zip(at("foot")).zip(rest).map(|((a, b), x)| (a - b + x).powi(2)).sum();
    assert!((apart.sqrt() - 30.0).abs() < 1e-9, "{apart}");
    assert!((number(&found, "contributions/body/translation_z") - at("corner")[2]).abs() < 1e-3);
    let checked = place.run(Command::Check, BLOCK, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    assert_eq!(checked["materials"][0]["rigid"], true, "{checked}");
    let heard = place.text(Command::Check, BLOCK, &[]);
    assert!(heard.contains("; rigid; density"), "{heard}");
    let columns = std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap();
    assert!(columns.lines().next().unwrap().contains("body.rotation_z"), "{columns}");
}

#[test]
fn what_it_does_is_told() {
    let (place, heard) = (CaseDirectory::new(), Heard::default());
    let thrown = with(BLOCK, r#""start": "rest""#, r#""start": "rest", "velocity": [0, 0, "0.1 m/s"]"#);
    let thrown = with(&thrown, r#""end": "200 ms""#, r#""end": "20 ms""#)
        .replace(r#""output": "40 ms""#, r#""output": "20 ms""#);
    let spun = with(&thrown, r#"[0, 0, "0.1 m/s"]"#, r#"["-2 * (Y - 10) / (1 s)", "2 * (X - 10) / (1 s)", "0.1 m/s"]"#);
    let found =
        place.run_with(Command::Solve, &spun, &Console::new(heard.clone()), &place.options(&[])).unwrap().result;
    let angle = number(&found, "contributions/body/rotation_z");
    let text = heard.text();
    assert!((angle / 0.04 - 1.0).abs() < 1e-2 && text.contains("rigid body  body moves by (0."), "{angle} {text}");
    assert!(text.contains("turns by 0.039994 rad = 2.2915 degrees about (0, 0, 1)\n"), "{text}");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("<th>rigid body</th>") && page.contains("turns by [degrees]"), "the table of rigid bodies");
    assert!(page.contains("<td>2.2915</td>"), "its turn");
    let checked = place.text(Command::Check, BLOCK, &[]);
    assert!(checked.contains("rigid       1 rigid body of 6 unknowns, translation and rotation"), "{checked}");
    assert!(checked.contains("            body: mass 0.004 kg"), "{checked}");
    let stretched = with(&spun, r#""2 * (X - 10) / (1 s)""#, r#""1 * (X - 10) / (1 s)""#);
    let said = problems(&stretched);
    assert!(said.contains("time/velocity") && said.contains("changes the shape of \"body\""), "{said}");
}

#[test]
fn the_derivative_by_its_friction_is_right() {
    let heard = CaseDirectory::new().text(Command::Gradient, BLOCK, &[]);
    assert!(heard.contains("gradient    right"), "{heard}");
}

#[test]
fn what_a_rigid_region_does_not_go_with_is_told_at_its_place() {
    let held = with(BLOCK, r#""loads""#, r#""supports": [ { "surface": "z+", "displacement": { "x": 1 } } ], "loads""#);
    let said = problems(&held);
    assert!(said.contains("materials/0/rigid") && said.contains("\"z+\" moves node"), "{said}");
    let muscle = r#""actuation": [ { "name": "pull", "kind": "fiber_tension", "region": "body", "direction": "x", "tension": "1 kPa" } ], "loads""#;
    let said = problems(&with(BLOCK, r#""loads""#, muscle));
    assert!(said.contains("materials/0/rigid") && said.contains("\"pull\" acts in this region alone"), "{said}");
    let word = with(BLOCK, r#""rigid": true"#, r#""rigid": "yes""#);
    assert!(problems(&word).contains("materials/0/rigid"), "{}", problems(&word));
    let multigrid = with(BLOCK, r#""loads""#, r#""linear_solver": "multigrid", "loads""#);
    assert!(problems(&multigrid).contains("rigid bodies"), "{}", problems(&multigrid));
}
