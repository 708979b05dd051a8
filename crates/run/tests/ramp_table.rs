//! What `ramp.csv` and the result say of forces of supports, energies and volumes, against balances.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::CaseDirectory;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options};
use serde_json::Value;

/// A block on two supports under a traction, its weight and a muscle.
const LOADED: &str = r#"{ "nastic": 1, "units": "mm", "title": "loaded",
  "mesh": { "box": { "size": [20, 8, 8], "cells": [3, 1, 1], "element": "hex20" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.2 MPa", "poisson": 0.3, "density": "1200 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": "all" }, { "surface": "x+", "fix": ["z"] } ],
  "loads": [ { "surface": "z+", "traction": ["2 kPa", "0.5 kPa", 0] }, { "gravity": [0, 0, "-9.81 m/s^2"] } ],
  "actuation": [ { "name": "muscle", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
  "controls": [ { "of": "muscle", "space": "uniform", "start": "0 Pa" } ],
  "probes": [ { "name": "tip", "point": [20, 8, 8] } ] }"#;

/// Forces of the traction on 20 x 8 mm^2 and of the weight of 20 x 8 x 8 mm^3, in N.
const LOADS: [f64; 3] = [2e3 * 160e-6, 0.5e3 * 160e-6, -1200.0 * 9.81 * 1280e-9];

fn ramp(place: &CaseDirectory, case: &str, ramp: &str) -> Value {
    let options = Options { analysis: Analysis::Ramp(ramp.to_owned()), ..place.options(&[]) };
    let outcome = place.run_with(Command::Solve, case, &Console::silent(), &options).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{:#}", outcome.result);
    outcome.result
}

/// Columns of a table by their names.
struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn read(place: &CaseDirectory, name: &str) -> Self {
        let text = std::fs::read_to_string(place.path("out").join(name)).unwrap();
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let rows = lines.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect());
        Self { names, rows: rows.collect() }
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let k = self.names.iter().position(|own| own == name);
        let k = k.unwrap_or_else(|| panic!("no {name} in {:?}", self.names));
        self.rows.iter().map(|row| row[k]).collect()
    }
}

#[test]
fn reactions_of_a_ramp_balance_the_loads() {
    let place = CaseDirectory::new();
    let result = ramp(&place, LOADED, "muscle=0 Pa:-20 kPa:4");
    let table = Table::read(&place, "ramp.csv");
    let scale = LOADS[0];
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let [clamp, end] = ["x-", "x+"].map(|support| table.column(&format!("reactions.{support}.{axis}")));
        for (row, (clamp, end)) in clamp.iter().zip(&end).enumerate() {
            let left = clamp + end + LOADS[k];
            assert!(left.abs() <= 1e-8 * scale, "{axis} of row {row}: {left} N are left of {clamp} and {end}");
            // the result says the same
            let point = &result["ramp"]["points"][row];
            assert_eq!(point["reactions"]["x-"][k].as_f64(), Some(*clamp), "{point:#}");
        }
        assert!(k > 0 || clamp.iter().all(|force| force.abs() > 0.5 * scale), "there is something to balance");
    }
    let files: Vec<&str> = result["files"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    for name in ["ramp.csv", "ramp_reactions.svg", "ramp_energies.svg"] {
        assert!(files.contains(&name), "{name} in {files:?}");
    }
    assert!(!files.contains(&"ramp_volumes.svg"), "there is no chamber");
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    for part in ["x-.x", "reaction (N)", "energy (mm*N)"] {
        assert!(page.contains(part), "{part} on the page");
    }
}

/// Without loads the work that is done from outside on a body held at both ends, whose end is moved, is what it stores: by the trapezoidal rule over the ramp.
#[test]
fn the_elastic_energy_is_the_work_of_what_moves_the_body() {
    let place = CaseDirectory::new();
    let case = common::bar_with(
        r#", "actuation": [ { "name": "grip", "kind": "motion", "surface": "x+" } ],
           "controls": [ { "of": "grip.translation", "space": "uniform", "direction": "x", "start": "0 mm", "lower": "-1 mm", "upper": "9 mm" } ]"#,
    );
    let result = ramp(&place, &case, "grip.translation=0 mm:4 mm:41");
    let table = Table::read(&place, "ramp.csv");
    let names = &table.names;
    let [force, energy] = ["reactions.grip.x", "energy.elastic"].map(|name| table.column(name));
    let step = 4.0 / 40.0;
    let work: f64 = force.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]) * step).sum();
    let stored = energy[40] - energy[0];
    assert!(work > 0.1 && (stored / work - 1.0).abs() < 1e-4, "{stored} and {work} of {names:?}");
    let last = &result["ramp"]["points"][40]["energy"]["elastic"];
    assert_eq!(last.as_f64(), Some(energy[40]), "{result:#}");
}

/// Where a ramp ends far outside of what its control may be that is said before hours of solves.
#[test]
fn an_end_in_another_unit() {
    let warned = |ramp_to: &str| {
        let place = CaseDirectory::new();
        let options = Options { analysis: Analysis::Ramp(format!("muscle=0 Pa:{ramp_to}:2")), ..place.options(&[]) };
        let result = place.run_with(Command::Solve, LOADED, &Console::silent(), &options).unwrap().result;
        result["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == "bounds")
    };
    assert!(warned("-20 MPa") && !warned("-20 kPa"));
}
