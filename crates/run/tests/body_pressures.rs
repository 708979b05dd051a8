//! Pressures between two bodies: even on flat blocks whatever their meshes, those of Hertz on curved ones, alike in results, VTU files and costs; their derivatives.
//! With `NASTIC_SLOW=1` (`scripts/slow.sh`) all kinds of cells and finer meshes.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::CaseDirectory;
use nastic_language::schema::Command;
use nastic_mesh::{CellKind, Mesh, Snapshot, box_mesh, rectangle};
use nastic_run::result::find;
use serde_json::Value;
use std::f64::consts::PI;

const YOUNG: f64 = 1e5;
const POISSON: f64 = 0.3;

fn slow() -> bool {
    std::env::var_os("NASTIC_SLOW").is_some()
}

fn number(found: &Value, path: &str) -> f64 {
    find(found, path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} in {found}"))
}

/// The largest pressure over one that is expected at most, as results, the cost's figure and the VTU file have it, and all pressures of the file.
fn told(place: &CaseDirectory, found: &Value) -> (f64, Snapshot, Vec<f64>) {
    let largest = number(found, "contributions/between/largest_pressure");
    let shown = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let pressures = shown.point_array("contact_pressure").unwrap().values.clone();
    let most = pressures.iter().copied().fold(0.0, f64::max);
    for other in [number(found, "figures/contact_pressure/largest_pressure"), most] {
        assert!((other / largest - 1.0).abs() < 1e-6, "{other} and {largest}");
    }
    (largest, shown, pressures)
}

/// Two blocks of so many cells along every edge of the faces by which they press each other.
fn blocks(element: &str, cells: [usize; 2]) -> String {
    let space = element.starts_with("hex") || element.starts_with("tet");
    let (sides, up) = if space { (&["x", "y"][..], "z") } else { (&["x"][..], "y") };
    let body = |name: &str, height: f64, n: usize| {
        let (corner, size, count) =
            ("0, ".repeat(sides.len()), "1, ".repeat(sides.len()), format!("{n}, ").repeat(sides.len()));
        format!(
            r#"{{ "name": "{name}", "corner": [{corner}{height}], "size": [{size}1], "cells": [{count}2], "element": "{element}" }}"#
        )
    };
    let guided: String = (["lower", "upper"].iter())
        .flat_map(|name| sides.iter().map(move |x| format!(r#"{{ "surface": "{name}.{x}-", "fix": "{x}" }}, "#)))
        .collect();
    format!(
        r#"{{ "nastic": 1, "units": "m", "mesh": {{ "boxes": [ {}, {} ] }},
          "materials": [ {{ "region": ["lower", "upper"], "law": "neo_hooke", "young": "{YOUNG} Pa", "poisson": {POISSON} }} ],
          "supports": [ {guided}{{ "surface": "lower.{up}-", "fix": "{up}" }},
                        {{ "surface": "upper.{up}+", "displacement": {{ "{up}": -0.08 }} }} ],
          "contact": [ {{ "name": "between", "surface": "lower.{up}+", "with": "upper.{up}-" }} ],
          "costs": [ {{ "kind": "contact_pressure", "contact": "between" }} ] }}"#,
        body("lower", 0.0, cells[0]),
        body("upper", 1.02, cells[1]),
    )
}

fn refine_of(refine: usize) -> String {
    format!("contact/0/refine={refine}")
}

/// Faces of 1 m^2 press each other evenly, to 2 % at every node, wherever the cells of the other one are.
#[test]
fn flat_blocks_press_evenly() {
    let all =
        ["quad4", "quad8", "tri6", "hex8", "hex20", "tet10"].map(|element| [(element, [3, 4]), (element, [7, 5])]);
    let few = [("quad4", [7, 5]), ("quad8", [3, 4]), ("tri6", [7, 5]), ("hex8", [3, 4]), ("hex20", [3, 4])];
    let cases = if slow() { all.concat() } else { few.to_vec() };
    let refined = ["quad4", "tri6", "hex8"].map(|element| (element, [3, 4], 2));
    let cases = cases.into_iter().map(|(element, cells)| (element, cells, 1));
    for (element, cells, refine) in cases.chain(refined.into_iter().filter(|_| slow())) {
        let place = CaseDirectory::new();
        let found = place
            .run(Command::Solve, &blocks(element, cells), &[&refine_of(refine)])
            .unwrap_or_else(|error| panic!("{error}"))
            .result;
        let (force, (largest, shown, pressures)) =
            (number(&found, "contributions/between/pressing"), told(&place, &found));
        let up = shown.mesh.dim() - 1;
        let between = |x: &[f64; 3]| (x[up] - 1.01).abs() < 0.011;
        let on_faces: Vec<f64> =
            shown.mesh.points().iter().zip(pressures).filter(|(x, _)| between(x)).map(|(_, p)| p / force).collect();
        let (least, most) = on_faces.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), p| (a.min(*p), b.max(*p)));
        assert!(
            on_faces.len() > cells.iter().sum() && least > 0.98 && most < 1.02,
            "{element} {cells:?}: {least} to {most}"
        );
        // the power mean of exponent 16
        let mean = number(&found, "cost/total") / force;
        assert!(mean > 0.99 && mean * force <= largest * (1.0 + 1e-12), "{element} {cells:?}: {mean}");
    }
}

/// Contact half-width or radius 1, radius of the roller or ball 50.
const RADIUS: f64 = 50.0;
/// Both bodies give.
const MODULUS: f64 = 0.5 * YOUNG / (1.0 - POISSON * POISSON);
const THICKNESS: f64 = 0.01 / RADIUS;
const GAP: f64 = 3.0 * THICKNESS;

/// Cells of a length as far as `even`, and longer by a factor each as far as `far`.
fn steps(length: f64, even: f64, factor: f64, far: f64) -> Vec<f64> {
    let (mut at, mut step) = (vec![0.0], length);
    while at[at.len() - 1] < far {
        let last = at[at.len() - 1];
        step *= if last < even - 1e-9 { 1.0 } else { factor };
        at.push(last + step);
    }
    at
}

/// Half (a quarter) of a block below z = 0, or of a roller (ball) above it, of `fine` cells across the contact.
fn body(dim: usize, fine: usize, roller: bool) -> Mesh {
    let length = 1.0 / fine as f64;
    let across = if dim == 3 { steps(length, 1.25, 1.6, 6.0) } else { steps(length, 1.25, 1.35, 60.0) };
    let deep = if dim == 3 { steps(length, length, 1.4, 6.0) } else { steps(length, 1.5, 1.35, 60.0) };
    let (m, n) = (across.len() - 1, deep.len() - 1);
    let grid = match dim {
        3 => box_mesh([m as f64, m as f64, n as f64], [m, m, n], CellKind::Hex8),
        _ => rectangle([m as f64, n as f64], [m, n], CellKind::Quad4),
    };
    let place = |x: [f64; 3]| {
        let mut y = [0.0; 3];
        (0..dim - 1).for_each(|i| y[i] = across[x[i].round() as usize]);
        let depth = x[dim - 1].round() as usize;
        let rise = GAP + (y[0] * y[0] + if dim == 3 { y[1] * y[1] } else { 0.0 }) / (2.0 * RADIUS);
        y[dim - 1] = if roller { deep[depth] + rise } else { -deep[n - depth] };
        y
    };
    grid.unwrap().mapped(place).unwrap()
}

/// The largest pressure over that of Hertz by the force, of bodies of so many cells across the contact.
fn beside_hertz(dim: usize, fine: [usize; 2], refine: usize) -> f64 {
    let place = CaseDirectory::new();
    let bodies = [("block", body(dim, fine[0], false)), ("roller", body(dim, fine[1], true))];
    nastic_io::write_vtu(place.path("pair.vtu"), &Snapshot::new(Mesh::together("pair", &bodies).unwrap())).unwrap();
    // at which the half-width is 1, of a roller on a layer as deep as both bodies are
    let depth = match dim {
        3 => 1.0 / RADIUS,
        _ => (2.0 * f64::ln(120.0) - POISSON / (1.0 - POISSON)) / (4.0 * RADIUS),
    };
    let (up, sideways, symmetry) = match dim {
        3 => ("z", r#"["x", "y"]"#, r#", { "surface": ["block.y-", "roller.y-"], "fix": "y" }"#),
        _ => ("y", r#""x""#, ""),
    };
    let push = -(depth + GAP - 2.0 * THICKNESS);
    let case = format!(
        r#"{{ "nastic": 1, "units": "m", "mesh": "pair.vtu",
          "materials": [ {{ "region": ["block", "roller"], "law": "neo_hooke", "young": "{YOUNG} Pa", "poisson": {POISSON} }} ],
          "supports": [ {{ "surface": "block.{up}-", "fix": "all" }}, {{ "surface": ["block.x-", "roller.x-"], "fix": "x" }}{symmetry},
                        {{ "surface": "roller.{up}+", "fix": {sideways}, "displacement": {{ "{up}": {push} }} }} ],
          "contact": [ {{ "name": "between", "surface": "block.{up}+", "with": "roller.{up}-", "thickness": {THICKNESS} }} ],
          "costs": [ {{ "kind": "contact_pressure", "contact": "between" }} ] }}"#
    );
    let found =
        place.run(Command::Solve, &case, &[&refine_of(refine)]).unwrap_or_else(|error| panic!("{error}")).result;
    let (largest, ..) = told(&place, &found);
    let force = number(&found, "contributions/between/pressing");
    let expected = match dim {
        3 => (6.0 * 4.0 * force * MODULUS * MODULUS / (PI.powi(3) * RADIUS * RADIUS)).cbrt(),
        _ => (2.0 * force * MODULUS / (PI * RADIUS)).sqrt(),
    };
    largest / expected
}

/// Within 5 % on four cells across the contact, rollers 2 % on eight, whichever body has the finer mesh.
#[test]
fn rollers_and_balls_press_as_hertz_says() {
    let few = [(2, [4, 5], 1), (2, [8, 6], 1), (2, [8, 10], 1)];
    let more = [
        (2, [4, 3], 1),
        (2, [5, 4], 1),
        (2, [4, 9], 1),
        (2, [4, 5], 4),
        (2, [16, 20], 1),
        (3, [4, 5], 1),
        (3, [5, 4], 1),
        (3, [8, 10], 1),
    ];
    for (dim, fine, refine) in few.into_iter().chain(more.into_iter().filter(|_| slow())) {
        let (ratio, within) = (beside_hertz(dim, fine, refine), if fine[0] < 8 { 0.05 } else { 0.02 });
        println!("{dim} {fine:?} refine {refine}: {ratio:.4}");
        assert!((ratio - 1.0).abs() < within, "{dim} {fine:?} refine {refine}: {ratio}");
    }
}

/// A plate that is an obstacle presses a small block onto a larger one, whose fibres pull: no sample is opposite to an edge.
const PRESSED: &str = r#"{ "nastic": 1, "units": "m",
  "mesh": { "boxes": [ { "name": "lower", "size": [1, 1, 0.5], "cells": [3, 3, 2], "element": "hex8" },
                       { "name": "upper", "corner": [0.13, 0.21, 0.52], "size": [0.6, 0.55, 0.4], "cells": [2, 2, 1], "element": "hex20" } ] },
  "materials": [ { "region": ["lower", "upper"], "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3 } ],
  "supports": [ { "surface": "lower.z-", "fix": "all" }, { "surface": "upper.z+", "foundation": "20 kN/m^3" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "lower", "direction": [0.6, 0, 0.8] } ],
  "obstacles": [ { "name": "plate", "shape": { "half_space": { "point": [0, 0, 0.925], "normal": [0, 0, -1] } } } ],
  "contact": [ { "name": "press", "surface": "upper.z+", "obstacle": "plate" },
               { "name": "between", "surface": "lower.z+", "with": "upper.z-" } ],
  "controls": [ { "of": "plate.translation", "name": "push", "direction": [0, 0, -1], "space": "uniform", "lower": 0, "upper": 0.1, "start": 0.06 },
                { "of": "plate.rotation", "name": "tilt", "direction": [0, 1, 0], "space": "uniform", "lower": -0.1, "upper": 0.1, "start": 0.01 },
                { "of": "fibers", "space": "uniform", "lower": 0, "upper": "20 kPa", "start": "3 kPa" },
                { "of": "between.stiffness", "space": "uniform", "lower": "1 MPa", "upper": "20 MPa" } ],
  "costs": [ { "kind": "contact_pressure", "contact": "between", "exponent": 4 } ] }"#;

/// By the pose of what pushes, by what pulls, by the stiffness of the layer.
#[test]
fn the_largest_pressure_has_exact_derivatives() {
    let found = CaseDirectory::new().run(Command::Gradcheck, PRESSED, &[]).unwrap_or_else(|error| panic!("{error}"));
    let (exit, found) = (found.exit.code(), found.result["gradcheck"].clone());
    assert!(exit == 0 && found["lowest_order"].as_f64().unwrap() > 1.95, "{found}");
}
