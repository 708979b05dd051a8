//! `nastic gains`: sensitivities against differences of equilibria, the law on softer and stiffer bodies, the C header, what no control moves, what is refused.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{CaseDirectory, with};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, Options};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command as Process;

/// A beam below a ceiling that its end touches, bent by fibres in its lower half, with outputs of every kind.
const BEAM: &str = r#"{ "nastic": 1, "units": { "length": "mm", "force": "N" },
  "mesh": { "box": { "size": [60, 8, 8], "cells": [6, 1, 2], "element": "hex20" } },
  "regions": [ { "name": "lower", "inside": { "box": { "low": [0, 0, 0], "high": [60, 8, 4] } } },
               { "name": "upper", "inside": { "box": { "low": [0, 0, 4], "high": [60, 8, 8] } } } ],
  "materials": [ { "region": ["lower", "upper"], "law": "neo_hooke", "young": "200 kPa", "poisson": 0.4 } ],
  "supports": [ { "surface": "x-", "fix": "all" } ],
  "obstacles": [ { "name": "ceiling", "shape": { "half_space": { "point": [0, 0, 8.5], "normal": [0, 0, -1] } } } ],
  "contact": [ { "name": "touch", "surface": "z+", "obstacle": "ceiling", "thickness": "1 mm", "stiffness": "5 kPa" } ],
  "actuation": [ { "name": "fibers", "kind": "fiber_tension", "region": ["lower", "upper"], "direction": [1, 0, 0] } ],
  "controls": [ { "of": "fibers", "space": "region", "start": "4 kPa * (2 - Z / (4 mm))", "lower": "-50 kPa", "upper": "50 kPa" } ],
  "costs": [
    { "kind": "position", "point": [60, 4, 4], "target": { "x": 60, "z": 5 } },
    { "kind": "markers", "deviation": "0.1 mm", "markers": [ { "name": "m", "point": [41, 0, 2], "position": { "x": 42, "z": 3 } } ] },
    { "kind": "orientation", "surface": "x+", "direction": [1, 0, 0.1] },
    { "kind": "curvature", "line": [[10, 4, 4], [30, 4, 4], [50, 4, 4]], "axis": [0, -1, 0], "curvature": "0.001 / (1 mm)" },
    { "kind": "mean_radius", "surface": "x+", "axis": [0, 1, 0], "centre": { "x": 0, "y": 0, "z": 0 }, "radius": 61 },
    { "kind": "reaction", "surface": "x-", "direction": [1, 0, 0.3], "force": "0.1 N", "weight": 100 },
    { "kind": "displacement", "surface": "x+", "direction": [1, 0, 1], "weight": 3 },
    { "kind": "contact_force", "contact": "touch", "weight": 2 },
    { "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z"] } ],
  "probes": [ { "name": "tip", "point": [60, 8, 8] } ] }"#;

fn number(value: &Value, path: &str) -> f64 {
    value.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {value}"))
}

/// What is found, whatever the case expects of itself as it is written.
fn gains(place: &CaseDirectory, case: &str, set: &[&str]) -> Value {
    let set = [&["expect={}"], set].concat();
    let outcome = place.run(Command::Gains, case, &set).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((outcome.exit, outcome.missed.len()), (Exit::Done, 0), "{:?}", outcome.missed);
    assert_eq!(place.json("gains.json"), outcome.result["gains"]);
    outcome.result["gains"].clone()
}

/// What the command is refused for.
fn refused(case: &str, set: &[&str]) -> String {
    match CaseDirectory::new().run(Command::Gains, case, set) {
        Ok(outcome) => panic!("{}", outcome.result["gains"]),
        Err(error) => {
            assert_eq!(error.exit(), Exit::BadInput, "{error}");
            error.to_string()
        }
    }
}

fn sentences(found: &Value) -> String {
    found["remarks"].as_array().into_iter().flatten().map(|one| one.as_str().unwrap().to_owned() + "\n").collect()
}

/// Every output of a result, those with targets first.
fn outputs(found: &Value) -> Vec<Value> {
    [&found["outputs"], &found["watched"]].into_iter().filter_map(Value::as_array).flatten().cloned().collect()
}

/// S against central differences of fourth order of the outputs of equilibria, relative to the largest entry of a control among outputs of one unit.
fn are_differences(case: &str, step: f64, by: &str, wanted: &[&str]) -> Value {
    let place = CaseDirectory::new();
    let found = gains(&place, case, &[]);
    let all = outputs(&found);
    assert_eq!(found["by"], by);
    let names: Vec<&str> = all.iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert!(wanted.iter().all(|name| names.contains(name)), "{names:?}");
    let controls = found["controls"].as_array().unwrap();
    // of many controls every third: each takes four runs
    for j in (0..controls.len()).step_by(if controls.len() > 4 { 3 } else { 1 }) {
        let moved = |t: f64| {
            let mut moved: Value = serde_json::from_str(case).unwrap();
            let value = |k: usize| number(&controls[k], "/value") + if k == j { t * step } else { 0.0 };
            std::fs::write(place.path("start.json"), start_file(&moved, controls, &value)).unwrap();
            for own in moved["controls"].as_array_mut().unwrap() {
                own["start"] = json!({ "file": "start.json" });
            }
            let options = Options { out: None, in_memory: true, ..place.options(&[]) };
            let silent = Console::silent();
            let outcome = place.run_with(Command::Gains, &moved.to_string(), &silent, &options);
            outputs(&outcome.unwrap_or_else(|error| panic!("{error}")).result["gains"])
        };
        let at = [1.0, -1.0, 2.0, -2.0].map(moved);
        let slope = |i: usize| {
            let pair = |k: usize| number(&at[k][i], "/value") - number(&at[k + 1][i], "/value");
            (8.0 * pair(0) - pair(2)) / (12.0 * step)
        };
        let entry = |i: usize| number(&all[i], &format!("/sensitivities/{j}"));
        for i in 0..all.len() {
            let alike = (0..all.len()).filter(|&k| all[k]["unit"] == all[i]["unit"]);
            let size = alike.map(|k| entry(k).abs()).fold(0.0, f64::max);
            let off = (entry(i) - slope(i)).abs();
            assert!(off <= 1e-7 * size, "{} by {}: {:e} and {:e}", names[i], controls[j]["name"], entry(i), slope(i));
        }
    }
    found
}

/// `controls.json` with these values.
fn start_file(case: &Value, controls: &[Value], value: &dyn Fn(usize) -> f64) -> String {
    let mut file = serde_json::Map::new();
    for own in case["controls"].as_array().unwrap() {
        let name = own["name"].as_str().unwrap_or_else(|| own["of"].as_str().unwrap());
        let is_own = |control: &Value| {
            let rest = control["name"].as_str().unwrap().strip_prefix(name).map(str::to_owned);
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let values: Vec<f64> = (0..controls.len()).filter(|&k| is_own(&controls[k])).map(value).collect();
        file.insert(name.to_owned(), json!(values));
    }
    Value::Object(file).to_string()
}

#[test]
fn sensitivities_of_every_output_are_differences_by_changes_of_the_state() {
    let found = are_differences(
        BEAM,
        1e-5,
        "tangents",
        &[
            "position.x",
            "position.z",
            "markers.m.z",
            "orientation.0",
            "orientation.1",
            "curvature.0",
            "mean_radius",
            "reaction",
            "displacement",
            "contact_force",
            "tip.displacement.z",
        ],
    );
    let names: Vec<&Value> = found["controls"].as_array().unwrap().iter().map(|one| &one["name"]).collect();
    assert_eq!(names, [&json!("fibers.lower"), &json!("fibers.upper")]);
    let force = outputs(&found).into_iter().find(|one| one["name"] == "contact_force").unwrap();
    assert!(number(&force, "/value") > 1e-3 && force["unit"] == "N" && force["target"].is_null(), "{force}");
    assert!(sentences(&found).contains("the law does not look at the cost tracking"), "{}", sentences(&found));
    // across the beam's plane of symmetry nothing moves; its surface x+ turns in the plane alone
    let said = sentences(&found);
    assert!(said.contains("no control moves orientation."), "{said}");
}

#[test]
fn sensitivities_by_adjoints_are_differences() {
    let case = with(BEAM, r#""space": "region""#, r#""space": { "grid": [1, 1, 1] }"#);
    let mut case: Value = serde_json::from_str(&case).unwrap();
    let costs = case["costs"].as_array().unwrap().clone();
    case["costs"] = json!([costs[0], costs[5], costs[7]]);
    are_differences(&case.to_string(), 2e-4, "adjoints", &["position.x", "reaction", "contact_force"]);
}

#[test]
fn sensitivities_by_turgor_tendons_and_magnets_are_differences() {
    let of = |actuation: &str, controls: &str| {
        let case = with(
            BEAM,
            r#"{ "name": "fibers", "kind": "fiber_tension", "region": ["lower", "upper"], "direction": [1, 0, 0] }"#,
            actuation,
        );
        let mut case: Value = serde_json::from_str(&case).unwrap();
        case["controls"] = serde_json::from_str(controls).unwrap();
        let costs = case["costs"].as_array().unwrap().clone();
        case["costs"] = json!([costs[0]]);
        case.to_string()
    };
    let turgor = of(
        r#"{ "name": "turgor", "kind": "turgor", "region": "lower" }"#,
        r#"[ { "of": "turgor", "space": "uniform", "start": "20 kPa" } ]"#,
    );
    are_differences(&turgor, 1e-4, "tangents", &["position.z"]);
    let tendon = of(
        r#"{ "name": "cable", "kind": "tendon", "points": [[0, 4, 2], [60, 4, 2]], "spacing": 10 }"#,
        r#"[ { "of": "cable", "space": "uniform", "start": "0.5 N" } ]"#,
    );
    let found = are_differences(&tendon, 1e-3, "tangents", &["position.z", "cable.length"]);
    let length = outputs(&found).into_iter().find(|one| one["name"] == "cable.length").unwrap();
    assert!(number(&length, "/sensitivities/0") < 0.0, "a cable that pulls harder is shorter: {length}");
    let pulled = with(&with(&tendon, r#""of":"cable""#, r#""of":"cable.pull""#), "0.5 N", "3 mm");
    let found = are_differences(&pulled, 1e-3, "tangents", &["cable.tension"]);
    assert!(!outputs(&found).iter().any(|one| one["name"] == "cable.length"), "it is what is given");
    let magnet = of(
        r#"{ "name": "magnet", "kind": "magnet", "region": ["lower", "upper"], "remanence": ["100 mT", 0, 0] }"#,
        r#"[ { "of": "magnet.field", "space": "uniform", "start": ["1 mT", 0, "3 mT"] } ]"#,
    );
    are_differences(&magnet, 1e-5, "tangents", &["position.z"]);
}

/// The pressure of a chamber of given volume, the volume of one of given pressure: the latter's change is the inverse of the former's.
#[test]
fn sensitivities_of_chambers_are_differences() {
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../../meshes/finger.msh");
    let case = |control: &str| {
        format!(
            r#"{{ "nastic": 1, "mesh": "{mesh}",
            "materials": [ {{ "region": "body", "law": "neo_hooke", "young": "0.6 MPa", "poisson": 0.4 }} ],
            "supports": [ {{ "surface": "clamp", "fix": ["x", "y", "z"] }}, {{ "surface": "middle", "fix": ["y"] }} ],
            "actuation": [ {{ "name": "air", "kind": "cavity", "surface": "chamber", "symmetry": "middle" }} ],
            "controls": [ {control} ],
            "costs": [ {{ "kind": "position", "point": [0.047, 0, 0], "target": {{ "z": -0.005 }} }} ] }}"#
        )
    };
    let by_volume = case(r#"{ "of": "air.volume", "space": "uniform", "start": "300 mm^3" }"#);
    let found = are_differences(&by_volume, 2e-10, "tangents", &["position.z", "air.pressure"]);
    let pressure = outputs(&found).into_iter().find(|one| one["name"] == "air.pressure").unwrap();
    let start = number(&pressure, "/value");
    let by_pressure = case(&format!(r#"{{ "of": "air", "space": "uniform", "start": {start:?} }}"#));
    // the product with what was held to differences above does for the other
    let found = gains(&CaseDirectory::new(), &by_pressure, &[]);
    let volume = outputs(&found).into_iter().find(|one| one["name"] == "air.volume").unwrap();
    let product = number(&volume, "/sensitivities/0") * number(&pressure, "/sensitivities/0");
    assert!((product - 1.0).abs() < 1e-6, "{product}");
}

/// The shipped case.
fn shipped() -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/cases/finger_gains.json");
    let text = std::fs::read_to_string(file).unwrap();
    text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Ten steps of the law bring the end of a finger of other rubber where it shall be, as the contraction foretells.
#[test]
fn the_law_closes_the_error_of_softer_and_stiffer_bodies() {
    let place = CaseDirectory::new();
    let outcome = place.run(Command::Gains, &shipped(), &[]).unwrap();
    assert_eq!((outcome.exit, outcome.missed.len()), (Exit::Done, 0), "{:?}", outcome.missed);
    let found = outcome.result["gains"].clone();
    assert_eq!(found["scenarios"].as_object().unwrap().len(), 2);
    for (name, one) in found["scenarios"].as_object().unwrap() {
        let errors: Vec<f64> = one["errors"].as_array().unwrap().iter().map(|error| error.as_f64().unwrap()).collect();
        let (open, closed, rate) = (errors[0], errors[10], number(one, "/contraction_at_end"));
        assert!(errors.len() == 11 && open > 0.5 && closed < 0.02 * open, "{name}: {errors:?}");
        // late in the loop, before it is rounding
        let last = (1..errors.len()).rev().find(|&k| errors[k] > 1e-7 * open).unwrap();
        let ratio = errors[last] / errors[last - 1];
        assert!(number(one, "/contraction") < 0.5 && (ratio / rate - 1.0).abs() < 0.02, "{name}: {rate}, {ratio}");
        assert!(sentences(&found).contains(&format!("{name}: the error shrinks to ")), "{}", sentences(&found));
    }
    assert!(number(&found["nominal"], "/contraction") < 0.2, "{}", found["nominal"]);
    // the same on one thread
    let mut options = place.options(&[]);
    options.threads = Some(1);
    let alone = place.run_with(Command::Gains, &shipped(), &Console::silent(), &options).unwrap();
    assert_eq!(alone.result["gains"], found);
    // a controller that is told the outputs does as the loop did
    let table = std::fs::read_to_string(place.path("out/gains.csv")).unwrap();
    assert!(
        table.starts_with("output,unit,value,target,weight,sensitivity/flexor,sensitivity/extensor,gain/flexor"),
        "{table}"
    );
}

/// A law that was made where the cables bend the finger the other way diverges, which is said before, and no damping mends it.
#[test]
fn a_body_that_answers_otherwise_is_told() {
    let turned = r#"scenarios=[ { "name": "turned", "set": { "actuation/0/points": [[0, 8, 17], [100, 8, 17]], "actuation/1/points": [[0, 8, 3], [100, 8, 3]] } } ]"#;
    let found = gains(&CaseDirectory::new(), &shipped(), &[turned, "gains/steps=2"]);
    assert!(number(&found["scenarios"]["turned"], "/contraction") > 1.0, "{found}");
    let said = sentences(&found);
    assert!(
        said.contains("turned: the error grows to ") && said.contains("no damping makes the law converge"),
        "{said}"
    );
    // steps that are much too large: more damping mends them
    let soft = r#"scenarios=[ { "name": "soft", "set": { "materials/0/young": "0.1 MPa" } } ]"#;
    let small = ["controls/0/start=0.2 N", "controls/1/start=0.1 N", "gains/damping=0", "gains/steps=1"];
    let found = gains(&CaseDirectory::new(), &shipped(), &[&[soft], &small[..]].concat());
    let said = sentences(&found);
    let diverges = number(&found["scenarios"]["soft"], "/contraction") >= 1.0;
    assert!(diverges && said.contains("the law converges from nearby on every body"), "{said}");
}

#[test]
fn what_no_control_moves_is_told() {
    let one = r#"costs=[ { "kind": "position", "point": [100, 8, 10], "target": { "x": 84, "y": 8, "z": -15 } } ]"#;
    let found = gains(&CaseDirectory::new(), &shipped(), &[one, "scenarios=[]"]);
    let said = sentences(&found);
    assert!(said.contains("no control moves position.y: an error there stays"), "{said}");
    assert_eq!(found["unmoved"].as_array().unwrap().len(), 1);
    // three numbers by two controls: a combination
    let two = r#"costs=[ { "kind": "position", "point": [100, 8, 10], "target": { "x": 84, "z": -15 } }, { "kind": "position", "point": [50, 8, 10], "target": { "z": -5 } } ]"#;
    let found = gains(&CaseDirectory::new(), &shipped(), &[two, "scenarios=[]"]);
    let said = sentences(&found);
    assert!(said.contains("no control moves the combination ") && said.contains("position_1.z"), "{said}");
    assert!(said.contains("which no controls reach"), "{said}");
    let still = r#"costs=[ { "kind": "position", "point": [100, 8, 10], "target": { "y": 8 } } ]"#;
    assert!(refused(&shipped(), &[still]).contains("no control moves an output with a target (position.y)"));
}

/// The function of the header makes the step of the matrix in the JSON.
#[test]
fn the_header_compiles_and_steps_as_the_matrix_does() {
    let Some(compiler) =
        ["cc", "gcc", "clang"].into_iter().find(|name| Process::new(name).arg("--version").output().is_ok())
    else {
        eprintln!(
            "skipped: the_header_compiles_and_steps_as_the_matrix_does, for there is no C compiler (cc, gcc, clang)"
        );
        return;
    };
    let place = CaseDirectory::new();
    // a name that ends a comment, a bound that is not there
    let case = with(&shipped(), r#"{ "of": "flexor", "space""#, r#"{ "of": "flexor", "name": "f*??\"ä\\nl", "space""#);
    let found = gains(&place, &case, &["scenarios=[]"]);
    let program = "#include \"gains.h\"\n#include <stdio.h>\n#include <stdlib.h>\nint main(int argc, char **argv)\n{\n    \
        double y[NASTIC_GAINS_OUTPUTS], m[NASTIC_GAINS_CONTROLS];\n    int i;\n    if (argc != 1 + NASTIC_GAINS_OUTPUTS) return 1;\n    \
        for (i = 0; i < NASTIC_GAINS_OUTPUTS; ++i) y[i] = atof(argv[1 + i]);\n    \
        for (i = 0; i < NASTIC_GAINS_CONTROLS; ++i) m[i] = nastic_gains_start[i];\n    nastic_gains_step(y, m);\n    \
        for (i = 0; i < NASTIC_GAINS_CONTROLS; ++i) printf(\"%.17g\\n\", m[i]);\n    return 0;\n}\n";
    std::fs::write(place.path("out/main.c"), program).unwrap();
    let out = place.path("out");
    let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "main.c", "-o", "step"];
    let compiled = Process::new(compiler).args(flags).current_dir(&out).output().unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let mut whole = 0;
    for y in [[84.3, -15.2], [150.0, -120.0], [20.0, 90.0]] {
        let ran = Process::new(out.join("step")).args(y.map(|y| format!("{y:e}"))).output().unwrap();
        let text = String::from_utf8(ran.stdout).unwrap();
        let stepped: Vec<f64> = text.lines().map(|line| line.parse().unwrap()).collect();
        assert_eq!(stepped.len(), 2, "{text}");
        let at = |path: String| number(&found, &path);
        let [errors, moved] = [
            [0, 1].map(|i| y[i] - at(format!("/outputs/{i}/target"))),
            [0, 1].map(|j| stepped[j] - at(format!("/controls/{j}/value"))),
        ];
        for (j, stepped) in stepped.iter().enumerate() {
            // the derivative of 1/2 |e + S d|_Q^2 + 1/2 d.R d, beside its terms
            let s = |i: usize, k: usize| format!("/outputs/{i}/sensitivities/{k}");
            let q = |i: usize| format!("/outputs/{i}/weight");
            let new = |i: usize| errors[i] + (0..2).map(|k| at(s(i, k)) * moved[k]).sum::<f64>();
            let slope = (0..2).map(|i| at(s(i, j)) * at(q(i)) * new(i)).sum::<f64>()
                + at(format!("/controls/{j}/penalty")) * moved[j];
            let size = (0..2).map(|i| (at(s(i, j)) * at(q(i)) * errors[i]).abs()).sum::<f64>();
            let [lower, upper] = ["lower", "upper"].map(|end| at(format!("/controls/{j}/{end}")));
            assert!((lower..=upper).contains(stepped), "{stepped}");
            let presses = (*stepped == lower && slope > 0.0) || (*stepped == upper && slope < 0.0);
            assert!(presses || slope.abs() <= 1e-9 * size, "{stepped} {slope} of {size}");
        }
        let wanted = |j: usize| {
            at(format!("/controls/{j}/value")) - (0..2).map(|i| at(format!("/gain/{j}/{i}")) * errors[i]).sum::<f64>()
        };
        let cut =
            |j: usize| wanted(j) < at(format!("/controls/{j}/lower")) || wanted(j) > at(format!("/controls/{j}/upper"));
        if !cut(0) && !cut(1) {
            whole += 1;
            assert!((0..2).all(|j| (stepped[j] - wanted(j)).abs() <= 1e-12 * wanted(j).abs().max(1.0)), "{stepped:?}");
        }
    }
    assert!((1..3).contains(&whole), "{whole}");
    std::fs::remove_file(out.join("main.c")).unwrap();
}

#[test]
fn what_has_no_law_is_refused_before_anything_is_solved() {
    let controls = |text: &str| format!("controls={text}");
    for (set, wanted) in [
        (r#"time={ "end": 1, "step": 0.5, "scheme": "quasi_static" }"#.to_owned(), "\"gains\" is of equilibria"),
        (r#"actuation=[]"#.to_owned(), "needs controls"),
        ("costs=[]".to_owned(), "\"gains\" needs costs"),
        (
            r#"costs=[ { "kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z"] } ]"#.to_owned(),
            "needs outputs with targets: costs of the kind position",
        ),
        (r#"load_cases=[ { "name": "a" }, { "name": "b" } ]"#.to_owned(), "the case has 2 load cases"),
        ("gains/damping=-1".to_owned(), "gains/damping"),
        ("gains/steps=0".to_owned(), "gains/steps"),
        (controls(r#"[ { "of": "body.young", "space": "uniform", "log": true } ]"#), "leave \"log\" out"),
    ] {
        let case = with(&shipped(), r#"{ "region": "body","#, r#"{ "name": "body", "region": "body","#);
        let none = match set.split_once('=') {
            Some(("actuation", _)) => "controls=[]",
            Some(("controls", _)) => "actuation=[]",
            _ => "title=none",
        };
        let found = refused(&case, &[&set, none, "scenarios=[]", "optimizer/method=lbfgs"]);
        assert!(found.contains(wanted), "{set}:\n{found}");
    }
    let many =
        with(&with(BEAM, r#""space": "region""#, r#""space": { "grid": [20, 4, 4] }"#), "[6, 1, 2]", "[6, 1, 2]");
    assert!(refused(&many, &[]).contains("525 control values; \"gains\" takes 256 at most"), "{}", refused(&many, &[]));
    let magnet = r#"actuation=[ { "name": "fibers", "kind": "magnet", "region": ["lower", "upper"], "field": [0, 0, "1 mT"] } ]"#;
    for (key, wanted) in [("norm", "keep no length"), ("max_norm", "not of lengths")] {
        let control = format!(
            r#"controls=[ {{ "of": "fibers.remanence", "space": "uniform", "{key}": "0.1 T", "start": ["0.1 T", 0, 0] }} ]"#
        );
        let found = refused(BEAM, &[magnet, &control]);
        assert!(found.contains(wanted), "{found}");
    }
}
