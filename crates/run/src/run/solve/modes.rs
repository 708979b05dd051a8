//! `nastic solve --modes N`: eigenvalues and modes of the tangent at the equilibrium.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::session::{CommandFindings, CommandInput, Destination};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::ControlError;
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{Modes, SolveOptions};
use nastic_language::quantity::Dimension;
use nastic_mesh::Snapshot;
use nastic_numeric::format::scientific;
use nastic_report::record::{ModesRecord, numbers};

/// Unit of eigenvalues: a stiffness per volume.
const STIFFNESS: Dimension = Dimension::of(-4, 1, 0, 0);

/// The modes of every member, in their order.
pub(super) fn find(
    input: &CommandInput,
    destination: &Destination,
    point: &EnsemblePoint,
    count: usize,
) -> Result<Vec<Modes>, RunError> {
    let how = SolveOptions { cancel: Some(&input.cancel), ..SolveOptions::default() };
    for member in input.problem.members() {
        let free = member.solid().supports().fixed().iter().filter(|&&fixed| !fixed).count();
        if count > free {
            let what = format!("--modes {count}: the body has {free} free unknowns; ask for 1 to {free} modes");
            return Err(input.problem.complain("mesh", what).into());
        }
    }
    let of = |(member, at): (CaseMember<'_>, &nastic_control::Evaluated)| {
        let modes = member.solid().modes(at.state(), count, &how);
        modes.map_err(|error| destination.member_failed(input, member.index(), ControlError::from(error)))
    };
    input.problem.members().zip(&point.members).map(of).collect()
}

/// Puts eigenvalues into the result and says them.
pub(super) fn report(problem: &CaseProblem, console: &Console, findings: &mut CommandFindings, modes: &[Modes]) {
    let unit = unit(problem);
    for (index, own) in modes.iter().enumerate() {
        let member = problem.member(index);
        let record = ModesRecord {
            eigenvalues: Some(numbers(&own.eigenvalues)),
            negative: Some(own.negative),
            counted: Some(own.counted),
            iterations: own.by_products.as_ref().map(|found| found.iterations),
            errors: own.by_products.as_ref().map(|found| numbers(&found.errors)),
            unit: Some(unit.clone()),
            ..ModesRecord::default()
        };
        let (inside, how) = (member.inside(), record.how_found());
        findings.entries_of(member).modes = record;
        console.say(format!("modes       K phi = lambda M phi, M the volumes of the nodes{inside}{how}"));
        for (k, lambda) in own.eigenvalues.iter().enumerate() {
            let remark = if k < own.negative { "  unstable" } else { "" };
            console.say(format!("  {:>9} {:>16} {unit}{remark}", k + 1, scientific(*lambda, 6)));
        }
    }
}

fn unit(problem: &CaseProblem) -> String {
    problem.units().label(STIFFNESS)
}

/// The modes as fields `mode_1` .. at the nodes.
pub(in crate::run) fn with_fields<'s>(
    mut shot: Snapshot,
    shapes: impl Iterator<Item = &'s [f64]>,
) -> Result<Snapshot, ControlError> {
    let dim = shot.mesh.dim();
    for (k, shape) in shapes.enumerate() {
        let entry = |u: &[f64]| [u[0], u[1], u.get(2).copied().unwrap_or(0.0)];
        let values = shape.chunks_exact(dim).flat_map(entry).collect();
        shot = shot.with_points(&format!("mode_{}", k + 1), 3, values)?;
    }
    Ok(shot)
}
