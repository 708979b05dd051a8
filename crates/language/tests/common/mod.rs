//! Cases with one mistake.

#![allow(dead_code, clippy::unwrap_used, clippy::panic)] // helpers of several tests

use nastic_language::schema::Case;
use nastic_language::syntax::Document;

/// A case with a block of nearly every kind.
pub const COMPLETE: &str = include_str!("../cases/complete.json");

/// All problems of `text` after replacing `from` by `to`, which must occur.
pub fn problems_with(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "nothing to replace: {from}");
    let broken = text.replacen(from, to, 1);
    let read = Document::parse("case.json", &broken).and_then(|document| Case::read(&document));
    read.map_or_else(|problems| problems.to_string(), |_| String::new())
}

/// Expects one problem, ending so; its place is checked where it matters.
pub fn one(text: &str, from: &str, to: &str, ending: &str) {
    let found = problems_with(text, from, to);
    assert_eq!(found.lines().count(), 1, "{from} -> {to}:\n{found}");
    assert!(found.ends_with(ending), "{from} -> {to}:\n{found}\nwanted: {ending}");
}
