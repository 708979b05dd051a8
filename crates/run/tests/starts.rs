//! Several starts: side by side with the same bits for any number of threads, early stopping, interruptions between and within rounds.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

use crate::common;

use common::{CaseDirectory, Heard};
use nastic_language::catalogue::Catalogue;
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, OnTrial, Options, resume};
use serde_json::Value;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

pub const MAGNET: &str = include_str!("../../language/tests/cases/magnet_pair.json");
const STARTS: [&str; 5] = [
    "optimizer/starts=4",
    "optimizer/seed=7",
    "optimizer/max_iterations=60",
    "optimizer/tolerance=1e-4",
    r#"title="Magnet""#,
];

/// A file and what it holds.
type NamedBytes = (String, Vec<u8>);

/// Results but for times and threads, the history but for seconds, all files that show no times.
fn content(place: &CaseDirectory) -> (Value, Vec<Value>, Vec<NamedBytes>) {
    let mut result = place.json("result.json");
    let timed = ["seconds", "threads", "peak_memory", "resumed"];
    result.as_object_mut().unwrap().retain(|key, _| !timed.contains(&key.as_str()));
    let own = ["result.json", "history.jsonl", "checkpoint.bin", "report.html"];
    let is_own = |name: &str| own.contains(&name) || name.starts_with("checkpoint_");
    let files = place.files().into_iter().filter(|name| !is_own(name));
    let files = files.map(|name| (name.clone(), std::fs::read(place.path("out").join(name)).unwrap())).collect();
    let own_name = place.directory.path().display().to_string();
    (serde_json::from_str(&result.to_string().replace(&own_name, "")).unwrap(), history(place), files)
}

pub fn history(place: &CaseDirectory) -> Vec<Value> {
    let text = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let line = |line: &str| {
        let mut line: Value = serde_json::from_str(line).unwrap();
        line.as_object_mut().unwrap().remove("seconds");
        line
    };
    text.lines().map(line).collect()
}

pub fn assert_same(place: &CaseDirectory, other: &CaseDirectory, what: &str) {
    let ((result, history, files), (result_2, history_2, files_2)) = (content(place), content(other));
    assert_eq!(format!("{result:#}"), format!("{result_2:#}"), "{what}");
    assert_eq!(history, history_2, "{what}");
    assert_eq!(files.len(), files_2.len(), "{what}");
    for (file, file_2) in files.iter().zip(&files_2) {
        assert!(file == file_2, "{what}: {} differs", file.0);
    }
}

/// Optimises on so many threads; what was said.
fn optimise(place: &CaseDirectory, set: &[&str], threads: usize) -> String {
    let heard = Heard::default();
    let options = Options { threads: Some(threads), ..place.options(set) };
    place.run_with(Command::Optimize, MAGNET, &Console::new(heard.clone()), &options).unwrap();
    heard.text()
}

/// What is said above the table of starts, without the place of the case and without times.
fn without_times(said: &str) -> Vec<String> {
    let of = |line: &str| {
        let is_row = line.trim_start().starts_with(|c: char| c.is_ascii_digit()) && line.contains('%');
        // Seconds, and the smallest J: plain decimal numbers.
        let is_decimal = |word: &str| word.contains('.') && !word.contains(['e', '%']);
        let words = line.split_whitespace().filter(|word| !is_row || !is_decimal(word));
        words.collect::<Vec<_>>().join(" ")
    };
    said.lines().skip(1).take_while(|line| !line.starts_with("starts ")).map(of).collect()
}

#[test]
fn starts_give_the_same_bits_and_lines_on_any_number_of_threads() {
    let one = CaseDirectory::new();
    let said = optimise(&one, &STARTS, 1);
    let starts = one.json("result.json")["starts"].as_array().unwrap().clone();
    let stopped = starts.iter().filter(|start| start["stopped_early"] == true).count();
    assert!(stopped > 0, "the test needs a start that is stopped: {starts:#?}");
    for threads in [2, 3, 8] {
        let several = CaseDirectory::new();
        let said_there = optimise(&several, &STARTS, threads);
        assert_same(&several, &one, &format!("{threads} threads"));
        assert_eq!(without_times(&said_there), without_times(&said), "{threads} threads");
    }
}

#[test]
fn hopeless_starts_are_stopped_and_the_best_minimum_is_kept() {
    let (early, whole) = (CaseDirectory::new(), CaseDirectory::new());
    let said = optimise(&early, &STARTS, 2);
    let set: Vec<&str> = STARTS.iter().chain(&["optimizer/early_stopping=false"]).copied().collect();
    optimise(&whole, &set, 2);
    let (early, whole) = (early.json("result.json"), whole.json("result.json"));
    assert_eq!(early["best_start"], whole["best_start"]);
    assert_eq!(early["cost"], whole["cost"], "pauses are where checkpoints are: the run is the same to the bit");
    let best = early["best_start"].as_u64().unwrap() as usize;
    let mut stopped = 0;
    for (k, (start, to_the_end)) in
        early["starts"].as_array().unwrap().iter().zip(whole["starts"].as_array().unwrap()).enumerate()
    {
        assert_eq!(to_the_end["stopped_early"], false);
        if start["stopped_early"] == false {
            assert_eq!(start["cost"], to_the_end["cost"], "start {k}");
            continue;
        }
        stopped += 1;
        assert_ne!(k, best);
        let iterations = start["iterations"].as_u64().unwrap();
        assert!([10, 20, 40].contains(&iterations) && iterations < to_the_end["iterations"].as_u64().unwrap());
        assert!(start["stop"].as_str().unwrap().starts_with("stopped early: the cost "), "{start}");
        assert!(start["minimum"].is_null() && start["converged"] == false, "{start}");
        assert!(said.contains(&format!("\nstart {} stopped early: the cost ", k + 1)), "{said}");
    }
    assert!((1..=2).contains(&stopped), "{early:#}");
    assert!(said.lines().any(|line| line.ends_with(" iterations, stopped early")), "{said}");
}

/// Interrupted by what listens to trials, in the first round and behind it, on one thread and on several.
#[test]
fn starts_that_were_interrupted_go_on_to_the_bit() {
    let whole = CaseDirectory::new();
    optimise(&whole, &STARTS, 2);
    let trials = history(&whole).len();
    let more = [(trials / 3, 3), (4 * trials / 5, 2)].into_iter().filter(|_| std::env::var_os("NASTIC_SLOW").is_some());
    for (moment, threads) in [(3, 2), (trials / 2, 1), (trials - 4, 3)].into_iter().chain(more) {
        let place = CaseDirectory::new();
        let mut options = Options { threads: Some(threads), ..place.options(&STARTS) };
        let (heard, cancel) = (AtomicUsize::new(0), options.cancel.clone());
        options.on_trial = OnTrial::call(move |_| {
            cancel.fetch_or(heard.fetch_add(1, Ordering::Relaxed) + 1 == moment, Ordering::Relaxed);
        });
        let interrupted = place.run_with(Command::Optimize, MAGNET, &Console::silent(), &options).unwrap();
        assert_eq!(interrupted.exit, Exit::NotConverged, "after {moment} trials");
        let message = history(&place);
        let accepted =
            message.iter().filter(|trial| trial["accepted"] == true).filter_map(|trial| trial["cost"].as_f64());
        let (least, kept) =
            (accepted.fold(f64::INFINITY, f64::min), interrupted.result["cost"]["total"].as_f64().unwrap());
        assert!(kept <= least, "after {moment} trials the result has {kept:e}, the history {least:e}");
        let again = Options { threads: Some(4 - threads), ..Options::default() };
        let resumed = resume(&Catalogue::standard(), &place.path("out"), &again, &Console::silent()).unwrap();
        assert!(resumed.result["resumed"]["iteration"].as_u64().unwrap().is_multiple_of(10));
        assert_same(&place, &whole, &format!("interrupted after {moment} of {trials} trials on {threads} threads"));
    }
}

/// Who listens hears every trial once, in the order of the history.
#[test]
fn trials_are_told_in_the_order_of_the_history() {
    let place = CaseDirectory::new();
    let message: Arc<Mutex<Vec<Value>>> = Arc::default();
    let mut options = Options { threads: Some(3), ..place.options(&STARTS) };
    let kept = message.clone();
    options.on_trial = OnTrial::call(move |line| kept.lock().unwrap().push(serde_json::to_value(line).unwrap()));
    place.run_with(Command::Optimize, MAGNET, &Console::silent(), &options).unwrap();
    let mut message = message.lock().unwrap().clone();
    message.iter_mut().for_each(|line| drop(line.as_object_mut().unwrap().remove("seconds")));
    assert_eq!(message, history(&place));
}

/// On a terminal one passing line reports all starts that run at once.
#[test]
fn the_passing_line_tells_of_all_starts_under_way() {
    let place = CaseDirectory::new();
    let passing = Heard::default();
    let console = Console::silent().with_passing(passing.clone());
    place.run_with(Command::Optimize, MAGNET, &console, &place.options(&STARTS)).unwrap();
    let said = passing.text();
    assert!(said.contains("starts under way: 1 (iteration "), "{said}");
    assert!(said.contains("), 2 (iteration "), "{said}");
}
