//! Cases that a program made: without a file, with meshes of its own, results in memory.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_language::syntax::Document;
use nastic_mesh::{CellKind, box_mesh};
use nastic_run::console::Console;
use nastic_run::run::{OnTrial, Options, Outcome, RunError, States, resume, run_document};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

/// The bar as a program has it.
fn bar() -> Value {
    Document::parse("bar.json", BAR).unwrap().json()
}

fn run(command: Command, case: &Value, options: &Options) -> Result<(Outcome, Option<States>), RunError> {
    run_document(command, Document::from_json("bar", case), options, &Console::silent())
}

fn in_memory() -> Options {
    Options { in_memory: true, threads: Some(2), ..Options::default() }
}

#[test]
fn a_document_made_by_a_program_gives_what_its_file_gives() {
    let place = CaseDirectory::new();
    let of_file = place.run(Command::Optimize, BAR, &[]).unwrap();
    let (of_document, states) = run(Command::Optimize, &bar(), &in_memory()).unwrap();
    for key in ["cost", "controls", "min_J", "iterations", "probes", "stop"] {
        assert_eq!(of_file.result[key], of_document.result[key], "{key}");
    }
    let (states, file) = (states.unwrap(), nastic_io::read_snapshot(place.path("out/optimum.vtu")).unwrap());
    let own = states.snapshot(states.problem().member(0)).unwrap();
    let names = |arrays: &[nastic_mesh::NamedArray]| arrays.iter().map(|a| a.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&own.point_data), names(&file.point_data));
    assert_eq!(own.point_array("displacement"), file.point_array("displacement"));
    assert_eq!(names(&own.cell_data), names(&file.cell_data).into_iter().filter(|a| a != "region").collect::<Vec<_>>());
    let picture = states.picture(states.problem().member(0)).unwrap();
    assert_eq!(picture, std::fs::read(place.path("out/picture.png")).unwrap(), "the same picture");
}

#[test]
fn commands_in_memory_write_nothing_unless_told_where() {
    let place = CaseDirectory::new();
    let mut case = bar();
    case["output"] = json!({ "directory": place.path("of_the_case").display().to_string() });
    for command in [Command::Solve, Command::Gradient, Command::Optimize] {
        let (_, states) = run(command, &case, &in_memory()).unwrap();
        assert!(states.is_some());
    }
    assert!(!place.path("of_the_case").exists());
    run(Command::Solve, &case, &Options { out: Some(place.path("out")), ..in_memory() }).unwrap();
    assert!(place.path("out/result.json").is_file());
}

#[test]
fn every_trial_is_told_as_in_the_history() {
    let place = CaseDirectory::new();
    let message: Arc<Mutex<Vec<Value>>> = Arc::default();
    let heard = message.clone();
    let on_trial = OnTrial::call(move |line| heard.lock().unwrap().push(serde_json::to_value(line).unwrap()));
    run(Command::Optimize, &bar(), &Options { out: Some(place.path("out")), on_trial, ..in_memory() }).unwrap();
    let text = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(lines.len() > 2);
    assert_eq!(*message.lock().unwrap(), lines);
}

#[test]
fn whoever_is_told_may_stop_the_run() {
    let cancel = Arc::new(AtomicBool::new(false));
    let raised = cancel.clone();
    let on_trial = OnTrial::call(move |line| raised.store(line.trial == 1, Ordering::Relaxed));
    let (outcome, _) = run(Command::Optimize, &bar(), &Options { on_trial, cancel, ..in_memory() }).unwrap();
    assert_eq!(outcome.result["iterations"], 1);
    assert_eq!(outcome.result["converged"], false);
}

#[test]
fn an_interrupted_run_of_an_unchanged_file_is_resumed_from_the_file() {
    let place = CaseDirectory::new();
    let mut case = bar();
    case["output"] = json!({ "checkpoint": 1 });
    let file = place.write("bar.json", &case.to_string());
    let (cancel, out) = (Arc::new(AtomicBool::new(false)), Some(place.path("out")));
    let raised = cancel.clone();
    let on_trial = OnTrial::call(move |line| raised.store(line.iteration == 2, Ordering::Relaxed));
    let document = Document::from_json(&file.display().to_string(), &case);
    let options = Options { on_trial, cancel, out, ..in_memory() };
    run_document(Command::Optimize, document, &options, &Console::silent()).unwrap();
    let resumed = resume(&Catalogue::standard(), &place.path("out"), &in_memory(), &Console::silent()).unwrap();
    let (whole, _) = run(Command::Optimize, &case, &in_memory()).unwrap();
    assert_eq!(resumed.result["cost"], whole.result["cost"]);
}

#[test]
fn a_mesh_stands_for_a_file() {
    let mesh = |n| Arc::new(box_mesh([1.0, 0.2, 0.2], [n, 1, 1], CellKind::Hex8).unwrap().named("a mesh of one's own"));
    let mut case = bar();
    let (by_box, _) = run(Command::Solve, &case, &in_memory()).unwrap();
    let size = case["mesh"]["box"].clone();
    let cells = size["cells"][0].as_u64().unwrap() as usize;
    let kind = CellKind::from_name(size["element"].as_str().unwrap()).unwrap();
    let edges = [0, 1, 2].map(|k| size["size"][k].as_f64().unwrap());
    let counts = [cells, size["cells"][1].as_u64().unwrap() as usize, size["cells"][2].as_u64().unwrap() as usize];
    let same = Arc::new(box_mesh(edges, counts, kind).unwrap());
    case["mesh"] = json!("mesh:1");
    let solve = |case: &Value, mesh: Arc<nastic_mesh::Mesh>| {
        let document = Document::from_json("bar", case).with_meshes(BTreeMap::from([("mesh:1".to_owned(), mesh)]));
        run_document(Command::Solve, document, &in_memory(), &Console::silent())
    };
    let (given, _) = solve(&case, same).unwrap();
    assert_eq!(given.result["probes"], by_box.result["probes"]);
    assert_ne!(given.result["case_hash"], by_box.result["case_hash"]);

    case["supports"][0]["surface"] = json!("clmp");
    let wrong = solve(&case, mesh(2)).unwrap_err().to_string();
    assert!(wrong.contains("bar: supports/0/surface") && wrong.contains("a mesh of one's own"), "{wrong}");
    let mut case = bar();
    case["mesh"] = json!({ "file": "mesh:1", "scale": 1e-3 });
    let wrong = solve(&case, mesh(2)).unwrap_err().to_string();
    assert!(wrong.starts_with("bar: mesh/scale: a mesh that is given as arrays has no scale"), "{wrong}");
    // Without the mesh the name is that of a file.
    let missing = run(Command::Solve, &case, &in_memory()).unwrap_err().to_string();
    assert!(missing.contains("mesh:1"), "{missing}");
}
