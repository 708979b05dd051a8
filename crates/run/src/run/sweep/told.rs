//! What is said of the runs of a sweep.

use crate::console::Console;
use crate::run::sweep::one_run::Origin;
use nastic_language::number::{count, short};
use nastic_report::SweepRow;
use serde_json::Value;
use std::fmt;

/// Missing runs that are named on the terminal.
const NAMED: usize = 5;

/// How many runs of a part came about in which way.
#[derive(Default)]
pub(super) struct Tally {
    made: usize,
    kept: usize,
    interrupted: usize,
    elsewhere: usize,
}

impl Tally {
    pub fn add(&mut self, origin: Origin) {
        *match origin {
            Origin::Made { interrupted: true, .. } => &mut self.interrupted,
            Origin::Made { .. } => &mut self.made,
            Origin::Kept => &mut self.kept,
            Origin::Elsewhere => &mut self.elsewhere,
        } += 1;
    }
}

/// "3 runs made, 1 interrupted": those of which there are some.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { made, kept, interrupted, elsewhere } = *self;
        let all = [(made, "made"), (kept, "kept"), (interrupted, "interrupted"), (elsewhere, "left to others")];
        let mut told = all.into_iter().filter(|(runs, _)| *runs > 0);
        let (runs, how) = told.next().unwrap_or(all[0]);
        write!(f, "{} {how}", count(runs, "run"))?;
        told.try_for_each(|(runs, how)| write!(f, ", {runs} {how}"))
    }
}

/// What is said of one run.
pub(super) fn line(row: &SweepRow, origin: Origin, runs: usize) -> String {
    let number = |figure: &str, label: &str| row.number(figure).map(|value| format!("{label} {}", short(value)));
    let iterations = row.number("iterations").map(|n| count(n as usize, "iteration"));
    let parts = [number("cost/total", "cost"), number("hausdorff/true", "true Hausdorff"), iterations];
    let mut text = format!("{:<12}{}: ", format!("run {}/{runs}", row.index + 1), row.directory);
    text += &parts.into_iter().flatten().chain([format!("exit code {}", row.exit)]).collect::<Vec<_>>().join(", ");
    if let Some(error) = &row.error {
        text += &format!(" ({error})");
    } else if !row.is_done() {
        text += &row.figures.get("stop").and_then(Value::as_str).map_or_else(String::new, |stop| format!(" ({stop})"));
    }
    text += match origin {
        Origin::Made { resumed: true, .. } => "; went on from its checkpoint",
        // The error says who works on it.
        Origin::Made { .. } | Origin::Elsewhere => "",
        Origin::Kept => "; kept",
    };
    if !row.warnings.is_empty() {
        text += &format!("; WARNING: {}", row.warnings.join(", "));
    }
    text
}

/// Names the runs that have no row; `others` of them have a finished result, but not of what is joined.
pub(super) fn say_missing(missing: &[String], others: &[String], console: &Console) {
    let not_made: Vec<&String> = missing.iter().filter(|run| !others.contains(run)).collect();
    let others: Vec<&String> = others.iter().collect();
    if !not_made.is_empty() {
        console.say(format!(
            "missing     {} not made or not finished: {}",
            count(not_made.len(), "run"),
            named(&not_made)
        ));
    }
    if !others.is_empty() {
        let (runs, names) = (count(others.len(), "run"), named(&others));
        console.say(format!(
            "missing     {runs} there, but of another case, other options or another version of the program: {names}"
        ));
        console.say(format!(
            "{:<12}join with the case and options they were made with, or run the parts again with those of now",
            ""
        ));
    }
}

fn named(runs: &[&String]) -> String {
    let more = if runs.len() > NAMED { " .." } else { "" };
    runs.iter().take(NAMED).map(|run| run.as_str()).collect::<Vec<_>>().join(" ") + more
}
