//! Checkpoints: an optimisation that was interrupted ends with the bits of one that was not; nothing else is resumed.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{BAR, CaseDirectory, DRIVEN, Heard, with};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::result::CheckpointError;
use nastic_run::run::{Exit, OnTrial, Options, Outcome, RunError, resume};
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const MAGNET: &str = include_str!("../../language/tests/cases/magnet_pair.json");
const SNAPPING: &str = include_str!("../../language/tests/cases/snapping_strip.json");
const SHORT: [&str; 3] = ["optimizer/max_iterations=7", "optimizer/tolerance=1e-9", "output/checkpoint=3"];

/// Raises a flag once so many lines were said that contain a word.
struct Watch {
    cancel: Arc<AtomicBool>,
    word: &'static str,
    left: usize,
}

impl std::io::Write for Watch {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        // A line comes in pieces; its end is in the last.
        let text = std::str::from_utf8(bytes).unwrap();
        let lines = if self.word.is_empty() { text.matches('\n').count() } else { text.matches(self.word).count() };
        self.left = self.left.saturating_sub(lines);
        if self.left == 0 {
            self.cancel.store(true, Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Optimises until so many lines were said.
fn interrupt(place: &CaseDirectory, case: &str, set: &[&str], lines: usize) -> Result<Outcome, RunError> {
    interrupt_on(2, place, case, set, ("", lines))
}

/// Optimises until a word was said so many times, one start after the other.
fn interrupt_at(
    place: &CaseDirectory,
    case: &str,
    set: &[&str],
    moment: (&'static str, usize),
) -> Result<Outcome, RunError> {
    interrupt_on(1, place, case, set, moment)
}

fn interrupt_on(
    threads: usize,
    place: &CaseDirectory,
    case: &str,
    set: &[&str],
    (word, left): (&'static str, usize),
) -> Result<Outcome, RunError> {
    let options = Options { threads: Some(threads), ..place.options(set) };
    let watch = Watch { cancel: options.cancel.clone(), word, left };
    place.run_with(Command::Optimize, case, &Console::new(watch), &options)
}

/// Optimises until an iteration was made.
fn interrupt_behind(place: &CaseDirectory, case: &str, set: &[&str], iteration: usize) -> Outcome {
    let options = place.options(set);
    let options = Options { on_trial: stop_behind(&options, iteration), ..options };
    let outcome = place.run_with(Command::Optimize, case, &Console::silent(), &options).unwrap();
    assert_eq!(outcome.result["iterations"], iteration);
    outcome
}

fn stop_behind(options: &Options, iteration: usize) -> OnTrial {
    let cancel = options.cancel.clone();
    OnTrial::call(move |trial| {
        if trial.accepted && trial.iteration == iteration {
            cancel.store(true, Ordering::Relaxed);
        }
    })
}

fn go_on(place: &CaseDirectory, threads: usize, console: &Console) -> Result<Outcome, RunError> {
    resume(
        &Catalogue::standard(),
        &place.path("out"),
        &Options { threads: Some(threads), ..Options::default() },
        console,
    )
}

fn refused(place: &CaseDirectory) -> CheckpointError {
    match go_on(place, 1, &Console::silent()) {
        Err(error @ RunError::Checkpoint(_)) if error.exit() != Exit::BadInput => panic!("{error}"),
        Err(RunError::Checkpoint(why)) => why,
        other => panic!("not refused: {other:?}"),
    }
}

/// A file and what it holds.
type NamedBytes = (String, Vec<u8>);

/// What must be the same: all but times and the entry that says that it was resumed.
fn content(place: &CaseDirectory) -> (Value, Vec<Value>, Vec<NamedBytes>) {
    let mut result = place.json("result.json");
    result
        .as_object_mut()
        .unwrap()
        .retain(|key, _| !["seconds", "threads", "peak_memory", "resumed"].contains(&key.as_str()));
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let line = |line: &str| {
        let mut line: Value = serde_json::from_str(line).unwrap();
        line.as_object_mut().unwrap().remove("seconds");
        line
    };
    // The page shows times too.
    let own = ["result.json", "history.jsonl", "checkpoint.bin", "report.html"];
    let files = place.files().into_iter().filter(|name| !own.contains(&name.as_str()));
    let files = files.map(|name| (name.clone(), std::fs::read(place.path("out").join(name)).unwrap()));
    (result, history.lines().map(line).collect(), files.collect())
}

fn assert_same(place: &CaseDirectory, whole: &CaseDirectory, what: &str) {
    let ((result, history, files), (result_2, history_2, files_2)) = (content(place), content(whole));
    // Texts show in which order keys stand, and every digit.
    assert_eq!(
        format!("{result:#}").replace(&name(place), ""),
        format!("{result_2:#}").replace(&name(whole), ""),
        "{what}"
    );
    assert_eq!(history, history_2, "{what}");
    let names = |files: &[NamedBytes]| files.iter().map(|file| file.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(&files), names(&files_2), "{what}");
    for (file, file_2) in files.iter().zip(&files_2) {
        assert!(file == file_2, "{what}: {} differs", file.0);
    }
}

fn name(place: &CaseDirectory) -> String {
    place.directory.path().display().to_string()
}

/// Interrupts at many moments of a case, resumes, and compares with the run that went through.
fn goes_on_to_the_bit(case: &str, set: &[&str], moments: &[usize]) {
    let whole = CaseDirectory::new();
    whole.run(Command::Optimize, case, set).unwrap();
    for lines in moments {
        let place = CaseDirectory::new();
        let interrupted = interrupt(&place, case, set, *lines);
        match &interrupted {
            Ok(outcome) => assert_eq!(outcome.exit, Exit::NotConverged, "after {lines} lines"),
            Err(error) => assert!(matches!(error, RunError::Cancelled), "after {lines} lines: {error}"),
        }
        let resumed = go_on(&place, 1 + lines % 2, &Console::silent()).unwrap().result;
        assert!(resumed["resumed"]["iteration"].as_u64().unwrap().is_multiple_of(3), "{}", resumed["resumed"]);
        assert_same(&place, &whole, &format!("interrupted after {lines} lines"));
    }
}

#[test]
fn a_fibre_goes_on_to_the_bit() {
    goes_on_to_the_bit(BAR, &SHORT, &[1, 5, 6, 8, 9, 12]);
}

#[test]
fn a_distance_with_stages_goes_on_to_the_bit() {
    let (from, to) = (BAR.find(r#""costs""#).unwrap(), BAR.find(r#""optimizer""#).unwrap());
    let costs = r#""costs": [ { "kind": "smoothed_hausdorff",
        "target": { "box": { "size": [0.9, 0.25, 0.3], "cells": [3, 1, 1], "element": "hex8" } },
        "phi": { "exponential": { "length": 0.1 } },
        "stages": [ { "alpha": 1, "beta": 4, "gamma": 4 }, { "alpha": 3, "beta": 16, "gamma": 8 } ] } ], "#;
    let case = format!("{}{costs}{}", &BAR[..from], &BAR[to..]);
    let set: Vec<&str> = SHORT.iter().chain(&["optimizer/starts=2"]).copied().collect();
    goes_on_to_the_bit(&case, &set, &[6, 10, 14, 24]);
}

#[test]
fn load_cases_and_several_starts_go_on_to_the_bit() {
    let starts = ["optimizer/starts=3", "optimizer/seed=4", "output/every=2"];
    let set: Vec<&str> = SHORT.iter().chain(&starts).copied().collect();
    let moments: Vec<usize> = (8..40).step_by(7).collect();
    // Without a title pictures would show where the case lies.
    goes_on_to_the_bit(&with(MAGNET, "{\n", "{ \"title\": \"Magnet\",\n"), &set, &moments);
}

/// The best of the starts is one that had ended before.
#[test]
fn what_earlier_starts_found_is_kept() {
    let set: Vec<&str> = SHORT.iter().chain(&["optimizer/starts=2", "optimizer/seed=2"]).copied().collect();
    let whole = CaseDirectory::new();
    let result = whole.run(Command::Optimize, BAR, &set).unwrap().result;
    assert_eq!(result["best_start"], 0, "the test needs a start as written that is the best");
    // While the second start is evaluated, after its gradient was checked, and in the midst of its run.
    for (moment, starts, from) in
        [(("start 2 of 2", 1), 1, (0, 6)), (("gradient    right", 2), 1, (0, 6)), (("\n", 23), 2, (1, 3))]
    {
        let place = CaseDirectory::new();
        let outcome = interrupt_at(&place, BAR, &set, moment).unwrap();
        assert_eq!(outcome.exit, Exit::NotConverged);
        assert_eq!(outcome.result["cost"], result["cost"], "{moment:?}");
        assert_eq!(outcome.result["starts"].as_array().map_or(1, Vec::len), starts, "{moment:?}");
        let resumed = go_on(&place, 2, &Console::silent()).unwrap().result["resumed"].clone();
        assert_eq!(
            (resumed["start"].as_u64(), resumed["iteration"].as_u64()),
            (Some(from.0), Some(from.1)),
            "{moment:?}"
        );
        assert_same(&place, &whole, &format!("{moment:?}"));
    }
}

/// A column that its load has made unstable.
const PUSHED: [&str; 2] = [r#"loads=[{ "surface": "x+", "traction": ["-30 kPa", 0, 0] }]"#, "controls/0/start=0"];

/// Warnings of every start stand in the result, also of those that an earlier program made.
#[test]
fn warnings_of_starts_are_kept() {
    let set: Vec<&str> = SHORT.iter().chain(&PUSHED).chain(&["optimizer/starts=2"]).copied().collect();
    let whole = CaseDirectory::new();
    let warnings = whole.run(Command::Optimize, BAR, &set).unwrap().result["warnings"].clone();
    let unstable = |place: &str| {
        let is = |warning: &&Value| warning["code"] == "unstable" && warning["place"] == place;
        warnings.as_array().unwrap().iter().filter(is).count()
    };
    assert_eq!((unstable("start 1 of 2"), unstable("start 2 of 2")), (1, 1), "{warnings:#}");
    goes_on_to_the_bit(BAR, &set, &[7, 12, 24]);
}

/// What was said of a start stands in the result also where the runs end with an error.
#[test]
fn warnings_of_a_start_are_kept_when_the_optimisation_fails() {
    let set: Vec<&str> = SHORT.iter().chain(&PUSHED).copied().collect();
    let place = CaseDirectory::new();
    let blocked = place.path("out/history.jsonl");
    let unstable = |what: &str| {
        let result = place.json("result.json");
        let warnings = result["warnings"].as_array().unwrap();
        let of_start = warnings.iter().filter(|warning| warning["code"] == "unstable" && warning["place"] == "start");
        assert_eq!((of_start.count(), &result["exit"]), (1, &Value::from(7)), "{what}: {result:#}");
    };
    std::fs::create_dir_all(&blocked).unwrap();
    let error = place.run(Command::Optimize, BAR, &set).unwrap_err();
    assert!(matches!(error, RunError::Write(_)), "{error}");
    unstable("optimize");
    std::fs::remove_dir(&blocked).unwrap();
    interrupt(&place, BAR, &set, 12).unwrap();
    std::fs::remove_file(&blocked).unwrap();
    std::fs::create_dir(&blocked).unwrap();
    let error = go_on(&place, 2, &Console::silent()).unwrap_err();
    assert!(matches!(error, RunError::Write(_)), "{error}");
    unstable("resume");
}

#[test]
fn an_optimum_that_is_verified_goes_on_to_the_bit() {
    let set: Vec<&str> = SHORT.iter().chain(&PUSHED).chain(&["optimizer/verify=true"]).copied().collect();
    goes_on_to_the_bit(BAR, &set, &[8, 11]);
}

/// The first step leads to another branch: the warning is kept whether it was made before the checkpoint or behind it.
#[test]
fn a_change_of_branch_goes_on_to_the_bit() {
    let target = r#"costs/0/target=["X", "Y - 0.05"]"#;
    let set = [target, "optimizer/max_iterations=5", "output/checkpoint=3", "optimizer/verify=false"];
    let whole = CaseDirectory::new();
    let warnings = whole.run(Command::Optimize, SNAPPING, &set).unwrap().result["warnings"].clone();
    assert_eq!(warnings[0]["code"], "branch_change", "{warnings:#}");
    goes_on_to_the_bit(SNAPPING, &set, &[8, 12]);
}

/// The end of a run that was itself resumed, twice.
#[test]
fn what_was_resumed_can_be_resumed_again() {
    let (whole, place) = (CaseDirectory::new(), CaseDirectory::new());
    whole.run(Command::Optimize, BAR, &SHORT).unwrap();
    interrupt(&place, BAR, &SHORT, 6).unwrap();
    for lines in [5, 12] {
        let cancel = Arc::new(AtomicBool::new(false));
        let console = Console::new(Watch { cancel: cancel.clone(), word: "", left: lines });
        let outcome =
            resume(&Catalogue::standard(), &place.path("out"), &Options { cancel, ..Options::default() }, &console)
                .unwrap();
        assert_eq!(outcome.result["stop"], "cancelled");
    }
    let heard = Heard::default();
    go_on(&place, 2, &Console::new(heard.clone())).unwrap();
    assert!(heard.text().contains("resumed     at iteration 3\n"), "{}", heard.text());
    assert_same(&place, &whole, "resumed twice");
    // One that has ended is only ended again.
    go_on(&place, 2, &Console::silent()).unwrap();
    assert_same(&place, &whole, "resumed after its end");
}

/// Who stops a run again before it has come as far as the one before loses nothing of what that had found.
#[test]
fn what_was_found_stays_when_a_resumed_run_is_stopped_early() {
    let (whole, place) = (CaseDirectory::new(), CaseDirectory::new());
    let set: Vec<&str> = SHORT.iter().copied().chain(["output/every=1"]).collect();
    whole.run(Command::Optimize, BAR, &set).unwrap();
    interrupt_behind(&place, BAR, &set, 5);
    let before = content(&place);
    let heard = Heard::default();
    let options = Options::default();
    let options = Options { on_trial: stop_behind(&options, 4), ..options };
    let again = resume(&Catalogue::standard(), &place.path("out"), &options, &Console::new(heard.clone())).unwrap();
    assert_eq!(again.result["iterations"], 4, "{}", heard.text());
    assert!(heard.text().contains("stopped before it had come as far as the program before, whose results stay"));
    assert_eq!(format!("{before:?}"), format!("{:?}", content(&place)));
    go_on(&place, 2, &Console::silent()).unwrap();
    assert_same(&place, &whole, "stopped early");
    // nor of one that had ended
    let before = content(&place);
    let options = Options::default();
    let options = Options { on_trial: stop_behind(&options, 4), ..options };
    resume(&Catalogue::standard(), &place.path("out"), &options, &Console::silent()).unwrap();
    assert_eq!(format!("{before:?}"), format!("{:?}", content(&place)));
}

/// A checkpoint is written before its turn where iterations are expensive.
#[test]
fn dear_iterations_are_kept_before_their_turn() {
    let place = CaseDirectory::new();
    let set = ["optimizer/max_iterations=8", "optimizer/tolerance=1e-12"];
    interrupt_behind(&place, DRIVEN, &set, 7);
    let resumed = go_on(&place, 2, &Console::silent()).unwrap().result["resumed"].clone();
    assert!(resumed["iteration"].as_u64() >= Some(1), "{resumed}");
}

#[test]
fn an_interrupted_run_says_how_to_go_on() {
    let place = CaseDirectory::new();
    let heard = Heard::default();
    let options = place.options(&SHORT);
    options.cancel.store(true, Ordering::Relaxed);
    // Raised before anything is solved: there is no result, but there is a checkpoint.
    let error = place.run_with(Command::Optimize, BAR, &Console::silent(), &options).unwrap_err();
    assert!(matches!(error, RunError::Cancelled) && error.exit() == Exit::NotConverged);
    assert_eq!(go_on(&place, 2, &Console::silent()).unwrap().result["resumed"]["iteration"], 0);
    interrupt(&place, BAR, &SHORT, 11).unwrap();
    let cancel = Arc::new(AtomicBool::new(true));
    resume(
        &Catalogue::standard(),
        &place.path("out"),
        &Options { cancel, ..Options::default() },
        &Console::new(heard.clone()),
    )
    .unwrap();
    let described = heard.text();
    assert!(described.contains(&format!("to go on    nastic resume {}/out\n", name(&place))), "{described}");
    assert!(described.contains("from iteration 3, with the result of a run without interruption"), "{described}");
}

/// The way on that a run suggests whose iterations were used up.
#[test]
fn a_case_that_reads_its_own_results_is_warned() {
    let place = CaseDirectory::new();
    let result = place.run(Command::Optimize, BAR, &SHORT).unwrap().result;
    assert_eq!(result["warnings"], serde_json::json!([]));
    let start = r#"controls/0/start={"file": "out/optimum.vtu", "array": "tension"}"#;
    let set = [SHORT[0], SHORT[1], SHORT[2], start];
    let outcome = interrupt(&place, BAR, &set, 10).unwrap();
    let warning = outcome.result["warnings"][0]["message"].as_str().unwrap();
    assert!(warning.contains("optimum.vtu of its own output directory") && warning.contains("--out"), "{warning}");
    let described = refused(&place).to_string();
    assert!(described.contains("out/optimum.vtu has other content"), "{described}");
}

#[test]
fn without_a_schedule_there_is_no_checkpoint_and_an_old_one_goes() {
    let place = CaseDirectory::new();
    assert!(matches!(refused(&place), CheckpointError::Missing { .. }));
    assert!(!place.path("out").exists(), "a directory was made");
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    assert!(place.path("out/checkpoint.bin").exists());
    place.run(Command::Optimize, BAR, &[SHORT[0], "output/checkpoint=0"]).unwrap();
    assert!(!place.path("out/checkpoint.bin").exists());
    let described = refused(&place).to_string();
    assert!(described.contains("out has no checkpoint.bin") && described.contains("output/checkpoint"), "{described}");
}

/// The iteration of the checkpoint that is not replaced; nothing in the directory changes.
fn not_replaced(place: &CaseDirectory) -> usize {
    let content = || place.files().into_iter().map(|name| std::fs::read(place.path("out").join(name)).unwrap());
    let before: Vec<Vec<u8>> = content().collect();
    match place.run(Command::Optimize, BAR, &SHORT) {
        Err(RunError::Interrupted { iteration, .. }) => {
            assert!(content().eq(before), "something was written");
            iteration
        }
        other => panic!("not refused: {other:?}"),
    }
}

/// The best start of those that were run ended by its own test or by its number of iterations, the optimisation did not.
#[test]
fn an_optimisation_that_has_starts_left_is_not_replaced_unasked() {
    let set: Vec<&str> = SHORT.iter().chain(&["optimizer/starts=4", "optimizer/seed=2"]).copied().collect();
    let place = CaseDirectory::new();
    for moment in [("start 2 of 4", 1), ("gradient    right", 2), ("start 3 of 4", 1)] {
        std::fs::remove_dir_all(place.path("out")).ok();
        let result = interrupt_at(&place, BAR, &set, moment).unwrap().result;
        let stop = result["stop"].as_str().unwrap();
        assert!(result["converged"] == false && stop != "cancelled", "the test needs an end of its own: {stop}");
        assert_eq!(not_replaced(&place), 6, "{moment:?}");
    }
    go_on(&place, 2, &Console::silent()).unwrap();
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
}

/// Other commands write a result too.
#[test]
fn other_commands_end_no_optimisation_and_interrupt_none() {
    let place = CaseDirectory::new();
    let others = [Command::Solve, Command::Gradient];
    for set in [&SHORT[..], &["optimizer/tolerance=0.5"]] {
        let outcome = place.run(Command::Optimize, BAR, set).unwrap();
        assert_eq!(outcome.exit == Exit::Done, set.len() == 1, "{}", outcome.result["stop"]);
        for other in &others {
            place.run(other.clone(), BAR, &[]).unwrap();
        }
    }
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
    // One that had ended and is broken off while it is resumed has to end once more.
    let cancel = Arc::new(AtomicBool::new(true));
    let options = Options { cancel, ..Options::default() };
    resume(&Catalogue::standard(), &place.path("out"), &options, &Console::silent()).unwrap();
    for other in others {
        assert_eq!(not_replaced(&place), 6);
        place.run(other, BAR, &[]).unwrap();
    }
    assert_eq!(not_replaced(&place), 6);
    go_on(&place, 2, &Console::silent()).unwrap();
    place.run(Command::Optimize, BAR, &SHORT).unwrap();
}

#[test]
fn a_changed_case_is_refused_and_what_changed_is_named() {
    let place = CaseDirectory::new();
    let mesh = r#"{ "box": { "size": [1.0, 0.25, 0.25], "cells": [4, 1, 1], "element": "hex8" } }"#;
    let solved = CaseDirectory::new();
    solved.run(Command::Solve, BAR, &[]).unwrap();
    std::fs::copy(solved.path("out/start.vtu"), place.path("body.vtu")).unwrap();
    let case = with(BAR, mesh, r#""body.vtu""#);
    let set = [SHORT[0], SHORT[1], SHORT[2], "materials/0/mu1=90 kPa"];
    interrupt(&place, &case, &set, 9).unwrap();
    let whole = CaseDirectory::new();
    std::fs::copy(place.path("body.vtu"), whole.path("body.vtu")).unwrap();
    whole.run(Command::Optimize, &case, &set).unwrap();

    place.write("case.json", &case[..case.len() / 2]);
    assert!(matches!(go_on(&place, 1, &Console::silent()), Err(RunError::Input(_))), "half a case");
    place.write("case.json", &with(&case, "20 kPa", "21 kPa"));
    let described = refused(&place).to_string();
    assert!(described.contains("materials/0/mu2 was \"20 kPa\", is \"21 kPa\"; put it back"), "{described}");
    place.write("case.json", &with(&case, r#""output": { "every": 2 }"#, r#""loads": [], "output": {}"#));
    let described = refused(&place).to_string();
    assert!(
        described.contains("output/every was 2, is left out") && described.contains("loads was left out, is []"),
        "{described}"
    );
    // What the override replaces does not matter, and neither do comments.
    place.write("case.json", &format!("// the same\n{}", with(&case, "100 kPa", "110 kPa")));
    std::fs::rename(place.path("body.vtu"), place.path("away.vtu")).unwrap();
    let described = refused(&place).to_string();
    assert!(described.contains("body.vtu is missing"), "{described}");
    std::fs::write(place.path("body.vtu"), "other").unwrap();
    let described = refused(&place).to_string();
    assert!(described.contains("body.vtu has other content"), "{described}");
    std::fs::rename(place.path("away.vtu"), place.path("body.vtu")).unwrap();
    go_on(&place, 1, &Console::silent()).unwrap();
    assert_same(&place, &whole, "put back");
}
