//! Sweeps over meshes: names on the axis, the quantity of choice, observed orders against those of theory.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::CaseDirectory;
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, RunError, Sweep, SweepOutcome, sweep};
use serde_json::Value;

/// A bar of Poisson's ratio 0 that its own weight stretches by half at its upper end: u depends on x alone and is smooth.
const HANGING: &str = r#"{ "nastic": 1, "title": "hanging",
  "mesh": { "box": { "size": [1, 0.25, 0.25], "cells": [4, 1, 1], "element": "tet4" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "100 kPa", "poisson": 0, "density": "1000 kg/m^3" } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "loads": [ { "gravity": ["40 m/s^2", 0, 0] } ],
  "probes": [ { "name": "tip", "point": [1, 0, 0] } ] }"#;

const CELLS: &str = "mesh/box/cells=[24,8,8],[6,2,2],[12,4,4]";

fn swept(place: &CaseDirectory, quantity: Option<&str>, set: &[&str]) -> Result<SweepOutcome, RunError> {
    let file = place.write("case.json", HANGING);
    let how = Sweep { command: Command::Solve, warm: false, quantity: quantity.map(str::to_owned) };
    let options = Options { no_report: true, ..place.options(set) };
    sweep(&Catalogue::standard(), &how, &file, &options, &Console::silent())
}

fn text(place: &CaseDirectory, name: &str) -> String {
    std::fs::read_to_string(place.path("out").join(name)).unwrap()
}

/// The potential of an equilibrium falls as the square of the error of the strain: h^2 of linear elements, h^4 of quadratic ones.
#[test]
fn observed_orders_are_those_of_theory() {
    for (element, order) in [("tet4", 2.0), ("tet10", 4.0)] {
        let place = CaseDirectory::new();
        let element = format!("mesh/box/element={element}");
        let outcome = swept(&place, Some("potential"), &[CELLS, &element]).unwrap();
        assert_eq!(outcome.exit, Exit::Done);
        let records = outcome.result["convergence"].as_array().unwrap();
        let numbers = |key: &str| records.iter().map(|one| one[key].as_f64()).collect::<Vec<_>>();
        // from the coarsest to the finest, in whatever order they were typed
        assert_eq!(numbers("cells"), [144.0, 1152.0, 9216.0].map(Some));
        assert!(records[2]["run"].as_str().unwrap().contains("24"), "{records:#?}");
        let values = numbers("value").into_iter().flatten().collect::<Vec<f64>>();
        let expected: Vec<f64> = values.iter().map(|value| value - values[2]).collect();
        assert_eq!(numbers("difference").into_iter().flatten().collect::<Vec<f64>>(), expected);
        assert_eq!(numbers("order")[..2], [None, None]);
        let observed = numbers("order")[2].unwrap();
        assert!((observed - order).abs() < 0.2, "{element}: {observed} of {values:?}");
        // the same as a table, with units
        let csv = text(&place, "sweep_table.csv");
        let head = "mesh/box/cells,cells,unknowns,potential (N m),difference to the finest (N m),relative difference,observed order";
        assert_eq!(csv.lines().next(), Some(head));
        assert_eq!(csv.lines().count(), 4);
        let latex = text(&place, "sweep_table.tex");
        for part in [
            "\\toprule",
            "\\midrule",
            "\\bottomrule",
            "potential ($\\mathrm{N\\,m}$)",
            "[24,8,8] & 9216 &",
            "{lrrrrrr}",
        ] {
            assert!(latex.contains(part), "{part} in {latex}");
        }
    }
}

#[test]
fn meshes_have_names_on_the_axis_and_no_cost_of_a_solve_is_drawn() {
    let place = CaseDirectory::new();
    let cost = r#"costs=[{"kind":"tracking","surface":"x+","target":["X","Y","Z"]}]"#;
    let outcome = swept(&place, None, &["mesh/box/cells=[2,1,1],[4,1,1]", cost]).unwrap();
    assert!(outcome.result["runs"][0]["figures"]["cost/total"].is_number());
    let svg = text(&place, "sweep.svg");
    assert!(svg.contains(">[2,1,1]</text>") && svg.contains(">[4,1,1]</text>"), "{svg}");
    assert!(!svg.contains("cost/total") && !svg.contains(">0.5</text>"), "{svg}");
    assert!(svg.contains("tracking/tracking/root_mean_square (m)"), "{svg}");
    // two meshes show no order
    assert!(outcome.result["convergence"].as_array().unwrap().iter().all(|one| one["order"].is_null()));
    let page = text(&place, "sweep.html");
    assert!(page.contains("Convergence over meshes") && page.contains("difference to the finest"), "{page}");
}

/// What no results have is refused before any run.
#[test]
fn a_quantity_of_no_results_makes_no_run() {
    let place = CaseDirectory::new();
    let error = swept(&place, Some("enery/elastic"), &[CELLS]).unwrap_err().to_string();
    assert!(error.contains("--quantity: results have no \"enery\": did you mean \"energy\"?"), "{error}");
    assert!(!place.path("out").exists());
}

#[test]
fn the_quantity_is_of_the_users_choice() {
    let place = CaseDirectory::new();
    let tip = "probes/tip/displacement/0";
    let values = "materials/0/young=90 kPa,110 kPa";
    let outcome = swept(&place, Some(tip), &[values]).unwrap();
    assert_eq!((outcome.result["quantity"].as_str(), &outcome.result["convergence"]), (Some(tip), &Value::Null));
    let svg = text(&place, "sweep.svg");
    assert!(svg.contains(&format!("{tip} (m)")) && svg.contains("young (kPa)"), "{svg}");
    let csv = text(&place, "sweep_table.csv");
    assert!(csv.starts_with(&format!("materials/0/young,{tip} (m)\n90 kPa,")), "{csv}");
    // one that there is not is refused behind the first run, with those that there are
    let other = CaseDirectory::new();
    let refused = swept(&other, Some("probes/tipp/displacement/0"), &[values]).unwrap_err();
    assert_eq!(refused.exit(), Exit::BadInput);
    assert!(refused.to_string().contains(tip), "{refused}");
    assert!(!other.path("out/young=110_kPa").exists());
}
