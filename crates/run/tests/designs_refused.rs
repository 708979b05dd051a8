//! What cases with designs and maps of controls are refused for, rather than answered wrongly, and whose stage results are of.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, problems, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, ModesRequest, Options};
use serde_json::Value;

/// A strip of two parts, with a density and fibres that pull.
const STRIP: &str = r#"{ "nastic": 1,
    "mesh": { "box": { "size": [0.1, 0.04], "cells": [10, 4], "element": "quad4" } },
    "regions": [ { "name": "tip", "inside": { "box": { "low": [0.09, 0, -1], "high": [0.1, 0.04, 1] } } },
                 { "name": "end", "inside": { "box": { "low": [0.07, 0, -1], "high": [0.1, 0.04, 1] } } } ],
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3, "density": "1000 kg/m^3",
                     "design": [ { "name": "rho", "kind": "density", "least": 1e-3 } ] } ],
    "actuation": [ { "name": "muscle", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": [0, "-500 Pa"] } ],
    "controls": [ { "of": "rho", "space": "cell", "start": "0.2 + 6 * X", "projection": { "sharpness": [1, 8] } },
                  { "of": "muscle", "space": "cell", "start": "1 kPa", "upper": "20 kPa" } ],
    "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y"], "weight": 1e6 } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 1, "tolerance": 1e-9 } }"#;

const MUSCLE: &str = "\"start\": \"1 kPa\"";

/// The array of a control in a file of results.
fn array(place: &CaseDirectory, file: &str, name: &str) -> Vec<f64> {
    let shown = nastic_io::read_snapshot(place.path(file)).unwrap();
    shown.cell_data.iter().find(|array| array.name == name).unwrap().values.clone()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn results_are_of_the_stage_of_their_states() {
    let largest_of = |sharpness: &str, command: Command, file: &str, set: &[&str]| {
        let place = CaseDirectory::new();
        let options = Options { modes: ModesRequest { count: 1, undeformed: false }, ..place.options(set) };
        let case = with(STRIP, "\"sharpness\": [1, 8]", &format!("\"sharpness\": {sharpness}"));
        let found = place.run_with(command, &case, &Console::silent(), &options).unwrap().result;
        (largest(&array(&place, file, "rho")), found)
    };
    let first = largest_of("1", Command::Modes, "out/start.vtu", &[]);
    let staged = largest_of("[1, 8]", Command::Modes, "out/start.vtu", &[]);
    assert_eq!(first.0, staged.0);
    assert_eq!(first.1["modes"]["frequencies"], staged.1["modes"]["frequencies"]);
    // a run that ends before the last stage
    let (shown, ended) = largest_of("[1, 8]", Command::Optimize, "out/optimum.vtu", &[]);
    assert_eq!(ended["controls"]["rho"]["max"].as_f64().unwrap(), shown, "{ended}");
}

#[test]
fn ramps_and_paths_through_maps_are_refused() {
    let told = |case: &str, analysis: Analysis| {
        let place = CaseDirectory::new();
        let options = Options { analysis, ..place.options(&[]) };
        place.run_with(Command::Solve, case, &Console::silent(), &options).map(|done| done.result)
    };
    let ramp = || Analysis::Ramp("muscle=0 Pa:2 kPa:3".to_owned());
    let projected = with(STRIP, MUSCLE, "\"start\": \"1 kPa\", \"lower\": 0, \"projection\": { \"sharpness\": 2 }");
    let error = told(&projected, ramp()).unwrap_err().to_string();
    assert!(error.contains("does not go straight with them") && error.contains("nastic sweep"), "{error}");
    let held = with(STRIP, MUSCLE, "\"start\": \"1 kPa\", \"fixed\": { \"tip\": \"3 kPa\" }");
    let error = told(&held, Analysis::Path).unwrap_err().to_string();
    assert!(error.contains("\"muscle\" are no shares of themselves"), "{error}");
    // what is affine goes straight, and what is zero scales
    let smooth = with(STRIP, MUSCLE, "\"start\": \"1 kPa\", \"fixed\": { \"tip\": 0 }");
    let found: Value = told(&smooth, ramp()).unwrap();
    assert_eq!(found["ramp"]["points"].as_array().unwrap().len(), 3);
    told(&smooth, Analysis::Path).unwrap();
}

#[test]
fn what_designs_and_fixed_values_cannot_be_is_told() {
    let design = "{ \"name\": \"rho\", \"kind\": \"density\", \"least\": 1e-3 }";
    let other = "{ \"name\": \"other\", \"region\": \"body\", \"law\": \"neo_hooke\", \"young\": 1e5, \"poisson\": 0.3, \"design\": [ { \"name\": \"rho\", \"kind\": \"density\" } ] }";
    let mixture = |more: &str| {
        format!("{{ \"name\": \"rho\", \"kind\": \"mixture\", \"with\": \"other\"{more} }} ] }}, {other}, {{")
    };
    let rest = "\"region\": \"tip\", \"law\": \"neo_hooke\", \"young\": 1, \"poisson\": 0.3, \"design\": [";
    for (from, to, told) in [
        (
            "\"kind\": \"tracking\", \"surface\": \"x+\", \"target\": [\"X\", \"Y\"], \"weight\": 1e6",
            "\"kind\": \"pump_work\"",
            "takes the body as it is at rest, and \"rho\" changes it",
        ),
        ("\"density\": \"1000 kg/m^3\",", "", ""),
        (
            design,
            "{ \"name\": \"rho\", \"kind\": \"density\" }, { \"name\": \"fine\", \"kind\": \"density\", \"mass\": false }",
            "nothing says what \"fine\" is",
        ),
        (
            MUSCLE,
            "\"start\": \"1 kPa\", \"lower\": 0, \"fixed\": { \"tip\": \"-1 kPa\" }",
            "controls/1/fixed/tip: -1000 lies outside the bounds",
        ),
        (MUSCLE, "\"start\": \"1 kPa\", \"fixed\": { \"tip\": \"30 kPa\" }", "30000 lies outside the bounds"),
        (MUSCLE, "\"start\": \"1 kPa\", \"fixed\": { \"tip\": 0, \"end\": \"1 kPa\" }", "has another value in \"end\""),
        (MUSCLE, "\"start\": \"1 kPa\", \"fixed\": { \"tip\": 0, \"end\": 0 }", ""),
        (
            MUSCLE,
            "\"start\": \"1 kPa\", \"fixed\": { \"tip\": 0 }, \"symmetry\": [\"x\"]",
            "controls/1/fixed: what is held is not symmetric",
        ),
        (MUSCLE, "\"start\": \"1 kPa\", \"fixed\": { \"tip\": 0 }, \"symmetry\": [\"y\"]", ""),
        (MUSCLE, "\"start\": \"1 kPa\", \"symmetry\": [\"z\"]", "the symmetry ties none of them"),
        ("\"sharpness\": [1, 8]", "\"sharpness\": [8, 1]", "stages become sharper: 1 follows 8"),
        (
            design,
            "{ \"name\": \"rho\", \"kind\": \"mixture\", \"with\": { \"law\": \"fiber_family\", \"k1\": 5e4, \"k2\": 0.8, \"dispersion\": 0.1, \"fiber\": [1, 0] } }",
            "only reinforces a body",
        ),
        (
            "\"controls\": [ { \"of\": \"rho\", \"space\": \"cell\", \"start\": \"0.2 + 6 * X\", \"projection\": { \"sharpness\": [1, 8] } },",
            "\"load_cases\": [ { \"name\": \"up\", \"controls\": [ { \"of\": \"rho\", \"space\": \"cell\" } ] }, { \"name\": \"down\" } ], \"controls\": [",
            "nothing says what \"rho\" is in every load case",
        ),
        ("\"least\": 1e-3", "\"least\": 1e-3, \"mass\": true", ""),
        (
            &format!("\"density\": \"1000 kg/m^3\",\n                     \"design\": [ {design}"),
            &format!("\"design\": [ {}", design.replace("1e-3", "1e-3, \"mass\": true")),
            "no mass follows: materials/0 has no \"density\"",
        ),
        (
            design,
            "{ \"name\": \"rho\", \"kind\": \"mixture\", \"mass\": true, \"with\": { \"law\": \"neo_hooke\", \"young\": 1, \"poisson\": 0.3 } }",
            "the other law has no \"density\"",
        ),
        (design, &format!("{} {rest}{design}", mixture("")), "\"other\" follows designs of its own"),
    ] {
        let case = with(STRIP, from, to);
        match told {
            "" => drop(CaseDirectory::new().run(Command::Check, &case, &[]).unwrap()),
            told => assert!(problems(&case).contains(told), "{from} -> {to}: {}", problems(&case)),
        }
    }
    let tracking = "\"kind\": \"tracking\", \"surface\": \"x+\", \"target\": [\"X\", \"Y\"], \"weight\": 1e6";
    let grey = problems(&with(STRIP, tracking, "\"kind\": \"greyness\", \"of\": \"muscle\""));
    assert!(grey.contains("costs/0/of: no greyness"), "{grey}");
    let bounded = |of: &str| {
        let volume = format!(
            "\"constraints\": [ {{ \"cost\": {{ \"kind\": \"design_volume\", \"of\": \"{of}\" }}, \"at_most\": 0.5 }} ], \"costs\""
        );
        with(STRIP, "\"costs\"", &volume)
    };
    assert!(
        problems(&bounded("roh")).contains("constraints/0/cost/of: no control \"roh\""),
        "{}",
        problems(&bounded("roh"))
    );
    drop(CaseDirectory::new().run(Command::Check, &bounded("rho"), &[]).unwrap());
    // two densities in front of one law
    let two =
        with(STRIP, design, &format!("{{ \"name\": \"density\", \"kind\": \"density\", \"mass\": false }}, {design}"));
    let two =
        with(&two, "\"controls\": [", "\"controls\": [ { \"of\": \"density\", \"space\": \"cell\", \"start\": 0.5 },");
    let renamed = two.replace("\"rho\"", "\"fine\"");
    drop(CaseDirectory::new().run(Command::Check, &renamed, &[]).unwrap());
    // a filler ends before it is rigid
    let filled = with(STRIP, design, "{ \"name\": \"rho\", \"kind\": \"filler\", \"interpolation\": \"hill\" }");
    let filled = with(
        &filled,
        "\"start\": \"0.2 + 6 * X\", \"projection\": { \"sharpness\": [1, 8] }",
        "\"start\": 0.1, \"upper\": 0.4",
    );
    assert!(problems(&filled).contains("0 to 0.4, below which a filler stays"), "{}", problems(&filled));
}

/// Damping by stiffness takes the laws as they are written, whatever a density makes of them.
#[test]
fn damping_by_stiffness_is_refused_beside_designs() {
    let time = "\"time\": { \"end\": \"0.1 s\", \"step\": \"50 ms\", \"scheme\": \"backward_euler\", \"rayleigh\": { \"stiffness\": \"10 ms\" } }, \"costs\"";
    let moving = with(STRIP, "\"costs\"", time);
    let moving = with(&moving, ", \"projection\": { \"sharpness\": [1, 8] }", "");
    assert!(
        problems(&moving).contains("time/rayleigh/stiffness: its stiffness is that of the body"),
        "{}",
        problems(&moving)
    );
    let alone = with(&moving, ", \"rayleigh\": { \"stiffness\": \"10 ms\" }", "");
    assert!(!problems(&alone).contains("rayleigh"), "{}", problems(&alone));
}
