//! `nastic solve --exact-contact`: the equilibrium whose contacts have no layer, beside the one that has.

use crate::run::error::{Exit, RunError};
use crate::run::session::{CommandContext, CommandFindings, CommandInput, Destination};
use nastic_control::{ControlError, StateFields};
use nastic_ensemble::EnsemblePoint;
use nastic_fem::{ExactEquilibrium, Feature, Instant, Progress, SolveOptions, StateError, Touch, Workspace};
use nastic_language::number::{count, quantity, short, vector};
use nastic_language::quantity::Dimension;
use nastic_numeric::format::scientific;
use nastic_report::record::ExactContactRecord;
use nastic_result::snapshot;

/// Refuses what does not go with it, before anything is solved.
pub(super) fn check(input: &CommandInput, destination: &Destination) -> Result<(), RunError> {
    for (index, member) in input.problem.members().enumerate() {
        let supported = member.solid().model().properties().supports(Feature::ExactContact);
        supported
            .map_err(|error| destination.member_failed(input, index, ControlError::from(StateError::from(error))))?;
    }
    Ok(())
}

/// Solves, says and writes it for every member.
pub(super) fn run(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
) -> Result<Exit, RunError> {
    let CommandContext { destination, console, .. } = context;
    let mut files = Vec::new();
    for index in 0..point.members.len() {
        files.extend(findings.timed(console, "exact contact", |findings| of_member(context, findings, point, index))?);
    }
    if destination.out.is_some() {
        findings.say_files(console, files);
    }
    Ok(Exit::Done)
}

fn of_member(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
    index: usize,
) -> Result<Vec<String>, RunError> {
    let CommandContext { input, destination, console } = context;
    let (member, at) = (input.problem.member(index), &point.members[index]);
    let progress = |now: &Progress| {
        let line = format!("exact contact: Newton iteration {}, residual {:.1e}", now.newton, now.residual);
        console.progress(now.newton, line);
    };
    let how = SolveOptions { cancel: Some(&input.cancel), watch: Some(&progress), ..SolveOptions::default() };
    let model = member.solid().model();
    let found = model.stability().exact_contact(at.state(), &how, &mut Workspace::default());
    let found = found.map_err(|error| destination.member_failed(input, index, ControlError::from(error)))?;
    let layered = model.contacts().touches(&Instant::of(at.state()));
    let touches = found.model.contacts().touches(&Instant::of(&found.state));
    let units = member.problem().units();
    let moved = found.state.u.iter().zip(at.state().u.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let inside = member.inside();
    console.say(format!(
        "exact       contact without a layer, {} further equilibria, gaps {} of the layer, {} almost without a pressure: the body moves by at most {}{inside}",
        found.rounds,
        scientific(found.violation, 1),
        count(found.weakly_active, "sample"),
        quantity(moved, Dimension::LENGTH, units)
    ));
    for ((name, exact), (_, layered)) in touches.iter().zip(&layered) {
        let share = 100.0 * (layered.pressing / exact.pressing - 1.0);
        let change = if exact.pressing > 0.0 {
            format!("; its layer changes what it presses with by {} %", short((100.0 * share).round() / 100.0))
        } else {
            String::new()
        };
        console.say(format!(
            "            {name} pushes with {} {}, largest pressure {}{change}",
            vector(&exact.force[..member.mesh().dim()]),
            units.force().symbol,
            quantity(exact.largest_pressure, Dimension::PRESSURE, units)
        ));
    }
    let entry = entry(&found, moved, &touches, member.mesh().dim());
    let name = format!("{}.vtu", member.file("exact_contact"));
    let mut files = Vec::new();
    if let Some(out) = &destination.out {
        let shot = snapshot::iterate(member, &StateFields::new(&found.state, &at.m, at.stage))?;
        let pressures = found.model.contacts().nodal_pressures(&Instant::of(&found.state)).unwrap_or_default();
        out.write_vtu(&name, &shot.with_points("contact_pressure", 1, pressures).map_err(ControlError::from)?)?;
        files.push(name);
    }
    findings.entries_of(member).exact_contact = Some(entry);
    Ok(files)
}

/// What is put into the result, in the units of the case.
fn entry(found: &ExactEquilibrium, moved: f64, touches: &[(String, Touch)], dim: usize) -> ExactContactRecord {
    let contacts = touches.iter().map(|(name, touch)| (name.clone(), touch.quantities(dim).into())).collect();
    ExactContactRecord {
        rounds: found.rounds,
        newton_iterations: found.state.report.newton,
        violation: found.violation.into(),
        weakly_active: found.weakly_active,
        largest_change: moved.into(),
        contacts: Some(contacts),
    }
}
