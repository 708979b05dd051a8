//! Sensitivities and the law of `nastic gains`: as a part of the page, as a table, as a C header, in sentences.

mod header;
mod remarks;

pub use header::header;
pub use remarks::remarks;

use crate::csv;
use crate::html::{paragraph, section, table};
use crate::number::number;
use crate::record::{GainsLoopRecord, GainsOutputRecord, GainsRecord, Number, RunRecord};
use serde_json::{Map, Value, json};

/// One row per output, those without a target behind the others: value, target, weight, its row of S by control, its column of L.
#[must_use]
pub fn rows(found: &GainsRecord) -> String {
    let by_control = |of: &dyn Fn(usize) -> Number| -> Map<String, Value> {
        let controls = found.controls.iter().enumerate();
        controls.map(|(j, control)| (control.name.clone(), json!(of(j)))).collect()
    };
    let row = |(i, one): (usize, &GainsOutputRecord)| {
        let gain = |j: usize| found.gain[j].get(i).copied().unwrap_or_default();
        json!({
            "output": one.name, "unit": one.unit, "value": one.value, "target": one.target, "weight": one.weight,
            "sensitivity": by_control(&|j| one.sensitivities[j]), "gain": by_control(&gain),
        })
    };
    let rows: Vec<Value> = found.outputs.iter().chain(found.watched.iter().flatten()).enumerate().map(row).collect();
    csv::table(&rows)
}

/// The law on every body, and the sensitivities.
pub(crate) fn section_of(result: &RunRecord) -> String {
    let Some(found) = &result.gains else { return String::new() };
    let body = |(name, one): (&str, &GainsLoopRecord)| {
        let ends = [one.errors.first(), one.errors.last(), Some(&one.unreachable), Some(&one.contraction)];
        let numbers = ends.map(|value| number(value.and_then(|value| **value), ""));
        [vec![name.to_owned()], numbers.to_vec()].concat()
    };
    let scenarios = found.scenarios.iter().flatten().map(|(name, one)| (name.as_str(), one));
    let bodies: Vec<Vec<String>> = std::iter::once(("the case", &found.nominal)).chain(scenarios).map(body).collect();
    let output = |one: &GainsOutputRecord| {
        let own = [one.value, one.target].map(|value| number(*value, &one.unit)).to_vec();
        let by = one.sensitivities.iter().map(|value| number(**value, ""));
        [vec![one.name.clone()], own, by.collect()].concat()
    };
    let outputs: Vec<Vec<String>> = found.outputs.iter().chain(found.watched.iter().flatten()).map(output).collect();
    let controls = found.controls.iter().map(|one| format!("by {} [{}]", one.name, one.unit));
    let head: Vec<String> = ["output", "value", "target"].map(str::to_owned).into_iter().chain(controls).collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let remarks: String = found.remarks.iter().flatten().map(|remark| paragraph(&format!("{remark}."))).collect();
    let content = remarks
        + &table(&["body", "error, open loop", "closed loop", "unreachable", "contraction"], &bodies)
        + &table(&head, &outputs);
    section("gains", "Sensitivities and law", &content)
}
