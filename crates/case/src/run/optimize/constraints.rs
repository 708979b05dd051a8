//! Constraints in results.

use super::super::number::short;
use super::super::session::Session;
use crate::lower::{CaseMember, CaseProblem};
use crate::warning::{BETWEEN_NODES, Warning};
use nastic_control::{BetweenNodes, Constraint, EnsemblePoint, Evaluated};
use nastic_opt::{AugmentedLagrangian, ConstraintReport, ConstraintsReport, Sense};
use serde_json::{Map, Value, json};

/// Groups of more values than this list their active ones alone.
const FEW: usize = 20;

/// `{ "violation", "penalty", "updates", "groups": { NAME: { "sense", "values", "active", "violation", "scale", "unit", .. } } }`; nothing without
/// constraints.
pub(super) fn json(problem: &CaseProblem, all: &ConstraintsReport, point: &EnsemblePoint) -> Option<Value> {
    let of = |(one, known): (&ConstraintReport, Known<'_>)| (one.group.name.clone(), group(one, &known));
    let groups: Map<String, Value> = all.groups.iter().zip(known(problem, point)).map(of).collect();
    let out = json!({ "violation": all.violation, "penalty": all.penalty, "updates": all.updates, "groups": groups });
    (!all.groups.is_empty()).then_some(out)
}

fn group(one: &ConstraintReport, known: &Known<'_>) -> Value {
    let sense = if one.group.sense == Sense::Equal { "equal" } else { "at_most" };
    let largest = one.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut out = json!({
        "sense": sense, "count": one.values.len(), "active": one.active(), "violation": one.violation(),
        "largest": largest, "scale": one.group.scale, "unit": known.unit,
    });
    if let Some((index, value)) = worst(one) {
        let place = known.node(index);
        let (node, position) = (place.map(|(node, _)| node), place.map(|(_, x)| x));
        out["worst"] = json!({ "index": index, "value": value, "node": node, "position": position });
    }
    if let Some(BetweenNodes { distance, position }) = known.between {
        out["between_nodes"] = json!({ "distance": distance, "position": position });
    }
    if one.values.len() <= FEW {
        (out["values"], out["multipliers"]) = (json!(one.values), json!(one.multipliers));
    } else {
        let touching = one.multipliers.iter().enumerate().filter(|(_, y)| **y != 0.0);
        let entry = |(k, y): (usize, &f64)| json!({ "index": k, "value": one.values[k], "multiplier": y });
        out["touching"] = touching.map(entry).collect();
    }
    out
}

/// What the problem knows of a group beside its values.
pub(super) struct Known<'p> {
    /// The unit of its values, where they have one: lengths so far.
    unit: Option<&'p str>,
    /// The nodes that its values belong to.
    nodes: Option<&'p [u32]>,
    member: CaseMember<'p>,
    at: &'p Evaluated,
    between: Option<BetweenNodes>,
}

impl Known<'_> {
    /// The node of a value, and where it is in the deformed body.
    fn node(&self, index: usize) -> Option<(u32, [f64; 3])> {
        let node = *self.nodes?.get(index)?;
        let dim = self.member.solid().discretization().dim();
        let mut x = *self.member.mesh().points().get(node as usize)?;
        x.iter_mut().zip(self.at.state.u.iter().skip(node as usize * dim).take(dim)).for_each(|(x, u)| *x += u);
        Some((node, x))
    }
}

/// Group by group.
pub(super) fn known<'p>(problem: &'p CaseProblem, point: &'p EnsemblePoint) -> impl Iterator<Item = Known<'p>> {
    let length = problem.units().length().symbol;
    problem.members().zip(&point.members).flat_map(move |(member, at)| {
        let terms = member.reduced().constraint_terms().iter().map(Box::as_ref).zip(member.reduced().between_nodes(at));
        let of = move |(term, between): (&'p dyn Constraint, Option<BetweenNodes>)| {
            let unit = (term.unit() == "m").then_some(length);
            Known { unit, nodes: term.nodes(), member, at, between }
        };
        terms.map(of).collect::<Vec<_>>()
    })
}

/// The value that violates its constraint most, or comes closest to that, and its index.
fn worst(one: &ConstraintReport) -> Option<(usize, f64)> {
    let size = |c: f64| if one.group.sense == Sense::Equal { c.abs() } else { c };
    let values = one.values.iter().copied().enumerate();
    values.max_by(|a, b| size(a.1).total_cmp(&size(b.1)).then(b.0.cmp(&a.0)))
}

/// Where every node keeps its distance and the body between nodes is inside of the obstacle.
pub(super) fn warnings(problem: &CaseProblem, all: &ConstraintsReport, point: &EnsemblePoint) -> Vec<Warning> {
    let feasibility = AugmentedLagrangian::default().feasibility;
    let of = |(one, known): (&ConstraintReport, Known<'_>)| {
        let (tolerance, between) = (feasibility * one.group.scale, known.between?);
        let unit = known.unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let message = format!(
            "{}: between nodes the body is up to {}{unit} inside of the obstacle, at ({})",
            one.group.name,
            short(-between.distance),
            between.position.map(short).join(", ")
        );
        let entered = between.distance < -tolerance && one.violation() <= tolerance;
        entered.then(|| Warning::new(&BETWEEN_NODES, message))
    };
    all.groups.iter().zip(known(problem, point)).filter_map(of).collect()
}

/// A line for every group.
pub(super) fn say(session: &Session<'_>, all: &ConstraintsReport, point: &EnsemblePoint) {
    for (k, (one, known)) in all.groups.iter().zip(known(&session.problem, point)).enumerate() {
        let head = if k == 0 { "constraints" } else { "" };
        let unit = known.unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let most = one.multipliers.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let place = worst(one).filter(|_| one.violation() > 0.0).and_then(|(index, _)| known.node(index));
        let place =
            place.map_or_else(String::new, |(node, x)| format!(" at node {node} ({})", x.map(short).join(", ")));
        session.console.say(format!(
            "{head:<12}{}: largest violation {}{unit}{place} ({} of its scale), {} of {} active, largest multiplier {}",
            one.group.name,
            short(one.violation()),
            short(one.violation() / one.group.scale),
            one.active(),
            one.values.len(),
            short(most)
        ));
    }
}
