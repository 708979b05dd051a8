//! Costs, constraints and targets in words.

use super::line::{Line, line};
use super::shape_cost;
use super::time;
use crate::lower::{CaseProblem, TargetShape};
use nastic_language::number::{count, short};
use nastic_language::schema::{Constraint, Cost, HoldsWhen, Phi, ShapeOrName, Stage, Stages};
use nastic_opt::Constrained;

/// Costs, constraints and targets.
pub fn costs(problem: &CaseProblem) -> Vec<Line> {
    let mut out: Vec<Line> = problem.case.costs.iter().map(|cost| cost_line("costs", cost)).collect();
    let is_driven = !problem.case.controls.is_empty();
    if !problem.has_costs() && is_driven {
        out.push(line("costs", "none: solve needs none, optimize and gradient do".to_owned()));
    }
    let reduced = problem.member(0).reduced();
    for (k, (block, group)) in problem.case.constraints.iter().zip(reduced.constraints()).enumerate() {
        let instants = reduced.constraint_states(k).len().max(1);
        let bound = match (&block.obstacle, block.at_most, block.at_least) {
            (Some(keep_out), ..) => format!(
                "{} at least {} {} from {}",
                count(group.len / instants, "node"),
                short(keep_out.clearance),
                problem.units().length().symbol,
                obstacle(&keep_out.shape)
            ),
            (None, Some(most), _) => format!("at most {}", short(most)),
            (None, None, Some(least)) => format!("at least {}", short(least)),
            (None, None, None) => format!("equal to {}", short(block.equal.unwrap_or_default())),
        };
        let when = problem
            .case
            .time
            .as_ref()
            .map_or_else(String::new, |_| format!(", {}", instants_of(block, instants, problem.lacks_steps())));
        out.push(line("constraints", format!("{}: {bound}{when}", block.name())));
    }
    for target in problem.member(0).targets() {
        out.push(target_line(problem, target));
    }
    out
}

/// `a half-space`, or the obstacle's name.
pub(super) fn obstacle(shape: &ShapeOrName) -> String {
    match shape {
        ShapeOrName::Shape(shape) => format!("a {}", shape.name().replace('_', "-")),
        ShapeOrName::Name(name) => name.clone(),
    }
}

/// At which instants a constraint of a motion holds.
fn instants_of(block: &Constraint, count_of: usize, lacks_steps: bool) -> String {
    match &block.when {
        // how many there are is not known yet
        Some(HoldsWhen::Always) if lacks_steps => "at every instant".to_owned(),
        None if lacks_steps && block.obstacle.is_some() => "at every instant".to_owned(),
        _ => format!("at {}", count(count_of, "instant")),
    }
}

/// A term of the cost.
pub fn cost_line(head: &'static str, cost: &Cost) -> Line {
    let text = match cost {
        Cost::SmoothedHausdorff(block) => {
            let stages = match &block.stages {
                Stages::Auto => "automatic stages".to_owned(),
                Stages::List(stages) => {
                    let of = |s: &Stage| format!("({}, {}, {})", short(s.alpha), short(s.beta), short(s.gamma));
                    format!("(alpha, beta, gamma) = {}", stages.iter().map(of).collect::<Vec<_>>().join(" then "))
                }
            };
            format!("phi {}, {stages}", phi(&block.phi))
        }
        _ => cost.term().map(shape_cost::in_words).unwrap_or_default(),
    };
    let (name, kind) = (cost.name(), cost.kind());
    let name = if name == kind { name.to_owned() } else { format!("{name} ({kind})") };
    line(head, format!("{name}: {text}, weight {}{}", short(cost.weight()), time::when(cost.when())))
}

/// A shape that a term aims at.
fn target_line(problem: &CaseProblem, target: &TargetShape) -> Line {
    let unit = problem.units().length().symbol;
    if target.displacement.is_empty() {
        let size: Vec<String> = target.mesh.size()[..target.mesh.dim()].iter().map(|s| short(*s)).collect();
        let cells = count(target.mesh.cells(), "cell");
        return line(
            "targets",
            format!("{}: {} ({cells}), size {} {unit}", target.cost, target.mesh.name(), size.join(" x ")),
        );
    }
    let n = target.displacement.iter().filter(|(_, matters)| *matters).count();
    let length = |u: &[f64; 3]| u.iter().map(|x| x * x).sum::<f64>().sqrt();
    let far = target.displacement.iter().map(|(u, _)| length(u)).fold(0.0, f64::max);
    line("targets", format!("{}: {} to be moved by up to {} {unit}", target.cost, count(n, "node"), short(far)))
}

fn phi(phi: &Phi) -> String {
    match phi {
        Phi::Exponential(block) => match (block.length, block.fraction) {
            (Some(length), _) => format!("exp(-r/{})", short(length)),
            (None, Some(fraction)) => format!("exp(-r/l), l {} of the target's diagonal", short(fraction)),
            (None, None) => "exp(-r/l)".to_owned(),
        },
        Phi::Inverse(block) => format!("1/(r + {})", short(block.eps)),
        Phi::SmoothInverse(block) => format!("1/sqrt(r^2 + {}^2)", short(block.eps)),
    }
}
