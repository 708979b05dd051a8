//! The table of a sweep and what is said of it before any run is made.

use crate::console::Console;
use crate::run::sweep::Sweep;
use nastic_case::lower::{Axis, SweepPlan, Swept, sweep_times};
use nastic_language::number::count;
use nastic_report::record::{SweepRecord, SweptRecord};
use nastic_report::{SweepAxis, SweepTable, case_name};
use serde_json::Value;
use std::path::Path;

/// The table without rows.
pub(super) fn table(plan: &SweepPlan, sweep: &Sweep, case: &Path) -> SweepTable {
    let name = || case_name(&case.display().to_string());
    let title = plan.document.json()["title"].as_str().map_or_else(name, str::to_owned);
    let (swept, fixed): (Vec<&Swept>, Vec<&Swept>) = plan.swept.iter().partition(|one| one.is_swept());
    let Axis { label, places, is_named } = Axis::of(swept[0]);
    let of = |one: &&Swept| SweptRecord { path: one.path.clone(), values: one.values.clone() };
    let asked = SweepRecord {
        command: sweep.command.name().to_owned(),
        case: case.display().to_string(),
        swept: swept.iter().map(of).collect(),
        fixed: fixed.into_iter().map(|one| one.setting(0)).collect(),
        warm: sweep.warm,
        planned: plan.runs.len(),
        quantity: sweep.quantity.clone(),
        ..SweepRecord::default()
    };
    SweepTable {
        title: format!("{title}: sweep"),
        asked,
        axis: SweepAxis { label, places, is_named },
        times: sweep_times(&plan.swept, plan.runs.len()),
        rows: Vec::new(),
        missing: Vec::new(),
        exit: 0,
    }
}

/// Says what will be run.
pub(super) fn introduce(plan: &SweepPlan, sweep: &Sweep, console: &Console) {
    let several = plan.swept.iter().filter(|one| one.is_swept()).count() > 1;
    let how = if several { ", all combinations" } else { "" };
    console.say(format!("sweep       {} of {}{how}", count(plan.runs.len(), "run"), sweep.command.name()));
    for one in &plan.swept {
        let head = if one.is_swept() { "swept" } else { "fixed" };
        console.say(format!("{head:<12}{} = {}", one.path, one.values.join(", ")));
    }
    if sweep.warm {
        let how = "every run after the first starts from the controls of the last one before that has some";
        console.say(format!("warm        {how}"));
    }
}

/// Rows of the table in a directory, if there is one.
pub(super) fn rows_there(directory: &Path) -> Option<usize> {
    let table: Value = serde_json::from_slice(&std::fs::read(directory.join("sweep.json")).ok()?).ok()?;
    table["runs"].as_array().map(Vec::len)
}
