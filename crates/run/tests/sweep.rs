//! `nastic sweep`: one run per value, a table of them all.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, Heard};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::record::TrialRecord;
use nastic_run::run::{Exit, OnTrial, Options, RunError, Sweep, SweepOutcome, run, sweep};
use serde_json::Value;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

const OPTIMIZE: Sweep = Sweep { command: Command::Optimize, warm: false, quantity: None };
const SOLVE: Sweep = Sweep { command: Command::Solve, warm: false, quantity: None };

fn sweep_with(
    place: &CaseDirectory,
    how: &Sweep,
    options: &Options,
    console: &Console,
) -> Result<SweepOutcome, RunError> {
    let file = place.write("case.json", BAR);
    sweep(&Catalogue::standard(), how, &file, &Options { no_report: true, ..options.clone() }, console)
}

fn swept(place: &CaseDirectory, how: &Sweep, set: &[&str]) -> SweepOutcome {
    sweep_with(place, how, &place.options(set), &Console::silent()).unwrap()
}

/// The table, head first.
fn table(place: &CaseDirectory) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(place.path("out/sweep.csv")).unwrap();
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

#[test]
fn every_row_has_the_numbers_of_a_run_of_its_own() {
    let place = CaseDirectory::new();
    let heard = Heard::default();
    let options = place.options(&["materials/0/mu1=90 kPa,110 kPa", "optimizer/max_iterations=3"]);
    let outcome = sweep_with(&place, &OPTIMIZE, &options, &Console::new(heard.clone())).unwrap();
    assert_eq!(outcome.exit, Exit::NotConverged);
    assert_eq!(place.json("sweep.json"), outcome.result);
    let table = table(&place);
    assert_eq!(table.len(), 3);
    assert_eq!(table[0][..3], ["run", "materials/0/mu1", "exit"]);
    for (row, value) in table[1..].iter().zip(["90 kPa", "110 kPa"]) {
        assert_eq!(row[..3], [format!("mu1={}", value.replace(' ', "_")), value.to_owned(), "4".to_owned()]);
        let alone = CaseDirectory::new();
        let set = [format!("materials/0/mu1={value}"), "optimizer/max_iterations=3".to_owned()];
        let alone = alone.run(Command::Optimize, BAR, &[&set[0], &set[1]]).unwrap().result;
        let terms = alone["cost"]["terms"].as_object().unwrap();
        let term = terms.keys().next().unwrap();
        for (figure, found) in [
            ("cost/total", &alone["cost"]["total"]),
            (&format!("cost/terms/{term}"), &terms[term]),
            ("iterations", &alone["iterations"]),
            ("min_J", &alone["min_J"]),
            ("stop", &alone["stop"]),
            ("probes/tip/displacement/2", &alone["probes"]["tip"]["displacement"][2]),
        ] {
            let column = table[0].iter().position(|name| name == figure).unwrap_or_else(|| panic!("no {figure}"));
            let found = found.as_str().map_or_else(|| found.to_string(), str::to_owned);
            assert_eq!(row[column].trim_matches('"'), found.split(',').next().unwrap(), "{figure}");
        }
        assert!(place.path("out").join(&row[0]).join("optimum.vtu").exists());
    }
    assert_ne!(outcome.result["runs"][0]["figures"]["cost/total"], outcome.result["runs"][1]["figures"]["cost/total"]);
    let pvd = std::fs::read_to_string(place.path("out/sweep.pvd")).unwrap();
    assert!(pvd.contains(r#"timestep="90.0""#) && pvd.contains(r#"file="mu1=110_kPa/optimum.vtu""#), "{pvd}");
    let svg = std::fs::read_to_string(place.path("out/sweep.svg")).unwrap();
    assert!(svg.contains("mu1 (kPa)") && svg.contains("cost/total"), "the axis and a curve");
    let page = std::fs::read_to_string(place.path("out/sweep.html")).unwrap();
    assert!(page.contains(r#"<a href="mu1=110_kPa/report.html">mu1=110_kPa</a>"#) && page.contains("<svg"), "{page}");
    let head = "<th>exit</th><th>cost/total</th>";
    assert!(page.contains(head) && page.matches("<tr>").count() == 3, "{page}");
    let said = heard.text();
    assert!(said.contains("2 runs of optimize") && said.contains("run 2/2     mu1=110_kPa: cost"), "{said}");
}

#[test]
fn several_options_mean_all_combinations_and_arrays_are_values() {
    let place = CaseDirectory::new();
    let set = ["actuation/0/direction=[1,0,0],[0,0,1]", "controls/0/start=-10 kPa,-20 kPa", "materials/0/mu2=[1]"];
    // mu2 is no list: every run is refused for it, and is a row nevertheless.
    let refused = swept(&place, &SOLVE, &set);
    assert_eq!(refused.exit, Exit::BadInput);
    assert_eq!(refused.result["runs"].as_array().unwrap().len(), 4);
    assert!(refused.result["runs"][3]["error"].as_str().unwrap().contains("mu2"), "{}", refused.result["runs"][3]);
    assert!(!place.path("out/sweep.pvd").exists());

    let outcome = swept(&place, &SOLVE, &set[..2]);
    assert_eq!(outcome.exit, Exit::Done);
    let runs = outcome.result["runs"].as_array().unwrap();
    let names: Vec<&str> = runs.iter().map(|run| run["run"].as_str().unwrap()).collect();
    let expected = ["_1_0_0_,start=-10_kPa", "_1_0_0_,start=-20_kPa", "_0_0_1_,start=-10_kPa", "_0_0_1_,start=-20_kPa"];
    assert_eq!(names, expected.map(|name| format!("direction={name}")));
    let tip = |run: &Value| run["figures"]["probes/tip/displacement/0"].as_f64().unwrap();
    assert!(
        tip(&runs[1]) < tip(&runs[0]) && tip(&runs[0]) < 0.0,
        "a fibre along the bar shortens it, a stronger one more"
    );
    assert!(tip(&runs[3]) > tip(&runs[2]) && tip(&runs[2]) > 0.0, "one across it lengthens it");
    assert_eq!(runs[2]["values"]["actuation/0/direction"], serde_json::json!([0, 0, 1]));
    let pvd = std::fs::read_to_string(place.path("out/sweep.pvd")).unwrap();
    assert!(pvd.contains(r#"timestep="3.0""#) && pvd.contains("start=-20_kPa/start.vtu"), "{pvd}");
}

#[test]
fn a_run_that_fails_is_a_row_and_the_worst_decides_the_exit_code() {
    let crushed = |end: &str| {
        format!(r#"supports=[{{"surface":"x-","fix":"all"}},{{"surface":"x+","displacement":{{"x":{end}}}}}]"#)
    };
    let set = format!("{},{}", crushed("0.1"), crushed("-1.2").strip_prefix("supports=").unwrap());
    let place = CaseDirectory::new();
    let outcome = swept(&place, &SOLVE, &[&set]);
    let runs = outcome.result["runs"].as_array().unwrap();
    assert_eq!((outcome.exit, &runs[0]["exit"], &runs[1]["exit"]), (Exit::ForwardFailed, &0.into(), &3.into()));
    assert!(runs[1]["error"].as_str().unwrap().contains("failure.vtu"), "{}", runs[1]["error"]);
    assert_eq!(table(&place).len(), 3);
    let ranked = [Exit::Done, Exit::Warned, Exit::NotConverged, Exit::ForwardFailed, Exit::BadInput, Exit::NotWritten];
    for pair in ranked.windows(2) {
        assert_eq!((pair[0].worst(pair[1]), pair[1].worst(pair[0])), (pair[1], pair[1]));
    }
}

#[test]
fn expectations_of_the_case_are_left_aside() {
    let place = CaseDirectory::new();
    let expect = r#"expect={"min_J": {"value": 3, "absolute": 0.1}}"#;
    assert_eq!(place.run(Command::Solve, BAR, &[expect]).unwrap().exit, Exit::ExpectMissed);
    assert_eq!(swept(&place, &SOLVE, &["controls/0/start=0 Pa,-10 kPa", expect]).exit, Exit::Done);
}

#[test]
fn a_warm_run_starts_where_the_one_before_ended() {
    let set = ["costs/0/weight=1,1.01"];
    let place = CaseDirectory::new();
    let cold = swept(&place, &OPTIMIZE, &set);
    assert!(cold.result["runs"][1]["warm_from"].is_null());
    let warm = Sweep { warm: true, ..OPTIMIZE };
    let options = Options { restart: true, ..place.options(&set) };
    let outcome = sweep_with(&place, &warm, &options, &Console::silent()).unwrap();
    let runs = outcome.result["runs"].as_array().unwrap();
    assert_eq!((&runs[0]["warm_from"], &runs[1]["warm_from"]), (&Value::Null, &"weight=1".into()));
    assert_eq!(runs[0]["figures"], cold.result["runs"][0]["figures"], "the first starts as the case says");
    let end = runs[0]["figures"]["cost/terms/tracking"].as_f64().unwrap();
    let start = place.json("weight=1.01/result.json")["start"]["cost"]["terms"]["tracking"].as_f64().unwrap();
    assert!((start / (1.01 * end) - 1.0).abs() < 1e-6, "{start} {end}");
}

#[test]
fn a_sweep_that_is_cancelled_keeps_what_it_has() {
    let place = CaseDirectory::new();
    let trials = Arc::new(AtomicUsize::new(0));
    let options = place.options(&["costs/0/weight=1,2,3"]);
    let (cancel, counted) = (options.cancel.clone(), trials.clone());
    let on_trial = OnTrial::call(move |_: &TrialRecord| {
        // Within the second run.
        if counted.fetch_add(1, Ordering::Relaxed) == 6 {
            cancel.store(true, Ordering::Relaxed);
        }
    });
    let outcome = sweep_with(&place, &OPTIMIZE, &Options { on_trial, ..options }, &Console::silent()).unwrap();
    assert_eq!(outcome.exit, Exit::NotConverged);
    let kept = outcome.result["runs"].as_array().unwrap().len();
    assert!((1..3).contains(&kept), "{kept}");
    assert_eq!(table(&place).len(), kept + 1);
    assert_eq!(outcome.result["planned"], 3);
}

#[test]
fn what_cannot_be_swept_is_refused_before_anything_is_written() {
    static PLACE: OnceLock<CaseDirectory> = OnceLock::new();
    let place = PLACE.get_or_init(CaseDirectory::new);
    for (how, set, part) in [
        (&OPTIMIZE, "materials/0/mu1=1", "no option has several values"),
        (&OPTIMIZE, "materials/0/mu1=50,100 kPa", "a unit belongs to the value before it alone"),
        (&OPTIMIZE, "matter/0/mu1=1,2", "matter"),
        (&Sweep { command: Command::Check, warm: false, quantity: None }, "materials/0/mu1=1,2", "not \"check\""),
        (&Sweep { warm: true, ..SOLVE }, "materials/0/mu1=1,2", "--warm"),
        (&Sweep { warm: true, ..OPTIMIZE }, "controls/0/start=1,2", "--warm"),
    ] {
        let error = sweep_with(place, how, &place.options(&[set]), &Console::silent()).unwrap_err();
        assert_eq!(error.exit(), Exit::BadInput);
        assert!(error.to_string().contains(part), "{error}");
        assert!(!place.path("out").exists());
    }
    // The same case runs as it is.
    assert!(run(Command::Check, &place.path("case.json"), &place.options(&[]), &Console::silent()).is_ok());
}
