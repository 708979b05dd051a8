//! Motions in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, problems};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options};
use serde_json::Value;

/// A bar of silicone, 100 mm long, whose longitudinal waves take about 6 ms from end to end.
fn case(time: &str, material: &str, blocks: &str) -> String {
    format!(
        r#"{{ "nastic": 1, "title": "bar",
        "mesh": {{ "box": {{ "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3{material} }} ],
        "probes": [ {{ "name": "tip", "point": [0.1, 0.005, 0.005] }} ],
        "time": {{ {time} }}{blocks} }}"#
    )
}

const DENSE: &str = r#", "density": "1000 kg/m^3""#;
const HELD: &str = r#", "supports": [ { "surface": "x-", "fix": "all" } ]"#;
const FIBERS: &str =
    r#", "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0]"#;
/// A control in time with this start.
fn control_text(start: &str) -> String {
    format!(
        r#" }} ], "controls": [ {{ "of": "fibers", "space": "uniform", "lower": "-50 kPa", "upper": 0,
        "start": {start}, "in_time": {{ "every": "10 ms" }} }} ]"#
    )
}

const STEPS: &str = r#""end": "20 ms", "step": "1 ms""#;

fn tip(result: &Value) -> Vec<f64> {
    result["probes"]["tip"]["displacement"].as_array().unwrap().iter().map(|u| u.as_f64().unwrap()).collect()
}

fn solve(text: &str) -> Value {
    CaseDirectory::new().run(Command::Solve, text, &[]).unwrap().result
}

#[test]
fn a_body_without_supports_falls_and_flies() {
    let motion = format!(r#"{STEPS}, "start": "rest", "velocity": ["2 m/s", 0, "0.5 m/s"]"#);
    let result = solve(&case(&motion, DENSE, r#", "loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ]"#));
    let (u, t) = (tip(&result), 0.02);
    for (found, exact) in u.iter().zip([2.0 * t, 0.0, 0.5 * t - 0.5 * 9.81 * t * t]) {
        assert!((found - exact).abs() < 1e-11, "{u:?}");
    }
    let (energies, mass) = (&result["time"]["energies"], 1e-2);
    let kinetic = energies["end"]["kinetic"].as_f64().unwrap();
    let speeds: [f64; 2] = [2.0, 0.5 - 9.81 * t];
    let exact = 0.5 * mass * speeds.iter().map(|v| v * v).sum::<f64>();
    assert!((kinetic / exact - 1.0).abs() < 1e-9, "{kinetic} {exact}");
    // far away, it is deformed no more
    let far = format!(r#"{STEPS}, "start": "rest", "velocity": ["2000 m/s", 0, 0]"#);
    let result = solve(&case(&far, DENSE, ""));
    assert!(
        tip(&result)[0] > 39.0 && !result["warnings"].to_string().contains("extreme_deformation"),
        "{}",
        result["warnings"]
    );
}

#[test]
fn a_value_in_time_and_a_control_in_time_are_the_same() {
    let fixed = case(STEPS, DENSE, &format!(r#"{HELD}{FIBERS}, "tension": "-1 MPa * t / (1 s)" }} ]"#));
    let control = r#" } ], "controls": [ { "of": "fibers", "space": "uniform", "lower": "-50 kPa", "upper": 0,
        "start": "-1 MPa * t / (1 s)", "in_time": { "every": "10 ms" } } ]"#;
    let control = case(STEPS, DENSE, &format!("{HELD}{FIBERS}{control}"));
    let (fixed, controlled) = (solve(&fixed), solve(&control));
    let (a, b) = (tip(&fixed), tip(&controlled));
    assert!(a[0] < -1e-3 && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
    assert_eq!(controlled["controls"]["fibers"]["instants"], serde_json::json!([0.0, 0.01, 0.02]));
    assert_eq!(controlled["controls"]["fibers"]["values"][2], -2e4);
    // from a table, linear between its rows
    let place = CaseDirectory::new();
    place.write("pump.csv", "t, air, tension\n0, 7, 0\n0.01, 8, -1e4\n0.04, 9, -4e4\n");
    let table = r#"{ "file": "pump.csv", "column": "tension" }"#;
    for text in [
        case(STEPS, DENSE, &format!(r#"{HELD}{FIBERS}, "tension": {table} }} ]"#)),
        case(STEPS, DENSE, &format!("{HELD}{FIBERS}{}", control_text(table))),
    ] {
        let c = tip(&place.run(Command::Solve, &text, &[]).unwrap().result);
        assert!(a.iter().zip(&c).all(|(a, c)| (a - c).abs() < 1e-12), "{a:?} {c:?}");
    }
    for (content, column, wanted) in [
        ("t,a\n0,1\n1,x\n", "a", "line 3: \"x\" in column \"a\" is no number"),
        ("t,a\n0,1\n0,2\n", "a", "line 3: t = 0 does not lie behind 0"),
        ("t,a,a\n0,1,2\n1,1,2\n", "a", "two columns are called \"a\""),
        ("t,a\n0,1\n", "b", "no column \"b\"; it has: t, a"),
        ("", "a", "the file is empty"),
    ] {
        place.write("pump.csv", content);
        let table = format!(r#"{{ "file": "pump.csv", "column": "{column}" }}"#);
        let text = case(STEPS, DENSE, &format!(r#"{HELD}{FIBERS}, "tension": {table} }} ]"#));
        let error = place.run(Command::Check, &text, &[]).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    // times in another unit than the case's; a short ramp that is held is none
    for (last, is_told) in [("40", true), ("1e-4", false), ("0.04", false)] {
        place.write("pump.csv", &format!("t,a\n0,0\n{last},-1e4\n"));
        let table = r#"{ "file": "pump.csv", "column": "a" }"#;
        let said =
            place.text(Command::Check, &case(STEPS, DENSE, &format!("{HELD}{FIBERS}{}", control_text(table))), &[]);
        let wanted = "controls/0/start/file: t of pump.csv ends at 40 s, the motion at 0.02 s: t is in the case's unit of time, s";
        assert_eq!(said.contains("[units]"), is_told, "{said}");
        assert!(last != "40" || said.contains(wanted), "{said}");
    }
    // a vector too, of a magnet in a field that turns
    let magnet = r#", "actuation": [ { "name": "magnet", "kind": "magnet", "region": "body", "remanence": [0.05, 0, 0],
        "field": ["0 T", "20 mT * sin(50 * t / (1 s))", "0 T"] } ]"#;
    let moved = tip(&solve(&case(STEPS, DENSE, &format!("{HELD}{magnet}"))));
    assert!(moved[1] > 1e-5, "{moved:?}");
}

#[test]
fn damping_takes_energy() {
    let energy = |time: &str, material: &str| {
        let motion =
            format!(r#"{time}, "end": "100 ms", "step": "1 ms", "velocity": ["10 * X * 1 m/s / (1 m)", 0, 0]"#);
        let result = solve(&case(&motion, &format!("{DENSE}{material}"), HELD));
        let of = |key: &str| {
            let entry = &result["time"]["energies"][key];
            entry["kinetic"].as_f64().unwrap() + entry["potential"].as_f64().unwrap()
        };
        of("end") / of("start")
    };
    let free = energy(r#""scheme": "implicit_midpoint""#, "");
    assert!((free - 1.0).abs() < 1e-3, "{free}");
    let midpoint = r#""scheme": "implicit_midpoint""#;
    for (name, time, material) in [
        ("Maxwell", midpoint.to_owned(), r#", "maxwell": [ { "shear": "60 kPa", "relaxation": "4 ms" } ]"#),
        ("Kelvin-Voigt", midpoint.to_owned(), r#", "kelvin_voigt": { "shear": "100 Pa * (1 s)" }"#),
        ("Rayleigh", format!(r#"{midpoint}, "rayleigh": {{ "mass": "10 / (1 s)", "stiffness": "0.2 ms" }}"#), ""),
    ] {
        let left = energy(&time, material);
        assert!(left > 0.0 && left < 0.5 * free, "{name}: {left} of the energy is left");
    }
}

#[test]
fn costs_and_controls_in_time_have_a_right_gradient() {
    let blocks = r#" } ],
        "controls": [ { "of": "fibers", "space": "uniform", "lower": "-100 kPa", "upper": "100 kPa", "rate": "20 MPa / (1 s)",
            "start": "-20 kPa * sin(200 * t / (1 s))", "in_time": { "every": "5 ms" } } ],
        "costs": [
          { "kind": "position", "surface": "x+", "weight": 1e6, "when": "integral", "target": { "x": "0.1 m - 0.1 m/s * t" } },
          { "kind": "tracking", "surface": "x+", "weight": 1e6, "when": { "at": ["10 ms", "20 ms"] }, "target": ["0.098", "Y", "Z"] },
          { "name": "late", "kind": "position", "point": [0.1, 0, 0], "weight": 1e6, "when": { "time_above": 0.1 }, "target": { "x": "0.095" } },
          { "kind": "control_rate", "of": "fibers", "weight": 1e-9 },
          { "kind": "kinetic_energy", "weight": 1e3, "when": "integral" },
          { "name": "spent", "kind": "actuation_work", "weight": 10 },
          { "kind": "control_norm", "of": "fibers", "weight": 1e-8 } ]"#;
    let text = case(STEPS, DENSE, &format!("{HELD}{FIBERS}{blocks}"));
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Gradcheck, &text, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    // Every second of the terms counts.
    let result = place.run(Command::Gradient, &text, &[]).unwrap().result;
    let terms = result["cost"]["terms"].as_object().unwrap();
    assert_eq!(terms.len(), 7, "{terms:?}");
    assert!(terms.values().all(|value| value.as_f64().unwrap() > 0.0), "{terms:?}");
    let optimum = place.run(Command::Optimize, &text, &["optimizer/max_iterations=5"]).unwrap();
    assert!(optimum.result["cost"]["total"].as_f64() < optimum.result["start"]["cost"]["total"].as_f64());
    assert!(place.files().contains(&"motion.pvd".to_owned()));
}

#[test]
fn a_motion_is_written_step_by_step() {
    let place = CaseDirectory::new();
    let control = r#" } ], "controls": [ { "of": "fibers", "space": "uniform", "lower": "-50 kPa", "upper": 0,
        "start": "-1 MPa * t / (1 s)", "in_time": { "every": "10 ms", "interpolation": "constant" } } ]"#;
    let text = case(&format!(r#"{STEPS}, "output": "5 ms""#), DENSE, &format!("{HELD}{FIBERS}{control}"));
    let result = place.run(Command::Solve, &text, &[]).unwrap().result;
    let files = place.files();
    assert_eq!(files.iter().filter(|name| name.starts_with("motion_")).count(), 5, "{files:?}");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(
        page.contains("\"label\":\"t = 0.0 s\"") || page.contains("\"label\":\"t = 0 s\""),
        "no instants in the page"
    );
    assert!(page.contains("\"label\":\"t = 0.02 s\"") && page.contains("Over the time"));
    assert!(!page.contains("\"label\":\"equilibrium\""), "a motion has none");
    for name in ["motion.csv", "motion.svg", "energies.svg", "controls.svg", "motion.pvd"] {
        assert!(files.iter().any(|file| file == name), "{name} in {files:?}");
    }
    let text = std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 22);
    let column = |name: &str| rows[0].iter().position(|head| *head == name).unwrap();
    let number = |row: usize, name: &str| rows[row][column(name)].parse::<f64>().unwrap();
    assert_eq!(number(21, "t"), 0.02);
    assert_eq!(number(21, "tip.x"), tip(&result)[0]);
    // constant within an interval: the value of its middle
    assert_eq!([5, 20].map(|row| number(row, "fibers")), [-5e3, -15e3]);
    assert!(number(21, "kinetic_energy") > 0.0);
    assert!(result["inertia"].is_null());
    assert_eq!(number(21, "reactions.x-.x"), result["reactions"]["x-"][0].as_f64().unwrap());
}

#[test]
fn what_looks_at_equilibria_refuses_motions() {
    let text = case(STEPS, DENSE, HELD);
    for (analysis, option) in [
        (Analysis::Minimum, "--minimum"),
        (Analysis::ExactContact, "--exact-contact"),
        (Analysis::Modes(2), "--modes"),
        (Analysis::Path, "--path"),
        (Analysis::Equilibria(2), "--equilibria"),
    ] {
        let place = CaseDirectory::new();
        let options = Options { analysis, ..place.options(&[]) };
        let error = place.run_with(Command::Solve, &text, &Console::silent(), &options).unwrap_err().to_string();
        assert!(error.contains(&format!("time: {option} looks at equilibria")), "{error}");
    }
}

#[test]
fn mistakes_are_told_with_what_to_write() {
    let control = |more: &str| {
        format!(
            r#"{HELD}{FIBERS} }} ], "controls": [ {{ "of": "fibers", "space": "uniform", "lower": "-1 kPa", "upper": 0{more} }} ]"#
        )
    };
    for (text, wanted) in [
        (case(STEPS, "", HELD), "a motion needs masses: give every material a \"density\""),
        (
            case(r#""end": "20 ms", "step": "3 ms""#, DENSE, HELD),
            "the end 0.02 is no multiple of the step 0.003: take 0.00285",
        ),
        (
            case(r#""end": "20 ms", "step": "1 ms", "output": "1.5 ms""#, DENSE, HELD),
            "0.0015 is no multiple of the step 0.001",
        ),
        (
            case(r#""end": "20 ms", "dt": "1 ms", "step": "1 ms""#, DENSE, HELD),
            "time/dt: unknown key \"dt\": write \"step\"",
        ),
        (case(&format!(r#"{STEPS}, "memory": 1e-3"#), DENSE, HELD), "time/memory: 0.001 MB are too few"),
        (
            case(&format!(r#"{STEPS}, "scheme": "bdf2", "gamma": 0.5"#), DENSE, HELD),
            "time/gamma: is a parameter of \"newmark\", and the scheme is \"bdf2\"",
        ),
        (
            case(&format!(r#"{STEPS}, "scheme": "newmark", "beta": 0.2"#), DENSE, HELD),
            "time/scheme: Newmark's scheme with beta = 0.2, gamma = 0.6: take 2 beta >= gamma >= 1/2",
        ),
        (case(r#""end": "20 mm", "step": "1 ms""#, DENSE, HELD), "is a length, a time is wanted (s, ms)"),
        (case(STEPS, r#", "density": "1000 kg/m^2""#, HELD), "a density is wanted (kg/m^3)"),
        (case(STEPS, DENSE, ""), "or let it move from rest: \"start\": \"rest\" in \"time\""),
        (
            case(&format!(r#"{STEPS}, "scheme": "quasi_static", "velocity": [0, 0, "1 m/s"]"#), DENSE, HELD),
            "time/velocity: \"quasi_static\" has no inertia",
        ),
        (
            case(&format!(r#"{STEPS}, "scheme": "quasi_static", "start": "rest""#), "", ""),
            "supports: the supports leave",
        ),
        (
            case(
                &format!(r#"{STEPS}, "velocity": [0, 0, "1 m/s"]"#),
                &format!(r#"{DENSE}, "kelvin_voigt": {{ "shear": "5 Pa * 1 s" }}"#),
                HELD,
            ),
            "begins with an acceleration",
        ),
        (
            case(
                STEPS,
                DENSE,
                r#", "supports": [ { "surface": "x-", "displacement": { "x": "1 mm * sin(20 * t / (1 s))" } } ]"#,
            ),
            "supports/0/displacement/x: \"1 mm * sin(20 * t / (1 s))\" depends on the time t, which supports do not",
        ),
        (
            case(STEPS, DENSE, &control(r#", "in_time": { "every": "0.5 ms" }"#)),
            "0.0005 is no multiple of the step 0.001",
        ),
        (
            case(STEPS, DENSE, &control(r#", "start": "-1 kPa * t / (1 s)""#)),
            "the start depends on the time t, and the control does not",
        ),
        (case(STEPS, DENSE, &control(r#", "in_time": { "every": "3 ms" }"#)), "the end 0.02 is no multiple of 0.003"),
        (
            case(STEPS, DENSE, &control(r#", "rate": "1 kPa/(1 s)""#)),
            "the rate of a control that does not change in time",
        ),
        (
            case(STEPS, DENSE, &control(r#", "in_time": { "every": "5 ms" }, "rate": "1 kPa""#)),
            "unit of the wrong kind: \"1 kPa\"",
        ),
        (
            case(
                STEPS,
                DENSE,
                &control(r#", "in_time": { "every": "5 ms" }, "start": "-1 kPa""#)
                    .replace("\"-1 kPa\", \"upper\"", "\"-1 MPa * t / (1 s)\", \"upper\""),
            ),
            "at t = 0 lies outside what is allowed",
        ),
        (case(STEPS, &format!(r#"{DENSE}, "poisson": "0.3 * t / (1 s)""#), HELD), "poisson"),
        (
            case(
                STEPS,
                DENSE,
                &format!(
                    r#"{HELD}, "costs": [ {{ "kind": "position", "surface": "x+", "target": {{ "x": 0.1 }}, "when": {{ "at": "1.5 ms" }} }} ]"#
                ),
            ),
            "t = 0.0015 is no instant of the motion",
        ),
        (
            case(STEPS, DENSE, &format!(r#"{HELD}, "optimizer": {{ "method": "newton_cg" }}"#)),
            "\"newton_cg\" needs second derivatives, which motions do not have",
        ),
        (
            case(STEPS, DENSE, &format!(r#"{HELD}, "optimizer": {{ "verify": true }}"#)),
            "optimizer/verify: every motion is computed from its start",
        ),
        (
            case(STEPS, DENSE, &format!(r#"{HELD}, "optimizer": {{ "unstable": "refuse" }}"#)),
            "optimizer/unstable: the states of a motion are no equilibria",
        ),
    ] {
        let found = problems(&text);
        assert!(found.contains(wanted), "{found}\nwanted: {wanted}");
    }
    // and in a static case
    let still = |text: String| text.replace(&format!(r#""time": {{ {STEPS} }}"#), r#""output": {}"#);
    for (text, wanted) in [
        (case(STEPS, DENSE, &control(r#", "in_time": { "every": "5 ms" }"#)), "controls/0/in_time: the case is static"),
        (
            case(STEPS, DENSE, &format!(r#"{HELD}{FIBERS}, "tension": "-1 MPa * t / (1 s)" }} ]"#)),
            "and the case is static: give \"time\"",
        ),
        (
            case(
                STEPS,
                DENSE,
                &format!(
                    r#"{HELD}, "costs": [ {{ "kind": "position", "surface": "x+", "target": {{ "x": 0.1 }}, "when": "end" }} ]"#
                ),
            ),
            "costs/0/when: the case is static",
        ),
        (case(STEPS, "", &format!(r#"{HELD}, "loads": [ {{ "gravity": [0, 0, -9.81] }} ]"#)), "weight needs masses"),
    ] {
        let found = problems(&still(text));
        assert!(found.contains(wanted), "{found}\nwanted: {wanted}");
    }
}

/// Newmark's scheme with beta = 1/4, gamma = 1/2 is the trapezoidal rule, its defaults are those of the catalogue; memory that is set to
/// suffice does.
#[test]
fn schemes_have_parameters() {
    let motion = |scheme: &str| {
        let time =
            format!(r#"{STEPS}, "scheme": {scheme}, "start": "rest", "velocity": ["10 * X * 1 m/s / (1 m)", 0, 0]"#);
        tip(&solve(&case(&time, DENSE, HELD)))
    };
    let trapezoidal = motion(r#""trapezoidal""#);
    for (scheme, same) in [
        (r#""newmark", "beta": 0.25, "gamma": 0.5"#, true),
        (r#""newmark", "gamma": 0.5"#, true),
        (r#""newmark""#, false),
        (r#""newmark", "gamma": 0.6"#, false),
        (r#""generalized_alpha", "rho": 0.5"#, false),
    ] {
        let found = motion(scheme);
        let gap = (found[0] - trapezoidal[0]).abs();
        assert!(trapezoidal[0].abs() > 1e-3 && (gap < 1e-9) == same, "{scheme}: {gap:e} {trapezoidal:?}");
    }
    let [default, written] = [r#""generalized_alpha""#, r#""generalized_alpha", "rho": 0.8"#].map(motion);
    assert_eq!(default, written);
    let text = problems(&case(&format!(r#"{STEPS}, "memory": 1e-3"#), DENSE, HELD));
    let least: f64 = text.split("at least ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(problems(&case(&format!(r#"{STEPS}, "memory": {least}"#), DENSE, HELD)).is_empty(), "{text}");
}

#[test]
fn weight_is_the_same_as_a_body_force() {
    let weight = |load: &str| {
        tip(&solve(
            &case(STEPS, DENSE, &format!("{HELD}, {load}"))
                .replace(&format!(r#""time": {{ {STEPS} }}"#), r#""output": {}"#),
        ))
    };
    let (a, b) = (
        weight(r#""loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ]"#),
        weight(r#""loads": [ { "region": "body", "body_force": [0, 0, -9810] } ]"#),
    );
    assert!(a[2] < -1e-4 && a == b, "{a:?} {b:?}");
}

/// What springs of viscous laws hold for the moment is no potential: with all nodes prescribed it is that of the equilibrium.
#[test]
fn the_potential_is_that_of_the_relaxed_body() {
    let stretched = r#", "supports": [ { "surface": "x-", "fix": "all" },
        { "surface": "x+", "fix": ["y", "z"], "displacement": { "x": "10 mm" } } ]"#;
    let time = format!(r#"{STEPS}, "scheme": "quasi_static", "start": "rest""#);
    let viscous =
        r#", "maxwell": [ { "shear": "0.1 MPa", "relaxation": "1 s" } ], "kelvin_voigt": { "shear": "50 Pa * 1 s" }"#;
    let moving = case(&time, viscous, stretched).replace("[4, 1, 1]", "[1, 1, 1]");
    let still = moving.replace(&format!(r#""time": {{ {time} }}"#), r#""output": {}"#);
    let (moving, still) = (solve(&moving), solve(&still));
    let exact = still["potential"].as_f64().unwrap();
    for found in [&moving["potential"], &moving["time"]["energies"]["end"]["potential"]] {
        assert!((found.as_f64().unwrap() / exact - 1.0).abs() < 1e-12 && exact > 1e-3, "{found} {exact}");
    }
}

/// A target that moves is shown where it is at the end; unusual densities and tensions beyond the law at any instant are warned of.
#[test]
fn the_end_is_shown_and_all_instants_are_looked_at() {
    let cost = r#", "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X + 1 m/s * t", "Y", "Z"], "when": "integral" } ]"#;
    let problem = common::lower(&case(STEPS, DENSE, &format!("{HELD}{cost}"))).unwrap();
    let target = &problem.member(0).targets()[0];
    let moved: Vec<f64> = target.displacement.iter().filter(|(_, matters)| *matters).map(|(u, _)| u[0]).collect();
    assert!(moved.len() == 4 && moved.iter().all(|u| (u - 0.02).abs() < 1e-15), "{moved:?}");
    let text = common::warnings(&case(STEPS, r#", "density": 1.07"#, HELD));
    assert!(text.contains("materials/0/density: a density of 1.07 kg/m^3 is no usual one"), "{text}");
    let late = format!(r#"{HELD}{FIBERS}, "tension": "20 MPa * t / (1 s)" }} ]"#);
    let text = common::warnings(&case(STEPS, DENSE, &late));
    assert!(text.contains("actuation/0/tension: a tension of 400000"), "{text}");
}
