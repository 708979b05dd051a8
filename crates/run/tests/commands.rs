//! Whole commands on a bar of four cells: results, files, exit codes.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, OPTIMUM_POINTS, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, RunError};
use serde_json::Value;

fn number(value: &Value, path: &str) -> f64 {
    let found = nastic_run::result::find(value, path).unwrap_or_else(|| panic!("no {path} in {value:#}"));
    found.as_f64().unwrap_or_else(|| panic!("{path} is {found}"))
}

fn singles(snapshot: &nastic_mesh::Snapshot, name: &str) -> Vec<[f64; 1]> {
    snapshot.point_array(name).unwrap().values.iter().map(|x| [*x]).collect()
}

#[test]
fn check_describes_and_solves_nothing() {
    let place = CaseDirectory::new();
    let text = place.text(Command::Check, BAR, &[]);
    for part in [
        "body        box: 4 cells, 60 unknowns, 20 control values",
        "size 1 x 0.25 x 0.25 m, volume 0.0625 m^3",
        "x-: 1 facet, area 0.0625 m^2",
        "mu1 100000 Pa",
        "the law stays polyconvex up to a tension of 200000 Pa",
        "tension: by node, 20 unknowns, start -50000 to 0 Pa, within [-200000, 100000] Pa",
        "12 of 60 displacement components held",
        "m < 0 contracts the fibre",
        "check       the case is complete and consistent",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    let result = place.json("result.json");
    assert_eq!(number(&result, "mesh/cells"), 4.0);
    assert_eq!(number(&result, "materials/0/parameters/mu1/si"), 1e5);
    assert_eq!(place.files(), ["result.json"], "check leaves nothing behind but the result asked for by --out");
}

#[test]
fn check_shows_values_in_si_too() {
    let place = CaseDirectory::new();
    let units = r#""units": { "length": "mm", "force": "N" }, "mesh""#;
    let text = with(BAR, r#""mesh""#, units);
    let text = text.replace("[1.0, 0.25, 0.25]", "[\"1 m\", \"250 mm\", 250]");
    let said = place.text(Command::Check, &text, &[]);
    assert!(said.contains("mu1 0.1 MPa = 100000 Pa"), "{said}");
    assert_eq!(number(&place.json("result.json"), "materials/0/parameters/mu1/value"), 0.1);
}

#[test]
fn solve_writes_the_equilibrium_with_its_arrays() {
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Solve, BAR, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done);
    let result = place.json("result.json");
    assert_eq!(result, outcome.result);
    assert_eq!(number(&result, "inertia"), 0.0);
    assert!(number(&result, "min_J") > 0.5);
    assert!(number(&result, "cost/terms/tracking") > 0.0);
    let lifted = number(&result, "probes/tip/displacement/2");
    assert!(lifted > 0.01, "a contracted upper side lifts the tip: {lifted}");
    // dead loads are absent: the support carries nothing
    for k in 0..3 {
        assert!(number(&result, &format!("reactions/x-/{k}")).abs() < 1e-6);
    }
    let snapshot = nastic_io::read_snapshot(place.path("out/start.vtu")).unwrap();
    assert_eq!(snapshot.mesh.points().len(), 20);
    let points: Vec<&str> = snapshot.point_data.iter().map(|a| a.name.as_str()).collect();
    let detailed = ["reaction", "nodal_cauchy_stress", "nodal_mises", "target_distance"];
    assert_eq!(points, [&["displacement", "tension"], &detailed[..]].concat());
    let cells: Vec<&str> = snapshot.cell_data.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(
        cells,
        ["J", "P", "cauchy_stress", "mises", "energy", "direction_tension", "green_strain", "principal_stretches"]
    );
    let tip = snapshot.mesh.points().iter().position(|x| *x == [1.0, 0.25, 0.25]).unwrap();
    assert_eq!(snapshot.point_array("displacement").unwrap().at(tip)[2], lifted);
    assert_eq!(snapshot.point_array("tension").unwrap().at(tip), [-5e4]);
    // The tracked end is to be at (X - 0.1, Y, Z + 0.1); other nodes have no target.
    let moved = snapshot.positions();
    for (x, (y, [distance])) in
        snapshot.mesh.points().iter().zip(moved.iter().zip(singles(&snapshot, "target_distance")))
    {
        let to = [x[0] - 0.1, x[1], x[2] + 0.1];
        let wanted = if x[0] == 1.0 { (0..3).map(|c| (y[c] - to[c]).powi(2)).sum::<f64>().sqrt() } else { 0.0 };
        assert!((distance - wanted).abs() < 1e-7, "{distance}, {wanted} at {x:?}");
    }
    let strains = snapshot.cell_array("green_strain").unwrap().values.chunks_exact(9);
    let stretches = snapshot.cell_array("principal_stretches").unwrap().values.chunks_exact(3);
    for (strain, stretch) in strains.zip(stretches) {
        assert!(stretch[0] > stretch[1] && stretch[1] >= stretch[2] && stretch[2] > 0.5, "{stretch:?}");
        let trace: f64 = stretch.iter().map(|l| 0.5 * (l * l - 1.0)).sum();
        assert!((trace - strain[0] - strain[4] - strain[8]).abs() < 1e-6, "{strain:?}, {stretch:?}");
    }
    assert!(place.path("out/picture.png").exists() && place.path("out/picture.svg").exists());
    assert!(place.path("out/target.vtu").exists());
}

#[test]
fn gradient_gives_one_array_per_control_that_differences_confirm() {
    let place = CaseDirectory::new();
    place.run(Command::Gradient, BAR, &[]).unwrap();
    let derivative = place.json("derivative.json");
    let entries = derivative["tension"].as_array().unwrap();
    assert_eq!(entries.len(), 20);
    let sum: f64 = entries.iter().map(|d| d.as_f64().unwrap()).sum();
    let norm = entries.iter().map(|d| d.as_f64().unwrap().powi(2)).sum::<f64>().sqrt();
    let result = place.json("result.json");
    assert!((number(&result, "derivative_norm/euclidean") / norm - 1.0).abs() < 1e-12);
    // all nodes together: the derivative along a constant shift
    let shifted = |by: f64| {
        let start = format!("controls/0/start=-50 kPa * Z / 0.25 m + {by}");
        number(&place.run(Command::Solve, BAR, &[&start]).unwrap().result, "cost/total")
    };
    let difference = (shifted(10.0) - shifted(-10.0)) / 20.0;
    assert!((difference / sum - 1.0).abs() < 1e-6, "{difference:e} and {sum:e}");
}

#[test]
fn gradcheck_has_a_row_per_step_and_leaves_no_state_behind() {
    let place = CaseDirectory::new();
    let text = place.text(Command::Gradcheck, BAR, &[]);
    assert!(text.contains("control tension, direction 1 of 2"), "{text}");
    assert!(text.contains("total") && text.contains("tracking") && text.contains("control_norm"), "{text}");
    for t in ["1.0e+00", "1.0e-04", "1.0e-08"] {
        assert!(text.lines().any(|line| line.trim_start().starts_with(t)), "{t}\n{text}");
    }
    assert!(text.contains("verdict     right"), "{text}");
    let result = place.json("result.json");
    assert_eq!(result["gradcheck"]["passed"], true);
    assert!(number(&result, "gradcheck/lowest_order") > 1.95);
    assert_eq!(result["gradcheck"]["tests"].as_array().unwrap().len(), 3);
    assert!(text.contains("second      right") && text.contains("d.Hd"), "{text}");
    assert_eq!(result["gradcheck"]["second"]["passed"], true);
    assert!(number(&result, "gradcheck/second/lowest_order") > 2.95);
    let seconds: Vec<_> =
        (0..3).map(|k| result["gradcheck"]["tests"][k]["second"].as_str().unwrap().to_owned()).collect();
    assert_eq!(seconds, ["right", "right", "quadratic"]);
    assert_eq!(place.files(), ["result.json"]);
}

#[test]
fn optimize_lowers_the_cost_and_keeps_its_promises() {
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Optimize, BAR, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::NotConverged, "four iterations are too few");
    let result = place.json("result.json");
    assert!(number(&result, "cost/total") < 0.1 * number(&result, "start/cost/total"));
    assert_eq!(number(&result, "iterations"), 4.0);
    assert!(number(&result, "newton_iterations") > 0.0);
    assert!(number(&result, "controls/tension/min") >= -2e5);
    assert!(number(&result, "controls/tension/max") <= 1e5);
    for key in [
        "derivative_norm",
        "trials",
        "failed_solves",
        "factorisations",
        "reused_factorisations",
        "min_J",
        "inertia",
        "seconds",
        "versions",
        "case_hash",
        "probes",
        "reactions",
        "stop",
    ] {
        assert!(!result[key].is_null(), "{key}");
    }
    for file in ["start.vtu", "optimum.vtu", "target.vtu", "iteration_0000.vtu", "iteration_0002.vtu"] {
        nastic_io::read_snapshot(place.path("out").join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    }
    let optimum = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
    let points: Vec<&str> = optimum.point_data.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(points, OPTIMUM_POINTS);
    let collection = std::fs::read_to_string(place.path("out/iterations.pvd")).unwrap();
    assert!(collection.contains("iteration_0000.vtu") && collection.contains("iteration_0004.vtu"), "{collection}");
    assert!(
        !std::fs::read_dir(place.path("out")).unwrap().any(|e| e
            .unwrap()
            .file_name()
            .to_string_lossy()
            .contains(".part"))
    );
}

#[test]
fn the_history_has_every_key_in_every_line() {
    let place = CaseDirectory::new();
    place.run(Command::Optimize, BAR, &[]).unwrap();
    let text = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for (k, line) in lines.iter().enumerate() {
        for key in [
            "trial",
            "iteration",
            "stage",
            "accepted",
            "reason",
            "cost",
            "terms",
            "gradient_norm",
            "relative_gradient",
            "step",
            "predicted",
            "newton",
            "factorisations",
            "back_substitutions",
            "min_J",
            "active",
            "seconds",
        ] {
            assert!(line.get(key).is_some(), "{key} in {line}");
        }
        assert_eq!(line["trial"], k);
        // The derivative before predicts a decrease, of about the size of the actual one where the step was accepted.
        assert_eq!(line["predicted"].is_null(), k == 0, "{line}");
        assert!(k == 0 || number(line, "predicted") < 0.0);
    }
    let first = number(&lines[0], "gradient_norm");
    assert!(
        lines
            .iter()
            .all(|l| (number(l, "relative_gradient") * first - number(l, "gradient_norm")).abs() <= 1e-12 * first)
    );
    assert_eq!(lines[0]["reason"], "start");
    assert!(lines[0]["newton"].as_u64().unwrap() > 0, "the start was solved for");
    assert!(number(&lines[1], "terms/tracking") > 0.0);
    let accepted: Vec<f64> = lines.iter().filter(|l| l["accepted"] == true).map(|l| number(l, "cost")).collect();
    assert!(accepted.windows(2).all(|pair| pair[1] < pair[0]), "{accepted:?}");
}

#[test]
fn a_converged_run_is_done() {
    let place = CaseDirectory::new();
    let outcome =
        place.run(Command::Optimize, BAR, &["optimizer/max_iterations=200", "optimizer/tolerance=1e-2"]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result["stop"]);
    assert_eq!(outcome.result["converged"], true);
}

#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads: usize| {
        let place = CaseDirectory::new();
        let options = Options { threads: Some(threads), ..place.options(&[]) };
        place.run_with(Command::Optimize, BAR, &Console::silent(), &options).unwrap();
        let mut result = place.json("result.json");
        result
            .as_object_mut()
            .unwrap()
            .retain(|key, _| !["seconds", "threads", "peak_memory", "case"].contains(&key.as_str()));
        (result, std::fs::read(place.path("out/optimum.vtu")).unwrap())
    };
    assert_eq!(run(1), run(2));
}

#[test]
fn a_run_starts_where_another_ended() {
    let place = CaseDirectory::new();
    let first = place.run(Command::Optimize, BAR, &[]).unwrap().result;
    std::fs::create_dir_all(place.path("kept")).unwrap();
    std::fs::copy(place.path("out/optimum.vtu"), place.path("kept/optimum.vtu")).unwrap();
    let start = r#"controls/0/start={"file": "kept/optimum.vtu", "array": "tension"}"#;
    let second = place.run(Command::Gradient, BAR, &[start]).unwrap().result;
    let (a, b) = (number(&first, "cost/total"), number(&second, "cost/total"));
    // what trials are solved to
    assert!((a - b).abs() < 1e-8 * a, "{a:e} and {b:e}");
    // a field by cell or one for all takes the means
    for space in ["cell", "uniform", "region"] {
        let space = format!("controls/0/space={space}");
        let outcome = place.run(Command::Check, BAR, &[start, &space]).unwrap();
        assert!(number(&outcome.result, "controls/tension/min") >= number(&first, "controls/tension/min"));
    }
    let wrong = r#"controls/0/start={"file": "kept/optimum.vtu", "array": "tensoin"}"#;
    let error = place.run(Command::Check, BAR, &[wrong]).unwrap_err().to_string();
    assert!(error.contains("controls/0/start/array: array \"tensoin\" not found in kept/optimum.vtu"), "{error}");
    let error = place.run(Command::Check, BAR, &[start, "mesh/box/cells=[5, 1, 1]"]).unwrap_err().to_string();
    assert!(error.contains("is not on the mesh of this case"), "{error}");
}

#[test]
fn fields_by_cell_travel_through_files_to_the_bit() {
    let place = CaseDirectory::new();
    let case = with(BAR, r#""space": "node""#, r#""space": "cell""#);
    let first = place.run(Command::Optimize, &case, &["optimizer/max_iterations=2"]).unwrap().result;
    std::fs::copy(place.path("out/optimum.vtu"), place.path("first.vtu")).unwrap();
    let start = r#"controls/0/start={"file": "first.vtu", "array": "tension"}"#;
    let second = place.run(Command::Check, &case, &[start]).unwrap().result;
    for key in ["controls/tension/min", "controls/tension/max"] {
        assert_eq!(number(&first, key), number(&second, key));
    }
}

#[test]
fn expectations_are_judged() {
    let place = CaseDirectory::new();
    let expect = r#""expect": { "probes/tip/displacement/0": { "value": 1, "absolute": 0.1, "command": "solve" },
        "probes/top/displacement/0": { "value": 1, "absolute": 0.1, "command": "solve" },
        "min_J": { "value": 0.95, "relative": 0.2 } }, "output""#;
    let case = with(BAR, r#""output""#, expect);
    let outcome = place.run(Command::Solve, &case, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::ExpectMissed);
    assert_eq!(outcome.missed.len(), 2);
    let message = outcome.missed[0].to_string();
    assert!(
        message.starts_with("probes/tip/displacement/0 is -0.") && message.contains("expected 1 within 1e-1"),
        "{message}"
    );
    let message = outcome.missed[1].to_string();
    assert!(message.ends_with("the result has no such value; \"probes\" has: tip"), "{message}");
    let outcome = place.run(Command::Gradient, &case, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "what is expected of solve is not asked of gradient");
    assert_eq!(outcome.result["expect"]["checked"], 1);
}

#[test]
fn an_impossible_solve_keeps_its_last_good_state() {
    let place = CaseDirectory::new();
    place.run(Command::Solve, BAR, &[]).unwrap();
    let pushed = with(
        BAR,
        r#""fix": ["x", "y", "z"] }"#,
        r#""fix": ["x", "y", "z"] }, { "surface": "x+", "displacement": { "x": -1.2 } }"#,
    );
    for command in [Command::Solve, Command::Gradient, Command::Optimize, Command::Gradcheck] {
        let error = place.run(command.clone(), &pushed, &[]).unwrap_err();
        assert_eq!(error.exit(), Exit::ForwardFailed, "{error}");
        let message = error.to_string();
        assert!(message.contains("at load 0.") && message.contains("failure.vtu"), "{message}");
        let last = nastic_io::read_snapshot(place.path("out/failure.vtu")).unwrap();
        let moved = last.point_array("displacement").unwrap().values.iter().fold(0.0f64, |m, u| m.max(u.abs()));
        assert!(moved > 0.1, "it came some of the way: {moved}");
        let result = place.json("result.json");
        assert_eq!(result["exit"], 3);
        let failure = &result["failure"];
        let share = |key: &str| failure[key].as_f64().unwrap_or_else(|| panic!("no {key} in {failure:#}"));
        assert!(share("load") > 0.0 && share("load") <= 1.0, "{failure:#}");
        assert!(["inverted", "no_convergence"].contains(&failure["kind"].as_str().unwrap()), "{failure:#}");
        if failure["kind"] == "no_convergence" {
            assert!(share("reached") < share("load") && failure["cause"].is_string(), "{failure:#}");
        }
        // all cells are ranked by their smallest J, in the file and in the result
        let worst = failure["worst_cells"].as_array().unwrap();
        let (rank, lowest) = (last.cell_array("failure_rank").unwrap(), last.cell_array("min_J").unwrap());
        for (k, one) in worst.iter().enumerate() {
            let cell = one["cell"].as_u64().unwrap() as usize;
            assert_eq!((rank.values[cell], Some(lowest.values[cell])), ((k + 1) as f64, one["min_J"].as_f64()));
        }
        let least = lowest.values.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(worst.len() == 4 && worst[0]["min_J"] == least && (0.0..0.9).contains(&least), "{failure:#}");
    }
}

#[test]
fn a_cost_with_a_kink_at_the_start_fails_the_gradient_check() {
    let place = CaseDirectory::new();
    // The target is the body itself: every point of one meets a point of the other.
    let kinked = r#"{ "kind": "smoothed_hausdorff",
        "target": { "box": { "size": [1.0, 0.25, 0.25], "cells": [4, 1, 1], "element": "hex8" } },
        "phi": { "exponential": { "length": 0.05 } }, "stages": [ { "alpha": 2, "beta": 2, "gamma": 2 } ] }"#;
    let case = with(BAR, r#"{ "kind": "tracking", "surface": "x+", "target": ["X - 0.1", "Y", "Z + 0.1"] }"#, kinked);
    let case = with(&case, r#""-50 kPa * Z / 0.25 m""#, "0");
    assert_eq!(place.run(Command::Gradcheck, &case, &[]).unwrap().exit, Exit::GradientWrong);
    let outcome = place.run(Command::Optimize, &case, &[]).unwrap();
    assert_eq!(outcome.exit, Exit::GradientWrong, "it refuses to start");
    assert!(!place.path("out/history.jsonl").exists() && !place.path("out/optimum.vtu").exists());
}

#[test]
fn a_cancelled_run_keeps_what_it_has() {
    let place = CaseDirectory::new();
    let options = place.options(&[
        "optimizer/max_iterations=100000",
        "optimizer/tolerance=1e-15",
        "optimizer/method=projected_gradient",
        "optimizer/verify=true",
        "expect={\"cost/total\": {\"value\": 7, \"absolute\": 1e-9}}",
    ]);
    let cancel = options.cancel.clone();
    let table = Watch { cancel, rows: 0 };
    let outcome = place.run_with(Command::Optimize, BAR, &Console::new(table), &options).unwrap();
    assert_eq!(outcome.exit, Exit::NotConverged);
    assert_eq!(outcome.result["stop"], "cancelled");
    assert!(number(&outcome.result, "iterations") >= 1.0);
    // Neither verified, as that would be cancelled too, nor held to what it might have reached.
    assert_eq!((&outcome.result["warnings"], outcome.missed.len()), (&serde_json::json!([]), 0));
    nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
}

/// Raises the flag once the table has some rows.
struct Watch {
    cancel: std::sync::Arc<std::sync::atomic::AtomicBool>,
    rows: usize,
}

impl std::io::Write for Watch {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.rows += bytes.iter().filter(|b| **b == b'\n').count();
        if self.rows > 15 {
            self.cancel.store(true, std::sync::atomic::Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_directory_that_cannot_be_written_is_told_before_any_work() {
    let place = CaseDirectory::new();
    place.write("file", "in the way");
    let options = Options { out: Some(place.path("file/out")), ..place.options(&[]) };
    let error = place.run_with(Command::Optimize, BAR, &Console::silent(), &options).unwrap_err();
    assert!(matches!(error, RunError::Write(_)), "{error}");
    assert_eq!(error.exit(), Exit::NotWritten);
}

#[test]
fn commands_say_what_they_need() {
    let place = CaseDirectory::new();
    let bare = r#"{ "nastic": 1, "mesh": { "box": { "size": [1, 1, 1], "cells": [1, 1, 1], "element": "hex8" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0.3 } ],
        "supports": [ { "surface": "z-", "fix": ["x", "y", "z"] } ],
        "loads": [ { "surface": "z+", "traction": [0, 0, "10 kPa * X / 1 m"] } ] }"#;
    let outcome = place.run(Command::Solve, bare, &[]).unwrap();
    // the load's resultant: the mean of X over the face, 1/2
    assert!((number(&outcome.result, "reactions/z-/2") + 5e3).abs() < 1e-6, "{:#}", outcome.result["reactions"]);
    let error = place.run(Command::Optimize, bare, &[]).unwrap_err();
    assert_eq!(error.exit(), Exit::BadInput);
    assert!(error.to_string().contains("\"optimize\" needs controls, and the case has none"), "{error}");
}

#[test]
fn magnets_and_turgor_go_through_the_same_code() {
    let place = CaseDirectory::new();
    let magnet = r#"{ "nastic": 1, "mesh": { "box": { "size": [1, 0.1], "cells": [10, 1], "element": "quad9" } },
        "materials": [ { "region": "body", "law": "neo_hooke", "young": "1 MPa", "poisson": 0 } ],
        "supports": [ { "surface": "x-", "fix": ["x", "y"] } ],
        "actuation": [ { "name": "magnet", "kind": "magnet", "region": "body", "field": [0, "5 mT"] } ],
        "controls": [ { "of": "magnet.remanence", "name": "design", "space": "cell", "start": [1, 0, 0], "norm": "100 mT" } ],
        "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y + 0.1"] } ],
        "optimizer": { "max_iterations": 3 }, "output": { "every": 0 } }"#;
    assert_eq!(place.run(Command::Gradcheck, magnet, &[]).unwrap().exit, Exit::Done);
    let result = place.run(Command::Optimize, magnet, &[]).unwrap().result;
    assert!(number(&result, "cost/total") < number(&result, "start/cost/total"));
    assert!((number(&result, "controls/design/min") - 0.1).abs() < 1e-12);
    let optimum = nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap();
    assert_eq!(optimum.cell_array("design").unwrap().components, 3);
    assert!(optimum.cell_array("B_r").is_some() && optimum.cell_array("B_a").is_some());
    let random = place.run(Command::Check, magnet, &[r#"controls/0/start={"random": 3}"#]).unwrap().result;
    assert!((number(&random, "controls/design/max") - 0.1).abs() < 1e-12);

    let turgor = with(
        BAR,
        r#""kind": "fiber_tension", "region": "body", "direction": [1, 0, 0]"#,
        r#""kind": "turgor", "region": "body""#,
    );
    let turgor = with(&turgor, r#""-50 kPa * Z / 0.25 m""#, r#""10 kPa""#);
    assert_eq!(place.run(Command::Gradcheck, &turgor, &[]).unwrap().exit, Exit::Done);
}

#[test]
fn the_reference_numbers_come_out_of_a_case_file() {
    let place = CaseDirectory::new();
    let case = with(
        BAR,
        r#""size": [1.0, 0.25, 0.25], "cells": [4, 1, 1]"#,
        r#""size": [1.0, 0.2, 0.2], "cells": [10, 2, 2]"#,
    );
    let case = with(&case, r#""300 kPa""#, r#""1 MPa""#);
    let case = with(&case, r#""-50 kPa * Z / 0.25 m""#, r#""-150e3 * Z / 0.2""#);
    let case = with(
        &case,
        r#"["X - 0.1", "Y", "Z + 0.1"]"#,
        r#"["0.90 - sin(0.55)*(Z - 0.1)", "Y", "0.35 + cos(0.55)*(Z - 0.1)"]"#,
    );
    let case = with(&case, r#""point": [1.0, 0.25, 0.25]"#, r#""point": [1.0, 0.2, 0.2]"#);
    let case = with(&case, r#"{ "kind": "control_norm", "of": "tension", "weight": 1e-14 }"#, "");
    let result = place.run(Command::Gradient, &case, &[]).unwrap().result;
    // hex8, n = 2: FEniCSx, NGSolve, JAX-FEM; cost and derivative: five codes
    for (k, expected) in [-0.186179761, 0.008186681, 0.235506464].into_iter().enumerate() {
        assert!((number(&result, &format!("probes/tip/displacement/{k}")) - expected).abs() < 1e-8);
    }
    assert!((number(&result, "cost/total") / 1.85521855017e-5 - 1.0).abs() < 1e-9);
    assert!((number(&result, "derivative_norm/euclidean") / 2.0357999826e-10 - 1.0).abs() < 1e-9);
}
