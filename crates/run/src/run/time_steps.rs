//! Time steps of a case with a tolerance: found before a command solves anything, and held to the tolerance at its end.

use crate::console::Console;
use crate::run::error::RunError;
use crate::run::progress::watch;
use crate::run::session::{CommandFindings, Opened, START_ACCURACY};
use nastic_case::lower::{CaseMember, CaseProblem, StepsError};
use nastic_case::warning::{STEP_ERROR, Warning};
use nastic_control::{AdaptiveSteps, Evaluated, StepError};
use nastic_ensemble::EnsemblePoint;
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::Time;
use nastic_report::record::{StepErrorRecord, TimeRecord};

/// Errors of steps beyond the tolerance by less are those of the solves, which optimisers do not ask for as exactly.
const SLACK: f64 = 1.1;

/// Finds the time steps of a case with a tolerance, at its start controls; all that follows has these.
pub(super) fn find(opened: &mut Opened<'_>) -> Result<(), RunError> {
    let Opened { input, destination, console, findings } = opened;
    if !input.problem.lacks_steps() {
        return Ok(());
    }
    let find = |_: &mut _| input.problem.with_adaptive_steps(START_ACCURACY, input.signal.clone());
    let found = findings.timed(console, "steps", find);
    console.clear();
    let (problem, steps) = found.map_err(|error| match error {
        StepsError::Motion { member, error } => destination.member_failed(input, member, error),
        StepsError::Input(problems) => problems.into(),
    })?;
    take(opened, problem, steps);
    Ok(())
}

/// Takes the steps that an earlier program found, if any.
pub(super) fn restore(opened: &mut Opened<'_>, steps: Vec<AdaptiveSteps>) -> Result<(), RunError> {
    let input = &opened.input;
    if input.problem.lacks_steps() {
        let instants: Vec<Vec<f64>> = steps.iter().map(|steps| steps.instants.clone()).collect();
        let problem = input.problem.through(&instants, input.signal.clone())?;
        take(opened, problem, steps);
    }
    Ok(())
}

fn take(opened: &mut Opened<'_>, mut problem: CaseProblem, steps: Vec<AdaptiveSteps>) {
    let Opened { input, console, findings, .. } = opened;
    if input.command.optimizes() {
        problem.refuse_unstable_if_asked();
    }
    watch(&mut problem, console);
    // what is wrong at instants that were not known before
    let known = |warning: &&Warning| !input.problem.warnings.iter().any(|known| known.message == warning.message);
    let new: Vec<Warning> = problem.warnings.iter().filter(known).cloned().collect();
    (input.problem, findings.steps) = (problem, steps);
    input.share_members();
    findings.warn_all(console, new);
    for (member, steps) in input.problem.members().zip(&findings.steps) {
        console.say(format!("steps       {}", shown(member, steps)));
    }
}

/// Warns of the members whose motion needs shorter steps than those that were found at the start controls.
pub(super) fn check_errors(
    problem: &CaseProblem,
    console: &Console,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
) {
    findings.warn_all(console, problem.members().zip(&point.members).filter_map(|(member, at)| warning(member, at)));
}

fn shown(member: CaseMember<'_>, steps: &AdaptiveSteps) -> String {
    let (units, (least, most)) = (member.problem().units(), steps.range());
    let time = |value: f64| quantity(value, Dimension::TIME, units);
    let report = &steps.report;
    let failed = if report.failed > 0 { format!(", {} without a solution", report.failed) } else { String::new() };
    let of = if member.name().is_empty() { String::new() } else { format!(" of {}", member.name()) };
    format!(
        "{}{of} from {} to {}, found at the start controls ({} rejected{failed})",
        count(steps.instants.len() - 1, "step"),
        time(least),
        time(most),
        report.rejected
    )
}

fn warning(member: CaseMember<'_>, at: &Evaluated) -> Option<Warning> {
    let tolerance = member.case().time.as_ref()?.tolerance?;
    let StepError { error, time } = at.solved.error.filter(|found| found.error > SLACK * tolerance)?;
    let units = member.problem().units();
    let message = format!(
        "a step of the motion has an estimated error of {}, {} times the tolerance, at t = {}: the steps are those of the start controls",
        quantity(error, Dimension::LENGTH, units),
        short(error / tolerance),
        quantity(time, Dimension::TIME, units)
    );
    Some(Warning::new(&STEP_ERROR, message).of(member.name()))
}

/// Of the result's entry `time`: the steps, and their largest estimated error.
pub(super) fn record(found: &[AdaptiveSteps], member: CaseMember<'_>, time: &Time, at: &Evaluated) -> TimeRecord {
    let mut out = match time.step {
        Some(step) => TimeRecord { step: step.into(), ..TimeRecord::default() },
        None => TimeRecord { tolerance: time.tolerance.into(), ..TimeRecord::default() },
    };
    if let (None, Some(steps)) = (time.step, found.get(member.index())) {
        let (least, most) = steps.range();
        (out.shortest, out.longest) = (least.into(), most.into());
        (out.rejected, out.failed) = (Some(steps.report.rejected), Some(steps.report.failed));
    }
    out.step_error =
        at.solved.error.map(|StepError { error, time }| StepErrorRecord { largest: error.into(), t: time.into() });
    out
}
