//! Control fields and optimiser in words.

use super::line::{Line, line};
use super::time;
use crate::film::{kilovolts, voltages};
use crate::lower::{Admitted, CaseProblem, ControlField, grid_cells};
use nastic_ensemble::EnsembleBlock;
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Metric;

/// The control fields.
pub fn controls(problem: &CaseProblem) -> Vec<Line> {
    let fields = problem.ensemble.blocks().iter().zip(&problem.controls);
    let of = |(place, field): (&EnsembleBlock, &ControlField)| {
        let (block, shared) =
            (problem.control_block(place), problem.leads().nth(1).is_some() && field.load_case.is_none());
        let shared = if shared { ", shared by all load cases" } else { "" };
        let values = &block.values_of(place.of(&problem.start))[..];
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let unit = behind(&field.unit);
        let start = if low == high { short(low) } else { format!("{} to {}", short(low), short(high)) };
        let volts = voltages(problem.member(place.owner), block, values);
        let volts = volts.map_or_else(String::new, |volts| format!(" ({} over the film at rest)", kilovolts(volts)));
        let components =
            if block.components > 1 { format!(" of {} components", block.components) } else { String::new() };
        let unknowns = count(block.basis.len(), "unknown");
        let admitted = admitted(field);
        let knots = time::knots(problem, block, &field.array);
        let grid =
            block.basis.grid().map(|grid| format!(" of {} cells", grid_cells(grid.cells(), problem.mesh().dim())));
        line(
            "controls",
            format!(
                "{}: by {}{}{knots}, {unknowns}{components}{}{}, start {start}{unit}{volts}, {admitted}{shared}",
                field.name,
                block.basis.space().name(),
                grid.unwrap_or_default(),
                if block.log { " by their logarithms" } else { "" },
                field_chain(problem, field)
            ),
        )
    };
    fields.map(of).collect()
}

/// What stands in front of a field, in words.
fn field_chain(problem: &CaseProblem, field: &ControlField) -> String {
    let all = problem.leads().flat_map(|member| &member.case().controls);
    let Some(control) = all.into_iter().find(|control| control.at == field.at) else { return String::new() };
    let held = control.fixed.iter().map(|(region, value)| format!("{} in {region}", value.text()));
    let mirrored =
        (!control.symmetry.is_empty()).then(|| format!("symmetric about {}", count(control.symmetry.len(), "plane")));
    let length = |length| format!("filtered over {}", quantity(length, Dimension::LENGTH, problem.units()));
    let projected = control.projection.as_ref().map(|own| {
        let sharpness: Vec<String> = own.sharpness.0.iter().map(|own| short(*own)).collect();
        format!("projected about {} with sharpness {}", short(own.eta), sharpness.join(", then "))
    });
    let cut = control.cut.map(|level| format!("cut at {}", short(level)));
    let links = held.chain(mirrored).chain(control.filter.map(length)).chain(projected).chain(cut);
    links.map(|link| format!(", {link}")).collect()
}

/// A unit behind a number; nothing of a pure number.
fn behind(unit: &str) -> String {
    if unit == "1" { String::new() } else { format!(" {unit}") }
}

fn admitted(field: &ControlField) -> String {
    let unit = behind(&field.unit);
    match field.admitted {
        Admitted::Between { lower, upper } => format!("within [{}, {}]{unit}", short(lower), short(upper)),
        Admitted::Norm(norm) => format!("of length {}{unit}", short(norm)),
        Admitted::MaxNorm(most) => format!("no longer than {}{unit}", short(most)),
        Admitted::Any => "unbounded".to_owned(),
    }
}

/// The optimiser; nothing where there is nothing to optimise.
pub fn optimizer(problem: &CaseProblem) -> Vec<Line> {
    if problem.start.is_empty() || !problem.has_costs() {
        return vec![];
    }
    let block = &problem.case.optimizer;
    let metric = match block.metric {
        Metric::L2 => "L2 (lumped)".to_owned(),
        Metric::H1(length) => format!("H1 of length {}", quantity(length, Dimension::LENGTH, problem.units())),
    };
    let text = format!(
        "{}, at most {} iterations, tolerance {}{} on the projected gradient, metric {metric}",
        block.method.name(),
        block.max_iterations,
        short(block.tolerance),
        if block.absolute_tolerance > 0.0 {
            format!(" (absolute {})", short(block.absolute_tolerance))
        } else {
            String::new()
        }
    );
    vec![line("optimizer", text)]
}
