//! `nastic solve --minimum`: on from an unstable equilibrium to a stable one.

use crate::run::error::RunError;
use crate::run::session::CommandContext;
use nastic_control::{ControlError, SolvedStates};
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{SolveOptions, Workspace};
use nastic_language::number::short;
use nastic_numeric::format::scientific;
use nastic_opt::Objective;

/// The point with every member's state taken down to a minimum of its potential, costs valued there.
pub(super) fn descend(context: CommandContext<'_>, mut point: EnsemblePoint) -> Result<EnsemblePoint, RunError> {
    let CommandContext { input, destination, console } = context;
    let mut work = Vec::new();
    for index in 0..point.members.len() {
        let (member, at) = (input.problem.member(index), &point.members[index]);
        let how = SolveOptions { cancel: Some(&input.cancel), ..SolveOptions::default() };
        let found = member.solid().model().stability().descend(at.state(), &how, &mut Workspace::default());
        let found = found.map_err(|error| destination.member_failed(input, index, ControlError::from(error)))?;
        if found.saddles > 0 {
            let (from, to) = (at.state().report.energy, found.state.report.energy);
            console.say(format!(
                "descent     potential from {} to {}, by {}{}",
                short(from),
                short(to),
                scientific(from - to, 3),
                member.inside()
            ));
        }
        let mut report = found.state.report;
        // A state that was a minimum already brings its own work.
        if found.saddles > 0 {
            report.add_work(&at.work);
        } else {
            console.say("descent     the equilibrium is stable already");
        }
        work.push(report);
        let solved = &mut point.members[index].solved;
        *solved = SolvedStates::one(found.state, solved.accuracy);
    }
    let restaged = input.problem.ensemble.restage(0, &point);
    let mut point = restaged.map_err(|failed| destination.evaluation_failed(input, &failed))?;
    // Valuing again is no work of a solve.
    point.members.iter_mut().zip(work).for_each(|(at, work)| at.work = work);
    Ok(point)
}
