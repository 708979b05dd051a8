//! Sweeps in parts: the same table, to the byte, for any number of processes in any order, also where one of them is killed.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, code, signal, start, text};
use std::os::unix::process::ExitStatusExt;
use std::process::Output;

/// Twelve optimisations, of which four are refused for a shear modulus below zero; with checkpoints.
const TWELVE: [&str; 14] = [
    "sweep",
    "case.json",
    "--out",
    "there",
    "--set",
    "materials/0/mu1=90 kPa,110 kPa,-1 kPa",
    "--set",
    "costs/0/weight=1,2,3,4",
    "--set",
    "optimizer={\"method\":\"projected_gradient\",\"max_iterations\":12,\"tolerance\":1e-15}",
    "--set",
    "output/checkpoint=2",
    "--threads",
    "1",
];
const TABLE: [&str; 5] = ["sweep.json", "sweep.html", "sweep.csv", "sweep.svg", "sweep.pvd"];

fn twelve<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&TWELVE, more].concat()
}

fn table(place: &CaseDirectory) -> Vec<Vec<u8>> {
    TABLE.iter().map(|name| std::fs::read(place.path("there").join(name)).unwrap()).collect()
}

fn one_process() -> Vec<Vec<u8>> {
    let place = CaseDirectory::new(BAR);
    let whole = place.nastic(&twelve(&[]));
    assert_eq!(code(&whole), 2, "{}", text(&whole.stderr));
    let said = text(&whole.stdout);
    assert!(said.contains("run 12/12") && !said.contains("kept"), "{said}");
    table(&place)
}

fn join(place: &CaseDirectory) -> (Output, serde_json::Value) {
    let joined = place.nastic(&twelve(&["--join"]));
    let json = std::fs::read(place.path("there/sweep.json")).unwrap();
    (joined, serde_json::from_slice(&json).unwrap())
}

fn assert_same(place: &CaseDirectory, whole: &[Vec<u8>], what: &str) {
    let (joined, _) = join(place);
    assert_eq!(code(&joined), 2, "{what}: {}", text(&joined.stdout));
    for ((name, found), expected) in TABLE.iter().zip(table(place)).zip(whole) {
        assert!(found == *expected, "{what}: {name} differs: {}", text(&found));
    }
}

#[test]
fn parts_in_any_order_give_the_table_of_one_process() {
    let whole = one_process();
    for (order, at_once) in [(&[1][..], false), (&[3, 1, 2], false), (&[5, 2, 4, 1, 3], true)] {
        let place = CaseDirectory::new(BAR);
        let parts: Vec<String> = order.iter().map(|part| format!("{part}/{}", order.len())).collect();
        let part = |part: &String| start(place.program(&twelve(&["--part", part])));
        let ended = |child: std::process::Child| child.wait_with_output().unwrap();
        let outputs: Vec<Output> = if at_once {
            parts.iter().map(part).collect::<Vec<_>>().into_iter().map(ended).collect()
        } else {
            parts.iter().map(|name| ended(part(name))).collect()
        };
        for (part, output) in parts.iter().zip(outputs) {
            let said = text(&output.stdout);
            // The worst of its runs: the third of five parts has none that is refused.
            let expected = if part == "3/5" { 4 } else { 2 };
            assert_eq!(code(&output), expected, "{part}: {said}");
            assert!(said.contains(&format!("part {part}")) && !said.contains("kept"), "{said}");
        }
        assert!(!place.path("there/sweep.json").exists(), "parts write no table");
        assert_same(&place, &whole, &format!("{parts:?}"));
        // The runs are there: who joins may be any process, and a sweep in one process keeps them.
        let again = place.nastic(&twelve(&[]));
        assert_eq!(text(&again.stdout).matches("; kept").count(), 8, "{}", text(&again.stdout));
        assert_same(&place, &whole, "again");
    }
}

#[test]
fn a_part_that_is_killed_goes_on_to_the_same_table() {
    let whole = one_process();
    let place = CaseDirectory::new(BAR);
    for part in ["3/3", "1/3"] {
        place.nastic(&twelve(&["--part", part]));
    }
    let mut child = start(place.program(&twelve(&["--part", "2/3"])));
    place.wait_for_lines("there/mu1=90_kPa,weight=2/history.jsonl", 6, &mut child);
    assert!(signal(&child, "KILL"));
    assert_eq!(child.wait_with_output().unwrap().status.signal(), Some(9));
    let (joined, table) = join(&place);
    let missing: Vec<&str> = table["missing"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    assert!(missing.contains(&"mu1=-1_kPa,weight=3"), "its last run: {missing:?}");
    assert_eq!((table["runs"].as_array().unwrap().len(), &table["planned"]), (12 - missing.len(), &12.into()));
    let said = text(&joined.stdout);
    assert!(said.contains(&format!("missing     {} run", missing.len())) && said.contains(missing[0]), "{said}");
    let again = place.nastic(&twelve(&["--part", "2/3"]));
    assert!(text(&again.stdout).contains("; went on from its checkpoint"), "{}", text(&again.stdout));
    assert_same(&place, &whole, "after a part was killed");
}

/// A sweep in one process that is killed goes on by the same command.
#[test]
fn a_sweep_that_is_killed_goes_on() {
    let whole = one_process();
    let place = CaseDirectory::new(BAR);
    let mut child = start(place.program(&twelve(&[])));
    place.wait_for_lines("there/mu1=90_kPa,weight=3/history.jsonl", 5, &mut child);
    assert!(signal(&child, "KILL"));
    child.wait_with_output().unwrap();
    let first = place.path("there/mu1=90_kPa,weight=1/result.json");
    let (before, so_far) = (std::fs::read(&first).unwrap(), std::fs::read(place.path("there/sweep.json")).unwrap());
    let so_far: serde_json::Value = serde_json::from_slice(&so_far).unwrap();
    let missing = so_far["missing"].as_array().unwrap().len();
    assert!(missing >= 9 && so_far["exit"] == 4, "the table of a sweep under way names what is missing: {so_far:#}");
    let again = place.nastic(&twelve(&[]));
    let said = text(&again.stdout);
    assert!(said.lines().any(|line| line.starts_with("run 1/12 ") && line.ends_with("; kept")), "{said}");
    assert_eq!(std::fs::read(&first).unwrap(), before, "what is kept is not written again");
    assert_eq!(table(&place), whole);
    // Nothing is kept on demand.
    let anew = place.nastic(&twelve(&["--restart"]));
    assert!(!text(&anew.stdout).contains("kept") && std::fs::read(&first).unwrap() != before);
}

#[test]
fn what_is_missing_is_named_and_decides_the_exit_code() {
    let place = CaseDirectory::new(BAR);
    let solve =
        ["sweep", "case.json", "--out", "there", "--command", "solve", "--set", "costs/0/weight=1,2,3,4,5,6,7,8"];
    let with = |more: &[&'static str]| place.nastic(&[&solve[..], more].concat());
    assert_eq!(code(&with(&["--part", "2/8"])), 0);
    let joined = with(&["--join"]);
    let said = text(&joined.stdout);
    assert_eq!(code(&joined), 4, "{said}");
    assert!(
        said.contains("missing     7 runs not made or not finished: weight=1 weight=3 weight=4 weight=5 weight=6 .."),
        "{said}"
    );
    assert_eq!(std::fs::read_to_string(place.path("there/sweep.csv")).unwrap().lines().count(), 2);
    let told: serde_json::Value = serde_json::from_slice(&with(&["--join", "--json"]).stdout).unwrap();
    assert_eq!((told["missing"].as_array().unwrap().len(), &told["exit"]), (7, &4.into()));
    // More parts than runs: the last ones have none.
    let none = with(&["--part", "9/9"]);
    assert!(code(&none) == 0 && text(&none.stdout).contains("0 runs made"), "{}", text(&none.stdout));
    for (arguments, part) in [
        (&["--part", "0/3"][..], "K/N"),
        (&["--part", "4/3"], "1 <= K <= N"),
        (&["--part", "1/3", "--join"], "cannot be used with"),
        (&["--restart", "--join"], "cannot be used with"),
    ] {
        let refused = with(arguments);
        assert_eq!(code(&refused), 2, "{arguments:?}");
        assert!(text(&refused.stderr).contains(part), "{}", text(&refused.stderr));
    }
}

/// Runs that were made with another case or other options are distinguished from those that are missing, and the table that they have stays.
#[test]
fn joining_with_another_case_leaves_the_table_and_says_what_to_do() {
    let place = CaseDirectory::new(BAR);
    let four = ["sweep", "case.json", "--out", "there", "--command", "solve", "--set", "costs/0/weight=1,2,3,4"];
    let with = |more: &[&'static str]| place.nastic(&[&four[..], more].concat());
    assert_eq!((code(&with(&["--part", "1/1"])), code(&with(&["--join"]))), (0, 0));
    let whole = table(&place);
    let other = "there, but of another case, other options or another version of the program: weight=1";
    let left = |joined: &Output, missing: &str| {
        let said = text(&joined.stdout);
        assert!(
            code(joined) == 4 && said.contains(missing) && said.contains("join with the case and options"),
            "{said}"
        );
        assert!(said.contains("unchanged   there: the table there has 4 runs; that of now has 0"), "{said}");
        assert!(!said.contains("results ") && table(&place) == whole, "{said}");
    };
    let more = ["--join", "--set", "optimizer/tolerance=1e-3"];
    let joined = with(&more);
    left(&joined, &format!("missing     4 runs {other} weight=2 weight=3 weight=4"));
    assert!(!text(&joined.stdout).contains("not made"), "{}", text(&joined.stdout));
    std::fs::write(place.path("case.json"), BAR.replace("\"Bar\"", "\"Another bar\"")).unwrap();
    left(&with(&["--join"]), "missing     4 runs there, but");
    std::fs::write(place.path("case.json"), BAR).unwrap();
    assert!(code(&with(&["--join"])) == 0 && table(&place) == whole);
    // Both kinds at once; without a table there one is written.
    std::fs::remove_dir_all(place.path("there/weight=3")).unwrap();
    let joined = with(&more);
    left(&joined, &format!("missing     3 runs {other} weight=2 weight=4"));
    assert!(text(&joined.stdout).contains("missing     1 run not made or not finished: weight=3"));
    std::fs::remove_file(place.path("there/sweep.json")).unwrap();
    let joined = with(&more);
    assert!(code(&joined) == 4 && text(&joined.stdout).contains("results     there"), "{}", text(&joined.stdout));
    assert_eq!(std::fs::read_to_string(place.path("there/sweep.csv")).unwrap().lines().count(), 1);
    // What is missing for another reason is no row of the table.
    assert_eq!(code(&with(&["--join"])), 4);
    assert_eq!(std::fs::read_to_string(place.path("there/sweep.csv")).unwrap().lines().count(), 4);
}
