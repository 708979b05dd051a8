//! Tendons that cannot stretch in case files: their pull as a control, a fixed value, a ramp.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options};

/// A finger with a flexor below its axis and an extensor above it, what drives each, and the controls.
fn case([flexor, extensor]: [&str; 2], controls: &str) -> String {
    let tendon = |name: &str, z: f64, drive: &str| {
        format!(
            r#"{{ "name": "{name}", "kind": "tendon", "points": [[0, 8, {z}], [100, 8, {z}]], "spacing": 10{drive} }}"#
        )
    };
    let tendons = [tendon("flexor", 3.0, flexor), tendon("extensor", 17.0, extensor)].join(", ");
    format!(
        r#"{{ "nastic": 1, "units": "mm",
        "mesh": {{ "box": {{ "size": [100, 16, 20], "cells": [10, 1, 2], "element": "hex8" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3 }} ],
        "supports": [ {{ "surface": "x-", "fix": "all" }} ],
        "actuation": [ {tendons} ], "controls": [ {controls} ],
        "costs": [ {{ "kind": "tracking", "surface": "x+", "target": ["X - 10", "Y", "Z - 30"] }} ],
        "probes": [ {{ "name": "tip", "point": [100, 8, 10] }} ] }}"#
    )
}

const LET_OUT: &str = r#", "pull": "-50 mm""#;
const PULLED: &str =
    r#"{ "of": "flexor.pull", "space": "uniform", "start": "10 mm", "lower": "0 mm", "upper": "30 mm" }"#;

fn number(result: &serde_json::Value, path: &str) -> f64 {
    nastic_run::result::find(result, path).and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN)
}

#[test]
fn a_pull_is_a_control_or_a_fixed_value() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, &case(["", LET_OUT], PULLED), &[]).unwrap().result;
    let of = |name: &str, what: &str| number(&found, &format!("contributions/{name}/{what}"));
    let (tension, tip) = (of("flexor", "tension"), number(&found, "probes/tip/displacement/2"));
    assert!((of("flexor", "length") - 90.0).abs() < 1e-9 && tension > 0.5 && tip < -15.0, "{tension}, {tip}");
    assert_eq!((of("flexor", "slack"), of("flexor", "pull"), of("flexor", "reference_length")), (0.0, 10.0, 100.0));
    assert_eq!((of("extensor", "slack"), of("extensor", "tension")), (1.0, 0.0));
    assert_eq!(found["inertia"], 0);
    let lines = std::fs::read_to_string(place.path("out").join("start_lines.vtu")).unwrap();
    assert!(lines.contains("line:flexor") && lines.contains("Name=\"tension\""), "{lines}");
    assert!(std::fs::read_to_string(place.path("out").join("picture.svg")).unwrap().contains("grey where slack"));
    // fixed to the same, or to the tension found
    for drive in [r#", "pull": "10 mm""#.to_owned(), format!(r#", "tension": {tension:?}"#)] {
        let same = place.run(Command::Solve, &case([&drive, LET_OUT], ""), &[]).unwrap().result;
        assert!((number(&same, "probes/tip/displacement/2") / tip - 1.0).abs() < 1e-8, "{drive}");
        assert!((number(&same, "contributions/flexor/length") - 90.0).abs() < 1e-7, "{drive}");
    }
    // tied at its length at rest, the extensor holds the finger
    let held = place.run(Command::Solve, &case(["", r#", "pull": "0 mm""#], PULLED), &[]).unwrap().result;
    let (length, lifted) = (number(&held, "contributions/extensor/length"), number(&held, "probes/tip/displacement/2"));
    assert!((length - 100.0).abs() < 1e-9 && lifted > 0.9 * tip, "{length}, {lifted} after {tip}");
}

#[test]
fn its_gradient_is_right_and_leads_to_the_target() {
    let both = format!("{PULLED}, {}", PULLED.replace("flexor", "extensor").replace("\"10 mm\"", "\"1 mm\""));
    let place = CaseDirectory::new();
    let checked = place.run(Command::Gradcheck, &case(["", ""], &both), &[]).unwrap();
    assert_eq!(checked.exit, Exit::Done, "{}", checked.result);
    // From rest, where the derivative is that of the taut cable.
    let from_rest = PULLED.replace("\"10 mm\"", "0");
    let outcome = place.run(Command::Optimize, &case(["", LET_OUT], &from_rest), &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    let tip = number(&outcome.result, "probes/tip/displacement/2");
    assert!((tip + 30.0).abs() < 3.0 && number(&outcome.result, "contributions/flexor/tension") > 0.5, "{tip}");
}

/// From a cable that is let out to one that is drawn in: lengths and tensions as a table.
#[test]
fn a_ramp_of_the_pull_passes_the_onset() {
    let place = CaseDirectory::new();
    let analysis = Analysis::Ramp("flexor.pull=-5 mm:15 mm:5".to_owned());
    let options = Options { analysis, ..place.options(&[]) };
    let text = case(["", LET_OUT], PULLED);
    let outcome = place.run_with(Command::Solve, &text, &Console::silent(), &options).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    let table = std::fs::read_to_string(place.path("out").join("ramp.csv")).unwrap();
    let (head, rows) = table.split_once('\n').unwrap();
    let column = |name: &str| -> Vec<f64> {
        let at = head.split(',').position(|own| own == name).unwrap_or_else(|| panic!("no {name} in {head}"));
        rows.lines().map(|row| row.split(',').nth(at).unwrap().parse().unwrap()).collect()
    };
    let (pulls, tensions) = (column("flexor.pull"), column("flexor.tension"));
    assert_eq!(pulls, [-5.0, 0.0, 5.0, 10.0, 15.0]);
    assert!(tensions[..2] == [0.0, 0.0] && tensions[1..].windows(2).all(|pair| pair[0] < pair[1]), "{tensions:?}");
}

#[test]
fn mistakes_are_told() {
    let message = |drive: [&str; 2], controls: &str, wanted: &str| {
        let found = problems(&case(drive, controls));
        assert!(found.contains(wanted), "{found}");
    };
    let tension = r#", "tension": "1 N""#;
    message([tension, LET_OUT], PULLED, "\"flexor\" is driven by its tension and by its pull: keep one of them");
    message(["", LET_OUT], "", "\"flexor\" has no effect: its tension is zero");
    message([r#", "pull": "1 N""#, LET_OUT], "", "actuation/0/pull");
    message(["", LET_OUT], &PULLED.replace("30 mm", "30 N"), "controls/0/upper");
    message(["", LET_OUT], &PULLED.replace("flexor.pull", "flexor.pul"), "did you mean \"flexor.pull\"");
    let inputs = "no actuation \"flexor.tension\": what can be controlled of \"flexor\" is \"flexor\" (its tension) and \
                  \"flexor.pull\" (its pull), one of which drives it";
    message(["", LET_OUT], &PULLED.replace("flexor.pull", "flexor.tension"), inputs);
    let elastic = r#", "stiffness": "2 N/mm""#;
    let input = "no actuation \"flexor.tension\": what can be controlled of \"flexor\" is \"flexor\" (its pull); with \"stiffness\" a tendon has no \
                 tension";
    message([elastic, LET_OUT], &PULLED.replace("flexor.pull", "flexor.tension"), input);
    let error = CaseDirectory::new().run(Command::Solve, &case([r#", "pull": "100 mm""#, LET_OUT], ""), &[]);
    let error = format!("{:?}", error.map(|outcome| outcome.result.to_string()));
    assert!(error.contains("leaves none of its length"), "{error}");
    let time = r#""time": { "end": "10 ms", "step": "5 ms", "scheme": "implicit_midpoint" }, "probes""#;
    let moving = case([r#", "pull": "1 mm""#, LET_OUT], "").replace("\"probes\"", time);
    let found = problems(&moving.replace("\"law\"", "\"density\": \"1000 kg/m^3\", \"law\""));
    assert!(found.contains("time/scheme: implicit_midpoint does not go with \"flexor\""), "{found}");
}

/// A pull in motion, along a path from rest, and the modes about its end: the tendon is as long as it is let.
#[test]
fn a_pull_goes_with_motions_paths_and_modes() {
    let still = case([r#", "pull": "1 mm""#, LET_OUT], "");
    let taut = |result: &serde_json::Value| {
        let of = |key: &str| result["contributions"]["flexor"][key].as_f64().unwrap();
        assert!(of("tension") > 0.0, "{result}");
        assert!(((of("length") + of("pull")) / of("reference_length") - 1.0).abs() < 1e-10, "{result}");
    };
    let time = r#""time": { "end": "10 ms", "step": "5 ms", "start": "rest" }, "probes""#;
    let moving = still.replace("\"probes\"", time).replace("\"law\"", "\"density\": \"1000 kg/m^3\", \"law\"");
    let outcome = CaseDirectory::new().run(Command::Solve, &moving, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    taut(&outcome.result);
    for analysis in [Analysis::Path, Analysis::Modes(2)] {
        let place = CaseDirectory::new();
        let options = Options { analysis, ..place.options(&[]) };
        let outcome = place.run_with(Command::Solve, &still, &Console::silent(), &options).unwrap();
        assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    }
}

/// A misspelt "stiffness" makes it another tendon, of which controls and motions would get messages that do not concern them.
#[test]
fn a_mistake_in_a_tendon_is_told_once() {
    let own = PULLED.replace("flexor.pull", "flexor");
    let time = r#""time": { "end": "10 ms", "step": "5 ms" }, "probes""#;
    for (drive, controls, wanted) in [
        (r#", "pull": "1 N""#, "", "a length is wanted"),
        (r#", "tensoin": "1 N""#, "", "did you mean \"tension\"?"),
        (r#", "stifness": "2 N/mm""#, own.as_str(), "unknown key \"stifness\""),
        (r#", "stifness": "2 N/mm", "pull": "1 mm""#, "", "unknown key \"stifness\""),
    ] {
        let still = case([drive, r#", "tension": "1 N""#], controls);
        let moving = still.replace("\"probes\"", time).replace("\"law\"", "\"density\": \"1000 kg/m^3\", \"law\"");
        for found in [problems(&still), problems(&moving)] {
            assert!(found.lines().count() == 1 && found.contains(wanted), "{drive}: {found}");
        }
    }
}

/// Let out by 8 mm the flexor is slack where the extensor has lifted the end: nothing depends on its pull there.
#[test]
fn a_cable_that_is_slack_at_the_optimum_is_said_to_be() {
    let finger = include_str!("../../../examples/cases/tendon_finger.json");
    let of = |name: &str, pull: &str| {
        let before = format!(r#"{{ "of": "{name}", "space": "uniform", "start": "1 N", "upper": "15 N" }}"#);
        (before, format!(r#"{{ "of": "{name}.pull", "space": "uniform", {pull}, "upper": "15 mm" }}"#))
    };
    let lifted = |flexor: &str| {
        let (flexor, extensor) = (of("flexor", flexor), of("extensor", r#""start": "1 mm", "lower": "0 mm""#));
        let case = with(&with(finger, &flexor.0, &flexor.1), &extensor.0, &extensor.1);
        let case = with(&case, "[20, 2, 2]", "[8, 1, 1]");
        let case = with(&case, r#""76 + 0.8 * (Z - 10)", "Y", "-32 + 0.6 * (Z - 10)""#, r#""96", "Y", "Z + 20""#);
        let found = CaseDirectory::new().run(Command::Optimize, &case, &["expect={}"]).unwrap();
        let all = found.result["warnings"].as_array().unwrap().clone();
        all.into_iter().find(|warning| warning["code"] == "idle").map(|one| one["message"].as_str().unwrap().to_owned())
    };
    let idle = lifted(r#""start": "-8 mm", "lower": "-10 mm""#).unwrap();
    assert!(
        idle.contains("flexor.pull: the derivative is exactly zero") && idle.contains("the cable is slack"),
        "{idle}"
    );
    // at its lower bound nothing is wrong
    assert_eq!(lifted(r#""start": "-8 mm", "lower": "-8 mm""#), None);
}
