//! Meshed obstacles whose distance is on a grid, in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, warnings, with};
use nastic_language::schema::Command;
use nastic_mesh::{CellKind, Snapshot, box_mesh};
use nastic_run::result::find;
use serde_json::Value;

/// A bar that a block from a mesh, hollow below, indents; its place and turn and the stiffness are controls.
const INDENTED: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 20, 10], "cells": [4, 4, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "z-", "fix": "all" } ],
  "obstacles": [ { "name": "stamp", "shape": { "mesh": "stamp.vtu" }, "grid": "1 mm", "translation": [0.5, 0, 0] } ],
  "contact": [ { "name": "dent", "surface": "z+", "obstacle": "stamp", "thickness": 0.5 } ],
  "controls": [ { "of": "stamp.translation", "name": "depth", "direction": [0, 0, -1], "space": "uniform", "lower": 0, "upper": 3, "start": 1 },
                { "of": "stamp.rotation", "name": "turn", "space": "uniform", "lower": [-0.2, -0.2, -0.2], "upper": [0.2, 0.2, 0.2],
                  "start": [0.03, 0.02, -0.04] },
                { "of": "dent.stiffness", "space": "uniform", "lower": "1 MPa", "upper": "20 MPa" } ],
  "costs": [ { "kind": "contact_pressure", "contact": "dent" }, { "kind": "position", "point": [10, 10, 10], "target": { "z": 8 } } ] }"#;

/// Beside the case, arched below, above the bar.
fn stamp(place: &CaseDirectory) {
    let at = |x: [f64; 3]| [x[0] + 4.0, x[1] + 4.0, x[2] + 10.1 + 0.03 * (4.0 - (x[0] - 6.0).abs()).max(0.0).powi(2)];
    let stamp = box_mesh([12.0, 12.0, 5.0], [8, 4, 2], CellKind::Hex8).unwrap().mapped(at).unwrap();
    nastic_io::write_vtu(place.path("stamp.vtu"), &Snapshot::new(stamp)).unwrap();
}

fn number(found: &Value, path: &str) -> f64 {
    find(found, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {found}"))
}

/// Statically, and with friction, implicit and lagged, in a motion.
#[test]
fn pose_and_stiffness_are_controls_with_exact_derivatives() {
    let place = CaseDirectory::new();
    stamp(&place);
    let motion = r#"time={ "end": "12 ms", "step": "4 ms", "scheme": "backward_euler", "start": "rest" }"#;
    let costs = r#"costs=[ { "kind": "contact_slip", "contact": "dent", "when": { "at": ["8 ms", "12 ms"] } },
                           { "kind": "contact_force", "contact": "dent" } ]"#;
    let rough = vec![motion, costs, "contact/0/friction=0.4", r#"contact/0/slip_speed="20 mm/s""#];
    let rough =
        [rough, vec![r#"controls/0/in_time={ "every": "4 ms" }"#, r#"controls/0/start="100 mm/s * t""#]].concat();
    let lagged = [rough.clone(), vec!["contact/0/lagged=true"]].concat();
    for settings in [vec![], rough, lagged] {
        let found = place.run(Command::Gradcheck, INDENTED, &settings).unwrap_or_else(|error| panic!("{error}"));
        let check = &found.result["gradcheck"];
        assert_eq!(found.exit.code(), 0, "{settings:?} {check}");
        assert!(check["lowest_order"].as_f64().unwrap() > 1.9, "{settings:?} {check}");
        for test in check["tests"].as_array().unwrap() {
            assert_eq!(test["verdict"], "right", "{settings:?} {test}");
        }
    }
}

/// The solve names the grid, draws the solid itself, and reports gaps and pressures that go together.
#[test]
fn the_solid_is_drawn_and_its_grid_told() {
    let place = CaseDirectory::new();
    stamp(&place);
    let found = place.run(Command::Optimize, INDENTED, &["optimizer/max_iterations=5", "expect={}"]).unwrap().result;
    let drawn = nastic_io::read_snapshot(place.path("out/optimum_obstacles.vtu")).unwrap().mesh;
    assert_eq!(drawn.cells(), 64, "{:?}", place.files());
    assert!(number(&found, "contributions/dent/pressing") > 0.0);
    let heard = place.text(Command::Check, INDENTED, &[]);
    assert!(
        heard.contains("\"stamp\": its distance is interpolated on") && heard.contains(" nodes, 1 mm apart"),
        "{heard}"
    );
}

/// Where faces are flat it is the exact distance of the mesh: the same values as by the formula of the box, and an optimum that keeps away from it.
#[test]
fn costs_and_constraints_take_an_obstacle_on_a_grid() {
    let case = r#"{ "nastic": 1, "units": "mm",
      "mesh": { "box": { "size": [40, 10, 10], "cells": [8, 2, 2], "element": "hex8" } },
      "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
      "supports": [ { "surface": "x-", "fix": "all" } ],
      "actuation": [ { "name": "muscle", "kind": "muscle", "region": "body", "direction": "x" } ],
      "obstacles": [ { "name": "block", "shape": SHAPE } ],
      "controls": [ { "of": "muscle", "space": "cell", "start": "10 kPa * Z / 10 mm", "lower": 0, "upper": "50 kPa" } ],
      "costs": [ { "kind": "position", "surface": "x+", "target": { "z": 9 } },
                 { "kind": "obstacle", "surface": "z+", "shape": "block", "clearance": 6, "weight": 1e-3 } ],
      "constraints": [ { "obstacle": { "surface": "z+", "shape": "block", "clearance": 1 } } ] }"#;
    let exact = with(case, "SHAPE", r#"{ "box": { "low": [-20, -20, 12], "high": [70, 30, 42] } }"#);
    let meshed = with(case, "SHAPE", r#"{ "mesh": { "file": "block.vtu" } }, "grid": 2"#);
    let run = |command: Command, case: &str| {
        let place = CaseDirectory::new();
        let at = |x: [f64; 3]| [x[0] - 20.0, x[1] - 20.0, x[2] + 12.0];
        let block = box_mesh([90.0, 50.0, 30.0], [1; 3], CellKind::Hex8).unwrap().mapped(at).unwrap();
        nastic_io::write_vtu(place.path("block.vtu"), &Snapshot::new(block)).unwrap();
        let settings = ["optimizer/max_iterations=60", "expect={}"];
        place.run(command, case, &settings).unwrap_or_else(|error| panic!("{error}")).result
    };
    let [by_formula, by_grid] = [&exact, &meshed].map(|case| run(Command::Solve, case));
    let [a, b] = [&by_formula, &by_grid].map(|found| number(found, "cost/total"));
    assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
    let violation = |found: &Value| number(found, "constraints/groups/obstacle/violation");
    let [a, b] = [violation(&by_formula), violation(&by_grid)];
    assert!(a > 1.0 && (a / b - 1.0).abs() < 1e-3, "{a} {b}");
    let best = run(Command::Optimize, &meshed);
    assert!(violation(&best) < 1e-2, "{}", best["constraints"]);
}

#[test]
fn mistakes_get_answers() {
    let of = |obstacle: &str| {
        format!(
            r#"{{ "nastic": 1, "units": "mm",
  "mesh": {{ "box": {{ "size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8" }} }},
  "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 }} ],
  "supports": [ {{ "surface": "z+", "fix": "all" }} ],
  "obstacles": [ {{ "name": "plate", {obstacle}, "translation": [0, 0, -30] }} ],
  "contact": [ {{ "surface": "z-", "obstacle": "plate" }} ] }}"#
        )
    };
    let plate = |height: f64, more: &str| {
        of(&format!(
            r#""shape": {{ "mesh": {{ "box": {{ "size": [30, 30, {height}], "cells": [2, 2, 1], "element": "hex8" }} }} }}{more}"#
        ))
    };
    let round = of(r#""shape": { "sphere": { "center": [0, 0, 0], "radius": 5 } }, "grid": 1"#);
    for (case, words) in [
        (plate(5.0, r#", "grid": "1 mm", "rounding": 1"#), ": obstacles/0/grid: an obstacle has a rounding or a grid"),
        (round, ": obstacles/0/grid: a sphere has a distance in closed form: leave the grid out"),
        (plate(5.0, r#", "grid": 0"#), ": obstacles/0/grid: must be positive"),
        (plate(5.0, r#", "grid": "1 kPa""#), ": obstacles/0/grid: "),
        (plate(5.0, r#", "grid": 0.03"#), "are the most (64 MB): take a spacing of 0.1"),
        (plate(5.0, ""), "give `rounding`, or a thinner layer by `thickness`, or put its distance on a `grid`"),
    ] {
        let message = problems(&case);
        assert!(message.contains(words), "{message}");
    }
    // the usual layer of a wide surface, 6 mm, is wider than the margin that a small solid has by itself
    let wide = with(&plate(5.0, r#", "grid": 0.5"#), "[20, 20, 10]", "[2000, 2000, 1000]");
    assert_eq!(problems(&wide), "");
    let unread = problems(&plate(5.0, r#", "grid": 0"#));
    assert!(!unread.contains("rounding"), "{unread}");
    let message = warnings(&plate(5.0, r#", "grid": 3"#));
    assert!(message.contains("[coarse_grid]") && message.contains("more than the layer of contact"), "{message}");
    assert_eq!(message.matches("coarse_grid").count(), 1, "{message}");
}

/// A wall that the grid goes through on both sides is reported, and how thick it is.
#[test]
fn a_wall_that_the_grid_loses_is_told() {
    let place = CaseDirectory::new();
    let at = |x: [f64; 3]| [x[0] + 4.0, x[1] + 4.0, x[2] + 11.0 - 0.05 * (x[0] - 6.0).powi(2)];
    let sheet = box_mesh([12.0, 12.0, 0.4], [8, 4, 1], CellKind::Hex8).unwrap().mapped(at).unwrap();
    nastic_io::write_vtu(place.path("stamp.vtu"), &Snapshot::new(sheet)).unwrap();
    let heard = place.text(Command::Check, INDENTED, &[]);
    assert!(heard.contains("[coarse_grid]") && heard.contains("too coarse for a wall that is 0."), "{heard}");
    let finer = place.text(Command::Check, INDENTED, &["obstacles/0/grid=0.2"]);
    assert!(!finer.contains("coarse_grid"), "{finer}");
}
