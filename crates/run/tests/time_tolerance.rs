//! Motions in case files whose time steps follow a tolerance.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, resume};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A bar of silicone that fibres hold shortened until t = 0, then vibrates; Rayleigh damping brings it to rest.
const RELEASED: &str = r#"{ "nastic": 1, "title": "bar",
  "mesh": { "box": { "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0],
                   "tension": "-20 kPa * (t <= 0)" } ],
  "probes": [ { "name": "tip", "point": [0.1, 0.005, 0.005] } ],
  "time": { "end": "100 ms", "tolerance": "2 um", "output": "10 ms", "rayleigh": { "mass": "40 / (1 s)", "stiffness": "0.5 ms" } } }"#;

/// The same bar, driven by a control.
fn driven() -> String {
    let fixed = r#""direction": [1, 0, 0],
                   "tension": "-20 kPa * (t <= 0)" } ],"#;
    let control = r#""direction": [1, 0, 0] } ],
  "controls": [ { "of": "fibers", "space": "uniform", "lower": "-60 kPa", "upper": 0, "start": "-2 kPa",
                  "in_time": { "every": "10 ms" } } ],
  "costs": [ { "kind": "position", "surface": "x+", "weight": 1e6, "target": { "x": "0.09" }, "when": { "at": ["13 ms", "40 ms"] } },
             { "kind": "control_rate", "of": "fibers", "weight": 1e-13 } ],
  "optimizer": { "max_iterations": 12 },"#;
    with(&with(RELEASED, fixed, control), "100 ms", "40 ms")
}

fn solve(case: &str) -> (CaseDirectory, Value) {
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Solve, case, &[]).unwrap_or_else(|error| panic!("{error}"));
    (place, outcome.result)
}

fn rows(place: &CaseDirectory) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect()
}

/// Displacement of the tip at the end of the shared stretch of time.
fn tip_at(rows: &[Vec<f64>], t: f64) -> f64 {
    rows.iter().find(|row| (row[0] - t).abs() < 1e-12).unwrap()[5]
}

/// Steps are short while the bar vibrates and long at the end; they lead through what is written; their errors add up to less than the sum of the tolerances.
#[test]
fn steps_follow_the_motion() {
    let (place, result) = solve(RELEASED);
    let found = rows(&place);
    let steps: Vec<f64> = found.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    let longest = |from: f64, to: f64| {
        let own = found.windows(2).filter(|pair| pair[0][0] >= from && pair[1][0] <= to);
        own.map(|pair| pair[1][0] - pair[0][0]).fold(0.0, f64::max)
    };
    let time = &result["time"];
    let number = |key: &str| time[key].as_f64().unwrap();
    println!("{} steps, {time}", steps.len());
    assert!(longest(0.09, 0.1) > 2.5 * longest(0.001, 0.01), "{} {}", longest(0.001, 0.01), longest(0.09, 0.1));
    assert_eq!((number("steps"), number("tolerance")), (steps.len() as f64, 2e-6));
    assert_eq!(number("longest"), steps.iter().copied().fold(0.0, f64::max));
    assert_eq!(number("shortest"), steps.iter().copied().fold(f64::INFINITY, f64::min));
    assert!(number("longest") <= 0.002 * (1.0 + 1e-12) && time.get("step").is_none());
    let written = place.files().into_iter().filter(|name| name.starts_with("motion_")).count();
    assert_eq!(written, 11);
    // the error of every step is at most the tolerance, and the first one is not all there is
    let largest = time["step_error"]["largest"].as_f64().unwrap();
    assert!(largest <= 2e-6 * 1.01 && largest > 5e-7, "{largest:e}");

    // its first step, within which the fibres let go, is as long as theirs
    let fine = with(RELEASED, r#""tolerance": "2 um""#, r#""step": "0.1 ms""#);
    let exact = rows(&solve(&fine).0);
    let error_of = |rows: &[Vec<f64>]| {
        (1..=10)
            .map(|k| (tip_at(rows, 0.01 * f64::from(k)) - tip_at(&exact, 0.01 * f64::from(k))).abs())
            .fold(0.0, f64::max)
    };
    let coarse = rows(&solve(&with(RELEASED, "2 um", "20 um")).0);
    let (error, worse) = (error_of(&found), error_of(&coarse));
    println!("error {error:.2e} in {} steps, {worse:.2e} in {}", steps.len(), coarse.len() - 1);
    // at most the sum of what the steps may add, 1.8e-4
    assert!(error < 6e-5 && worse > 2.0 * error && coarse.len() < found.len(), "{error:e} {worse:e}");
}

#[test]
fn the_derivative_over_found_steps_is_right() {
    let case = driven();
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Gradcheck, &case, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
    // knots and the instants of costs are instants of the motion
    place.run(Command::Solve, &case, &[]).unwrap();
    let times: Vec<f64> = rows(&place).iter().map(|row| row[0]).collect();
    for wanted in [0.01, 0.013, 0.02, 0.03, 0.04] {
        assert!(times.iter().any(|t| (t - wanted).abs() < 1e-15), "{wanted}: {times:?}");
    }
}

/// The control at the optimum is fifteen times that of the start: the steps of the start are too long for it, which is said. Twice the
/// same bits.
#[test]
fn an_optimum_that_needs_shorter_steps_is_told() {
    let case = driven();
    let place = CaseDirectory::new();
    let optimum = place.run(Command::Optimize, &case, &[]).unwrap().result;
    assert!(optimum["cost"]["total"].as_f64().unwrap() < 0.2 * optimum["start"]["cost"]["total"].as_f64().unwrap());
    let codes: Vec<&str> =
        optimum["warnings"].as_array().unwrap().iter().map(|warning| warning["code"].as_str().unwrap()).collect();
    assert!(codes.contains(&"step_error"), "{codes:?}");
    let error = optimum["time"]["step_error"]["largest"].as_f64().unwrap();
    assert!(error > 1.5 * 2e-6, "{error:e}");
    let again = CaseDirectory::new().run(Command::Optimize, &case, &[]).unwrap().result;
    assert_eq!(optimum["cost"], again["cost"]);
    // begun again from there it has steps of its own
    let file = place.path("out").join("controls.json").display().to_string();
    let from_there = with(&case, r#""start": "-2 kPa""#, &format!(r#""start": {{ "file": "{file}" }}"#));
    let result = solve(&from_there).1;
    assert!(result["time"]["steps"].as_u64() > optimum["time"]["steps"].as_u64(), "{}", result["time"]);
    assert!(result["warnings"].as_array().unwrap().iter().all(|warning| warning["code"] != "step_error"));
}

/// Raises a flag at the line about a trial.
struct Watch {
    cancel: Arc<AtomicBool>,
    word: &'static str,
}

impl std::io::Write for Watch {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if std::str::from_utf8(bytes).unwrap().trim_start().starts_with(self.word) {
            self.cancel.store(true, Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// An optimisation that is resumed finds its steps once more, those of its start.
#[test]
fn a_resumed_optimisation_has_the_same_steps() {
    let case = with(&driven(), r#""max_iterations": 12"#, r#""max_iterations": 4"#);
    let case = with(&case, r#""optimizer""#, r#""output": { "checkpoint": 1 }, "optimizer""#);
    let (whole, place) = (CaseDirectory::new(), CaseDirectory::new());
    let expected = whole.run(Command::Optimize, &case, &[]).unwrap().result;
    let options = place.options(&[]);
    let watch = Watch { cancel: options.cancel.clone(), word: "3 " };
    let stopped = place.run_with(Command::Optimize, &case, &Console::new(watch), &options).unwrap();
    assert_eq!(stopped.exit, Exit::NotConverged);
    let options = Options { threads: Some(1), ..Options::default() };
    let found = resume(&Catalogue::standard(), &place.path("out"), &options, &Console::silent()).unwrap().result;
    assert!(found["resumed"]["iteration"].as_u64().unwrap() > 0, "{}", found["resumed"]);
    for key in ["cost", "controls", "time", "iterations", "trials", "gradient_norm"] {
        assert_eq!(found[key], expected[key], "{key}");
    }
}

/// Piecewise constant controls jump at knots: the step behind each is a thousandth of the whole time again.
#[test]
fn steps_behind_jumps_are_short() {
    let case = with(&driven(), r#""every": "10 ms""#, r#""every": "20 ms", "interpolation": "constant""#);
    let (place, _) = solve(&case);
    let times: Vec<f64> = rows(&place).iter().map(|row| row[0]).collect();
    let behind = |t: f64| {
        let k = times.iter().position(|own| (own - t).abs() < 1e-12).unwrap();
        times[k + 1] - times[k]
    };
    assert!(behind(0.0) <= 4.1e-5 && behind(0.02) <= 4.1e-5, "{} {}", behind(0.0), behind(0.02));
}

#[test]
fn what_a_tolerance_does_not_go_with_is_refused() {
    let tolerance = r#""tolerance": "2 um""#;
    for (from, to, wanted) in [
        (
            tolerance,
            r#""tolerance": "2 um", "step": "1 ms""#,
            "exactly one of \"step\", \"tolerance\" must be given, found 2",
        ),
        (tolerance, r#""mass": "lumped""#, "exactly one of \"step\", \"tolerance\" must be given, found 0"),
        (tolerance, r#""tolerance": "2 ms""#, "is a time, a length is wanted"),
        (
            tolerance,
            r#""tolerance": "2 um", "scheme": "bdf2""#,
            "time/scheme: \"bdf2\" does not estimate the error of its steps: take \"tr_bdf2\"",
        ),
        (tolerance, r#""step": "1 ms", "longest": "2 ms""#, "time/longest: all steps have one length"),
    ] {
        let found = problems(&with(RELEASED, from, to));
        assert!(found.contains(wanted), "{found}\nwanted: {wanted}");
    }
    // out of reach: a failed motion, not a wrong case
    let error = CaseDirectory::new().run(Command::Solve, &with(RELEASED, "2 um", "1e-30"), &[]).unwrap_err();
    assert_eq!(error.exit(), Exit::ForwardFailed, "{error}");
    assert!(error.to_string().contains("out of reach"), "{error}");
}

/// `check` says what it knows without running the motion.
#[test]
fn check_says_what_is_to_be_found() {
    let text = CaseDirectory::new().text(Command::Check, RELEASED, &[]);
    for wanted in ["steps to 0.1 s, found before the motion runs", "none longer than 0.002 s", "11 given instants"] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    let text = CaseDirectory::new().text(Command::Solve, RELEASED, &[]);
    assert!(text.contains("found at the start controls (") && text.contains("a step adds at most"), "{text}");
}
