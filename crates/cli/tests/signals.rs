//! Signals that ask the program to stop.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)] // a test may

use crate::common;

use common::{BAR, CaseDirectory, code, signal, start, text};
use std::os::unix::process::ExitStatusExt;

/// Far more iterations than there is time for.
const LONG: [&str; 8] = [
    "optimize",
    "case.json",
    "--set",
    "optimizer/max_iterations=100000",
    "--set",
    "optimizer/tolerance=1e-15",
    "--set",
    "optimizer/method=projected_gradient",
];

#[test]
fn sigint_and_sigterm_keep_what_was_found() {
    for name in ["INT", "TERM"] {
        let place = CaseDirectory::new(BAR);
        let mut child = start(place.program(&LONG));
        place.wait_for_lines("out/case/history.jsonl", 4, &mut child);
        assert!(signal(&child, name));
        let output = child.wait_with_output().unwrap();
        assert_eq!(code(&output), 4, "SIG{name}: {}", text(&output.stderr));
        assert!(text(&output.stderr).contains("stopping after the step at hand"), "{}", text(&output.stderr));
        let result = std::fs::read(place.path("out/case/result.json")).unwrap();
        let result: serde_json::Value = serde_json::from_slice(&result).unwrap();
        assert_eq!(result["stop"], "cancelled");
        nastic_io::read_snapshot(place.path("out/case/optimum.vtu")).unwrap();
    }
}

#[test]
fn a_sweep_ends_with_the_run_at_hand() {
    let place = CaseDirectory::new(BAR);
    let mut arguments = LONG.to_vec();
    arguments[0] = "sweep";
    arguments.extend(["--set", "costs/0/weight=1,2"]);
    let mut child = start(place.program(&arguments));
    place.wait_for_lines("out/case/weight=1/history.jsonl", 4, &mut child);
    assert!(signal(&child, "INT"));
    let output = child.wait_with_output().unwrap();
    assert_eq!(code(&output), 4, "{}", text(&output.stderr));
    assert!(
        text(&output.stdout).contains("missing     1 run not made or not finished: weight=2"),
        "{}",
        text(&output.stdout)
    );
    assert_eq!(std::fs::read_to_string(place.path("out/case/sweep.csv")).unwrap().lines().count(), 2);
    assert!(place.path("out/case/weight=1/optimum.vtu").exists() && !place.path("out/case/weight=2").exists());
}

/// The same part twice at the same time: the run is left to the first, and that ends by a signal. No run is made.
#[test]
fn a_part_tells_runs_that_were_stopped_and_those_of_others_from_those_it_made() {
    let place = CaseDirectory::new(BAR);
    let mut arguments = LONG.to_vec();
    arguments[0] = "sweep";
    arguments.extend(["--set", "output/checkpoint=2", "--set", "costs/0/weight=1,2", "--part", "1/2"]);
    let (history, closing) = ("out/case/weight=1/history.jsonl", "; --join makes the table when all parts are done");
    let mut first = start(place.program(&arguments));
    place.wait_for_lines(history, 8, &mut first);
    assert!(place.path("out/case/weight=1/checkpoint.bin").exists());
    let second = place.nastic(&arguments);
    let said = text(&second.stdout);
    assert!(
        code(&second) == 7 && said.contains("exit code 7 (") && said.contains("in use by another program"),
        "{said}"
    );
    assert!(
        !said.contains("went on") && said.contains(&format!("part 1/2    1 run left to others{closing}")),
        "{said}"
    );
    assert!(signal(&first, "TERM"));
    let output = first.wait_with_output().unwrap();
    let said = text(&output.stdout);
    assert!(code(&output) == 4 && said.contains(&format!("part 1/2    1 run interrupted{closing}")), "{said}");
    // It goes on, and is stopped once more.
    let lines = std::fs::read_to_string(place.path(history)).unwrap().lines().count();
    let mut third = start(place.program(&arguments));
    place.wait_for_lines(history, lines + 4, &mut third);
    assert!(signal(&third, "TERM"));
    let said = text(&third.wait_with_output().unwrap().stdout);
    assert!(said.contains("(cancelled); went on from its checkpoint") && said.contains("1 run interrupted;"), "{said}");
}

#[test]
fn a_program_that_is_to_outlive_its_terminal_does() {
    let place = CaseDirectory::new(BAR);
    // What nohup does before it starts a program.
    let mut child = start(place.shell("trap '' HUP", &LONG));
    place.wait_for_lines("out/case/history.jsonl", 4, &mut child);
    assert!(signal(&child, "HUP"));
    let lines = std::fs::read_to_string(place.path("out/case/history.jsonl")).unwrap().lines().count();
    place.wait_for_lines("out/case/history.jsonl", lines + 4, &mut child);
    assert!(signal(&child, "KILL"));
    assert_eq!(child.wait_with_output().unwrap().status.signal(), Some(9));
}
