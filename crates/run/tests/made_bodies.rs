//! Bodies as they are made: files of several materials, directions of fields, the thinnest bars and gaps.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // helpers of tests

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;
use std::path::Path;

/// A bar of two silicones, some of which is left out, in centimetres, beside a frame without a design.
const BAR: &str = r#"{ "nastic": 1, "units": { "length": "cm", "force": "N", "time": "s", "field": "T" },
    "mesh": { "box": { "size": [2, 1, 1], "cells": [8, 4, 4], "element": "hex8" } },
    "regions": [ { "name": "frame", "inside": { "box": { "low": [-1, -1, -1], "high": [0.5, 2, 2] } } },
                 { "name": "free", "inside": { "box": { "low": [0.5, -1, -1], "high": [3, 2, 2] } } } ],
    "materials": [ { "name": "sheet", "region": "frame", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 },
                   { "name": "ecoflex", "region": "free", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3,
                     "design": [ { "name": "stiff", "kind": "mixture", "with": "sheet" }, { "name": "rho", "kind": "density", "least": 0.01 } ] } ],
    "supports": [ { "surface": "x-", "fix": "all" } ],
    "loads": [ { "surface": "x+", "traction": [0, 0, "-1 kPa"] } ],
    "controls": [ { "of": "stiff", "space": "cell", "start": "0.2 + 0.3 * X / (1 cm)" },
                  { "of": "rho", "space": "cell", "start": "0.3 + 0.5 * Y / (1 cm)" } ],
    "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, 0, -1] } ],
    "optimizer": { "method": "lbfgs", "max_iterations": 0, "tolerance": 1e-9 } }"#;

/// Name, material and volume of each object of a file; nothing where there is no Python.
fn objects(file: &Path) -> Option<Vec<(String, String, f64)>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/readback/three_mf.py");
    let Ok(output) = std::process::Command::new("python3").arg(script).arg(file).output() else {
        println!("SKIPPED: no python3 to read 3MF files back with");
        return None;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let of = |line: &str| {
        let [name, material, volume] = line.split(" | ").collect::<Vec<_>>().try_into().unwrap();
        (name.to_owned(), material.to_owned(), volume.parse().unwrap())
    };
    Some(text.lines().map(of).collect())
}

/// An object for each material, without what is left out, and the frame; together they are what the density fills.
#[test]
fn bodies_of_several_materials_are_one_file() {
    let place = CaseDirectory::new();
    let found = place.run(Command::Optimize, BAR, &[]).unwrap().result;
    let Some(objects) = objects(&place.path("out/design.3mf")) else { return };
    let names: Vec<(&str, &str)> =
        objects.iter().map(|(name, material, _)| (name.as_str(), material.as_str())).collect();
    assert_eq!(names, [("sheet", "sheet"), ("stiff, rho", "sheet"), ("stiff_rest, rho", "ecoflex")]);
    // in cubic millimetres
    let share = |name: &str| found["controls"][name]["volume"].as_f64().unwrap();
    let [frame, stiff, soft] = [0, 1, 2].map(|k| objects[k].2);
    assert!((frame - 500.0).abs() < 1e-6, "{frame}");
    assert!((stiff + soft - 1500.0 * share("rho")).abs() < 0.01 * 1500.0, "{stiff} {soft} {}", share("rho"));
    // the two fields change along different axes, so that the share of one is that of the other's part
    assert!((stiff - 1500.0 * share("rho") * share("stiff")).abs() < 0.02 * 1500.0, "{stiff}");
    let bent = self::objects(&place.path("out/design_deformed.3mf")).unwrap();
    assert!(bent.len() == 3 && (bent[1].2 / stiff - 1.0).abs() < 0.05 && bent[1].2 != stiff, "{bent:?}");
}

/// A plate of 5 mm in the middle of the body, and its complement.
fn striped(start: &str, more: &str) -> String {
    format!(
        r#"{{ "nastic": 1, "units": "mm",
        "mesh": {{ "box": {{ "size": [20, 10], "cells": [20, 22], "element": "quad4" }} }},
        "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3,
                         "design": [ {{ "name": "rho", "kind": "density", "least": 0.01 }} ] }} ],
        "supports": [ {{ "surface": "x-", "fix": "all" }} ],
        "loads": [ {{ "surface": "x+", "traction": [0, "-1 Pa"] }} ],
        "controls": [ {{ "of": "rho", "space": "cell", "start": "{start}"{more} }} ],
        "costs": [ {{ "kind": "displacement", "surface": "x+", "direction": [0, -1] }} ],
        "optimizer": {{ "method": "lbfgs", "max_iterations": 0, "tolerance": 1e-9 }} }}"#
    )
}

const PLATE: &str = "0.9 - 0.16 * abs(Y - 5 mm) / (1 mm)";
const SLIT: &str = "0.1 + 0.16 * abs(Y - 5 mm) / (1 mm)";

#[test]
fn the_thinnest_bar_and_gap_are_found() {
    let of = |start: &str, more: &str| {
        let found = CaseDirectory::new().run(Command::Optimize, &striped(start, more), &[]).unwrap().result;
        (found["controls"]["rho"].clone(), common::messages(&found, "thin"))
    };
    let near = |value: &serde_json::Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-3;
    let (plate, told) = of(PLATE, "");
    assert!(near(&plate["smallest_bar"]["width"], 5.0) && near(&plate["smallest_bar"]["position"][1], 5.0), "{plate}");
    // beside the plate the void is open
    assert!(plate["smallest_gap"].is_null() && told.is_empty(), "{plate} {told:?}");
    let (slit, _) = of(SLIT, "");
    assert!(near(&slit["smallest_gap"]["width"], 5.0) && near(&slit["smallest_bar"]["width"], 2.5), "{slit}");
    let (_, told) = of(SLIT, ", \"least_bar\": \"2.6 mm\", \"least_gap\": \"4 mm\"");
    assert!(told.len() == 1 && told[0].contains("the smallest bar of \"rho\" is 2."), "{told:?}");
    assert!(told[0].contains("below \"least_bar\", 2.6 mm"), "{told:?}");
    let (_, told) = of(SLIT, ", \"least_gap\": \"6 mm\"");
    assert!(told.len() == 1 && told[0].contains("the smallest gap of \"rho\" is "), "{told:?}");
    // stripes of 1 mm, which a filter of 1.5 mm leaves faint
    let (_, told) = of("0.5 + 0.4 * cos(3.14159265 * Y / (1 mm))", ", \"filter\": \"1.5 mm\"");
    assert!(told.iter().any(|told| told.contains("below the length of its filter, 1.5 mm")), "{told:?}");
}

#[test]
fn what_is_not_made_has_no_least_bar() {
    let filler = with(
        &striped(PLATE, ", \"upper\": 0.3, \"least_bar\": \"1 mm\""),
        "\"kind\": \"density\", \"least\": 0.01",
        "\"kind\": \"filler\"",
    );
    let told = common::problems(&filler.replace("0.9 - ", "0.2 - 0.0 * "));
    assert!(told.contains("controls/0/least_bar: \"rho\" is no density, mixture or electrode"), "{told}");
}

/// Directions of a remanence that is sought, in millimetres, without the cells that are left out.
#[test]
fn directions_of_remanences_are_a_table() {
    let strip = r#"{ "nastic": 1, "mesh": { "box": { "size": [0.02, 0.01, 0.005], "cells": [4, 2, 1], "element": "hex8" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0.3,
                         "design": [ { "name": "rho", "kind": "density", "least": 0.01 } ] } ],
        "supports": [ { "surface": "x-", "fix": "all" } ],
        "actuation": [ { "name": "magnet", "kind": "magnet", "region": "body", "field": [0, 0, 0.005] } ],
        "controls": [ { "of": "magnet.remanence", "space": "cell", "norm": 0.1, "start": ["0.06", "0.08", "0"] },
                      { "of": "rho", "space": "cell", "start": "0.9 - 40 * X / (1 m)" } ],
        "costs": [ { "kind": "displacement", "surface": "x+", "direction": [0, 0, -1] } ],
        "optimizer": { "method": "spectral", "max_iterations": 0, "tolerance": 1e-9 } }"#;
    let place = CaseDirectory::new();
    place.run(Command::Optimize, strip, &[]).unwrap();
    let text = std::fs::read_to_string(place.path("out/directions_magnet.remanence.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("x_mm,y_mm,z_mm,volume_mm3,e_x,e_y,e_z,length_T"));
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    // half of eight cells is filled
    assert_eq!(rows.len(), 4, "{text}");
    for row in &rows {
        let near = |k: usize, expected: f64| (row[k] - expected).abs() < 1e-9;
        assert!(row[0] < 10.0 && near(2, 2.5) && near(3, 125.0), "{row:?}");
        assert!(near(4, 0.6) && near(5, 0.8) && near(6, 0.0) && near(7, 0.1), "{row:?}");
    }
}

/// What is cut is the body behind its change of shape: a bar of 10 mm whose upper side moves by 4 mm.
#[test]
fn what_is_cut_is_where_the_shape_has_moved_it() {
    let text = striped("1", ", \"fixed\": { \"body\": 1 }");
    let text = with(
        &text,
        "\"controls\": [",
        "\"actuation\": [ { \"name\": \"back\", \"kind\": \"shape\", \"region\": \"body\", \"modes\": { \"up\": [0, \"Y / (10 mm) * min(X / (2 mm), 1)\"] } } ],
         \"controls\": [ { \"of\": \"back.up\", \"space\": \"uniform\", \"start\": \"4 mm\", \"lower\": 0, \"upper\": \"5 mm\" },",
    );
    let height = |name: &str, place: &CaseDirectory| {
        let bytes = std::fs::read(place.path("out").join(name)).unwrap();
        let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        // 84 bytes of head; of 50 bytes a triangle a normal and three corners
        let corners = (84..bytes.len()).step_by(50).flat_map(|at| (1..4).map(move |k| at + 12 * k + 4));
        corners.map(number).fold(0.0_f32, f32::max)
    };
    let place = CaseDirectory::new();
    place.run(Command::Optimize, &text, &[]).unwrap();
    let made = height("design_rho.stl", &place);
    assert!((made - 14.0).abs() < 1e-4, "{made}");
}
