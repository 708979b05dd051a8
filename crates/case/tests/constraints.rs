//! Constraints in case files: what they reach, say and write, and what is wrong with them.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod common;

use common::{Heard, Place, problems};
use nastic_case::catalogue::Catalogue;
use nastic_case::console::Console;
use nastic_case::run::{Exit, Options, Outcome, resume};
use nastic_case::schema::Command;
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const KEEP_OUT: &str = include_str!("../../../examples/cases/keep_out.json");

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn optimize(place: &Place, set: &[&str]) -> (Outcome, String) {
    let heard = Heard::default();
    let outcome = place.run_with(Command::Optimize, KEEP_OUT, &Console::new(heard.clone()), &place.options(set));
    (outcome.unwrap(), heard.text())
}

/// Around the ball: feasible to 1e-8 of the diagonal, at a cost; without the constraint the body is within it.
#[test]
fn a_finger_reaches_around_a_ball() {
    let (place, free) = (Place::new(), Place::new());
    let (found, text) = optimize(&place, &[]);
    assert_eq!(found.exit, Exit::Done, "{text}");
    let constraints = &found.result["constraints"];
    let ball = &constraints["groups"]["ball"];
    let diagonal = (1.0f64 + 0.04 + 0.04).sqrt();
    assert!((number(&ball["scale"]) - diagonal).abs() < 1e-12);
    assert!(number(&constraints["violation"]) <= 1e-8 && number(&ball["violation"]) <= 1e-8 * diagonal);
    assert_eq!((&ball["sense"], &ball["unit"]), (&Value::from("at_most"), &Value::from("m")));
    let active = ball["active"].as_u64().unwrap();
    assert!(active > 0 && active < ball["count"].as_u64().unwrap());
    assert!(text.contains("\nconstraints ball: largest violation "), "{text}");
    assert!(text.contains(" violation ") && text.contains("new multipliers"), "{text}");

    let (unconstrained, text) = optimize(&free, &["constraints=[]", "expect={}"]);
    assert_eq!(unconstrained.exit, Exit::Done, "{text}");
    assert!(unconstrained.result["constraints"].is_null() && !text.contains("violation"));
    let cost = |outcome: &Outcome| number(&outcome.result["cost"]["total"]);
    assert!(cost(&found) > 5.0 * cost(&unconstrained), "{} and {}", cost(&found), cost(&unconstrained));

    // The history has the cost alone beside that with the penalty; both ends agree.
    let history = std::fs::read_to_string(place.path("out/history.jsonl")).unwrap();
    let lines: Vec<Value> = history.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let last = lines.iter().rfind(|line| line["accepted"] == true).unwrap();
    assert!((number(&last["objective"]) - cost(&found)).abs() <= 1e-12 * cost(&found));
    assert!(number(&last["violation"]) <= 1e-8 && number(&last["penalty"]) > 0.0);
    assert!(lines.iter().any(|line| line["reason"] == "multipliers"));
    // The ball is drawn: 11 x 11 x 6 faces more than without.
    let polygons = |place: &Place| std::fs::read_to_string(place.path("out/picture.svg")).unwrap().len();
    assert!(polygons(&place) > polygons(&free) + 10_000, "{} and {}", polygons(&place), polygons(&free));
}

/// Interrupted behind an update of the multipliers and resumed: the same bits.
#[test]
fn resumed_to_the_bit() {
    struct Watch(Arc<AtomicBool>, usize);
    impl std::io::Write for Watch {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.1 = self.1.saturating_sub(std::str::from_utf8(bytes).unwrap().matches("new multipliers").count());
            if self.1 == 0 {
                self.0.store(true, Ordering::Relaxed);
            }
            Ok(bytes.len())
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let short = ["output/checkpoint=3", "optimizer/max_iterations=40"];
    let (whole, pieces) = (Place::new(), Place::new());
    let (uninterrupted, _) = optimize(&whole, &short);
    let options = pieces.options(&short);
    let watch = Watch(options.cancel.clone(), 2);
    let broken = pieces.run_with(Command::Optimize, KEEP_OUT, &Console::new(watch), &options).unwrap();
    assert_eq!(broken.exit, Exit::NotConverged);
    let options = Options { threads: Some(1), ..Options::default() };
    let resumed = resume(&Catalogue::standard(), &pieces.path("out"), &options, &Console::silent()).unwrap();
    assert!(resumed.result["resumed"]["iteration"].as_u64().unwrap() > 0);
    for key in ["constraints", "cost", "controls", "iterations", "trials", "stop"] {
        assert_eq!(resumed.result[key], uninterrupted.result[key], "{key}");
    }
}

#[test]
fn bounds_on_functionals() {
    let bound = |of: &str| {
        let from = KEEP_OUT.find("\"constraints\": [").unwrap();
        let to = KEEP_OUT.find("\"optimizer\"").unwrap();
        format!("{}\"constraints\": [ {of} ], {}", &KEEP_OUT[..from], &KEEP_OUT[to..])
    };
    assert_eq!(
        problems(&bound("{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" }, \"at_most\": 1e6 }")),
        ""
    );
    let wrong = |of: &str, what: &str| {
        let found = problems(&bound(of));
        assert!(found.contains(what), "{of}:\n{found}\nwanted: {what}");
    };
    wrong(
        "{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" } }",
        "exactly one of \"at_most\" and \"equal\"",
    );
    wrong("{ \"cost\": { \"kind\": \"control_norm\", \"of\": \"tension\" }, \"at_most\": 0 }", "needs a \"scale\"");
    wrong(
        "{ \"obstacle\": { \"surface\": \"top\", \"shape\": { \"sphere\": { \"center\": [0, 0, 1], \"radius\": 0.1 } } } }",
        "constraints/0/obstacle/surface",
    );
    wrong(
        "{ \"obstacle\": { \"surface\": \"z+\", \"shape\": { \"sphere\": { \"center\": [0, 0, 1], \"radius\": 0.1 } } }, \"at_most\": 0 }",
        "\"clearance\" in its block",
    );
    wrong(
        "{ \"obstacle\": { \"surface\": \"z+\", \"shape\": { \"half_space\": { \"point\": [0, 0, 1], \"normal\": [0, 0, 0] } } } }",
        "a half-space needs a normal",
    );
    wrong("{ \"obstacle\": { \"surface\": \"z+\", \"shape\": { \"ball\": {} } } }", "sphere");
}
