//! Springs in case files.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;

/// A bar that does not contract sideways, on a spring between the middle of its end and the ground.
const BAR: &str = r#"{ "nastic": 1, "units": "mm",
  "mesh": { "box": { "size": [20, 10, 10], "cells": [4, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "mu": "0.1 MPa", "lambda": 0 } ],
  "supports": [ { "surface": "x-", "fix": "x" }, { "surface": "y-", "fix": "y" }, { "surface": "z-", "fix": ["z"] } ],
  "springs": [ { "name": "band", "from": [20, 5, 5], "to": { "ground": [40, 5, 5] }, "stiffness": "0.5 N/mm", "length": "8 mm" } ],
  "probes": [ { "name": "tip", "point": [20, 5, 5] } ] }"#;
const ENDS: &str = r#""from": [20, 5, 5], "to": { "ground": [40, 5, 5] }"#;

/// k (g - s l - L) = mu A (s - 1/s), in N and mm: (10 + 10) s^2 - 16 s - 10 = 0.
#[test]
fn a_bar_on_a_spring_has_the_stretch_of_the_closed_solution() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Solve, BAR, &[]).unwrap().result;
    let number = |path: &str| nastic_run::result::find(&found, path).unwrap().as_f64().unwrap();
    let s = (16.0 + f64::sqrt(16.0 * 16.0 + 4.0 * 20.0 * 10.0)) / 40.0;
    assert!((number("probes/tip/displacement/0") - 20.0 * (s - 1.0)).abs() < 1e-7, "{}", found["probes"]);
    assert!((number("contributions/band/force") - 10.0 * (s - 1.0 / s)).abs() < 1e-7, "{}", found["contributions"]);
    assert!((number("contributions/band/length") - (40.0 - 20.0 * s)).abs() < 1e-7);
    assert_eq!(number("contributions/band/rest_length"), 8.0);
    // where lines are drawn and written, and tables
    let read = |name: &str| std::fs::read_to_string(place.path("out").join(name)).unwrap();
    let files: Vec<_> = std::fs::read_dir(place.path("out")).unwrap().map(|f| f.unwrap().file_name()).collect();
    let lines = files.iter().find(|file| file.to_string_lossy().ends_with("_lines.vtu")).unwrap();
    let lines = read(&lines.to_string_lossy());
    assert!(lines.contains("line:band") && lines.contains("Name=\"force\""), "{lines}");
    assert!(read("picture.svg").contains("lines: springs"));
    assert!(read("report.html").contains("rest length"));
}

/// Without a name it is called by its number, without a length its ends are at rest; its parameters vary over load cases.
#[test]
fn names_lengths_and_load_cases() {
    let bare = with(BAR, r#""name": "band", "#, "");
    let bare = with(&bare, r#", "length": "8 mm""#, "");
    let found = CaseDirectory::new().run(Command::Solve, &bare, &[]).unwrap().result;
    let number = |path: &str| nastic_run::result::find(&found, path).unwrap().as_f64().unwrap();
    assert_eq!((number("contributions/spring 0/rest_length"), number("contributions/spring 0/force")), (20.0, 0.0));
    assert!(number("probes/tip/displacement/0").abs() < 1e-12);
    // within the body, from the mean of nothing but its own points
    let inner = with(BAR, ENDS, r#""from": [0, 5, 5], "to": [20, 5, 5]"#);
    let found = CaseDirectory::new().run(Command::Solve, &inner, &[]).unwrap().result;
    let s = (4.0 + f64::sqrt(4.0 * 4.0 + 4.0 * 20.0 * 10.0)) / 40.0;
    let tip = nastic_run::result::find(&found, "probes/tip/displacement/0").unwrap().as_f64().unwrap();
    assert!((tip - 20.0 * (s - 1.0)).abs() < 1e-7, "{tip}");
    let cases = r#""load_cases": [ { "name": "soft" }, { "name": "stiff", "set": { "springs/0/stiffness": "1 N/mm" } } ], "probes""#;
    let found = CaseDirectory::new().run(Command::Solve, &with(BAR, r#""probes""#, cases), &[]).unwrap().result;
    let tip = |name: &str| found["load_cases"][name]["probes"]["tip"]["displacement"][0].as_f64().unwrap();
    let stiff = (32.0 + f64::sqrt(32.0 * 32.0 + 4.0 * 30.0 * 10.0)) / 60.0;
    assert!((tip("soft") - 20.0 * (16.0 + f64::sqrt(1056.0)) / 40.0 + 20.0).abs() < 1e-7, "{}", tip("soft"));
    assert!((tip("stiff") - 20.0 * (stiff - 1.0)).abs() < 1e-7, "{}", tip("stiff"));
}

#[test]
fn check_says_what_it_understood() {
    let found = CaseDirectory::new().run(Command::Check, BAR, &[]).unwrap().result;
    let spring = &found["springs"][0];
    assert_eq!((spring["name"].as_str(), spring["to"]["ground"][0].as_f64()), (Some("band"), Some(40.0)));
    assert_eq!(spring["force_at_rest"].as_f64(), Some(6.0));
}

#[test]
fn mistakes_about_a_spring_are_told() {
    let cases = [
        (r#""0.5 N/mm""#, r#""0.5 N""#, vec!["springs/0/stiffness", "N/m"]),
        (r#""0.5 N/mm""#, "0", vec!["springs/0/stiffness", "must be positive"]),
        (r#""8 mm""#, "-1", vec!["springs/0/length", "not be negative"]),
        (r#""stiffness": "0.5 N/mm", "#, "", vec!["springs/0: missing key \"stiffness\""]),
        ("{ \"ground\": [40, 5, 5] }", "[40, 5, 5]", vec!["springs/0", "band", "end \"to\"", "outside the body"]),
        ("{ \"ground\": [40, 5, 5] }", "{ \"grund\": [40, 5, 5] }", vec!["springs/0/to", "did you mean \"ground\""]),
        ("{ \"ground\": [40, 5, 5] }", "\"wall\"", vec!["springs/0", "end \"to\"", "\"wall\" not found"]),
        ("{ \"ground\": [40, 5, 5] }", "[20, 5, 5]", vec!["springs/0", "both ends at one point"]),
        ("\"length\"", "\"rest_length\"", vec!["springs/0/rest_length", "stands under \"length\""]),
        ("\"stiffness\"", "\"k\"", vec!["springs/0/k", "stands under \"stiffness\""]),
        ("\"band\"", "\"a/b\"", vec!["springs/0/name", "must not contain"]),
        ("\"springs\"", "\"spring\"", vec!["spring", "\"springs\""]),
        (
            r#""surface": "x-", "fix": "x""#,
            r#""surface": "x-", "stiffness": 3"#,
            vec!["supports/0/stiffness", "\"springs\""],
        ),
    ];
    for (from, to, message) in cases {
        let error = CaseDirectory::new().run(Command::Check, &with(BAR, from, to), &[]).unwrap_err().to_string();
        assert!(message.iter().all(|words| error.contains(words)), "{to}: {error}");
    }
    let twice =
        with(BAR, "\"springs\": [", &format!("\"springs\": [ {{ \"name\": \"band\", {ENDS}, \"stiffness\": 1 }},"));
    let error = CaseDirectory::new().run(Command::Check, &twice, &[]).unwrap_err().to_string();
    assert!(error.contains("springs/1") && error.contains("\"band\""), "{error}");
    // under tension it holds across itself too, without it along itself alone
    let rollers = with(BAR, ", { \"surface\": \"y-\", \"fix\": \"y\" }", "");
    assert!(CaseDirectory::new().run(Command::Check, &rollers, &[]).is_ok());
    let rollers = with(&rollers, r#", "length": "8 mm""#, "");
    let error = CaseDirectory::new().run(Command::Check, &rollers, &[]).unwrap_err().to_string();
    assert!(["supports", "1 rigid motion", "shift along y"].iter().all(|words| error.contains(words)), "{error}");
}
