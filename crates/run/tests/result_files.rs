//! What an optimisation leaves behind beside its states: controls to start from, tables, charts, kept iterations, the page.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Analysis, Exit, Options, RunError};
use serde_json::Value;

const SHORT: [&str; 1] = ["optimizer/max_iterations=4"];

#[test]
fn a_run_starts_from_the_controls_of_another() {
    let place = CaseDirectory::new();
    let first = place.run(Command::Optimize, BAR, &SHORT).unwrap().result;
    let file = place.path("out/controls.json");
    std::fs::copy(&file, place.path("controls.json")).unwrap();
    let start = r#"controls/0/start={"file": "controls.json"}"#;
    let second = place.run(Command::Solve, BAR, &[start]).unwrap().result;
    let (a, b) = (first["cost"]["total"].as_f64().unwrap(), second["cost"]["total"].as_f64().unwrap());
    assert!((a - b).abs() <= 1e-7 * a, "{a} {b}");
    let rms = |result: &Value| result["tracking"]["tracking"]["root_mean_square"].as_f64().unwrap();
    assert!((rms(&first) - rms(&second)).abs() <= 1e-7 * rms(&first));
    assert!(rms(&first) <= first["tracking"]["tracking"]["largest"].as_f64().unwrap());

    for (start, message) in [
        (
            r#"{"file": "controls.json", "control": "air"}"#,
            "control \"air\" not found in controls.json; it has: tension",
        ),
        (r#"{"file": "nowhere.json"}"#, "nowhere.json"),
    ] {
        let error = place.run(Command::Solve, BAR, &[&format!("controls/0/start={start}")]).unwrap_err().to_string();
        assert!(error.contains(message) && error.contains("controls/0/start"), "{error}");
    }
    std::fs::write(place.path("controls.json"), r#"{ "tension": [1, "a"] }"#).unwrap();
    let error = place.run(Command::Solve, BAR, &[start]).unwrap_err().to_string();
    assert!(error.contains("has 1 numbers for \"tension\""), "{error}");
}

#[test]
fn few_values_stand_in_the_result() {
    let place = CaseDirectory::new();
    let result = place.run(Command::Optimize, BAR, &["controls/0/space=uniform", SHORT[0]]).unwrap().result;
    let control = &result["controls"]["tension"];
    assert_eq!(control["values"], control["min"]);
    assert!(control["values"].is_number() && control["unit"] == "Pa" && control["slot"] == "tension", "{control}");
    let result = place.run(Command::Optimize, BAR, &["controls/0/space=region", SHORT[0]]).unwrap().result;
    let control = &result["controls"]["tension"];
    assert_eq!(control["values"]["body"], control["min"]);
}

#[test]
fn tables_charts_and_the_page_are_written() {
    let place = CaseDirectory::new();
    let result = place.run(Command::Optimize, BAR, &SHORT).unwrap().result;
    let table = std::fs::read_to_string(place.path("out/history.csv")).unwrap();
    assert_eq!(table.lines().count() as u64, result["trials"].as_u64().unwrap() + 2, "a head, the start, the trials");
    assert!(table.starts_with("trial,iteration,stage,accepted,reason,cost,terms/"), "{table}");
    let chart = std::fs::read_to_string(place.path("out/convergence.svg")).unwrap();
    assert!(chart.starts_with("<svg") && chart.contains("projected gradient"));
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    let cost = &result["cost"]["total"].as_f64().unwrap();
    let digits = format!("{cost:.4e}");
    assert!(page.contains(&digits[..5]) || page.contains(&format!("{cost}")[..5]), "{digits} is on the page");
    assert!(page.contains("<dt>Distance from target, largest</dt>") && page.contains("mm<small>"));
    for file in result["files"].as_array().unwrap() {
        assert!(place.path("out").join(file.as_str().unwrap()).is_file(), "{file} was not written");
    }
}

#[test]
fn the_page_of_a_failed_run_says_so_and_shows_the_last_state() {
    let place = CaseDirectory::new();
    let crushed = common::with(
        BAR,
        r#""fix": ["x", "y", "z"] }"#,
        r#""fix": ["x", "y", "z"] }, { "surface": "x+", "displacement": { "x": -1.2 } }"#,
    );
    place.run(Command::Solve, &crushed, &[]).unwrap_err();
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("<li class=\"error\"><b>failed</b>") && page.contains("last state before the failure"));
    assert!(!page.contains("\"label\":\"start\""), "no state of another run is shown");
    assert!(place.files().contains(&"failure.vtu".to_owned()));
    place.run(Command::Solve, BAR, &[]).unwrap();
    assert!(!place.files().contains(&"failure.vtu".to_owned()), "that of an earlier run");
}

const CRUSH: [&str; 2] =
    [r#""fix": ["x", "y", "z"] }"#, r#""fix": ["x", "y", "z"] }, { "surface": "x+", "displacement": { "x": -1.2 } }"#];

/// Beside the failure they would look like its results.
#[test]
fn a_run_that_fails_leaves_no_files_of_an_earlier_one() {
    let crushed = common::with(BAR, CRUSH[0], CRUSH[1]);
    let place = CaseDirectory::new();
    place.run(Command::Solve, BAR, &[]).unwrap();
    let whole = place.files();
    assert!(["start.vtu", "picture.svg", "target.vtu"].iter().all(|name| whole.iter().any(|file| file == name)));
    place.write("out/mine.vtu", "mine");
    place.run(Command::Solve, &crushed, &[]).unwrap_err();
    assert_eq!(place.files(), ["case.json", "failure.vtu", "mine.vtu", "report.html", "result.json"]);
    // a list that was edited reaches no other directory, and no file that is not of a run
    for name in ["out/notes.txt", "out/.hidden.vtu", "keep.vtu"] {
        place.write(name, "mine");
    }
    let mut edited = place.json("result.json");
    edited["files"] = serde_json::json!(["../keep.vtu", "notes.txt", ".hidden.vtu", "", "..", 1]);
    place.write("out/result.json", &edited.to_string());
    place.run(Command::Solve, &crushed, &[]).unwrap_err();
    assert!(["out/notes.txt", "out/.hidden.vtu", "keep.vtu"].iter().all(|name| place.path(name).exists()));
}

/// What the last run found stays where an option cannot be understood.
#[test]
fn a_refused_ramp_removes_nothing() {
    let place = CaseDirectory::new();
    place.run(Command::Solve, BAR, &[]).unwrap();
    let (before, result) = (place.files(), place.json("result.json"));
    for ramp in ["tension", "tention=0:-1 kPa:3"] {
        let options = Options { analysis: Analysis::Ramp(ramp.to_owned()), ..place.options(&[]) };
        place.run_with(Command::Solve, BAR, &Console::silent(), &options).unwrap_err();
        assert_eq!((place.files(), place.json("result.json")), (before.clone(), result.clone()), "{ramp}");
    }
}

/// Not even where it is the case that reads them, or another command that wrote them.
#[test]
fn what_is_still_of_use_is_not_removed() {
    let crushed = common::with(BAR, CRUSH[0], CRUSH[1]);
    let place = CaseDirectory::new();
    let has = |name: &str| place.files().iter().any(|file| file == name);
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    place.run(Command::Gradient, &crushed, &[]).unwrap_err();
    assert!(has("optimum.vtu") && has("controls.json") && has("checkpoint.bin"), "{:?}", place.files());
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    let from_there = [SHORT[0], r#"controls/0/start={"file": "out/controls.json"}"#];
    place.run(Command::Solve, &crushed, &from_there[1..]).unwrap_err();
    assert!(has("controls.json") && has("optimum.vtu") && has("checkpoint.bin"), "{:?}", place.files());
}

/// A case, a mesh or a start that is read is not replaced by a result of the same name, wherever the results are wanted.
#[test]
fn results_replace_nothing_that_is_read() {
    let place = CaseDirectory::new();
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    let from_there = [SHORT[0], r#"controls/0/start={"file": "out/controls.json"}"#];
    // a start that nastic wrote there itself may be replaced: a run that goes on
    place.run(Command::Optimize, BAR, &from_there).unwrap();
    let (before, controls) = (place.files(), std::fs::read(place.path("out/controls.json")).unwrap());
    std::fs::remove_file(place.path("out/result.json")).unwrap();
    let error = place.run(Command::Optimize, BAR, &from_there).unwrap_err();
    assert_eq!(error.exit(), Exit::BadInput);
    let text = error.to_string();
    assert!(text.contains("results would replace") && text.contains("out/controls.json, which is read"), "{text}");
    assert_eq!(std::fs::read(place.path("out/controls.json")).unwrap(), controls);
    assert_eq!(place.files().len() + 1, before.len());
    // the case itself, under the name of its copy and of the results
    for name in ["case.json", "result.json"] {
        let case = place.write(name, BAR);
        let options = Options { out: Some(case.parent().unwrap().to_owned()), ..place.options(&[]) };
        let error = nastic_run::run::run(Command::Solve, &case, &options, &Console::silent()).unwrap_err();
        assert!(matches!(error, RunError::ReplacesInput { .. }), "{error}");
        assert_eq!(std::fs::read_to_string(&case).unwrap(), BAR, "{name}");
    }
    // a mesh that has the name of a state
    std::fs::copy(place.path("out/start.vtu"), place.path("start.vtu")).unwrap();
    let mesh = place.write("bar.json", BAR);
    let set = vec![r#"mesh="start.vtu""#.to_owned()];
    let options = Options { out: Some(mesh.parent().unwrap().to_owned()), set, ..place.options(&[]) };
    let error = nastic_run::run::run(Command::Solve, &mesh, &options, &Console::silent()).unwrap_err();
    assert!(matches!(error, RunError::ReplacesInput { .. }), "{error}");
}

#[test]
fn a_run_from_an_optimum_stops_at_its_absolute_tolerance() {
    let place = CaseDirectory::new();
    let set = ["optimizer/method=lbfgs", "optimizer/tolerance=1e-2", "optimizer/max_iterations=60"];
    assert_eq!(place.run(Command::Optimize, BAR, &set).unwrap().exit, Exit::Done);
    let norm = place.json("result.json")["gradient_norm"].as_f64().unwrap();
    std::fs::copy(place.path("out/controls.json"), place.path("controls.json")).unwrap();
    let start = r#"controls/0/start={"file": "controls.json"}"#;
    let again = |more: &str| {
        let outcome = place.run(Command::Optimize, BAR, &[set[0], set[1], set[2], start, more]).unwrap();
        (outcome.result["iterations"].as_u64().unwrap(), outcome.result["stop"].as_str().unwrap().to_owned())
    };
    let (iterations, why) = again(&format!("optimizer/absolute_tolerance={:e}", 1.01 * norm));
    assert_eq!(iterations, 0, "{why}");
    assert!(why.contains("absolute tolerance"), "{why}");
    let (iterations, why) = again(&format!("optimizer/absolute_tolerance={:e}", 0.1 * norm));
    assert!(iterations > 0, "{why}");
}

/// Names stand in the page's data, where no sign of theirs may begin or end an element.
#[test]
fn names_do_not_break_the_page() {
    let place = CaseDirectory::new();
    let named = BAR.replace("\"tension\"", "\"<!--<script>\"");
    place
        .run_with(Command::Optimize, &named, &Console::silent(), &Options { figure: true, ..place.options(&SHORT) })
        .unwrap();
    let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
    assert!(page.contains("\\u003c!--\\u003cscript>"), "the name is in the data");
    assert!(!page.contains("<!--<script>"));
}
