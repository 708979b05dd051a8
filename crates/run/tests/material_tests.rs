//! Tests of materials as motions: a grip with free sides, the force that it takes over the time.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use serde_json::Value;

/// A cube of 10 mm in a grip that moves along x alone, on rollers behind it, below and beside it.
fn case(scheme: &str, material: &str, grip: &str) -> String {
    format!(
        r#"{{ "nastic": 1, "units": "mm",
        "mesh": {{ "box": {{ "size": [10, 10, 10], "cells": [1, 1, 1], "element": "hex8" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "mu": "20 kPa", "lambda": "40 kPa"{material} }} ],
        "supports": [ {{ "surface": "x-", "fix": "x" }}, {{ "surface": "y-", "fix": "y" }}, {{ "surface": "z-", "fix": "z" }} ],
        "probes": [ {{ "name": "corner", "point": [10, 10, 10] }} ],
        "time": {{ "end": "1 s", "step": "50 ms", "scheme": "{scheme}" }},
        "actuation": [ {{ "name": "grip", "kind": "motion", "surface": "x+"{grip} }} ] }}"#
    )
}

/// The columns of a table of a motion, by name.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').map(|cell| cell.trim_matches('"')).collect();
    let at = head.iter().position(|known| *known == name).unwrap_or_else(|| panic!("{name} of {head:?}"));
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

fn solve(text: &str) -> (Value, String) {
    let place = CaseDirectory::new();
    let result = place.run(Command::Solve, text, &[]).unwrap().result;
    (result, std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap())
}

/// `mu (a - 1/a) + lambda (l a^2 - 1) l a = 0` for the sides a, then the force per area.
fn uniaxial(l: f64) -> [f64; 2] {
    let (mu, lambda) = (0.02, 0.04);
    let lateral = |a: f64| mu * (a - 1.0 / a) + lambda * (l * a * a - 1.0) * l * a;
    let (mut low, mut high) = (0.2, 1.5);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if lateral(middle) < 0.0 { low = middle } else { high = middle }
    }
    [low, mu * (l - 1.0 / l) + lambda * (l * low * low - 1.0) * low * low]
}

#[test]
fn a_uniaxial_test_in_motion_is_the_closed_form() {
    let grip = r#", "fix": "x", "translation": ["8 mm * t / (1 s)", 0, 0]"#;
    let (result, csv) = solve(&case("quasi_static", "", grip));
    let [times, force, back] = ["t", "reactions.grip.x", "reactions.x-.x"].map(|name| column(&csv, name));
    for (n, t) in times.iter().enumerate() {
        let [side, stress] = uniaxial(1.0 + 0.8 * t);
        assert!((force[n] - 100.0 * stress).abs() < 1e-8, "{t}: {} {}", force[n], 100.0 * stress);
        assert!((force[n] + back[n]).abs() < 1e-9);
        let sideways = column(&csv, "corner.y")[n];
        assert!((sideways - 10.0 * (side - 1.0)).abs() < 1e-7, "{t}: {sideways} {side}");
    }
    let end = result["reactions"]["grip"][0].as_f64().unwrap();
    assert_eq!(end, *force.last().unwrap());
    assert!(result["reactions"]["grip"][1].as_f64().unwrap() == 0.0);
}

/// A step of strain, held: with E(t) = E_inf + (E_0 - E_inf) exp(-t/tau_E), whose exponential backward Euler makes (1 + h/tau_E)^-n.
#[test]
fn the_force_of_a_relaxation_test_is_the_prony_series() {
    let maxwell = r#", "maxwell": [ { "shear": "30 kPa", "relaxation": "200 ms" } ]"#;
    let grip = r#", "fix": ["x"], "translation": ["1e-5 mm * min(t / (50 ms), 1)", 0, 0]"#;
    let (_, csv) = solve(&case("quasi_static", maxwell, grip));
    let force = column(&csv, "reactions.grip.x");
    let young = |g: f64, k: f64| 9.0 * k * g / (3.0 * k + g);
    let (g, bulk, branch) = (0.02, 0.04 + 2.0 * 0.02 / 3.0, 0.03);
    let (long, instant) = (young(g, bulk), young(g + branch, bulk));
    let tau = 0.2 * (3.0 * bulk + g + branch) / (3.0 * bulk + g);
    assert!(force[0].abs() < 1e-15);
    for (n, found) in force.iter().enumerate().skip(1) {
        let of = |decay: f64| 100.0 * 1e-6 * (long + (instant - long) * decay);
        let discrete = of((1.0 + 0.05 / tau).powi(-(n as i32)));
        assert!((found / discrete - 1.0).abs() < 1e-4, "{n}: {found:e} {discrete:e}");
        let exact = of((-(n as f64 * 0.05) / tau).exp());
        assert!((found / exact - 1.0).abs() < 0.05, "{n}: {found:e} {exact:e}");
    }
}

/// A heavy cube that its grip accelerates evenly: the force is mass times acceleration, once waves have died down.
#[test]
fn a_grip_that_accelerates_bears_the_mass() {
    let grip = r#", "translation": ["5 mm * (t / (1 s))^2", 0, 0]"#;
    for scheme in ["backward_euler", "tr_bdf2", "quasi_static"] {
        let heavy = case(scheme, r#", "density": "1000 kg/m^3", "kelvin_voigt": { "shear": "500 Pa * (1 s)" }"#, grip);
        let free = heavy.replace(r#""supports": [ { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": "z" } ],"#, "");
        let (result, _) = solve(&free);
        let found = &result["reactions"]["grip"][0];
        // what this scheme does not know is no number
        if scheme == "tr_bdf2" {
            assert!(found.is_null(), "{found}");
            continue;
        }
        // in N, mm and s: 1 g times 10 mm/s^2
        let exact = if scheme == "quasi_static" { 0.0 } else { 1e-5 };
        let found = found.as_f64().unwrap();
        assert!((found - exact).abs() < 2e-7, "{scheme}: {found:e} {exact:e}");
    }
}

#[test]
fn what_a_grip_does_not_hold_cannot_move() {
    let grip = r#", "fix": "x", "translation": ["1 mm * t / (1 s)", "1 mm * t / (1 s)", 0]"#;
    let error = CaseDirectory::new().run(Command::Solve, &case("quasi_static", "", grip), &[]).unwrap_err().to_string();
    assert!(error.contains("motion \"grip\" goes") && error.contains("along y, which it does not hold"), "{error}");
    let wrong = problems(&case("quasi_static", "", r#", "fix": "w", "translation": [0, 0, 0]"#));
    assert!(wrong.contains("actuation/0/fix"), "{wrong}");
}
