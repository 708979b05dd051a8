//! Which runs of a sweep are made again, and which belong to a part.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, Heard, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, Share, Sweep, SweepOutcome, sweep};
use serde_json::Value;
use std::path::Path;
use std::sync::atomic::Ordering;

const SOLVE: Sweep = Sweep { command: Command::Solve, warm: false, quantity: None };
const WARM: Sweep = Sweep { command: Command::Optimize, warm: true, quantity: None };

/// A hexahedron, for Gmsh.
const BRICK: &str = r#"$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 1 "x-"
2 2 "x+"
3 3 "body"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 1 0.25 0
4 0 0.25 0
5 0 0 0.25
6 1 0 0.25
7 1 0.25 0.25
8 0 0.25 0.25
$EndNodes
$Elements
3
1 3 2 1 1 1 4 8 5
2 3 2 2 2 2 3 7 6
3 5 2 3 3 1 2 3 4 5 6 7 8
$EndElements
"#;

/// What became of a sweep, and what was said.
fn swept(file: &Path, how: &Sweep, options: &Options) -> (SweepOutcome, String) {
    let heard = Heard::default();
    let options = Options { no_report: true, ..options.clone() };
    let found = sweep(&Catalogue::standard(), how, file, &options, &Console::new(heard.clone())).unwrap();
    (found, heard.text())
}

fn part(text: &str) -> Share {
    Share::Part(text.parse().unwrap())
}

/// Changes the result of a run on disk.
fn change(place: &CaseDirectory, run: &str, with: impl FnOnce(&mut serde_json::Map<String, Value>)) {
    let file = place.path("out").join(run).join("result.json");
    let mut result: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    with(result.as_object_mut().unwrap());
    std::fs::write(file, result.to_string()).unwrap();
}

#[test]
fn a_run_is_kept_if_case_files_command_and_version_are_the_same() {
    let place = CaseDirectory::new();
    let (mesh, other) = (BRICK, "\n");
    place.write("box.msh", mesh);
    let case =
        with(BAR, r#"{ "box": { "size": [1.0, 0.25, 0.25], "cells": [4, 1, 1], "element": "hex8" } }"#, r#""box.msh""#);
    let file = place.write("case.json", &case);
    let options = place.options(&["materials/0/mu1=90 kPa,110 kPa"]);
    let kept = |options: &Options, how: &Sweep| swept(&file, how, options).1.matches("; kept").count();
    assert_eq!(kept(&options, &SOLVE), 0);
    assert_eq!(kept(&options, &SOLVE), 2);
    // The case named in another way, more values: the same runs.
    let more = place.options(&["materials/0/mu1=110 kPa,120 kPa,90 kPa"]);
    assert_eq!(swept(&place.path("./case.json"), &SOLVE, &more).1.matches("; kept").count(), 2);
    change(&place, "mu1=90_kPa", |result| drop(result.insert("interrupted".into(), true.into())));
    assert_eq!(kept(&options, &SOLVE), 1, "one that was interrupted");
    change(&place, "mu1=90_kPa", |result| result["versions"]["nastic"] = "0.0.1".into());
    assert_eq!(kept(&options, &SOLVE), 1, "one of another version");
    change(&place, "mu1=90_kPa", |result| drop(result.insert("exit".into(), 7.into())));
    assert_eq!(kept(&options, &SOLVE), 1, "one that could not write a file");
    assert_eq!(kept(&options, &SOLVE), 2);
    let fixed = place.options(&["materials/0/mu1=90 kPa,110 kPa", "materials/0/mu2=21 kPa"]);
    assert_eq!(kept(&fixed, &SOLVE), 0, "another case");
    assert_eq!(kept(&fixed, &SOLVE), 2);
    std::fs::write(place.path("box.msh"), mesh.to_owned() + other).unwrap();
    assert_eq!(kept(&fixed, &SOLVE), 0, "another mesh");
    assert_eq!(kept(&Options { restart: true, ..fixed.clone() }, &SOLVE), 0, "begun anew");
    assert_eq!(kept(&fixed, &Sweep { command: Command::Optimize, warm: false, quantity: None }), 0, "another command");
}

/// The exit code of a kept run is that under the options at hand.
#[test]
fn warnings_of_kept_runs_count_under_strict() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", BAR);
    let options = place.options(&["costs/0/weight=1,2", "controls/0/start=-50 kPa", r#"mesh/box/element="tet4""#]);
    let (lax, _) = swept(&file, &SOLVE, &options);
    assert!(lax.exit == Exit::Done && !lax.result["runs"][0]["warnings"].as_array().unwrap().is_empty(), "{lax:?}");
    let strict = Options { strict: true, ..options.clone() };
    let (kept, said) = swept(&file, &SOLVE, &strict);
    assert!(kept.exit == Exit::Warned && said.contains("; kept"), "{said}");
    let (anew, _) = swept(&file, &SOLVE, &Options { restart: true, ..strict });
    assert_eq!(kept.result, anew.result);
    assert_eq!(swept(&file, &SOLVE, &options).0.result, lax.result);
}

/// A run that its values made invalid is tried again: a file that was missing may be there now.
#[test]
fn a_refused_run_is_a_row_of_the_joined_table_and_is_tried_again() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", BAR);
    let set = [r#"mesh={"box":{"size":[1,0.25,0.25],"cells":[4,1,1],"element":"hex8"}},"late.msh""#];
    let options = place.options(&set);
    let (first, said) = swept(&file, &SOLVE, &Options { share: part("1/1"), ..options.clone() });
    assert_eq!(first.exit, Exit::BadInput, "{said}");
    let joined = Options { share: Share::Join, ..options.clone() };
    let (table, _) = swept(&file, &SOLVE, &joined);
    assert_eq!(table.result, first.result);
    assert!(table.result["runs"][1]["error"].as_str().unwrap().contains("late.msh"), "{}", table.result);
    place.write("late.msh", BRICK);
    let (second, said) = swept(&file, &SOLVE, &options);
    assert!(second.exit == Exit::Done && said.matches("; kept").count() == 1, "{said}");
}

/// A run without an equilibrium has an end like any other: it is kept, with its error.
#[test]
fn a_run_that_failed_is_kept() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", BAR);
    let crushed =
        |end: f64| format!(r#"[{{"surface":"x-","fix":"all"}},{{"surface":"x+","displacement":{{"x":{end}}}}}]"#);
    let options = place.options(&[&format!("supports={},{}", crushed(0.1), crushed(-1.2))]);
    let (first, said) = swept(&file, &SOLVE, &options);
    assert_eq!(first.exit, Exit::ForwardFailed, "{said}");
    let (again, said) = swept(&file, &SOLVE, &options);
    assert!(again == first && said.matches("; kept").count() == 2, "{said}");
    assert_eq!(swept(&file, &SOLVE, &Options { share: Share::Join, ..options }).0, first);
}

#[test]
fn a_warm_sweep_is_one_chain_which_the_first_part_runs() {
    let set = ["costs/0/weight=1,1.01,1.02"];
    let whole = CaseDirectory::new();
    let file = whole.write("case.json", BAR);
    let (expected, _) = swept(&file, &WARM, &whole.options(&set));
    // The second process has nothing to do, whoever comes first.
    let options = Options { out: Some(whole.path("parts")), ..whole.options(&set) };
    let (second, said) = swept(&file, &WARM, &Options { share: part("2/2"), ..options.clone() });
    assert!(second.exit == Exit::Done && said.contains("nothing to run: a warm sweep is one chain"), "{said}");
    assert!(!whole.path("parts").exists());
    swept(&file, &WARM, &Options { share: part("1/2"), ..options.clone() });
    let (joined, _) = swept(&file, &WARM, &Options { share: Share::Join, ..options.clone() });
    assert_eq!(joined.result, expected.result);
    // A run that is made again with another result takes those behind it with it.
    change(&whole, "../parts/weight=1.01", |result| drop(result.remove("exit")));
    let (_, said) = swept(&file, &WARM, &options);
    assert_eq!(said.matches("; kept").count(), 2, "to the same bits: {said}");
    let controls = whole.path("parts/weight=1/controls.json");
    std::fs::write(&controls, std::fs::read_to_string(&controls).unwrap().replace('-', "-1")).unwrap();
    let (_, said) = swept(&file, &WARM, &options);
    assert_eq!(said.matches("; kept").count(), 1, "{said}");
}

/// The lock is that of the run: a part leaves the one that another process works on, and makes the others.
#[test]
fn a_run_that_another_process_works_on_is_left_to_it() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", BAR);
    std::fs::create_dir_all(place.path("out/weight=2")).unwrap();
    let lock = std::fs::File::create(place.path("out/weight=2/.lock")).unwrap();
    lock.try_lock().unwrap();
    let whole = std::fs::File::create(place.path("out/.lock")).unwrap();
    whole.try_lock().unwrap();
    let options = place.options(&["costs/0/weight=1,2,3"]);
    let (found, said) = swept(&file, &SOLVE, &Options { share: part("1/1"), ..options.clone() });
    let exits: Vec<&Value> = found.result["runs"].as_array().unwrap().iter().map(|run| &run["exit"]).collect();
    assert_eq!(exits, [0, 7, 0], "{said}");
    assert!(found.exit == Exit::NotWritten && said.contains("is in use by another program"), "{said}");
    assert!(said.contains("part 1/1    2 runs made, 1 left to others; --join"), "{said}");
    assert!(!place.path("out/weight=2/result.json").exists());
    drop((lock, whole));
    let (joined, _) = swept(&file, &SOLVE, &Options { share: Share::Join, ..options });
    assert_eq!((joined.exit, &joined.result["missing"]), (Exit::NotConverged, &serde_json::json!(["weight=2"])));
}

/// After a stop the runs that are there are rows all the same.
#[test]
fn a_sweep_that_is_stopped_keeps_the_runs_behind() {
    let place = CaseDirectory::new();
    let file = place.write("case.json", BAR);
    swept(&file, &SOLVE, &place.options(&["costs/0/weight=3,4"]));
    let options = place.options(&["costs/0/weight=1,2,3"]);
    options.cancel.store(true, Ordering::Relaxed);
    let (stopped, _) = swept(&file, &SOLVE, &options);
    assert_eq!(
        (stopped.exit, &stopped.result["missing"]),
        (Exit::NotConverged, &serde_json::json!(["weight=1", "weight=2"]))
    );
    assert_eq!(stopped.result["runs"].as_array().unwrap().len(), 1);
}
