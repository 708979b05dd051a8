//! Designs as closed bodies in STL files.

#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;

/// A bar of two silicones, in millimetres.
const BAR: &str = r#"{ "nastic": 1, "units": "mm",
    "mesh": { "box": { "size": [20, 10, 10], "cells": [8, 4, 4], "element": "hex8" } },
    "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3,
                     "design": [ { "name": "stiff", "kind": "mixture", "with": { "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 } } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": [0, 0, "-1 kPa"] } ],
    "controls": [ { "of": "stiff", "space": "cell", "start": "0.2 + 0.03 * X", "filter": "2 mm" } ],
    "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, 0, -1] } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 1, "tolerance": 1e-9 } }"#;

/// The volume that an STL file encloses.
fn volume(place: &CaseDirectory, file: &str) -> f64 {
    let bytes = std::fs::read(place.path(file)).unwrap();
    let number = |at: usize| f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
    assert_eq!(bytes.len(), 84 + 50 * count);
    let spat = |k: usize| {
        let [a, b, c] = [1, 2, 3].map(|corner| [0, 1, 2].map(|i| number(84 + 50 * k + 12 * corner + 4 * i)));
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        a.iter().zip(cross).map(|(a, x)| a * x).sum::<f64>() / 6.0
    };
    (0..count).map(spat).sum()
}

#[test]
fn mixtures_are_cut_into_two_bodies_of_their_volumes() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, BAR, &[]).unwrap().result;
    let share = found["controls"]["stiff"]["volume"].as_f64().unwrap();
    let [stiff, soft] = ["", "_rest"].map(|part| volume(&place, &format!("out/design_stiff{part}.stl")));
    assert!((stiff - 2000.0 * share).abs() < 0.01 * 2000.0, "{stiff} {share}");
    assert!((stiff + soft - 2000.0).abs() < 1.0, "{stiff} {soft}");
    assert!(found["controls"]["stiff"]["level"].as_f64().is_some_and(|level| (0.2..0.9).contains(&level)), "{found}");
    // bent bodies are nearly as large
    let bent = volume(&place, "out/design_stiff_deformed.stl");
    assert!((bent / stiff - 1.0).abs() < 0.05 && bent != stiff, "{bent} {stiff}");
    for name in ["design_stiff.stl", "design_stiff_rest_deformed.stl"] {
        assert!(place.path("out").join(name).exists(), "{name}");
    }
}

/// The optimum is solved once more with cells of 0 and 1, of which a case says the same by itself; nothing is differentiated there.
#[test]
fn cut_designs_are_solved_once_more() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, BAR, &[]).unwrap().result;
    let cut = found["cut_cost"].as_f64().unwrap();
    let grey = found["cost"]["total"].as_f64().unwrap();
    // the soft end is at the support: without its share of the stiff material it bends more
    assert!(cut > 2.0 * grey && cut < 10.0 * grey, "{cut} {grey}");
    // of 128 cells the stiffest, as many as the field has volume
    let values = r#""start": { "file": "out/controls.json" }, "filter": "2 mm", "cut": LEVEL"#;
    let share = found["controls"]["stiff"]["volume"].as_f64().unwrap();
    let start = "\"start\": \"0.2 + 0.03 * X\", \"filter\": \"2 mm\"";
    let at = |level: f64| {
        let case = with(BAR, start, &values.replace("LEVEL", &level.to_string()));
        place.run(Command::Solve, &case, &[]).unwrap().result
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        let own = at(middle)["controls"]["stiff"]["volume"].as_f64().unwrap();
        (low, high) = if own > share { (middle, high) } else { (low, middle) };
    }
    let near = [low, high].map(|level| at(level)["cost"]["total"].as_f64().unwrap());
    assert!(near.iter().any(|own| (own / cut - 1.0).abs() < 1e-8), "{near:?} {cut}");
    let refused = place.run(
        Command::Optimize,
        &with(BAR, "\"filter\": \"2 mm\"", "\"cut\": 0.5"),
        &["output/directory=\"other\""],
    );
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("controls/0/cut: a field that is cut has no derivative"), "{refused}");
}

#[test]
fn densities_of_plane_bodies_are_plates() {
    let place = CaseDirectory::new();
    let plane = with(
        BAR,
        "\"size\": [20, 10, 10], \"cells\": [8, 4, 4], \"element\": \"hex8\"",
        "\"size\": [20, 10], \"cells\": [8, 4], \"element\": \"tri6\"",
    );
    let plane = with(&plane, "[0, 0, \"-1 kPa\"]", "[0, \"-1 kPa\"]");
    let plane = with(&plane, "\"direction\": [0, 0, -1]", "\"direction\": [0, -1]");
    let density = "\"kind\": \"density\", \"least\": 0.01 } ] } ],";
    let mixture =
        "\"kind\": \"mixture\", \"with\": { \"law\": \"neo_hooke\", \"young\": \"1 MPa\", \"poisson\": 0.3 } } ] } ],";
    let found = place.run(Command::Optimize, &with(&plane, mixture, density), &[]).unwrap().result;
    let (share, plate) = (found["controls"]["stiff"]["volume"].as_f64().unwrap(), 0.1 * 500f64.sqrt());
    let filled = volume(&place, "out/design_stiff.stl");
    assert!((filled - 200.0 * plate * share).abs() < 0.01 * 200.0 * plate, "{filled} {share}");
    assert!(!place.path("out/design_stiff_rest.stl").exists());
}

#[test]
fn designs_of_load_cases_are_deformed_as_these_and_earlier_ones_go() {
    let place = CaseDirectory::new();
    let out = |name: &str| place.path("out").join(name).exists();
    place.run(Command::Optimize, BAR, &[]).unwrap();
    assert!(out("design_stiff_rest.stl"));
    let control = "\"controls\": [ { \"of\": \"stiff\", \"space\": \"cell\", \"start\": \"0.2 + 0.03 * X\", \"filter\": \"2 mm\" } ],";
    let own = |name: &str| format!("{{ \"name\": \"{name}\", {} }}", control.trim_end_matches(','));
    let cases = format!("\"load_cases\": [ {}, {} ],", own("left"), own("right"));
    std::fs::remove_file(place.path("out/checkpoint.bin")).unwrap();
    place.run(Command::Optimize, &with(BAR, control, &cases), &[]).unwrap();
    for name in ["design_left.stiff.stl", "design_right.stiff.stl", "left_design_left.stiff_deformed.stl"] {
        assert!(out(name), "{name}");
    }
    for name in ["left_design_right.stiff_deformed.stl", "design_stiff.stl", "design_stiff_rest_deformed.stl"] {
        assert!(!out(name), "{name}");
    }
}

/// A uniform mixture is one material or the other: that is said, both bodies are not written at once.
#[test]
fn bodies_of_another_volume_than_the_design_are_warned_about() {
    for (start, part, gone) in [("0.3", "_rest", ""), ("0.7", "", "_rest")] {
        let place = CaseDirectory::new();
        let plateau = with(BAR, "\"start\": \"0.2 + 0.03 * X\", \"filter\": \"2 mm\"", &format!("\"start\": {start}"));
        let plateau = with(&plateau, "\"space\": \"cell\"", "\"space\": \"uniform\"");
        let found = place.run(Command::Optimize, &plateau, &["optimizer/max_iterations=0"]).unwrap().result;
        let own = &found["controls"]["stiff"];
        let share = own["cut_volume"].as_f64().unwrap();
        assert!((share - if part.is_empty() { 1.0 } else { 0.0 }).abs() < 1e-9 && share.is_sign_positive(), "{own}");
        let told = common::messages(&found, "cut_volume");
        assert!(told.len() == 1 && told[0].contains("\"stiff\" is "), "{told:?}");
        assert!((volume(&place, &format!("out/design_stiff{part}.stl")) - 2000.0).abs() < 1e-2);
        assert!(!place.path("out").join(format!("design_stiff{gone}.stl")).exists());
    }
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, BAR, &[]).unwrap().result;
    let own = &found["controls"]["stiff"];
    let [cut, share] = ["cut_volume", "volume"].map(|key| own[key].as_f64().unwrap());
    assert!((cut - share).abs() < 0.01 && common::messages(&found, "cut_volume").is_empty(), "{own}");
}

#[test]
fn designs_of_one_file_are_refused() {
    let second = r#"{ "name": "stiff_rest", "kind": "density", "least": 0.01 }, { "name": "stiff","#;
    let two = with(BAR, "{ \"name\": \"stiff\",", second);
    let control = |more: &str| {
        let own =
            format!("\"controls\": [ {{ \"of\": \"stiff_rest\", \"space\": \"cell\", \"start\": 0.5{more} }}, {{");
        common::problems(&with(&two, "\"controls\": [ {", &own))
    };
    let refused = control("");
    assert!(refused.contains("controls/0: \"design_stiff_rest.stl\" would be a file of \"stiff\" too"), "{refused}");
    assert_eq!(control(", \"name\": \"filled\""), "");
}
