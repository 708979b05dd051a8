//! The shipped cases hold what they expect, and mistakes in cases are reported with what, where and what to try.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use nastic::case::console::Console;
use nastic::case::run::{Exit, Options, Outcome, RunError, run};
use nastic::case::schema::Command;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cases").join(name)
}

/// Results of tests go below `target`, each to a directory of its own.
fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&directory).unwrap();
    directory
}

/// What a console was given.
#[derive(Clone, Default)]
struct Said(Arc<Mutex<Vec<u8>>>);

impl Said {
    fn console() -> (Self, Console) {
        let said = Self::default();
        (said.clone(), Console::new(said))
    }

    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

impl std::io::Write for Said {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn command(command: Command, case: &Path, name: &str, set: &[&str]) -> Result<Outcome, RunError> {
    let set = set.iter().map(|s| (*s).to_owned()).collect();
    // What an interrupted test run left there does not count.
    let options = Options { out: Some(scratch(name)), set, restart: true, ..Options::default() };
    run(command, case, &options, &Console::silent())
}

/// The optimisation of a shipped case, as it stands, with its `expect` met; `scripts/slow.sh --quick` leaves out the cases that stand here.
fn met(name: &str) -> Outcome {
    let outcome = command(Command::Optimize, &shipped(&format!("{name}.json")), name, &[]).unwrap();
    assert_eq!(
        (outcome.exit, outcome.missed.len()),
        (Exit::Done, 0),
        "{:?} {}",
        outcome.missed,
        outcome.result["stop"]
    );
    let page = scratch(name).join("report.html").metadata().unwrap().len();
    assert!(page < 5_000_000, "the page of {name} has {page} bytes");
    outcome
}

#[test]
fn every_shipped_case_is_complete() {
    let mut cases = 0;
    for entry in std::fs::read_dir(shipped("")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "json") {
            let outcome = command(Command::Check, &path, "check", &[]);
            let outcome = outcome.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            assert_eq!(outcome.exit, Exit::Done, "{}", path.display());
            // What is said of every dielectric is no fault of a case.
            let warnings = outcome.result["warnings"].as_array().unwrap();
            let faults = warnings.iter().filter(|warning| warning["code"] != "unbounded_energy").count();
            assert_eq!(faults, 0, "{}: {}", path.display(), outcome.result);
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.contains("\"expect\""), "{}: give it an expected number", path.display());
            cases += 1;
        }
    }
    assert!(cases >= 5);
}

#[test]
fn the_reference_case_meets_the_numbers_of_six_codes() {
    let outcome = command(Command::Solve, &shipped("reference.json"), "reference", &[]).unwrap();
    assert_eq!((outcome.exit, outcome.missed.len()), (Exit::Done, 0), "{:?}", outcome.missed);
    let outcome =
        command(Command::Solve, &shipped("reference.json"), "reference_off", &["materials/0/mu1=101 kPa"]).unwrap();
    assert_eq!((outcome.exit, outcome.missed.len()), (Exit::ExpectMissed, 3));
}

#[test]
fn gradcheck_passes_and_leaves_no_state() {
    let set = ["mesh/box/cells=[5,1,1]", "mesh/box/element=hex8"];
    let outcome = command(Command::Gradcheck, &shipped("tip_tracking.json"), "gradcheck", &set).unwrap();
    assert_eq!(outcome.exit, Exit::Done, "{}", outcome.result);
}

#[test]
fn a_magnet_is_described_by_the_formula_of_its_variant() {
    for (variant, carrier) in [("F", "C = F"), ("isochoric", "C = J^(-1/3) F"), ("rotation", "C = R of F = R U")] {
        let (said, console) = Said::console();
        let set = vec![format!("actuation/0/variant={variant}")];
        let options = Options { out: Some(scratch("variant")), set, ..Options::default() };
        run(Command::Check, &shipped("t_magnet.json"), &options, &console).unwrap();
        let said = said.text();
        assert!(said.contains(&format!("magnet adds -(1/mu0)(C B_r).B_a to the energy, {carrier}\n")), "{said}");
    }
}

#[test]
fn the_strip_reaches_its_target_within_bounds() {
    let outcome = met("strip");
    let (first, last) = (&outcome.result["start"]["cost"]["total"], &outcome.result["cost"]["total"]);
    assert!(last.as_f64().unwrap() < 1e-2 * first.as_f64().unwrap(), "{first} -> {last}");
    for file in ["start.vtu", "optimum.vtu", "iterations.pvd", "history.jsonl", "result.json", "picture.png"] {
        assert!(scratch("strip").join(file).exists(), "{file}");
    }
}

#[test]
fn the_finger_bends_as_the_case_expects() {
    let outcome = met("finger");
    let air = &outcome.result["contributions"]["air"];
    let grown = air["volume"].as_f64().unwrap() / air["reference_volume"].as_f64().unwrap();
    assert!(grown > 2.0, "the chamber grows {grown}-fold");
}

/// By its volume, past the pressure that the finger bears as a load.
#[test]
fn the_pneumatic_finger_bends_by_a_quarter_of_a_circle() {
    let outcome = met("pneunet");
    assert_eq!(outcome.result["inertia"], 0);
    let [start, end] = [&outcome.result["start"], &outcome.result].map(|at| at["cost"]["total"].as_f64().unwrap());
    assert!(end < 1e-2 * start, "{start} -> {end}");
}

#[test]
fn a_film_beyond_its_breakdown_strength_is_warned_about() {
    let case = shipped("dielectric_bilayer.json");
    let weak = ["actuation/0/breakdown=\"10 MV / 1 m\"", "expect={}"];
    let outcome = command(Command::Solve, &case, "weak_film", &weak).unwrap();
    let warned = outcome.result["warnings"].to_string();
    assert!(warned.contains("unbounded_energy"), "{warned}");
    assert!(warned.contains("the true field reaches 1.01") && warned.contains("1e+07 V/m"), "{warned}");
}

#[test]
fn the_tendon_finger_reaches_its_target_with_both_tendons() {
    let outcome = met("tendon_finger");
    let tensions = ["flexor", "extensor"].map(|name| {
        let tendon = &outcome.result["contributions"][name];
        assert_eq!((tendon["slack"].as_f64(), tendon["reference_length"].as_f64()), (Some(0.0), Some(100.0)));
        assert_eq!(tendon["tension"], outcome.result["controls"][name]["max"]);
        tendon["tension"].as_f64().unwrap()
    });
    assert!(tensions.iter().all(|tension| *tension > 1.0), "{tensions:?}");
    let files = outcome.result["files"].as_array().unwrap();
    for file in ["start_lines.vtu", "optimum_lines.vtu"] {
        let text = std::fs::read_to_string(scratch("tendon_finger").join(file)).unwrap();
        assert!(text.contains("line:flexor") && text.contains("Name=\"tension\""), "{file}");
        assert!(files.iter().any(|listed| listed == file), "{file} is not listed");
    }
    let picture = std::fs::read_to_string(scratch("tendon_finger").join("picture.svg")).unwrap();
    assert!(picture.contains("lines: tendons"));
}

#[test]
fn mistakes_about_a_tendon_are_told() {
    let text = std::fs::read_to_string(shipped("tendon_finger.json")).unwrap();
    let flexor = "[[0, 8, 3], [100, 8, 3]], \"spacing\": 5";
    let with = |change: &str| flexor.replace("5", change);
    let cases = [
        (
            "outside",
            flexor,
            "[[0, 8, 3], [100, 8, 23]]",
            vec!["actuation/0", "guide 1", "(100, 8, 23) is outside", "(100, 8, 20), 3.000e0"],
        ),
        ("twice", flexor, "[[0, 8, 3], [0, 8, 3]]", vec!["actuation/0", "guides 0 and 1 at one place"]),
        ("alone", flexor, "[[0, 8, 3]]", vec!["actuation/0", "1 guides"]),
        ("set", flexor, "[\"root\", [100, 8, 3]]", vec!["actuation/0", "guide 0", "\"root\" not found"]),
        ("unit", flexor, &with("\"5 N\""), vec!["actuation/0/spacing", "a length is wanted"]),
        ("sign", flexor, &with("-5"), vec!["actuation/0/spacing", "must be positive"]),
        ("pull", flexor, &with("5, \"pull\": 3"), vec!["actuation/0", "its tension and by its pull: keep one"]),
        (
            "both",
            flexor,
            &with("5, \"stiffness\": 3, \"tension\": 2"),
            vec!["actuation/0", "unknown key \"stiffness\""],
        ),
        ("pushes", "\"upper\": \"15 N\" },", "\"lower\": -1 },", vec!["controls/0/lower", "only pulls"]),
        ("start", "\"start\": \"1 N\"", "\"start\": \"-1 N\"", vec!["controls/0/start", "outside what is allowed"]),
        (
            "fixed",
            "\"spacing\": 5 }\n",
            "\"spacing\": 5, \"tension\": -2 },\n{ \"name\": \"x\", \"kind\": \"turgor\", \"region\": \"body\", \"pressure\": 1 }\n",
            vec!["actuation/1/tension"],
        ),
        ("space", "\"uniform\"", "\"cell\"", vec!["controls/0", "\"flexor\" is one number", "\"uniform\""]),
        ("word", "\"kind\": \"tendon\"", "\"kind\": \"cable\"", vec!["actuation/0/kind", "\"kind\": \"tendon\""]),
    ];
    for (name, from, to, shown) in cases {
        assert!(text.contains(from), "{from}");
        let path = scratch("tendon").join(format!("{name}.json"));
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let message = command(Command::Check, &path, "tendon", &[]).unwrap_err().to_string();
        assert!(shown.iter().all(|words| message.contains(words)), "{name}: {message}");
    }
}

/// Drawn in by lengths instead of tensions: the elastic tendons that find the same end, and the antagonist goes slack when it is let out.
#[test]
fn tendons_are_drawn_in_by_lengths() {
    let text = std::fs::read_to_string(shipped("tendon_finger.json")).unwrap();
    let text = text
        .replace("\"spacing\": 5", "\"spacing\": 5, \"stiffness\": \"2 N/mm\"")
        .replace("\"1 N\", \"upper\": \"15 N\"", "\"1 mm\", \"lower\": 0, \"upper\": 30");
    let text = text.split("\"expect\"").next().unwrap().to_owned() + "\"output\": { \"directory\": \"out\" } }";
    let path = scratch("pulled").join("finger.json");
    std::fs::write(&path, text).unwrap();
    let outcome = command(Command::Optimize, &path, "pulled", &[]).unwrap();
    let tendon = |name: &str, what: &str| outcome.result["contributions"][name][what].as_f64().unwrap();
    // the state is that of the tensions
    for (name, tension, length) in [("flexor", 7.7983, 80.013), ("extensor", 2.2566, 97.026)] {
        let found = (tendon(name, "tension"), tendon(name, "length"));
        assert!((found.0 - tension).abs() < 0.01 && (found.1 - length).abs() < 0.02, "{name}: {found:?}");
        let pull = outcome.result["controls"][name]["max"].as_f64().unwrap();
        assert!((2.0 * (found.1 - 100.0 + pull) - found.0).abs() < 1e-9, "{name}: pull {pull}");
    }
    let set = ["controls/1/lower=-5", "controls/1/start=-5", "controls/0/start=10"];
    let out = command(Command::Solve, &path, "pulled", &set).unwrap();
    let extensor = &out.result["contributions"]["extensor"];
    assert_eq!((extensor["slack"].as_f64(), extensor["tension"].as_f64()), (Some(1.0), Some(0.0)), "{extensor}");
}

/// The same by tendons that cannot stretch: their pulls are what the lengths lack.
#[test]
fn tendons_that_cannot_stretch_find_the_same_end() {
    let mut text = std::fs::read_to_string(shipped("tendon_finger.json")).unwrap();
    text = text.replace("\"1 N\", \"upper\": \"15 N\"", "\"1 mm\", \"lower\": 0, \"upper\": 30");
    for name in ["flexor", "extensor"] {
        text = text.replace(&format!("\"of\": \"{name}\""), &format!("\"of\": \"{name}.pull\""));
    }
    let text = text.split("\"expect\"").next().unwrap().to_owned() + "\"output\": { \"directory\": \"out\" } }";
    let path = scratch("rigid").join("finger.json");
    std::fs::write(&path, text).unwrap();
    let outcome = command(Command::Optimize, &path, "rigid", &[]).unwrap();
    let tendon = |name: &str, what: &str| outcome.result["contributions"][name][what].as_f64().unwrap();
    for (name, tension, length) in [("flexor", 7.7983, 80.013), ("extensor", 2.2566, 97.026)] {
        let found = (tendon(name, "tension"), tendon(name, "length"));
        println!("{name}: {found:?}, pull {}, iterations {}", tendon(name, "pull"), outcome.result["iterations"]);
        assert!((found.0 - tension).abs() < 0.01 && (found.1 - length).abs() < 0.02, "{name}: {found:?}");
        assert!((found.1 - 100.0 + tendon(name, "pull")).abs() < 1e-9, "{name}");
    }
}

#[test]
fn mistakes_about_a_cavity_are_told_once() {
    let text = std::fs::read_to_string(shipped("finger.json")).unwrap();
    let text = text.replace("../../meshes/", concat!(env!("CARGO_MANIFEST_DIR"), "/meshes/"));
    let place = "actuation/0";
    let cases = [
        (
            "open",
            ", \"symmetry\": [\"middle\"] }",
            " }",
            vec![place, "\"chamber\"", "\"air\"", "open at 76 edges", "lid"],
        ),
        ("name", "\"chamber\"", "\"chambr\"", vec![place, "\"chambr\" not found", "Did you mean \"chamber\""]),
        ("surface", "\"surface\": \"chamber\", ", "", vec![place, "missing key \"surface\""]),
        ("region", "\"chamber\", ", "\"chamber\", \"region\": \"soft\", ", vec!["unknown key \"region\""]),
        ("space", "\"uniform\"", "\"cell\"", vec!["controls/0", "\"air\" is one number", "\"uniform\""]),
    ];
    for (name, from, to, shown) in cases {
        assert!(text.contains(from), "{from}");
        let path = scratch("cavity").join(format!("{name}.json"));
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let message = command(Command::Check, &path, "cavity", &[]).unwrap_err().to_string();
        assert_eq!(message.lines().count(), 1, "{message}");
        shown.into_iter().for_each(|part| assert!(message.contains(part), "{name}: {message}\nwithout: {part}"));
    }
}

/// A small case with one thing changed, and what is said of it.
fn complaint(name: &str, from: &str, to: &str) -> String {
    const GOOD: &str = r#"{
      "nastic": 1,
      "mesh": { "box": { "size": [1.0, 0.2, 0.2], "cells": [10, 1, 1], "element": "hex8" } },
      "materials": [ { "region": "body", "law": "mooney_rivlin", "mu1": "100 kPa", "mu2": "20 kPa", "mu3": "300 kPa" } ],
      "supports": [ { "surface": "x-", "fix": ["x", "y", "z"] } ],
      "actuation": [ { "name": "tension", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0] } ],
      "controls": [ { "of": "tension", "space": "cell", "start": "0 Pa", "lower": "-100 kPa", "upper": "100 kPa" } ],
      "costs": [ { "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z + 0.1 m"] } ]
    }"#;
    assert!(GOOD.contains(from), "{from}");
    let path = scratch("mistakes").join(format!("{name}.json"));
    std::fs::write(&path, GOOD.replace(from, to)).unwrap();
    match command(Command::Check, &path, "mistakes", &[]) {
        Err(error) => {
            assert_eq!(error.exit(), Exit::BadInput, "{error}");
            error.to_string()
        }
        Ok(outcome) => outcome.result["warnings"].to_string(),
    }
}

#[test]
fn mistakes_are_told_with_what_where_and_what_to_try() {
    assert_eq!(complaint("good", "\"nastic\": 1", "\"nastic\": 1"), "[]");
    let generated = r#"{ "box": { "size": [1.0, 0.2, 0.2], "cells": [10, 1, 1], "element": "hex8" } }"#;
    let hausdorff = r#"{ "kind": "smoothed_hausdorff", "target": "nowhere.msh", "phi": { "exponential": { "length": 0.1 } },
                         "stages": [ { "alpha": 1, "beta": 4, "gamma": 4 } ] }"#;
    let tracking = r#"{ "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z + 0.1 m"] }"#;
    let cases: [(&str, &str, &str, &[&str]); 10] = [
        ("missing_mesh", generated, "\"nowhere.msh\"", &["nowhere.msh", "mesh"]),
        ("missing_target", tracking, hausdorff, &["nowhere.msh", "costs/0"]),
        (
            "region",
            "\"region\": \"body\", \"law\"",
            "\"region\": \"bdy\", \"law\"",
            &["\"bdy\" not found", "it has: body"],
        ),
        ("surface", "\"surface\": \"x-\"", "\"surface\": \"x_\"", &["\"x_\" not found", "x-"]),
        ("unit", "\"mu1\": \"100 kPa\"", "\"mu1\": \"100 mm\"", &["materials/0/mu1", "pressure"]),
        ("bounds", "\"lower\": \"-100 kPa\"", "\"lower\": \"200 kPa\"", &["controls/0", "lower"]),
        ("fiber", "\"direction\": [1, 0, 0]", "\"direction\": [1, 1, 0]", &["actuation/0/direction", "1.41"]),
        ("support", "\"fix\": [\"x\", \"y\", \"z\"]", "\"fix\": [\"x\"]", &["rigid motion", "shift along y"]),
        ("key", "\"supports\"", "\"suports\"", &["suports", "supports"]),
        ("zero", "\"size\": [1.0, 0.2, 0.2]", "\"size\": [1.0, 0.0, 0.2]", &["mesh", "0"]),
    ];
    for (name, from, to, parts) in cases {
        let said = complaint(name, from, to);
        for part in parts {
            assert!(said.contains(part), "{name}: no \"{part}\" in: {said}");
        }
    }
}

#[test]
fn a_body_in_millimetres_is_warned_about_with_its_size() {
    let said = complaint("millimetres", "\"size\": [1.0, 0.2, 0.2]", "\"size\": [1000, 200, 200]");
    assert!(said.contains("1000") && said.contains("scale"), "{said}");
}
