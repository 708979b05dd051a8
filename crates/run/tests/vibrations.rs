//! `nastic modes`: frequencies against those of beams, under load, in other units, of members; what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, Heard, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, ModesRequest, Options};
use serde_json::Value;
use std::f64::consts::TAU;

/// 1 m long, 20 mm thick, both ends held, E = 1 MPa, 1000 kg/m^3, in plane strain without lateral contraction.
fn strip() -> String {
    with(
        include_str!("../../language/tests/cases/swelling_strip.json"),
        "\"poisson\": 0.0",
        "\"poisson\": 0.0, \"density\": \"1000 kg/m^3\"",
    )
}

/// Euler's frequency of a beam held at both ends, from `beta L`.
fn beam(beta: f64) -> f64 {
    beta * beta / TAU * (1e6 * 0.02 * 0.02 / 12.0 / 1000.0_f64).sqrt()
}

fn modes(place: &CaseDirectory, case: &str, asked: ModesRequest, set: &[&str]) -> (Value, String) {
    let heard = Heard::default();
    let options = Options { modes: asked, ..place.options(set) };
    let outcome = place.run_with(Command::Modes, case, &Console::new(heard.clone()), &options);
    let outcome = outcome.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(outcome.exit, Exit::Done);
    (outcome.result, heard.text())
}

fn lowest(count: usize) -> ModesRequest {
    ModesRequest { count, undeformed: false }
}

#[test]
fn frequencies_are_told_and_shapes_written() {
    let place = CaseDirectory::new();
    let (result, said) = modes(&place, &strip(), lowest(3), &["controls/0/start=0 Pa"]);
    let found = &result["modes"];
    assert_eq!((&found["about"], &found["units"]["frequency"]), (&"equilibrium".into(), &"Hz".into()));
    assert_eq!((&found["neutral"], &found["unstable"]), (&0.into(), &0.into()));
    for (k, beta) in [4.730_041, 7.853_205, 10.995_608].into_iter().enumerate() {
        let hertz = found["frequencies"][k].as_f64().unwrap();
        assert!((hertz / beam(beta) - 1.0).abs() < 0.02, "{hertz} instead of {}", beam(beta));
        assert!(found["directions"][k][1].as_f64().unwrap() > 0.98, "{found}");
        assert!(said.contains(&format!("{hertz:.3}")), "{said}");
    }
    // of the shape of a beam held at both ends, with the largest value 1: 0.3965 of the mass of 20 kg per metre
    let mass = found["modal_masses"][0].as_f64().unwrap();
    assert!((mass / 20.0 - 0.3965).abs() < 0.005, "{mass}");
    assert_eq!(said.lines().filter(|line| line.contains(" Hz ")).count(), 3, "{said}");
    let snapshot = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let first = snapshot.point_array("mode_1").unwrap();
    let middle = snapshot.mesh.points().iter().position(|x| *x == [0.5, 0.01, 0.0]).unwrap();
    assert!(first.at(middle)[1] > 0.999 && snapshot.point_array("mode_3").is_some());
    for name in ["picture.png", "picture.svg", "report.html", "result.json", "case.json"] {
        assert!(place.path("out").join(name).exists(), "{name}");
        assert!(name == "result.json" || result["files"].as_array().unwrap().contains(&name.into()), "{result:#}");
    }
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("mode of vibration"));
}

/// The turgor presses the strip against its ends: its lowest frequency falls, and beyond buckling the mode is said to
/// be unstable. About the undeformed body the pressure does not count.
#[test]
fn pressure_lowers_the_frequency_until_the_strip_buckles() {
    let place = CaseDirectory::new();
    let first = |pressure: &str, asked: ModesRequest| {
        let start = format!("controls/0/start={pressure}");
        let (result, said) = modes(&place, &strip(), asked, &[start.as_str()]);
        (result["modes"].clone(), said)
    };
    let hertz = |found: &Value| found["frequencies"][0].as_f64().unwrap();
    let (rest, half) = (first("0 Pa", lowest(1)).0, first("658 Pa", lowest(1)).0);
    // w^2 falls nearly linearly to zero at 1316 Pa
    assert!((hertz(&half).powi(2) / hertz(&rest).powi(2) - 0.5).abs() < 0.03, "{half} {rest}");
    let (beyond, said) = first("2 kPa", lowest(2));
    assert_eq!((&beyond["frequencies"][0], &beyond["unstable"]), (&Value::Null, &1.into()));
    assert!(beyond["growth_rates"][0].as_f64().unwrap() > 1.0 && beyond["growth_rates"][1].is_null(), "{beyond}");
    assert!(said.contains("UNSTABLE") && said.contains("[unstable]"), "{said}");
    let (undeformed, _) = first("2 kPa", ModesRequest { count: 1, undeformed: true });
    assert_eq!((hertz(&undeformed), &undeformed["about"]), (hertz(&rest), &"undeformed body".into()));
}

/// Frequencies in Hz and masses in kg whatever the case's units.
#[test]
fn units_of_the_case_do_not_matter() {
    let place = CaseDirectory::new();
    // a square section bends in any direction, of which each has its modal mass
    let flat = with(BAR, "[1.0, 0.25, 0.25]", "[1.0, 0.25, 0.3]");
    let metres = with(&flat, "\"law\":", "\"density\": \"1100 kg/m^3\", \"law\":");
    let millimetres = with(&metres, "{", "{ \"units\": \"mm\",");
    let undeformed = ModesRequest { count: 1, undeformed: true };
    let one = modes(&place, &metres, undeformed, &[]).0;
    let scaled = modes(&place, &millimetres, undeformed, &[]).0;
    let of = |result: &Value, key: &str| result["modes"][key][0].as_f64().unwrap();
    // the numbers of the mesh are millimetres now: as stiff and dense a body, a thousand times as small
    assert!((of(&scaled, "frequencies") / of(&one, "frequencies") / 1000.0 - 1.0).abs() < 1e-6, "{scaled:#}");
    assert!((of(&scaled, "modal_masses") / of(&one, "modal_masses") * 1e9 - 1.0).abs() < 1e-6, "{scaled:#}");
}

/// What nothing holds has modes about its undeformed state, six of them rigid motions, with a factor or without. Its equilibrium is not determined: what may
/// be asked instead is said.
#[test]
fn a_free_body_has_its_rigid_motions() {
    let place = CaseDirectory::new();
    let dense = with(BAR, "\"law\":", "\"density\": \"1100 kg/m^3\", \"law\":");
    let free = with(&dense, r#""supports": [ { "surface": "x-", "fix": ["x", "y", "z"] } ],"#, "");
    let of = |solver: &str| {
        let set = format!("linear_solver={solver}");
        let (result, said) = modes(&place, &free, ModesRequest { count: 8, undeformed: true }, &[set.as_str()]);
        let found = result["modes"].clone();
        assert_eq!((&found["neutral"], &found["unstable"]), (&6.into(), &0.into()), "{solver}");
        assert!(said.contains("; 6 are zero within rounding, as rigid motions are"), "{said}");
        (found, said)
    };
    let ((direct, _), (products, said)) = (of("direct"), of("multigrid"));
    let hertz = |found: &Value| -> Vec<f64> {
        found["frequencies"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (exact, found) = (hertz(&direct), hertz(&products));
    assert!(exact[..6].iter().chain(&found[..6]).all(|hertz| *hertz == 0.0) && exact[6] > 0.0, "{exact:?} {found:?}");
    assert!(exact.iter().zip(&found).all(|(a, b)| (a - b).abs() <= 1e-8 * a), "{exact:?} {found:?}");
    // how modes without a factor were found is told
    assert!(direct["counted"] == true && direct["iterations"].is_null() && direct["errors"].is_null(), "{direct}");
    assert!(products["counted"] == false && products["iterations"].as_u64().unwrap() > 0, "{products}");
    let errors = products["errors"].as_array().unwrap();
    assert!(errors.len() == 8 && errors.iter().all(|error| error.as_f64().unwrap() <= 1e-7), "{products}");
    assert!(said.contains("iterations, shapes to about ") && said.contains("nothing proves"), "{said}");
    for asked in [lowest(8), ModesRequest { count: 8, undeformed: true }] {
        let options = Options { modes: asked, ..place.options(&[]) };
        let command = if asked.undeformed { Command::Solve } else { Command::Modes };
        let refused = place.run_with(command, &free, &Console::silent(), &options).unwrap_err();
        assert_eq!(refused.exit(), Exit::BadInput);
        assert!(refused.to_string().contains("nastic modes CASE --undeformed"), "{refused}");
    }
}

#[test]
fn every_member_has_its_modes() {
    let place = CaseDirectory::new();
    let cases = r#""load_cases": [
        { "name": "soft", "set": { "materials/0/young": "0.5 MPa" } }, { "name": "hard" } ], "probes""#;
    let case = with(&strip(), r#""probes""#, cases);
    let (result, said) = modes(&place, &case, lowest(1), &["controls/0/start=0 Pa"]);
    let first = |name: &str| result["load_cases"][name]["modes"]["frequencies"][0].as_f64().unwrap();
    assert!((first("hard") / first("soft") - 2f64.sqrt()).abs() < 1e-6, "{result:#}");
    assert!(said.contains("in soft") && place.path("out/soft_start.vtu").exists(), "{said}");
}

/// A motion's modes are those of the equilibrium that it begins at, and are reported as its steps show them: backward Euler
/// has `d/w = ln(1 + t^2)/t` and the frequency `atan(t)/t` at `t = h w`, without damping; with some of its own, more.
#[test]
fn modes_of_a_motion_are_told_as_its_steps_show_them() {
    let place = CaseDirectory::new();
    let (still, _) = modes(&place, &strip(), lowest(2), &["controls/0/start=658 Pa"]);
    let time = r#""time": { "end": "1 s", "step": "100 ms", "scheme": "backward_euler" }, "probes""#;
    let case = with(&strip(), r#""probes""#, time);
    let (result, said) = modes(&place, &case, lowest(2), &["controls/0/start=658 Pa"]);
    let found = &result["modes"];
    assert_eq!(found["about"], "equilibrium at t = 0");
    for k in 0..2 {
        let hertz = found["frequencies"][k].as_f64().unwrap();
        assert!((hertz / still["modes"]["frequencies"][k].as_f64().unwrap() - 1.0).abs() < 1e-8, "{found}");
        let t = 0.1 * TAU * hertz;
        let seen = |key: &str| found["in_steps"][key][k].as_f64().unwrap();
        assert_eq!(seen("damping"), 0.0);
        assert!((seen("damping_seen") - (1.0 + t * t).ln() / t).abs() < 1e-10, "{found}");
        assert!((seen("frequency_ratio") - t.atan() / t).abs() < 1e-10, "{found}");
    }
    assert!(said.contains("backward_euler, 0.1 s"), "{said}");
    let damped = with(&case, "\"backward_euler\"", r#""backward_euler", "start": "rest", "rayleigh": { "mass": 0.5 }"#);
    let found = modes(&place, &damped, lowest(1), &[]).0["modes"].clone();
    assert_eq!(found["about"], "undeformed body");
    let w = TAU * found["frequencies"][0].as_f64().unwrap();
    assert!((found["in_steps"]["damping"][0].as_f64().unwrap() - 0.5 / w).abs() < 1e-12, "{found}");
}

/// The ten lowest modes of `siere` are as they are, the next one is damped as by backward Euler; it has no derivative.
#[test]
fn exact_modes_are_told_as_they_are() {
    let place = CaseDirectory::new();
    let time = r#""time": { "end": "100 ms", "step": "50 ms", "scheme": "siere" }, "probes""#;
    let case = with(&strip(), r#""probes""#, time);
    let (result, _) = modes(&place, &case, lowest(11), &["controls/0/start=0 Pa"]);
    let seen = |key: &str, k: usize| result["modes"]["in_steps"][key][k].as_f64().unwrap();
    for k in 0..10 {
        assert_eq!((seen("damping_seen", k), seen("frequency_ratio", k)), (0.0, 1.0));
    }
    let t = 0.05 * TAU * result["modes"]["frequencies"][10].as_f64().unwrap();
    assert!((seen("damping_seen", 10) - (1.0 + t * t).ln() / t).abs() < 1e-10);
    let solved = place.run(Command::Solve, &case, &["controls/0/start=0 Pa"]).unwrap();
    assert_eq!(solved.exit, Exit::Done);
    for command in [Command::Optimize, Command::Gradcheck] {
        let costs = r#""costs": [ { "kind": "control_norm", "of": "swelling", "weight": 1 } ], "probes""#;
        let refused = place.run(command, &with(&case, r#""probes""#, costs), &[]).unwrap_err();
        assert_eq!(refused.exit(), Exit::BadInput);
        assert!(refused.to_string().contains("the adjoint does not go with \"siere\""), "{refused}");
    }
}

#[test]
fn what_has_no_such_modes_is_refused() {
    let place = CaseDirectory::new();
    let refused = place.run(Command::Modes, BAR, &[]).unwrap_err();
    assert_eq!(refused.exit(), Exit::BadInput);
    assert!(refused.to_string().contains("density"), "{refused}");
    let options = Options { modes: lowest(100_000), ..place.options(&[]) };
    let refused = place.run_with(Command::Modes, &strip(), &Console::silent(), &options).unwrap_err();
    assert_eq!(refused.exit(), Exit::BadInput);
    assert!(refused.to_string().contains("ask for 1 to"), "{refused}");
}

const DROPPED: &str = r#"{
  "nastic": 1,
  "mesh": { "box": { "size": [0.1, 0.02, 0.02], "cells": [4, 1, 1], "element": "hex20" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "200 kPa", "poisson": 0.4, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": ["x", "y", "z"] } ],
  "actuation": [ { "name": "fibre", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0], "tension": "1e-9 Pa * sin(t)" } ],
  "loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ],
  "time": { "end": "0.5 s", "step": "0.01 s", "scheme": "trapezoidal", "start": "rest" }
}"#;

/// Steps that damp or slow a vibration down which carries energy, and those between which a drive oscillates, are said to.
#[test]
fn steps_too_long_for_what_happens_are_said_to_be() {
    let warned = |command: Command, changes: &[(&str, &str)]| -> Vec<String> {
        let case = changes.iter().fold(DROPPED.to_owned(), |case, (before, after)| with(&case, before, after));
        let found = CaseDirectory::new().run(command, &case, &[]).unwrap();
        let all = found.result["warnings"].as_array().unwrap();
        let own = all.iter().filter(|one| one["code"] == "time_step");
        own.map(|one| one["message"].as_str().unwrap().to_owned()).collect()
    };
    let coarse = ("\"0.01 s\"", "\"0.05 s\"");
    let damped = ("trapezoidal", "backward_euler");
    assert_eq!(warned(Command::Solve, &[]), [""; 0]);
    let found = warned(Command::Solve, &[damped]);
    assert!(found.len() == 1 && found[0].contains("damp the lowest vibration by d/w = 0.2"), "{found:?}");
    let found = warned(Command::Solve, &[damped, coarse]);
    assert!(found.len() == 1 && found[0].contains("is seen at 0.6"), "{found:?}");
    // damped by the body itself, and slow beside the vibration
    assert_eq!(
        warned(Command::Solve, &[damped, ("\"start\": \"rest\"", "\"rayleigh\": { \"stiffness\": \"0.1 s\" }")]),
        [""; 0]
    );
    let drive = |formula: &'static str| ("1e-9 Pa * sin(t)", formula);
    let found = warned(Command::Check, &[coarse, drive("10 kPa * sin(2 * pi * 20 * t)")]);
    assert!(found.len() == 1 && found[0].contains("in 10 of 10"), "{found:?}");
    for resolved in ["10 kPa * sin(2 * pi * 1.5 * t)", "10 kPa * (t > 0.12)"] {
        assert_eq!(warned(Command::Check, &[coarse, drive(resolved)]), [""; 0], "{resolved}");
    }
}
