//! Starts in parts: joined they give what one process gives, to the bit.

#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;
use crate::starts::{MAGNET, assert_same, history};

use common::{BAR, CaseDirectory, Heard};
use nastic_language::schema::Command;
use nastic_run::console::Console;
use nastic_run::run::{Exit, OnTrial, Options, Outcome, RunError, Share};
use std::sync::atomic::{AtomicUsize, Ordering};

const STARTS: [&str; 5] = [
    "optimizer/starts=4",
    "optimizer/seed=7",
    "optimizer/max_iterations=25",
    "optimizer/early_stopping=false",
    r#"title="Magnet""#,
];

fn part(text: &str) -> Share {
    Share::Part(text.parse().unwrap())
}

/// Optimises, or does what is asked for of it; what was said.
fn optimise(place: &CaseDirectory, set: &[&str], share: Share) -> (Result<Outcome, RunError>, String) {
    let heard = Heard::default();
    let options = Options { share, ..place.options(set) };
    let found = place.run_with(Command::Optimize, MAGNET, &Console::new(heard.clone()), &options);
    (found, heard.text())
}

/// Fails unless the joined results are those of one process; removes the directories of the starts.
fn assert_joined(place: &CaseDirectory, whole: &CaseDirectory, what: &str) {
    for index in 0..4 {
        std::fs::remove_dir_all(place.path("out").join(format!("start_{index}"))).unwrap();
    }
    assert_same(place, whole, what);
}

#[test]
fn joined_starts_are_those_of_one_process() {
    for (output, orders) in [
        ("output/every=5", &[&["1/1"][..], &["3/3", "1/3", "2/3"], &["2/4", "4/4", "3/4", "1/4"]][..]),
        ("output/checkpoint=0", &[&["2/2", "1/2"]]),
    ] {
        let set: Vec<&str> = STARTS.iter().chain(&[output]).copied().collect();
        let whole = CaseDirectory::new();
        let one = optimise(&whole, &set, Share::Whole).0.unwrap();
        for parts in orders {
            let place = CaseDirectory::new();
            for name in *parts {
                let (ended, said) = optimise(&place, &set, part(name));
                let ended = ended.unwrap();
                assert_eq!(ended.exit, Exit::Done, "all have ended, converged or not: {said}");
                assert!(!place.path("out/result.json").exists() && !place.path("out/history.jsonl").exists());
            }
            let (joined, said) = optimise(&place, &set, Share::Join);
            assert_eq!(joined.unwrap().exit, one.exit, "{said}");
            assert!(said.contains("joined      4 of 4 starts"), "{said}");
            assert_joined(&place, &whole, &format!("{parts:?}, {output}"));
        }
    }
}

#[test]
fn a_part_that_was_stopped_goes_on_to_the_bit_and_keeps_what_has_ended() {
    let whole = CaseDirectory::new();
    optimise(&whole, &STARTS, Share::Whole).0.unwrap();
    let trials = history(&whole);
    let of_start = |start: usize| trials.iter().filter(|trial| trial["start"] == start).count();
    let place = CaseDirectory::new();
    // Within the second start of the part, behind its checkpoint at iteration 10.
    let moment = of_start(0) + of_start(2) / 2 + 2;
    let mut options = Options { share: part("1/2"), ..place.options(&STARTS) };
    let (heard, cancel) = (AtomicUsize::new(0), options.cancel.clone());
    options.on_trial = OnTrial::call(move |_| {
        cancel.fetch_or(heard.fetch_add(1, Ordering::Relaxed) + 1 == moment, Ordering::Relaxed);
    });
    let stopped = place.run_with(Command::Optimize, MAGNET, &Console::silent(), &options).unwrap();
    assert_eq!((stopped.exit, &stopped.result["interrupted"]), (Exit::NotConverged, &true.into()));
    optimise(&place, &STARTS, part("2/2")).0.unwrap();

    let (joined, said) = optimise(&place, &STARTS, Share::Join);
    let joined = joined.unwrap();
    assert_eq!(joined.exit, Exit::NotConverged);
    assert!(said.contains("missing     start 3 of 4: no finished run in start_2"), "{said}");
    let starts = joined.result["starts"].as_array().unwrap();
    assert_eq!((starts.len(), &starts[2]["failed"]), (4, &"missing: it has no finished run".into()));
    assert!(!place.path("out/checkpoint.bin").exists(), "nothing goes on from what is incomplete");

    let (ended, said) = optimise(&place, &STARTS, part("1/2"));
    assert_eq!(ended.unwrap().exit, Exit::Done);
    let lines: Vec<&str> = said.lines().filter(|line| line.starts_with("ended ")).collect();
    assert!(lines[0].ends_with("; kept") && lines[1].ends_with("; went on from its checkpoint"), "{said}");
    optimise(&place, &STARTS, Share::Join).0.unwrap();
    assert_joined(&place, &whole, "a part was stopped");
}

#[test]
fn starts_of_another_case_are_missing_and_without_the_first_there_is_no_result() {
    let place = CaseDirectory::new();
    let set = |more: &'static str| STARTS.iter().chain(&[more]).copied().collect::<Vec<_>>();
    let short = set("optimizer/max_iterations=3");
    optimise(&place, &short, part("2/2")).0.unwrap();
    let error = optimise(&place, &short, Share::Join).0.unwrap_err();
    assert!(matches!(error, RunError::NothingToJoin { .. }) && error.exit() == Exit::NotConverged, "{error}");
    assert!(error.to_string().contains("--part 1/N"), "{error}");
    optimise(&place, &set("optimizer/max_iterations=2"), part("1/2")).0.unwrap();
    assert!(optimise(&place, &short, Share::Join).0.is_err(), "start 1 is that of another case");
    let (anew, said) = optimise(&place, &short, part("1/2"));
    assert!(anew.unwrap().exit == Exit::Done && !said.contains("kept"), "{said}");
    assert!(optimise(&place, &short, Share::Join).0.is_ok());
    let anew = Options { share: part("1/2"), restart: true, ..place.options(&short) };
    let heard = Heard::default();
    place.run_with(Command::Optimize, MAGNET, &Console::new(heard.clone()), &anew).unwrap();
    assert!(!heard.text().contains("kept"), "{}", heard.text());
}

#[test]
fn what_cannot_be_divided_is_refused() {
    let place = CaseDirectory::new();
    for share in [part("1/2"), Share::Join] {
        for (case, set, message) in [
            (BAR, "optimizer/max_iterations=3", "the case has one: --set optimizer/starts=8"),
            (MAGNET, r#"optimizer={"starts":3,"max_iterations":60}"#, "--set optimizer/early_stopping=false"),
        ] {
            let options = Options { share, ..place.options(&[set]) };
            let refused = place.run_with(Command::Optimize, case, &Console::silent(), &options).unwrap_err();
            assert!(refused.exit() == Exit::BadInput && refused.to_string().contains(message), "{refused}");
            assert!(!place.path("out/start_0").exists() && !place.path("out/result.json").exists());
        }
    }
    // Nothing is compared before the tenth iteration.
    let set = ["optimizer/starts=3", "optimizer/max_iterations=8"];
    assert_eq!(optimise(&place, &set, part("3/3")).0.unwrap().exit, Exit::Done);
}

/// A start that another process works on is left to it.
#[test]
fn the_lock_is_that_of_the_start() {
    let place = CaseDirectory::new();
    std::fs::create_dir_all(place.path("out/start_1")).unwrap();
    let locks = ["out/.lock", "out/start_1/.lock"].map(|name| std::fs::File::create(place.path(name)).unwrap());
    locks.iter().for_each(|lock| lock.try_lock().unwrap());
    let set: Vec<&str> = STARTS.iter().chain(&["optimizer/max_iterations=2"]).copied().collect();
    let (found, said) = optimise(&place, &set, part("1/1"));
    assert_eq!(found.unwrap().exit, Exit::NotWritten);
    assert!(said.contains("ended       start 2 of 4: ") && said.contains("is in use by another program"), "{said}");
    drop(locks);
    let (joined, said) = optimise(&place, &set, Share::Join);
    assert_eq!(joined.unwrap().exit, Exit::NotConverged);
    assert!(said.contains("missing     start 2 of 4"), "{said}");
}
