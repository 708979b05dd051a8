//! A motion that is killed and stopped at random moments, gone on with, killed and stopped again: no state that was there is ever gone, and the
//! end is that of a program that was left alone, to the bit.
//!
//! Moments are drawn from a printed seed. `NASTIC_KILLS` sets how many there are (6 by default; `scripts/slow.sh` has more).

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)] // a test may

use crate::common;

use common::{CaseDirectory, NamedBytes, Random, code, signal, start, text};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::time::{Duration, Instant};

/// A viscoelastic block that is pulled over a floor; its steps take some Newton iterations.
const CASE: &str = r#"{ "nastic": 1, "title": "block",
  "mesh": { "box": { "size": [0.1, 0.02, 0.02], "cells": [10, 2, 2], "element": "hex8" } },
  "materials": [ { "region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3, "density": "1000 kg/m^3",
                   "maxwell": [ { "shear": "20 kPa", "relaxation": "10 ms" } ] } ],
  "loads": [ { "gravity": [0, 0, "-9.81 m/s^2"] } ],
  "obstacles": [ { "name": "floor", "shape": { "half_space": { "point": [0, 0, 0], "normal": [0, 0, 1] } } } ],
  "contact": [ { "name": "sole", "surface": "z-", "obstacle": "floor", "friction": 0.5 } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0],
                   "tension": "-1 MPa * t / (1 s)" } ],
  "time": { "end": "60 ms", "step": "1 ms", "scheme": "backward_euler", "start": "rest", "output": "2 ms" },
  "output": { "directory": "out" } }"#;

/// What a motion leaves, but for times and the entries that say that it was resumed.
fn content(directory: &Path) -> (serde_json::Value, Vec<NamedBytes>) {
    let text = std::fs::read_to_string(directory.join("result.json")).unwrap();
    let mut result: serde_json::Value = serde_json::from_str(&text).unwrap();
    result.as_object_mut().unwrap().retain(|key, _| !["seconds", "peak_memory", "resumed"].contains(&key.as_str()));
    let names = std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.retain(|name| !["result.json", "report.html", ".lock", ".written"].contains(&name.as_str()));
    names.sort();
    (result, names.into_iter().map(|name| (name.clone(), std::fs::read(directory.join(name)).unwrap())).collect())
}

/// Rows of `motion.csv`, and written states.
fn there(directory: &Path) -> [usize; 2] {
    let rows = std::fs::read_to_string(directory.join("motion.csv")).map_or(0, |text| text.lines().count());
    let is_state = |name: &str| name.starts_with("motion_") && name.ends_with(".vtu");
    let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
    [rows, entries.filter(|entry| entry.file_name().to_str().is_some_and(is_state)).count()]
}

#[test]
fn motions_that_are_killed_and_stopped_lose_nothing() {
    let place = CaseDirectory::new(CASE);
    let began = Instant::now();
    let whole = place.nastic(&["solve", "case.json", "--out", "whole"]);
    assert_eq!(code(&whole), 0, "{}", text(&whole.stderr));
    let (duration, expected) = (began.elapsed().as_secs_f64(), content(&place.path("whole")));
    let blows: usize = std::env::var("NASTIC_KILLS").map_or(6, |count| count.parse().unwrap());
    let mut random = Random(31);
    println!("seed 31, {duration:.2} s undisturbed");
    let (out, mut done, mut stopped) = (place.path("out"), 0, 0);
    // on a busy machine blows may come before a program has begun or behind its end: some more then
    while done < blows || (stopped == 0 && done < 10 * blows) {
        let mut kept = [0, 0];
        // links that go on from one another, until one comes to the end
        for link in 0.. {
            let goes_on = out.join("motion_checkpoint.bin").is_file();
            let arguments = if goes_on { ["resume", "out"] } else { ["solve", "case.json"] };
            let mut child = start(place.program(&arguments));
            // every fourth is left alone, so that all chains end
            if link % 4 < 3 {
                std::thread::sleep(Duration::from_secs_f64(0.7 * duration * random.unit()));
                if child.try_wait().unwrap().is_none() {
                    signal(&child, ["INT", "KILL", "TERM"][done % 3]);
                    done += 1;
                }
            }
            let output = child.wait_with_output().unwrap();
            let message = text(&output.stderr);
            if output.status.signal().is_none() {
                assert!([0, 4].contains(&code(&output)), "{arguments:?} ended with {}: {message}", output.status);
            }
            let now = there(&out);
            assert!(now[0] >= kept[0] && now[1] >= kept[1], "{arguments:?}: {kept:?} became {now:?}: {message}");
            kept = now;
            if output.status.code() == Some(4) && message.contains("nastic resume") {
                stopped += 1;
                assert!(out.join("motion_checkpoint.bin").is_file(), "{message}");
            }
            if output.status.code() == Some(0) {
                break;
            }
        }
        let found = content(&out);
        assert_eq!(found.0, expected.0);
        let names = |files: &[NamedBytes]| files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&found.1), names(&expected.1));
        assert!(found.1.iter().zip(&expected.1).all(|(one, other)| one == other));
        std::fs::remove_dir_all(&out).unwrap();
    }
    assert!(stopped > 0, "no motion was stopped");
}
