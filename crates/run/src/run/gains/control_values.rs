//! The values of a case's controls, each by its name.

use nastic_case::lower::{CaseProblem, ControlField};
use nastic_control::{Basis, Space};
use nastic_report::record::GainsControlRecord;

const AXES: [&str; 3] = ["x", "y", "z"];

/// All, in the order of the control vector; R is not known yet.
pub(super) fn of(problem: &CaseProblem, m: &[f64]) -> Vec<GainsControlRecord> {
    let mut out = Vec::new();
    for (block, field) in problem.ensemble.blocks().iter().zip(&problem.controls) {
        let own = problem.control_block(block);
        let largest = block.of(m).iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        for (i, value) in block.of(m).iter().enumerate() {
            let [lower, upper] = bounds(field, i);
            let range = (lower.is_finite() && upper.is_finite()).then_some(upper - lower);
            let scale = range.unwrap_or(largest);
            out.push(GainsControlRecord {
                name: field.name.clone() + &part(&own.basis, i / own.components) + &component(own.components, i),
                unit: field.unit.clone(),
                value: (*value).into(),
                lower: Some(lower).filter(|bound| bound.is_finite()).into(),
                upper: Some(upper).filter(|bound| bound.is_finite()).into(),
                scale: if scale > 0.0 { scale } else { 1.0 }.into(),
                ..GainsControlRecord::default()
            });
        }
    }
    out
}

/// The bounds of every value, infinite where there are none.
pub(super) fn all_bounds(problem: &CaseProblem) -> Vec<[f64; 2]> {
    let blocks = problem.ensemble.blocks().iter().zip(&problem.controls);
    blocks.flat_map(|(block, field)| (0..block.len).map(|i| bounds(field, i))).collect()
}

fn bounds(field: &ControlField, i: usize) -> [f64; 2] {
    field.bounds.as_ref().map_or([f64::NEG_INFINITY, f64::INFINITY], |bounds| bounds.at(i).into())
}

/// Where an unknown of a basis is; nothing of the only one.
fn part(basis: &Basis, unknown: usize) -> String {
    match basis.space() {
        Space::Uniform => String::new(),
        Space::Region => format!(".{}", basis.region(unknown)),
        _ => format!(".{unknown}"),
    }
}

fn component(components: usize, i: usize) -> String {
    if components == 1 { String::new() } else { format!(".{}", AXES.get(i % components).copied().unwrap_or_default()) }
}
