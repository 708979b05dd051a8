//! What the terminal says beside the table of trials.

#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests

mod common;

use common::{BAR, Heard, Place};
use nastic_case::console::Console;
use nastic_case::run::Options;
use nastic_case::schema::Command;

#[test]
fn distances_from_the_target_are_told_with_their_unit() {
    let place = Place::new();
    let said = place.text(Command::Optimize, BAR, &[]);
    let line = said.lines().find(|line| line.starts_with("distance    tracking: root mean square ")).unwrap();
    let result = place.json("result.json");
    for (key, from) in [("root_mean_square", &result["start"]), ("largest", &result)] {
        let value = from["tracking"]["tracking"][key].as_f64().unwrap();
        let shown = format!("{value:.3e}").replace("e-", "e-0");
        assert!(line.contains(&shown), "{shown} in {line}");
    }
    assert!(line.ends_with(" m"), "{line}");
    assert!(said.contains(" Pa, "), "controls have units:\n{said}");
}

#[test]
fn columns_are_explained_on_request() {
    let place = Place::new();
    let heard = Heard::default();
    let options = Options { explain: true, ..place.options(&["optimizer/max_iterations=1"]) };
    place.run_with(Command::Optimize, BAR, &Console::new(heard.clone()), &options).unwrap();
    let said = heard.text();
    let header = said.lines().find(|line| line.trim_start().starts_with("trial  iter")).unwrap();
    let two = header.replace("min J", "min_J");
    for column in two.split_whitespace() {
        let column = column.replace('_', " ");
        assert!(said.lines().any(|line| line.starts_with(&format!("{column:<12}"))), "{column} in\n{said}");
    }
    assert!(!place.text(Command::Optimize, BAR, &[]).contains("number of the trial"));
}

#[test]
fn a_body_at_rest_is_called_so() {
    let place = Place::new();
    let rest = "equilibrium the state of rest";
    assert!(place.text(Command::Solve, BAR, &["controls/0/start=0"]).contains(rest));
    assert!(!place.text(Command::Solve, BAR, &[]).contains(rest));
}
