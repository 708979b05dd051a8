//! Constraints in results.

use super::super::number::short;
use super::super::session::Session;
use crate::lower::CaseProblem;
use nastic_opt::{ConstraintReport, ConstraintsReport, Sense};
use serde_json::{Map, Value, json};

/// Groups of more values than this list their active ones alone.
const FEW: usize = 20;

/// `{ "violation", "penalty", "updates", "groups": { NAME: { "sense", "values", "active", "violation", "scale", "unit", .. } } }`; nothing without
/// constraints.
pub(super) fn json(problem: &CaseProblem, all: &ConstraintsReport) -> Option<Value> {
    let groups: Map<String, Value> =
        all.groups.iter().zip(units(problem)).map(|(one, unit)| (one.group.name.clone(), group(one, unit))).collect();
    let out = json!({ "violation": all.violation, "penalty": all.penalty, "updates": all.updates, "groups": groups });
    (!all.groups.is_empty()).then_some(out)
}

fn group(one: &ConstraintReport, unit: Option<&str>) -> Value {
    let sense = if one.group.sense == Sense::Equal { "equal" } else { "at_most" };
    let largest = one.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut out = json!({
        "sense": sense, "count": one.values.len(), "active": one.active(), "violation": one.violation(),
        "largest": largest, "scale": one.group.scale, "unit": unit,
    });
    if one.values.len() <= FEW {
        (out["values"], out["multipliers"]) = (json!(one.values), json!(one.multipliers));
    } else {
        let touching = one.multipliers.iter().enumerate().filter(|(_, y)| **y != 0.0);
        let entry = |(k, y): (usize, &f64)| json!({ "index": k, "value": one.values[k], "multiplier": y });
        out["touching"] = touching.map(entry).collect();
    }
    out
}

/// The unit of every group that has one: lengths so far.
fn units(problem: &CaseProblem) -> impl Iterator<Item = Option<&str>> {
    let length = problem.units().length().symbol;
    let members = problem.members().flat_map(|member| member.reduced().constraint_terms());
    members.map(move |constraint| (constraint.unit() == "m").then_some(length))
}

/// A line for every group.
pub(super) fn say(session: &Session<'_>, all: &ConstraintsReport) {
    for (k, (one, unit)) in all.groups.iter().zip(units(&session.problem)).enumerate() {
        let head = if k == 0 { "constraints" } else { "" };
        let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let most = one.multipliers.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        session.console.say(format!(
            "{head:<12}{}: largest violation {}{unit} ({} of its scale), {} of {} active, largest multiplier {}",
            one.group.name,
            short(one.violation()),
            short(one.violation() / one.group.scale),
            one.active(),
            one.values.len(),
            short(most)
        ));
    }
}
