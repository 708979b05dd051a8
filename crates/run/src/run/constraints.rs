//! Constraints in results.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::session::{CommandInput, Destination};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{BETWEEN_NODES, VIOLATED, Warning};
use nastic_control::{BetweenNodes, Bound, ControlError, Evaluated};
use nastic_ensemble::EnsemblePoint;
use nastic_fem::State;
use nastic_language::number::short;
use nastic_opt::{AugmentedLagrangian, Constrained, ConstraintReport, ConstraintsReport, Sense};
use nastic_report::record::{
    BetweenNodesRecord, ConstraintGroupRecord, ConstraintValueRecord, ConstraintsRecord, Number, numbers,
};

/// Groups of more values than this list their active ones alone.
const FEW: usize = 20;

/// What the problem knows of a group beside its values.
#[derive(Default)]
pub(super) struct Known {
    /// The unit of its values, where they have one: lengths so far.
    unit: Option<&'static str>,
    /// Of a bounded functional.
    bound: Option<Bound>,
    /// The largest value, or the one farthest from zero of an equality.
    worst: Option<Worst>,
    /// The nodes that the values of one instant belong to, where they do.
    nodes: Vec<u32>,
    /// The instants of a motion at which it holds; none of an equilibrium.
    times: Vec<f64>,
    /// The smallest distance between nodes, with the instant of a motion.
    between: Option<(BetweenNodes, Option<f64>)>,
}

/// The value that violates its constraint most, or comes closest to that.
struct Worst {
    index: usize,
    value: f64,
    /// The number of its state.
    state: usize,
    /// Where its node is in the deformed body.
    position: Option<[f64; 3]>,
}

impl Known {
    /// Behind a value.
    fn unit(&self) -> String {
        self.unit.map_or_else(String::new, |unit| format!(" {unit}"))
    }

    /// The functional with its bound, in words.
    fn functional(&self) -> Option<String> {
        let (bound, worst) = self.bound.zip(self.worst.as_ref())?;
        let value = short(bound.functional(worst.value));
        Some(format!("{value}{unit}, {bound}{unit}", unit = self.unit()))
    }

    /// The node of its worst value, in words.
    fn place(&self) -> Option<String> {
        let worst = self.worst.as_ref()?;
        let (node, x) = self.node(worst.index).zip(worst.position)?;
        Some(format!("node {node} ({})", x.map(short).join(", ")))
    }

    /// The node that a value belongs to, of a group with nodes.
    fn node(&self, index: usize) -> Option<u32> {
        self.nodes.get(index % self.nodes.len().max(1)).copied()
    }

    /// The instant of a value among so many, of a motion.
    fn time(&self, index: usize, values: usize) -> Option<f64> {
        self.times.get(index * self.times.len() / values.max(1)).copied()
    }
}

/// Looks where constraints are violated most, group by group. A motion that keeps few states in memory runs once more.
pub(super) fn look_at(
    input: &CommandInput,
    destination: &Destination,
    all: &ConstraintsReport,
    point: &EnsemblePoint,
) -> Result<Vec<Known>, RunError> {
    let (mut groups, mut found) = (all.groups.iter(), Vec::new());
    if all.groups.is_empty() {
        return Ok(found);
    }
    for (member, at) in input.problem.members().zip(&point.members) {
        let own: Vec<&ConstraintReport> = groups.by_ref().take(member.reduced().constraints().len()).collect();
        let failed = |error| destination.member_failed(input, member.index(), error);
        found.extend(look(member, at, &own).map_err(failed)?);
    }
    Ok(found)
}

fn look(member: CaseMember<'_>, at: &Evaluated, groups: &[&ConstraintReport]) -> Result<Vec<Known>, ControlError> {
    let (reduced, length) = (member.reduced(), member.problem().units().length().symbol);
    let terms = reduced.constraint_terms();
    let instants = reduced.timeline().map(|timeline| timeline.instants());
    // behind the constraints on states stand the limited rates, which belong to no state
    let of_no_state = |group: &&ConstraintReport| {
        let worst = worst(group).map(|(index, value)| Worst { index, value, state: usize::MAX, position: None });
        Known { worst, ..Known::default() }
    };
    let mut found: Vec<Known> = groups.iter().map(of_no_state).collect();
    for (k, ((term, group), known)) in terms.iter().zip(groups).zip(&mut found).enumerate() {
        let states = reduced.constraint_states(k);
        known.bound = term.bound();
        known.unit = (term.unit() == "m").then_some(length);
        known.nodes = term.nodes().unwrap_or_default().to_vec();
        known.times = instants.map_or_else(Vec::new, |instants| states.iter().map(|n| instants[*n]).collect());
        if let Some(worst) = &mut known.worst {
            worst.state = states.get(worst.index * states.len() / group.values.len()).copied().unwrap_or(0);
        }
    }
    if terms.iter().all(|term| term.nodes().is_none()) {
        return Ok(found);
    }
    reduced.for_each_state(at, &mut |n, state| {
        let between = reduced.between_nodes(&at.m, n, state)?;
        let time = instants.map(|_| state.time);
        for (between, known) in between.into_iter().zip(&mut found) {
            let node = known.worst.as_ref().filter(|worst| worst.state == n).and_then(|worst| known.node(worst.index));
            if let (Some(worst), Some(node)) = (&mut known.worst, node) {
                worst.position = position(member, node, state);
            }
            let least = known.between.as_ref().map_or(f64::INFINITY, |(known, _)| known.distance);
            if let Some(between) = between.filter(|between| between.distance < least) {
                known.between = Some((between, time));
            }
        }
        Ok(())
    })?;
    Ok(found)
}

/// Where a node is in the deformed body.
fn position(member: CaseMember<'_>, node: u32, state: &State) -> Option<[f64; 3]> {
    let dim = member.solid().discretization().dim();
    let mut x = *member.mesh().points().get(node as usize)?;
    let u = member.solid().model().displacement(&state.u);
    x.iter_mut().zip(u.iter().skip(node as usize * dim).take(dim)).for_each(|(x, u)| *x += u);
    Some(x)
}

/// The index of the worst value, and the value.
fn worst(one: &ConstraintReport) -> Option<(usize, f64)> {
    let size = |c: f64| if one.group.sense == Sense::Equal { c.abs() } else { c };
    let values = one.values.iter().copied().enumerate();
    values.max_by(|a, b| size(a.1).total_cmp(&size(b.1)).then(b.0.cmp(&a.0)))
}

/// As results have them; nothing without constraints.
pub(super) fn record(all: &ConstraintsReport, known: &[Known]) -> ConstraintsRecord {
    if all.groups.is_empty() {
        return ConstraintsRecord::default();
    }
    let of = |(one, known): (&ConstraintReport, &Known)| (one.group.name.clone(), group(one, known));
    ConstraintsRecord {
        violation: all.violation.into(),
        penalty: all.penalty.into(),
        updates: Some(all.updates),
        groups: all.groups.iter().zip(known).map(of).collect(),
    }
}

fn group(one: &ConstraintReport, known: &Known) -> ConstraintGroupRecord {
    let time = |t: Option<f64>| t.map(Number::from).unwrap_or_default();
    let time_of = |index: usize| time(known.time(index, one.values.len()));
    let worst = known.worst.as_ref().map(|worst| ConstraintValueRecord {
        index: worst.index,
        node: known.node(worst.index).into(),
        value: worst.value.into(),
        position: worst.position.map(|position| numbers(&position)).into(),
        t: time_of(worst.index),
        ..ConstraintValueRecord::default()
    });
    let between_nodes = known.between.map(|(BetweenNodes { distance, position }, t)| BetweenNodesRecord {
        distance: distance.into(),
        position: numbers(&position),
        t: time(t),
    });
    let is_small = one.values.len() <= FEW;
    let touching = || {
        let touching = one.multipliers.iter().enumerate().filter(|(_, y)| **y != 0.0);
        let entry = |(k, y): (usize, &f64)| ConstraintValueRecord {
            index: k,
            node: known.node(k).into(),
            value: one.values[k].into(),
            multiplier: (*y).into(),
            t: time_of(k),
            ..ConstraintValueRecord::default()
        };
        touching.map(entry).collect()
    };
    ConstraintGroupRecord {
        sense: known
            .bound
            .map_or(if one.group.sense == Sense::Equal { "equal" } else { "at_most" }, Bound::key)
            .to_owned(),
        bound: known.bound.map(|bound| bound.value().into()),
        functional: known.bound.zip(known.worst.as_ref()).map(|(bound, worst)| bound.functional(worst.value).into()),
        count: one.values.len(),
        active: one.active(),
        violation: one.violation().into(),
        largest: one.values.iter().copied().fold(f64::NEG_INFINITY, f64::max).into(),
        scale: one.group.scale.into(),
        unit: known.unit.map(str::to_owned).into(),
        worst,
        between_nodes,
        values: is_small.then(|| numbers(&one.values)),
        multipliers: is_small.then(|| numbers(&one.multipliers)),
        t: (is_small && !known.times.is_empty()).then(|| numbers(&known.times)),
        touching: (!is_small).then(touching),
    }
}

fn at_time(problem: &CaseProblem, time: Option<f64>) -> String {
    time.map_or_else(String::new, |t| format!(" at t = {} {}", short(t), problem.units().time().symbol))
}

/// The groups that are not met, each by how much and where, and whether one of them keeps nodes out of an obstacle.
pub(super) fn unmet(problem: &CaseProblem, all: &ConstraintsReport, known: &[Known]) -> (Vec<String>, bool) {
    let feasibility = AugmentedLagrangian::default().feasibility;
    let groups = all.groups.iter().zip(known);
    let violated: Vec<_> = groups.filter(|(one, _)| one.violation() > feasibility * one.group.scale).collect();
    let words = |(one, known): &(&ConstraintReport, &Known)| {
        let place = known.place().map_or_else(String::new, |place| format!(" at {place}"));
        let time = known.worst.as_ref().and_then(|worst| known.time(worst.index, one.values.len()));
        let (name, unit, by) = (&one.group.name, known.unit(), short(one.violation()));
        format!("{name} by {by}{unit}{place}{}", at_time(problem, time))
    };
    (violated.iter().map(words).collect(), violated.iter().any(|(_, known)| !known.nodes.is_empty()))
}

/// Where constraints are not met, or every node keeps its distance and the body between nodes is inside of the obstacle.
pub(super) fn warnings(problem: &CaseProblem, all: &ConstraintsReport, known: &[Known]) -> Vec<Warning> {
    let feasibility = AugmentedLagrangian::default().feasibility;
    let (violated, _) = unmet(problem, all, known);
    let violated = (!violated.is_empty())
        .then(|| Warning::new(&VIOLATED, format!("the constraints are not met: {}", violated.join(", "))));
    let of = |(one, known): (&ConstraintReport, &Known)| {
        let (tolerance, (between, time)) = (feasibility * one.group.scale, known.between?);
        let nearest = known.worst.as_ref().map_or(0.0, |worst| -worst.value);
        let message = format!(
            "{}: between nodes the body is up to {}{} inside of the obstacle, at ({}){}{}",
            one.group.name,
            short(-between.distance),
            known.unit(),
            between.position.map(short).join(", "),
            at_time(problem, time),
            if nearest > -between.distance { ", which slips between the nodes" } else { "" }
        );
        let entered = between.distance < -tolerance && one.violation() <= tolerance;
        entered.then(|| Warning::new(&BETWEEN_NODES, message))
    };
    violated.into_iter().chain(all.groups.iter().zip(known).filter_map(of)).collect()
}

/// A line for every group.
pub(super) fn say(problem: &CaseProblem, console: &Console, all: &ConstraintsReport, known: &[Known]) {
    for (k, (one, known)) in all.groups.iter().zip(known).enumerate() {
        let head = if k == 0 { "constraints" } else { "" };
        let unit = known.unit();
        let most = one.multipliers.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let held = format!(", {} of {} active, largest multiplier {}", one.active(), one.values.len(), short(most));
        let held = if one.multipliers.is_empty() { "" } else { &held };
        let functional = known.functional().map_or_else(String::new, |functional| functional + ": ");
        let told = known.unit.is_some() || known.bound.is_some();
        let worst = known.worst.as_ref().filter(|_| told || one.violation() > 0.0);
        let kept = worst.filter(|_| one.violation() == 0.0 && one.group.sense == Sense::AtMost);
        let kept = kept.map_or_else(String::new, |worst| format!(", kept by {}{unit}", short(-worst.value)));
        let place = worst.and_then(|_| known.place()).map_or_else(String::new, |place| format!(" at {place}"));
        let time = at_time(problem, worst.and_then(|worst| known.time(worst.index, one.values.len())));
        console.say(format!(
            "{head:<12}{}: {functional}largest violation {}{unit}{kept}{place}{time} ({} of its scale){held}",
            one.group.name,
            short(one.violation()),
            short(one.violation() / one.group.scale)
        ));
    }
}
