//! `nastic solve` with `--modes`: what is computed of the stability of equilibria, and what is written about it.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod common;

use common::{BAR, Heard, Place};
use nastic_case::console::Console;
use nastic_case::run::{Analysis, Exit, Options};
use nastic_case::schema::Command;
use serde_json::Value;

const STRIP: &str = include_str!("cases/swelling_strip.json");

/// The result of an analysis, how it ended and what it said.
fn analyse(place: &Place, case: &str, analysis: Analysis, set: &[&str]) -> (Value, Exit, String) {
    let heard = Heard::default();
    let options = Options { analysis, ..place.options(set) };
    let outcome = place.run_with(Command::Solve, case, &Console::new(heard.clone()), &options);
    let outcome = outcome.unwrap_or_else(|error| panic!("{error}"));
    (outcome.result, outcome.exit, heard.text())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

#[test]
fn modes_are_told_and_written() {
    let place = Place::new();
    let (result, exit, said) = analyse(&place, STRIP, Analysis::Modes(3), &[]);
    assert_eq!(exit, Exit::Done);
    let lambda = numbers(&result["modes"]["eigenvalues"]);
    assert_eq!(lambda.len(), 3);
    assert!(lambda[0] < 0.0 && 0.0 < lambda[1] && lambda[1] < lambda[2], "{lambda:?}");
    assert_eq!(result["modes"]["negative"], result["inertia"]);
    assert_eq!(result["modes"]["unit"], "N/m^4");
    assert_eq!(said.lines().filter(|line| line.contains("N/m^4")).count(), 3, "{said}");
    assert_eq!(said.lines().filter(|line| line.ends_with("unstable")).count(), 1, "{said}");
    let snapshot = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    let middle = snapshot.mesh.points().iter().position(|x| *x == [0.5, 0.01, 0.0]).unwrap();
    for k in 1..=3 {
        let mode = snapshot.point_array(&format!("mode_{k}")).unwrap();
        let largest = mode.values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        assert_eq!(largest, 1.0);
    }
    // the first mode bends to one side
    let first = snapshot.point_array("mode_1").unwrap().at(middle);
    assert!(first[1] > 0.99 && first[0].abs() < 0.01, "{first:?}");
}

#[test]
fn every_member_has_its_modes() {
    let place = Place::new();
    let cases = r#""load_cases": [ { "name": "calm", "set": { "materials/0/young": "2 MPa" } }, { "name": "pressed" } ], "probes""#;
    let case = common::with(STRIP, r#""probes""#, cases);
    let (result, ..) = analyse(&place, &case, Analysis::Modes(1), &[]);
    let first = |name: &str| result["load_cases"][name]["modes"]["eigenvalues"][0].as_f64().unwrap();
    assert!(first("calm") > 0.0 && first("pressed") < 0.0, "{result:#}");
    assert!(place.path("out/pressed_start.vtu").exists());
}

#[test]
fn more_modes_than_unknowns_are_refused() {
    let place = Place::new();
    let options = Options { analysis: Analysis::Modes(1000), ..place.options(&[]) };
    let refused = place.run_with(Command::Solve, BAR, &Console::silent(), &options).unwrap_err();
    assert!(refused.to_string().contains("ask for 1 to 48"), "{refused}");
}
