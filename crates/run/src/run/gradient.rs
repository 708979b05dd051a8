//! `nastic gradient`: cost and derivative at the start controls, for optimisers of others.

use crate::run::check_gradient;
use crate::run::error::{Exit, RunError};
use crate::run::report::{remove_earlier, say_files};
use crate::run::session::Session;
use crate::run::solve::equilibrium::show;
use crate::run::terminal::{digits, say_cost, say_members, say_probes};
use nastic_case::lower::CaseProblem;
use nastic_control::StateFields;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_language::number::short;
use nastic_opt::{Objective, Verdict};
use nastic_result::collections::write_collections;
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::target_files::write_targets;
use nastic_result::{controls, snapshot};

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    session.require(true, true).map_err(|error| session.refuse(error))?;
    remove_earlier(session)?;
    session.find_steps()?;
    let mut workspace = EnsembleWorkspace::default();
    let mut point = session.evaluate_start(&mut workspace)?;
    let derivative =
        session.timed("adjoint", |session| session.input.problem.ensemble.derivative(&mut point, &mut workspace));
    let derivative = derivative.map_err(|failed| session.evaluation_failed(&failed))?;
    session.console.clear();
    let found = session.inspect("equilibrium", &point);
    report(session, &point, &derivative, &found)?;
    session.look_at_unmet(&point)?;
    let certificate = check_gradient::of_start(session, &point, &derivative, &mut workspace)?;
    session.timed("write", |session| write(session, &point, &derivative, &found))?;
    show(session, point, Some(derivative), found);
    Ok(if certificate.verdict == Verdict::Wrong { Exit::GradientWrong } else { Exit::Done })
}

fn report(
    session: &mut Session<'_>,
    point: &EnsemblePoint,
    derivative: &[f64],
    found: &[Inspection],
) -> Result<(), RunError> {
    let entries = session.entries(point, found)?;
    session.findings.record.state = entries;
    session.findings.record.derivative_norm = controls::derivative_norm(&session.input.problem, derivative);
    session.findings.record.controls = Some(controls::controls(&session.input.problem, &point.m, 0));
    let result = &session.findings.record;
    say_cost(session, result);
    say_members(session, result);
    session.console.say(format!(
        "derivative  Euclidean norm {}, norm in the metric {}",
        digits(*result.derivative_norm.euclidean, 9),
        digits(*result.derivative_norm.metric, 9)
    ));
    for (block, field) in session.input.problem.ensemble.blocks().iter().zip(&session.input.problem.controls) {
        let own = block.of(derivative);
        let (low, high) = own.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        session.console.say(format!(
            "            {}: {} entries from {} to {}",
            field.name,
            own.len(),
            short(low),
            short(high)
        ));
    }
    say_probes(session, result);
    Ok(())
}

fn write(
    session: &mut Session<'_>,
    point: &EnsemblePoint,
    derivative: &[f64],
    found: &[Inspection],
) -> Result<(), RunError> {
    let Some(out) = session.destination.out.clone() else { return Ok(()) };
    let problem = &session.input.problem;
    out.write_json("derivative.json", &controls::by_control(problem, derivative))?;
    let mut files = vec!["derivative.json".to_owned()];
    files.extend(write_states(problem, "start", point, derivative, found, &out)?);
    files.extend(write_targets(problem, &out)?);
    files.extend(write_collections(problem, "start", &out)?);
    say_files(session, files);
    Ok(())
}

/// The states of all members, with the gradient.
pub(super) fn write_states(
    problem: &CaseProblem,
    what: &str,
    point: &EnsemblePoint,
    derivative: &[f64],
    found: &[Inspection],
    out: &Directory,
) -> Result<Vec<String>, RunError> {
    let gradient = problem.inner_product().map(|product| product.riesz(derivative));
    let mut files = Vec::new();
    for (member, at) in problem.members().zip(&point.members) {
        let gradient = gradient.as_ref().map(|gradient| member.local(gradient));
        let fields = StateFields { adjoint: at.adjoint(), gradient: gradient.as_deref(), ..StateFields::of(at) };
        let shot = snapshot::inspected(member, &fields, found.get(member.index()))?;
        files.extend(out.write_state(&member.file(what), &shot)?);
    }
    Ok(files)
}
