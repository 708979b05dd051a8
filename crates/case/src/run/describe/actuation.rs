//! The actuations in words and as JSON.

use super::{Line, catalogue_of, law, line, parameters, scalar, vector_field};
use crate::lower::CaseProblem;
use crate::quantity::Dimension;
use crate::run::number::quantity;
use crate::schema::{Fixed, Means};
use nastic_fem::BodyEnergy;
use serde_json::{Value, json};

pub(in crate::run) fn actuation(problem: &CaseProblem) -> Vec<Line> {
    let mut out = Vec::new();
    for actuation in &problem.case.actuation {
        let units = problem.units();
        let place = match &actuation.means {
            Means::Law { row, region, parameters: given } => {
                let values = parameters(given, &catalogue_of(row.forms), units);
                if values.is_empty() { region.to_string() } else { format!("{region}; {values}") }
            }
            Means::Contribution { values, .. } => {
                let told = |(key, names): (&&str, &Vec<String>)| format!("{key} {}", names.join(", "));
                let names = values.names.iter().filter(|(_, names)| !names.is_empty()).map(told);
                names.chain(values.flags.iter().map(ToString::to_string)).collect::<Vec<_>>().join("; ")
            }
        };
        out.push(line("actuation", format!("{}: {} on {place}", actuation.name, actuation.kind())));
        out.push(line("actuation", format!("  {}", actuation.about())));
        if let Some(volume) = volume_at_rest(problem, &actuation.name) {
            let dimension = if problem.mesh().dim() == 2 { AREA } else { VOLUME };
            out.push(line("actuation", format!("  volume at rest {}", quantity(volume, dimension, units))));
        }
        if let Some(limit) = limit(problem, &actuation.name, BodyEnergy::fiber_limit) {
            let limit = quantity(limit, Dimension::PRESSURE, units);
            out.push(line("actuation", format!("  the law stays polyconvex up to a tension of {limit}")));
        }
        if let Some((beside, joint)) = together(problem, &actuation.name) {
            let joint = quantity(joint, Dimension::PRESSURE, units);
            let beside = beside.join(", ");
            out.push(line("actuation", format!("  with that of {beside} on the same cells, all alike, up to {joint}")));
        }
        for (key, fixed) in &actuation.fixed {
            let value = match fixed {
                Fixed::Scalar(value) => scalar(value, Dimension::NONE, units),
                Fixed::Vector(value) => vector_field(value),
            };
            out.push(line("actuation", format!("  fixed {key} {value}")));
        }
    }
    out
}

/// The actuations as `check --json` has them.
pub(super) fn json(problem: &CaseProblem) -> Value {
    let actuations = problem.case.actuation.iter().map(|a| {
        let mut entry = match &a.means {
            Means::Law { row, region, parameters } => law(problem, region, row.name, parameters, row.forms),
            Means::Contribution { kind, values, .. } => {
                let mut entry = json!({ "kind": kind });
                values.names.iter().for_each(|(key, names)| entry[*key] = json!(names));
                values.flags.iter().for_each(|key| entry[*key] = json!(true));
                entry["reference_volume"] = json!(volume_at_rest(problem, &a.name));
                entry
            }
        };
        entry["name"] = json!(a.name);
        entry["fiber_limit"] = json!(limit(problem, &a.name, BodyEnergy::fiber_limit));
        if let Some((beside, joint)) = together(problem, &a.name) {
            entry["joint_fiber_limit"] = json!(joint);
            entry["beside"] = json!(beside);
        }
        entry
    });
    actuations.collect()
}

/// The smallest bound on a tension of all members.
fn limit(problem: &CaseProblem, actuation: &str, bound: impl Fn(&BodyEnergy, usize) -> Option<f64>) -> Option<f64> {
    let of = |body: &BodyEnergy| bound(body, number(body, actuation)?);
    problem.members().filter_map(|member| of(member.solid().body())).reduce(f64::min)
}

/// The families beside one on its cells, and what all of them may reach at once.
fn together(problem: &CaseProblem, actuation: &str) -> Option<(Vec<String>, f64)> {
    let body = problem.solid().body();
    let joint = limit(problem, actuation, BodyEnergy::joint_fiber_limit)?;
    let beside: Vec<String> = body.families_beside(number(body, actuation)?).into_iter().map(str::to_owned).collect();
    (!beside.is_empty()).then_some((beside, joint))
}

fn number(body: &BodyEnergy, actuation: &str) -> Option<usize> {
    body.actuations().iter().position(|attached| attached.name == actuation)
}

const VOLUME: Dimension = Dimension::of(3, 0, 0, 0);
/// In plane strain.
const AREA: Dimension = Dimension::of(2, 0, 0, 0);

/// The volume that a contribution of that name reports of itself at rest.
fn volume_at_rest(problem: &CaseProblem, name: &str) -> Option<f64> {
    let solid = problem.solid();
    let rest = solid.rest();
    let at = nastic_fem::Instant::new(&rest.u, &rest.controls, 0.0);
    let all = solid.model().quantities(&at).unwrap_or_default();
    all.into_iter().find(|(of, what, _)| of == name && *what == "volume").map(|(.., value)| value)
}
