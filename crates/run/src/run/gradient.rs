//! `nastic gradient`: cost and derivative at the start controls, for optimisers of others.

use crate::run::check_gradient;
use crate::run::error::{Exit, RunError};
use crate::run::report::{entries, remove_earlier};
use crate::run::session::{CommandContext, CommandFindings, Opened, evaluate_start};
use crate::run::solve::equilibrium::show;
use crate::run::terminal::{digits, say_cost, say_members, say_probes};
use crate::run::{time_steps, unmet};
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

pub(super) fn run(opened: &mut Opened<'_>) -> Result<Exit, RunError> {
    opened.input.require(true, true).map_err(|error| opened.destination.refuse(error))?;
    remove_earlier(&opened.input, &opened.destination)?;
    time_steps::find(opened)?;
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    let mut workspace = EnsembleWorkspace::default();
    let mut point = evaluate_start(context, findings, &mut workspace)?;
    let derivative =
        findings.timed(console, "adjoint", |_| input.problem.ensemble.derivative(&mut point, &mut workspace));
    let derivative = derivative.map_err(|failed| destination.evaluation_failed(input, &failed))?;
    console.clear();
    let found = findings.inspect(input, console, "equilibrium", &point);
    report(context, findings, &point, &derivative, &found)?;
    unmet::look_at(context, findings, &point)?;
    let certificate = check_gradient::of_start(input, console, findings, &point, &derivative, &mut workspace)?;
    findings.write(console, destination, |_, out| write(&input.problem, &point, &derivative, &found, out))?;
    show(&input.problem, findings, point, Some(derivative), found);
    Ok(if certificate.verdict == Verdict::Wrong { Exit::GradientWrong } else { Exit::Done })
}

fn report(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
    derivative: &[f64],
    found: &[Inspection],
) -> Result<(), RunError> {
    let CommandContext { input, destination, console } = context;
    findings.record.state = entries(input, destination, point, found)?;
    findings.record.derivative_norm = controls::derivative_norm(&input.problem, derivative);
    findings.record.controls = Some(controls::controls(&input.problem, &point.m, 0));
    let result = &findings.record;
    say_cost(&input.problem, console, result);
    say_members(console, result);
    console.say(format!(
        "derivative  Euclidean norm {}, norm in the metric {}",
        digits(*result.derivative_norm.euclidean, 9),
        digits(*result.derivative_norm.metric, 9)
    ));
    for (block, field) in input.problem.ensemble.blocks().iter().zip(&input.problem.controls) {
        let own = block.of(derivative);
        let (low, high) = own.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        console.say(format!(
            "            {}: {} entries from {} to {}",
            field.name,
            own.len(),
            short(low),
            short(high)
        ));
    }
    say_probes(&input.problem, console, result);
    Ok(())
}

fn write(
    problem: &CaseProblem,
    point: &EnsemblePoint,
    derivative: &[f64],
    found: &[Inspection],
    out: &Directory,
) -> Result<Vec<String>, RunError> {
    out.write_json("derivative.json", &controls::by_control(problem, derivative))?;
    let mut files = vec!["derivative.json".to_owned()];
    files.extend(write_states(problem, "start", point, derivative, found, out)?);
    files.extend(write_targets(problem, out)?);
    files.extend(write_collections(problem, "start", out)?);
    Ok(files)
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
