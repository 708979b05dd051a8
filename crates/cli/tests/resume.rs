//! The program killed, stopped and starved of space at random moments of an optimisation, then resumed: the result is
//! that of a program that was left alone, to the bit.
//!
//! Moments are drawn from a printed seed. `NASTIC_KILLS` sets how many kills there are of each case (10 by default;
//! `scripts/slow.sh` has more).

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, Random, assert_same, code, signal, start, text};
use std::os::unix::process::ExitStatusExt;
use std::time::{Duration, Instant};

const HEAD: &str = r#"{ "nastic": 1, "title": "Bar",
  "mesh": { "box": { "size": [1.0, 0.25, 0.25], "cells": [8, 2, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "mooney_rivlin", "mu1": "100 kPa", "mu2": "20 kPa", "mu3": "300 kPa" } ],
  "supports": [ { "surface": "x-", "fix": ["x", "y", "z"] } ],
  "actuation": [ { "name": "tension", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
  "controls": [ { "of": "tension", "space": "cell", "start": "-50 kPa * Z / 0.25 m",
                  "lower": "-200 kPa", "upper": "100 kPa" } ],
  "probes": [ { "name": "tip", "point": [1.0, 0.25, 0.25] } ],
  "output": { "directory": "out", "every": 4, "checkpoint": 3 },"#;

const FIBER: &str = r#"
  "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X - 0.1", "Y", "Z + 0.1"] },
             { "kind": "control_norm", "of": "tension", "weight": 1e-14 } ],
  "optimizer": { "method": "lbfgs", "max_iterations": 25, "tolerance": 1e-9, "starts": 2 } }"#;

const HAUSDORFF: &str = r#"
  "costs": [ { "kind": "smoothed_hausdorff",
               "target": { "box": { "size": [0.9, 0.25, 0.3], "cells": [7, 2, 2], "element": "hex8" } },
               "phi": { "exponential": { "length": 0.1 } }, "quadrature": 1,
               "stages": [ { "alpha": 1, "beta": 4, "gamma": 4 }, { "alpha": 3, "beta": 16, "gamma": 8 } ] } ],
  "optimizer": { "method": "lbfgs", "max_iterations": 20, "tolerance": 1e-9 } }"#;

const ENSEMBLE: &str = r#"
  "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X - 0.1", "Y", "Z + 0.1"] } ],
  "scenarios": [ { "name": "soft", "probability": 0.25, "set": { "materials/0/mu1": "90 kPa" } },
                 { "name": "stiff", "probability": 0.75, "set": { "materials/0/mu1": "120 kPa" } } ],
  "risk": { "mean_deviation": { "lambda": 0.5 } },
  "optimizer": { "method": "spectral", "max_iterations": 20, "tolerance": 1e-9 } }"#;

/// How the program is interrupted.
#[derive(Clone, Copy, PartialEq)]
enum Blow {
    /// kill -9
    Kill,
    /// SIGTERM and SIGINT in turn.
    Stop,
}

/// What became of a program that was to be interrupted.
enum Fate {
    /// It ended by itself, or by a signal that it answered.
    Ended,
    /// It was killed.
    Killed,
}

/// A case and its undisturbed run.
struct Trial {
    place: CaseDirectory,
    /// Seconds of the undisturbed run until it writes what it found.
    duration: f64,
}

impl Trial {
    fn new(rest: &str) -> Self {
        let place = CaseDirectory::new(&format!("{HEAD}{rest}"));
        let began = Instant::now();
        let output = place.nastic(&["optimize", "case.json", "--out", "whole", "--quiet"]);
        let duration = began.elapsed().as_secs_f64();
        assert!([0, 4].contains(&code(&output)), "{}", text(&output.stderr));
        let result: serde_json::Value =
            serde_json::from_slice(&std::fs::read(place.path("whole/result.json")).unwrap()).unwrap();
        Self { place, duration: duration - result["seconds"]["write"].as_f64().unwrap() }
    }

    /// Interrupts a program after some seconds, unless it ends before.
    fn interrupt(&self, arguments: &[&str], seconds: f64, name: &str) -> Fate {
        let mut child = start(self.place.program(arguments));
        std::thread::sleep(Duration::from_secs_f64(seconds));
        if child.try_wait().unwrap().is_none() {
            signal(&child, name);
        }
        let output = child.wait_with_output().unwrap();
        match output.status.signal() {
            Some(_) => Fate::Killed,
            None => {
                let (code, message) = (code(&output), text(&output.stderr));
                assert!([0, 4].contains(&code), "{arguments:?} ended with {code} after SIG{name}: {message}");
                Fate::Ended
            }
        }
    }

    /// Interrupts again and again what was begun once, resumes, and compares.
    fn survives(&self, blow: Blow, seed: u64, blows: usize) {
        println!("seed {seed}, {:.2} s undisturbed", self.duration);
        let mut random = Random(seed);
        let (mut done, mut killed) = (0, 0);
        while done < blows {
            let chain = (blows - done).min(5);
            let mut moments = vec![];
            for _ in 0..chain {
                // Links that go on from one another; some chains reach the end of the optimisation.
                let seconds = 0.5 * self.duration * random.unit();
                moments.push(seconds);
                let begun = self.place.path("broken/checkpoint.bin").exists();
                let arguments: &[&str] =
                    if begun { &["resume", "broken"] } else { &["optimize", "case.json", "--out", "broken"] };
                let name = if blow == Blow::Kill { "KILL" } else { ["TERM", "INT"][done % 2] };
                if let Fate::Killed = self.interrupt(arguments, seconds, name) {
                    killed += 1;
                }
                done += 1;
            }
            if !self.place.path("broken/checkpoint.bin").exists() {
                println!("  {moments:.4?} s: before the case was read");
                continue;
            }
            let output = self.place.nastic(&["resume", "broken", "--threads", "2"]);
            let message = text(&output.stdout);
            let from =
                message.lines().find(|line| line.starts_with("resumed")).unwrap_or("resumed     at the beginning");
            println!("  {moments:.4?} s: {from}");
            assert!([0, 4].contains(&code(&output)), "after {moments:?} s: {}", text(&output.stderr));
            assert_same(&self.place.path("broken"), &self.place.path("whole"), &format!("seed {seed}, {moments:?} s"));
            std::fs::remove_dir_all(self.place.path("broken")).unwrap();
        }
        println!("  {killed} of {done} killed");
        assert!(blow == Blow::Stop || 2 * killed >= done, "{killed} of {done}: most had ended before");
    }
}

fn blows() -> usize {
    std::env::var("NASTIC_KILLS").map_or(10, |text| text.parse().unwrap())
}

#[test]
fn a_fibre_with_two_starts_survives() {
    let trial = Trial::new(FIBER);
    trial.survives(Blow::Kill, 1, blows());
    trial.survives(Blow::Stop, 2, blows() / 4 + 1);
}

#[test]
fn a_distance_with_two_stages_survives() {
    let trial = Trial::new(HAUSDORFF);
    trial.survives(Blow::Kill, 3, blows());
    trial.survives(Blow::Stop, 4, blows() / 4 + 1);
}

#[test]
fn an_ensemble_survives() {
    let trial = Trial::new(ENSEMBLE);
    trial.survives(Blow::Kill, 5, blows());
    trial.survives(Blow::Stop, 6, blows() / 4 + 1);
}

#[test]
fn without_space_the_last_good_checkpoint_is_kept() {
    let trial = Trial::new(FIBER);
    let size = std::fs::metadata(trial.place.path("whole/checkpoint.bin")).unwrap().len();
    // In blocks of 512 bytes: room for the first checkpoints. The last ones do not fit, whichever start ends first (which changes their size).
    let limit = format!("ulimit -f {}", size / 2 / 512);
    println!("{size} bytes, {limit}");
    let output = trial.place.shell(&limit, &["optimize", "case.json", "--out", "full"]).output().unwrap();
    let message = text(&output.stdout);
    assert_eq!(code(&output), 7, "{message}\n{}", text(&output.stderr));
    assert_eq!(message.matches("WARNING     cannot write full/checkpoint.bin").count(), 1, "said once: {message}");
    assert!(
        message.contains("the optimisation goes on and will end with exit code 7; the checkpoint of iteration"),
        "{message}"
    );
    assert!(message.contains("to go on    nastic resume full"), "{message}");
    assert!(text(&output.stderr).contains("nastic: cannot write full/"), "{}", text(&output.stderr));
    let quiet = trial.place.shell(&limit, &["resume", "full", "--quiet"]).output().unwrap();
    assert!(code(&quiet) == 7 && text(&quiet.stderr).contains("cannot write full/"), "{}", text(&quiet.stderr));
    // There is space again.
    let output = trial.place.nastic(&["resume", "full"]);
    assert_eq!(code(&output), 4, "{}", text(&output.stderr));
    assert_same(&trial.place.path("full"), &trial.place.path("whole"), "after a full disk");
}

#[test]
fn a_second_program_in_the_same_directory_is_refused() {
    let place = CaseDirectory::new(BAR);
    let long = [
        "--set",
        "optimizer/max_iterations=100000",
        "--set",
        "optimizer/tolerance=1e-15",
        "--set",
        "optimizer/method=projected_gradient",
    ];
    let mut child = start(place.program(&[&["optimize", "case.json", "--out", "out"], long.as_slice()].concat()));
    place.wait_for_lines("out/history.jsonl", 2, &mut child);
    for second in [
        ["resume", "out"].as_slice(),
        &["optimize", "case.json", "--out", "out"],
        &["solve", "case.json", "--out", "out"],
    ] {
        let output = place.nastic(second);
        let message = text(&output.stderr);
        assert_eq!(code(&output), 7, "{second:?}: {message}");
        assert!(message.contains(&format!("out is in use by another program (process {})", child.id())), "{message}");
    }
    assert!(signal(&child, "KILL"));
    child.wait_with_output().unwrap();
    assert_eq!(code(&place.nastic(&["solve", "case.json", "--out", "out"])), 0, "the lock went with the program");
}

/// The checkpoint of an interrupted optimisation is not replaced unasked.
#[test]
fn an_interrupted_optimisation_is_not_begun_anew_unasked() {
    let place = CaseDirectory::new(BAR);
    let long = ["optimize", "case.json", "--out", "out", "--set", "optimizer/tolerance=1e-15"];
    let slow = ["--set", "optimizer/method=projected_gradient", "--set", "output/checkpoint=1"];
    let endless = ["--set", "optimizer/max_iterations=100000"];
    let mut child = start(place.program(&[&long[..], &slow, &endless].concat()));
    place.wait_for_lines("out/history.jsonl", 6, &mut child);
    assert!(signal(&child, "KILL"));
    child.wait_with_output().unwrap();
    let checkpoint = std::fs::read(place.path("out/checkpoint.bin")).unwrap();
    let output = place.nastic(&["optimize", "case.json", "--out", "out"]);
    let message = text(&output.stderr);
    assert_eq!(code(&output), 2, "{message}");
    assert!(message.contains("out holds the checkpoint of an interrupted optimisation (iteration "), "{message}");
    assert!(message.contains("nastic resume out, begin anew with --restart, or "), "{message}");
    assert_eq!(std::fs::read(place.path("out/checkpoint.bin")).unwrap(), checkpoint);
    // One that has ended is.
    for restart in [&["--restart"] as &[&str], &[]] {
        let output = place.nastic(&[&["optimize", "case.json", "--out", "out"], restart].concat());
        assert_eq!(code(&output), 4, "{}", text(&output.stderr));
    }
}

#[test]
fn a_directory_without_a_checkpoint_is_bad_input() {
    let place = CaseDirectory::new(BAR);
    let output = place.nastic(&["resume", "nowhere", "--json"]);
    assert_eq!(code(&output), 2);
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(answer["command"] == "resume" && answer["exit"] == 2, "{answer}");
    assert!(text(&output.stderr).contains("nastic: nowhere has no checkpoint.bin"), "{}", text(&output.stderr));
    assert!(!place.path("nowhere").exists());
    assert!(text(&place.nastic(&["--help"]).stdout).contains("resume"));
}
