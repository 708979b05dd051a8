//! Cases that are probably not what was meant: each is warned about, with the likely reason, and the usual one beside it is not.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, bar_with, messages, warnings, with};
use nastic_language::schema::Command;
use serde_json::Value;

fn solve(case: &str) -> Value {
    CaseDirectory::new().run(Command::Solve, case, &[]).unwrap_or_else(|error| panic!("{error}")).result
}

/// One warning that has these words, or none.
fn expect(case: &str, words: Option<[&str; 2]>) {
    let said = warnings(case);
    match words {
        Some(words) => assert!(words.iter().all(|word| said.contains(word)) && said.lines().count() == 1, "{said}"),
        None => assert_eq!(said, "", "{case}"),
    }
}

#[test]
fn densities_with_the_likely_factor() {
    for (density, meant) in [("1.07 kg/m^3", "1070"), ("1.07e6 kg/m^3", "1070"), ("1070", "1070"), ("1e-9", "")] {
        let case = with(&bar_with(""), "1000 kg/m^3", density);
        let likely = format!("{meant} kg/m^3 would be usual");
        expect(&case, (!meant.is_empty()).then_some(["[units]", &likely]));
    }
}

#[test]
fn gravity_with_the_likely_factor() {
    let pulled = |gravity: &str| bar_with(&format!(r#", "loads": [ {{ "gravity": [0, 0, {gravity}] }} ]"#));
    expect(&pulled("-9.81"), Some(["[units]", "9.81 m/s^2 would be usual, is a factor of 1000 missing?"]));
    expect(&pulled("\"-9810 m/s^2\""), Some(["[units]", "is a factor of 1000 too many?"]));
    ["-9810", "\"-1.62 m/s^2\"", "0"].iter().for_each(|usual| expect(&pulled(usual), None));
}

/// A magnet, its field a control or given, constant or over the time.
#[test]
fn magnetic_fields_of_many_teslas() {
    let magnet = |remanence: &str, field: &str, more: &str| {
        bar_with(&format!(
            r#", "actuation": [ {{ "name": "magnet", "kind": "magnet", "region": "body", "remanence": [{remanence}, 0, 0]{field} }} ]{more}"#
        ))
    };
    let given = |field: &str| format!(r#", "field": [0, {field}, 0]"#);
    let bounded = |norm: &str| {
        format!(
            r#", "controls": [ {{ "of": "magnet.field", "space": "uniform", "start": [0, 0, 0], "max_norm": {norm} }} ]"#
        )
    };
    expect(&magnet("\"80 mT\"", &given("\"10 mT\""), ""), None);
    expect(&magnet("80", &given("\"10 mT\""), ""), Some(["it reaches 80 T", "0.08 T would be usual"]));
    expect(&magnet("0.08", &given("10"), ""), Some(["it reaches 10 T", "0.01 T would be usual"]));
    expect(&magnet("0.08", "", &bounded("20")), Some(["the bounds reach 20 T", "0.02 T would be usual"]));
    expect(&magnet("0.08", "", &bounded("\"20 mT\"")), None);
    let moves = r#", "time": { "end": "1 s", "step": "20 ms", "start": "rest" }"#;
    let swings = |size: &str| magnet("0.08", &given(&format!(r#""{size} * sin(6 * t / (1 s))""#)), moves);
    expect(&swings("20 T"), Some(["over the time it reaches", "0.02 T would be usual"]));
    expect(&swings("20 mT"), None);
}

#[test]
fn electric_fields_beyond_any_breakdown() {
    let film = |field: &str| {
        let driven = r#", "actuation": [ { "name": "film", "kind": "dielectric", "region": "body", "direction": "z", "relative_permittivity": 3, "field": FIELD } ]"#;
        warnings(&bar_with(&with(driven, "FIELD", field)))
    };
    let usual = film("\"30 kV/mm\"");
    assert!(!usual.contains("[units]"), "{usual}");
    let beyond = film("\"30 MV/mm\"");
    assert!(beyond.contains("it reaches 3e+10 V/m") && beyond.contains("3e+07 V/m would be usual"), "{beyond}");
}

/// Plain numbers under millimetres, a bulk modulus in kPa beside one in Pa.
#[test]
fn pressures_and_moduli_in_another_unit() {
    let pushed = |load: &str| bar_with(&format!(r#", "loads": [ {load} ]"#));
    let traction = |value: &str| pushed(&format!(r#"{{ "surface": "x+", "traction": [{value}, 0, 0] }}"#));
    expect(&traction("\"5 GPa\""), Some(["[bounds]", "25000 times Young's modulus of the stiffest"]));
    expect(&traction("\"5 GPa * Y / (10 mm)\""), Some(["[bounds]", "times Young's modulus of the stiffest"]));
    expect(&traction("\"5 kPa\""), None);
    let force = |value: &str| pushed(&format!(r#"{{ "region": "body", "body_force": [{value}, 0, 0] }}"#));
    expect(&force("1e3"), Some(["[bounds]", "over the size of the body this force is"]));
    expect(&force("1e-5"), None);
    let turgor = |value: &str| {
        bar_with(&format!(
            r#", "actuation": [ {{ "name": "water", "kind": "turgor", "region": "body", "pressure": {value} }} ]"#
        ))
    };
    assert!(warnings(&turgor("\"40 MPa\"")).contains("it reaches 40 MPa, 200 times"));
    assert!(!warnings(&turgor("\"40 kPa\"")).contains("[bounds]"));
    let gent = |bulk: &str| {
        let law = format!(r#""law": "gent", "mu": "80 kPa", "jm": 60, "bulk": "{bulk}""#);
        with(&bar_with(""), r#""law": "neo_hooke", "young": "0.2 MPa", "poisson": 0.3"#, &law)
    };
    expect(&gent("4 kPa"), Some(["[units]", "Poisson's ratio at small strains is -0.8043"]));
    expect(&gent("60 kPa"), None);
}

/// In N/m^3 under millimetres, in metres under millimetres.
#[test]
fn foundations_and_springs_in_another_unit() {
    let beside = |blocks: &str| bar_with("").replace("\"fix\": \"all\" }", &format!("\"fix\": \"all\" }}{blocks}"));
    let bed = |stiffness: &str| beside(&format!(r#", {{ "surface": "z-", "foundation": {stiffness} }}"#));
    expect(&bed("1e6"), Some(["[units]", "this foundation is 1"]));
    expect(&bed("\"1e6 N/m^3\""), None);
    let spring = |stiffness: &str, length: &str| {
        bar_with(&format!(
            r#", "springs": [ {{ "from": [20, 2, 2], "to": {{ "ground": [40, 2, 2] }}, "stiffness": {stiffness}, "length": {length} }} ]"#
        ))
    };
    expect(&spring("0.5", "0.02"), Some(["[units]", "a rest length of 0.02 mm where its ends are 20 mm apart"]));
    expect(&spring("1e9", "20"), Some(["[units]", "this spring is"]));
    ["20", "0", "1"].iter().for_each(|usual| expect(&spring("0.5", usual), None));
}

#[test]
fn targets_far_away() {
    let aimed = |cost: &str| {
        bar_with(&format!(
            r#", "actuation": [ {{ "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": "x", "tension": "-1 kPa" }} ],
               "costs": [ {cost} ]"#
        ))
    };
    let position = |x: &str| aimed(&format!(r#"{{ "kind": "position", "surface": "x+", "target": {{ "x": {x} }} }}"#));
    expect(&position("2000"), Some(["[units]", "the target is 1980 mm away from the body at rest, 95 times its size"]));
    expect(&position("30"), None);
    let tracked =
        |by: &str| aimed(&format!(r#"{{ "kind": "tracking", "surface": "x+", "target": ["X + {by}", "Y", "Z"] }}"#));
    expect(&tracked("2000"), Some(["[units]", "the target is 2000 mm away"]));
    expect(&tracked("5"), None);
}

#[test]
fn cables_and_springs_between_held_points() {
    let cable = |end: &str| {
        bar_with(&format!(
            r#", "actuation": [ {{ "name": "cable", "kind": "tendon", "points": [[0, 1, 1], {end}], "tension": "1 mN" }} ]"#
        ))
    };
    expect(&cable("[0, 3, 3]"), Some(["[input]", "all its guides are held"]));
    expect(&cable("[20, 3, 3]"), None);
    let spring = |from: &str| {
        bar_with(&format!(
            r#", "springs": [ {{ "from": {from}, "to": {{ "ground": [10, 2, 20] }}, "stiffness": 1 }} ]"#
        ))
    };
    expect(&spring("[0, 2, 2]"), Some(["[input]", "both its ends are held"]));
    expect(&spring("[10, 2, 4]"), None);
}

#[test]
fn scenarios_that_are_all_the_same() {
    let twice = |young: &str| {
        let one = |young: &str| format!(r#"{{ "set": {{ "materials/0/young": "{young}" }} }}"#);
        let scenarios = format!(r#", "scenarios": [ {}, {} ]"#, one("90 kPa"), one(young));
        bar_with(&format!(
            r#", "actuation": [ {{ "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": "x", "tension": "-1 kPa" }} ],
               "costs": [ {{ "kind": "position", "surface": "x+", "target": {{ "x": 19 }} }} ]{scenarios}"#
        ))
    };
    expect(&twice("90 kPa"), Some(["[input]", "all 2 scenarios are the same"]));
    expect(&twice("91 kPa"), None);
}

/// A cube of 10 mm that begins at rest above a floor, or beside none.
const FALLING: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [10, 10, 10], "cells": [1, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.2 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ],
  "time": { "end": "0.3 s", "step": "10 ms", "scheme": "backward_euler", "start": "rest" } }"#;

/// After 0.3 s it has fallen by g t^2/2 = 441 mm (backward Euler adds h t g/2 = 15 mm), 26 times its diagonal of 17.3 mm.
#[test]
fn free_fall() {
    let found = solve(FALLING);
    let told = messages(&found, "free_flight");
    assert!(told.len() == 1 && told[0].contains("the body flies 456.165 mm far, 26 times its size"), "{told:?}");
    let short = messages(&solve(&with(FALLING, "0.3 s", "0.1 s")), "free_flight");
    assert!(short.is_empty(), "{short:?}");
    // on a floor it stays
    let floor = r#""obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, -1], "normal": [0, 0, 1] } } } ],
        "contact": [ { "surface": "z-", "obstacle": "floor" } ], "loads": ["#;
    let landed = solve(&with(FALLING, "\"loads\": [", floor));
    assert!(messages(&landed, "free_flight").is_empty(), "{}", landed["warnings"]);
    // of which the sign of gravity takes it away, which is told before
    let upwards = with(&with(FALLING, "\"loads\": [", floor), "-9.81", "9.81");
    expect(&upwards, Some(["[input]", "gravity takes the body away from \"floor\""]));
    assert_eq!(messages(&solve(&upwards), "free_flight").len(), 1);
}

/// Of a motion the smallest J is reported once: that of all instants.
#[test]
fn the_smallest_j_of_a_motion_once() {
    let pressed = bar_with(
        r#", "actuation": [ { "name": "swell", "kind": "turgor", "region": "body", "pressure": "-2 MPa * sin(3.1415926535 * t / (1 s))" } ],
             "time": { "end": "1 s", "step": "50 ms", "scheme": "quasi_static", "start": "rest", "output": "0.1 s" }"#,
    );
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, &pressed, &[]).unwrap_or_else(|error| panic!("{error}")).result;
    let told = messages(&found, "extreme_deformation");
    assert_eq!(told.len(), 1, "{told:?}");
    let least = found["min_J"].as_f64().unwrap();
    assert!(least < 0.2 && told[0].contains(&format!("at t = 0.5 s, is {least:.3}")), "{least}: {told:?}");
    let table = std::fs::read_to_string(place.path("out/motion.csv")).unwrap();
    let column: Vec<f64> = table.lines().skip(1).map(|row| row.split(',').nth(3).unwrap().parse().unwrap()).collect();
    assert_eq!(column.into_iter().fold(f64::INFINITY, f64::min), least);
}

/// A modulus in GPa moves the bar by a millionth of itself.
#[test]
fn a_body_that_hardly_moves() {
    let pulled = |young: &str| {
        let case =
            with(&bar_with(r#", "loads": [ { "surface": "x+", "traction": ["1 kPa", 0, 0] } ]"#), "0.2 MPa", young);
        messages(&solve(&case), "still")
    };
    let told = pulled("200 MPa");
    assert!(told.len() == 1 && told[0].contains("no point moves by more than"), "{told:?}");
    assert!(pulled("0.2 MPa").is_empty());
    // at rest nothing acts
    assert!(messages(&solve(&bar_with("")), "still").is_empty());
}

/// Obstacles that race, or that are in the body before any contact has seen them; poses that no solve takes are found before any.
#[test]
fn poses_that_are_hardly_meant() {
    let ball = |pose: &str, more: &str| {
        bar_with(&format!(
            r#", "obstacles": [ {{ "name": "ball", "shape": {{ "sphere": {{ "center": [15, 2, -3], "radius": 2 }} }}{pose} }} ],
            "contact": [ {{ "surface": "z-", "obstacle": "ball" }} ]{more}"#
        ))
    };
    let time = |step: &str| format!(r#", "time": {{ "end": "20 ms", "step": "{step}", "start": "rest" }}"#);
    let moves = |way: &str, step: &str| {
        warnings(&ball(&format!(r#", "translation": [0, "{way} * t / (20 ms)", 0]"#), &time(step)))
    };
    assert!(!moves("8 mm", "2 ms").contains("it moves"), "{}", moves("8 mm", "2 ms"));
    assert!(moves("8 mm", "10 ms").contains("4 mm within one time step"), "{}", moves("8 mm", "10 ms"));
    let floor = ball("", "").replace(
        r#"{ "sphere": { "center": [15, 2, -3], "radius": 2 } }"#,
        r#"{ "half_space": { "point": [0, 0, -3], "normal": [0, 0, 1] } }, "translation": [0, "90 mm * t / (20 ms)", 0]"#,
    );
    let belt = warnings(&with(&floor, r#", "obstacles""#, &format!(r#"{}, "obstacles""#, time("10 ms"))));
    assert!(!belt.contains("it moves"), "{belt}");
    assert!(moves("400 mm", "0.01 ms").contains("it moves with 20 m/s"));
    let hand = |way: &str| {
        let moves = format!(
            r#", "actuation": [ {{ "name": "hand", "kind": "motion", "surface": "x+", "translation": ["{way} * t / (20 ms)", 0, 0] }} ]{}"#,
            time("0.1 ms")
        );
        warnings(&bar_with(&moves)).contains("it moves with")
    };
    assert!(hand("400 mm") && !hand("2 mm"));
    let flies = |speed: &str| {
        warnings(&ball(
            "",
            &format!(
                r#", "time": {{ "end": "1 ms", "step": "0.1 ms", "start": "rest", "velocity": [0, 0, "{speed}"] }}"#
            ),
        ))
    };
    let free = |speed: &str| flies(speed).contains("it begins with");
    assert!(free("30 m/s") && !free("1 m/s"));
    let place = CaseDirectory::new();
    let error = place.run(Command::Check, &ball(r#", "rotation": [0, 0, 90]"#, ""), &[]).unwrap_err().to_string();
    assert!(error.contains("obstacles/0: contact") && error.contains("rotations are in radians"), "{error}");
}
