//! Constraints that equilibria and motions at the start controls do not meet, and obstacles that they are inside of: nothing holds them there,
//! for an obstacle of a cost or a constraint exerts no force.

use crate::run::constraints;
use crate::run::error::RunError;
use crate::run::session::{CommandContext, CommandFindings};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{VIOLATED, Warning};
use nastic_control::{Evaluated, FigureKind};
use nastic_ensemble::EnsemblePoint;
use nastic_language::number::short;
use nastic_opt::{Constrained, ConstraintReport, ConstraintsReport};

/// Parts of the body's diagonal by which it may be inside of the obstacle of a cost, which a penalty never keeps out altogether.
const DEPTH: f64 = 1e-3;

const NO_FORCE: &str = "an obstacle exerts no force by itself: it bounds what optimize may choose; to have the body pushed back, name it in \"contact\"";

/// Looks whether the states of an evaluated control meet the constraints and stay out of the obstacles of costs.
pub(super) fn look_at(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
) -> Result<(), RunError> {
    let CommandContext { input, destination, console } = context;
    let (problem, ensemble) = (&input.problem, &input.problem.ensemble);
    let (mut values, mut groups) = (ensemble.constraint_values(point).into_iter(), Vec::new());
    for group in ensemble.constraints() {
        let values: Vec<f64> = values.by_ref().take(group.len).collect();
        // nothing was optimised: there are no multipliers
        groups.push(ConstraintReport { multipliers: Vec::new(), values, group });
    }
    let violation = groups.iter().map(|one| one.violation() / one.group.scale).fold(0.0, f64::max);
    let all = ConstraintsReport { groups, violation, ..ConstraintsReport::default() };
    let known = constraints::look_at(input, destination, &all, point)?;
    let of_costs = problem.members().zip(&point.members).flat_map(|(member, at)| of_costs(member, at));
    let warnings: Vec<Warning> = of_constraints(problem, &all, &known).into_iter().chain(of_costs).collect();
    findings.record.optimum.constraints = constraints::record(&all, &known);
    constraints::say(problem, console, &all, &known);
    findings.warn_all(console, warnings);
    Ok(())
}

fn of_constraints(problem: &CaseProblem, all: &ConstraintsReport, known: &[constraints::Known]) -> Option<Warning> {
    let (unmet, by_obstacle) = constraints::unmet(problem, all, known);
    let why = if by_obstacle { format!("; {NO_FORCE}") } else { String::new() };
    let message = format!("the constraints are not met at the start controls: {}{why}", unmet.join(", "));
    (!unmet.is_empty()).then(|| Warning::new(&VIOLATED, message))
}

/// The costs whose obstacles the body is inside of.
fn of_costs(member: CaseMember<'_>, at: &Evaluated) -> Vec<Warning> {
    let reduced = member.reduced();
    let (unit, least) = (member.problem().units().length().symbol, DEPTH * member.mesh().diagonal());
    // a cost whose figures are not defined says so where they are asked for
    let figures = reduced.figures_of(at).unwrap_or_default();
    let depth = |figures: Vec<nastic_control::Figure>| {
        let distance = figures.iter().find(|figure| figure.kind == FigureKind::ObstacleDistance)?.value;
        (distance < -least).then_some(-distance)
    };
    let entered = reduced.term_names().into_iter().zip(figures).filter_map(|(name, own)| Some((name, depth(own)?)));
    entered
        .map(|(name, depth)| {
            let message =
                format!("the body is {} {unit} inside of the obstacle of cost {name}; {NO_FORCE}", short(depth));
            Warning::new(&VIOLATED, message).of(member.name())
        })
        .collect()
}
