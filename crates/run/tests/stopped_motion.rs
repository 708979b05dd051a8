//! Motions of `solve` that fail or are stopped leave what they found; those that were stopped go on with the same bits.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, Heard, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options, Outcome, RunError, Sweep, resume, sweep};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A viscoelastic bar that fibres pull ever harder.
const PULLED: &str = r#"{ "nastic": 1, "title": "bar",
  "mesh": { "box": { "size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3",
                   "maxwell": [ { "shear": "20 kPa", "relaxation": "10 ms" } ] } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0],
                   "tension": "-1 MPa * t / (1 s)" } ],
  "probes": [ { "name": "tip", "point": [0.1, 0.005, 0.005] } ],
  "costs": [ { "kind": "position", "surface": "x+", "target": { "x": "0.09" }, "when": "integral" } ],
  "time": { "end": "50 ms", "step": "1 ms", "scheme": "bdf2", "output": "5 ms" } }"#;

/// Counts the Newton iterations that solves reports, and raises a flag at one of them.
struct Watch {
    cancel: Arc<AtomicBool>,
    at: usize,
    count: Arc<AtomicUsize>,
}

impl std::io::Write for Watch {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let message = std::str::from_utf8(bytes).unwrap().matches("Newton").count();
        if self.count.fetch_add(message, Ordering::Relaxed) + message >= self.at {
            self.cancel.store(true, Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Raises a flag once something is shown.
struct StopAt {
    cancel: Arc<AtomicBool>,
    words: &'static str,
}

impl std::io::Write for StopAt {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if String::from_utf8_lossy(bytes).contains(self.words) {
            self.cancel.store(true, Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Solves until so many Newton iterations are done; how many there were.
fn solve(place: &CaseDirectory, case: &str, at: usize) -> (Result<Outcome, RunError>, usize) {
    let options = place.options(&[]);
    let count = Arc::new(AtomicUsize::new(0));
    let watch = Watch { cancel: options.cancel.clone(), at, count: count.clone() };
    let found = place.run_with(Command::Solve, case, &Console::silent().with_passing(watch), &options);
    (found, count.load(Ordering::Relaxed))
}

fn go_on(place: &CaseDirectory) -> Result<Outcome, RunError> {
    let options = Options { threads: Some(1), ..Options::default() };
    resume(&Catalogue::standard(), &place.path("out"), &options, &Console::silent())
}

/// All files but those with times and names of machines.
fn content(place: &CaseDirectory) -> Vec<(String, Vec<u8>)> {
    let wanted = place.files().into_iter().filter(|name| !["result.json", "report.html"].contains(&name.as_str()));
    wanted.map(|name| (name.clone(), std::fs::read(place.path("out").join(name)).unwrap())).collect()
}

/// A result without times, and without the path of its case.
fn plain(place: &CaseDirectory, mut result: Value) -> Value {
    let entries = result.as_object_mut().unwrap();
    for key in ["seconds", "peak_memory", "threads", "resumed"] {
        entries.remove(key);
    }
    let text = result.to_string().replace(&place.directory.path().display().to_string(), "");
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_motion_that_fails_leaves_what_it_found() {
    let place = CaseDirectory::new();
    let torn = with(PULLED, "-1 MPa * t / (1 s)", "1 GPa * max(t - 20.5 ms, 0) / (1 s)");
    let error = place.run(Command::Solve, &torn, &[]).unwrap_err();
    assert_eq!(error.exit(), Exit::ForwardFailed);
    let text = error.to_string();
    for wanted in ["in the time step of", "from t = 2.", "the motion until t = 0.02", "motion.csv and motion.pvd"] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    assert!(!text.contains("nastic resume"), "it would fail again: {text}");
    let (files, result) = (place.files(), place.json("result.json"));
    let rows = std::fs::read_to_string(place.path("out").join("motion.csv")).unwrap().lines().count() - 1;
    let reached = result["reached"]["steps"].as_u64().unwrap();
    assert!((20..30).contains(&reached) && rows as u64 == reached + 1, "{rows} {reached}");
    // those of the output, and the last one
    let written = files.iter().filter(|name| name.starts_with("motion_")).count() as u64;
    assert_eq!(written, reached / 5 + 1 + u64::from(!reached.is_multiple_of(5)));
    for name in ["motion.pvd", "motion.svg", "failure.vtu", "result.json"] {
        assert!(files.iter().any(|file| file == name), "{name}: {files:?}");
        assert!(name == "result.json" || result["files"].as_array().unwrap().contains(&name.into()), "{name}");
    }
    assert!(result["failure"]["t"].as_f64().unwrap() > 0.0199 && result["exit"] == 3, "{}", result["failure"]);
    assert!(!files.contains(&"motion_checkpoint.bin".to_owned()));
}

#[test]
fn a_motion_that_was_stopped_goes_on_with_the_same_bits() {
    let tolerance = with(PULLED, r#""step": "1 ms", "scheme": "bdf2""#, r#""tolerance": "1 um", "longest": "1 ms""#);
    let two = with(
        PULLED,
        r#""costs""#,
        r#""scenarios": [ { "name": "soft", "probability": 0.5, "set": { "materials/0/young": "0.2 MPa" } },
                         { "name": "hard", "probability": 0.5 } ], "costs""#,
    );
    // friction depends on the step that led to a state
    let rubbed = with(
        PULLED,
        r#""supports""#,
        r#""loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ],
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, 0], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "sole", "surface": "z-", "obstacle": "floor", "friction": 0.5 } ],
  "supports""#,
    );
    let rubbed = with(&rubbed, r#""scheme": "bdf2""#, r#""scheme": "backward_euler", "start": "rest""#);
    // of steps that are found the first half of the iterations, and more, belongs to that
    for (case, share) in [(PULLED, 0.5), (&tolerance, 0.8), (&rubbed, 0.5), (PULLED, 0.02)] {
        let (whole, place) = (CaseDirectory::new(), CaseDirectory::new());
        let (expected, iterations) = solve(&whole, case, usize::MAX);
        let expected = expected.unwrap();
        let error = solve(&place, case, (share * iterations as f64) as usize).0.unwrap_err();
        assert_eq!(error.exit(), Exit::NotConverged);
        let text = error.to_string();
        assert!(text.contains("stopped before there was a result; the motion until t = "), "{text}");
        assert!(text.contains("; nastic resume "), "{text}");
        assert!(place.files().contains(&"motion_checkpoint.bin".to_owned()));
        assert!(place.files().contains(&"motion.csv".to_owned()));
        let found = go_on(&place).unwrap();
        let steps = found.result["resumed"]["steps"][0].as_u64().unwrap();
        assert!(steps.is_multiple_of(16) && (steps > 0 || share < 0.1), "{}", found.result["resumed"]);
        assert_eq!(plain(&place, found.result), plain(&whole, expected.result));
        assert_eq!(content(&place), content(&whole));
        assert!(!place.files().contains(&"motion_checkpoint.bin".to_owned()));
    }
    // of several members, of which any may be ahead; one that was quicker than the signal is begun again
    let whole = CaseDirectory::new();
    let expected = whole.run(Command::Solve, &two, &[]).unwrap();
    let place = (0..20).map(|_| stopped_at_once(&two)).find_map(|(place, stopped)| stopped.then_some(place));
    let place = place.expect("it was stopped once");
    let found = go_on(&place).unwrap();
    assert_eq!(plain(&place, found.result), plain(&whole, expected.result));
    assert_eq!(content(&place), content(&whole));
}

/// Goes on until so many Newton iterations are done.
fn go_on_until(place: &CaseDirectory, at: usize) -> RunError {
    let cancel = Arc::new(AtomicBool::new(at == 0));
    let options = Options { threads: Some(1), cancel: cancel.clone(), ..Options::default() };
    let console = Console::silent().with_passing(Watch { cancel, at, count: Arc::default() });
    resume(&Catalogue::standard(), &place.path("out"), &options, &console).unwrap_err()
}

/// Files with states, and what is made of them.
fn of_states(place: &CaseDirectory) -> Vec<(String, Vec<u8>)> {
    let is_of_states = |name: &str| !["motion_checkpoint.bin", "case.json"].contains(&name);
    content(place).into_iter().filter(|(name, _)| is_of_states(name)).collect()
}

#[test]
fn a_motion_that_is_stopped_before_it_was_there_again_loses_nothing() {
    let (whole, place) = (CaseDirectory::new(), CaseDirectory::new());
    let (expected, iterations) = solve(&whole, PULLED, usize::MAX);
    let text = solve(&place, PULLED, iterations * 9 / 10).0.unwrap_err().to_string();
    let wanted = |text: &str| text.contains("goes on with it and computes the last ") && text.contains("once more");
    assert!(wanted(&text), "{text}");
    let kept = of_states(&place);
    assert!(kept.iter().filter(|(name, _)| name.ends_with(".vtu")).count() > 8, "{:?}", place.files());
    let reached = place.json("result.json")["reached"].clone();
    for at in [0, 1, 7, 0, 15] {
        let text = go_on_until(&place, at).to_string();
        assert!(wanted(&text), "{text}");
        assert!(of_states(&place) == kept, "{at}: {:?}", place.files());
        assert_eq!(place.json("result.json")["reached"], reached);
    }
    let heard = Heard::default();
    let options = Options { threads: Some(1), ..Options::default() };
    let found = resume(&Catalogue::standard(), &place.path("out"), &options, &Console::new(heard.clone())).unwrap();
    assert!(
        heard.text().contains("behind it are in the results already and are computed once more"),
        "{}",
        heard.text()
    );
    assert_eq!(plain(&place, found.result), plain(&whole, expected.unwrap().result));
    assert_eq!(content(&place), content(&whole));
}

/// Of members one after the other some have not begun when they are stopped.
#[test]
fn members_that_have_not_begun_begin_when_the_others_go_on() {
    let two = with(
        PULLED,
        r#""costs""#,
        r#""scenarios": [ { "name": "soft", "probability": 0.5, "set": { "materials/0/young": "0.2 MPa" } },
                         { "name": "hard", "probability": 0.5 } ], "costs""#,
    );
    let (whole, place) = (CaseDirectory::new(), CaseDirectory::new());
    let expected = whole.run(Command::Solve, &two, &[]).unwrap();
    // on one thread the second has not begun when the first is done
    let cancel = Arc::new(AtomicBool::new(false));
    let options = Options { threads: Some(1), cancel: cancel.clone(), ..place.options(&[]) };
    let console = Console::silent().with_passing(StopAt { cancel, words: "scenarios: 1 of 2" });
    let stopped = place.run_with(Command::Solve, &two, &console, &options);
    stopped.unwrap_err();
    let kept = of_states(&place);
    for _ in 0..2 {
        let text = go_on_until(&place, 0).to_string();
        assert!(text.contains("nastic resume"), "{text}");
        assert!(of_states(&place) == kept, "{:?}", place.files());
    }
    let found = go_on(&place).unwrap();
    assert_eq!(plain(&place, found.result), plain(&whole, expected.result));
    assert_eq!(content(&place), content(&whole));
}

/// A run that is stopped as soon as its first checkpoint is there, and whether it was.
fn stopped_at_once(case: &str) -> (CaseDirectory, bool) {
    let place = CaseDirectory::new();
    let options = place.options(&[]);
    let cancel = options.cancel.clone();
    let begun = place.path("out").join("motion_checkpoint.bin");
    let ended = Arc::new(AtomicBool::new(false));
    let over = ended.clone();
    let watch = std::thread::spawn(move || {
        while !begun.exists() && !over.load(Ordering::Relaxed) {
            std::thread::yield_now();
        }
        cancel.store(true, Ordering::Relaxed);
    });
    let stopped = place.run_with(Command::Solve, case, &Console::silent(), &options).is_err();
    ended.store(true, Ordering::Relaxed);
    watch.join().unwrap();
    (place, stopped)
}

/// A motion that was stopped is not thrown away by another command in its directory, unless it is asked to.
#[test]
fn another_command_leaves_a_stopped_motion() {
    let place = CaseDirectory::new();
    assert!(solve(&place, PULLED, 70).0.is_err());
    let kept = content(&place);
    let error = place.run(Command::Solve, PULLED, &[]).err().unwrap();
    let wanted = "holds the checkpoint of an interrupted motion: go on with it by nastic resume";
    assert!(error.exit() == Exit::BadInput && error.to_string().contains(wanted), "{error}");
    assert!(place.files().contains(&"motion_checkpoint.bin".to_owned()));
    assert_eq!(content(&place), kept);
    let options = Options { restart: true, ..place.options(&[]) };
    assert!(place.run_with(Command::Solve, PULLED, &Console::silent(), &options).is_ok());
    assert!(!place.files().contains(&"motion_checkpoint.bin".to_owned()));
}

#[test]
fn a_checkpoint_of_another_case_is_refused() {
    let place = CaseDirectory::new();
    assert!(solve(&place, PULLED, 70).0.is_err());
    place.write("case.json", &with(PULLED, "0.3 MPa", "0.4 MPa"));
    let error = go_on(&place).unwrap_err();
    assert_eq!(error.exit(), Exit::BadInput);
    let wanted = "materials/0/young was \"0.3 MPa\", is \"0.4 MPa\"";
    assert!(error.to_string().contains(wanted) && error.to_string().contains("the case changed"), "{error}");
    // damaged
    place.write("case.json", PULLED);
    let file = place.path("out").join("motion_checkpoint.bin");
    let mut bytes = std::fs::read(&file).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&file, &bytes).unwrap();
    let error = go_on(&place).unwrap_err().to_string();
    assert!(error.contains("motion_checkpoint.bin is damaged"), "{error}");
}

/// A sweep goes on with the motion in which it was stopped, if that is one of the same case.
#[test]
fn a_sweep_goes_on_with_a_motion_that_was_stopped() {
    let place = CaseDirectory::new();
    let (_, iterations) = solve(&place, PULLED, usize::MAX);
    let directory = place.path("out/young=2e6");
    let stop = |young: &str| {
        let set = [format!("materials/0/young={young}")];
        let options = Options { out: Some(directory.clone()), ..place.options(&[&set[0]]) };
        let watch = Watch { cancel: options.cancel.clone(), at: iterations / 2, count: Arc::default() };
        let console = Console::silent().with_passing(watch);
        assert!(place.run_with(Command::Solve, PULLED, &console, &options).is_err());
    };
    let both = |restart: bool| {
        let options = Options { restart, ..place.options(&["materials/0/young=1e6,2e6"]) };
        let (heard, how) = (Heard::default(), Sweep { command: Command::Solve, warm: false, quantity: None });
        let (file, console) = (place.path("case.json"), Console::new(heard.clone()));
        let found = sweep(&Catalogue::standard(), &how, &file, &options, &console).unwrap();
        (found, heard.text())
    };
    let (whole, _) = both(false);
    std::fs::remove_dir_all(&directory).unwrap();
    stop("2e6");
    let (again, said) = both(false);
    assert!(said.contains("; kept") && said.contains("; went on from its checkpoint"), "{said}");
    assert_eq!(again, whole);
    // That of another case is not replaced unasked.
    std::fs::remove_dir_all(&directory).unwrap();
    stop("3e6");
    let (refused, said) = both(false);
    assert!(refused.exit == Exit::BadInput && said.contains("the checkpoint of an interrupted motion"), "{said}");
    assert_eq!(both(true).0, whole);
}
