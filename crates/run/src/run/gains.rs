//! `nastic gains`: sensitivities of outputs by controls at the start, and a feedback law for a controller.

mod control_values;
mod law;
mod refusal;
mod trial;

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::progress;
use crate::run::report::remove_earlier;
use crate::run::session::{CommandContext, Opened, START_ACCURACY, evaluate, evaluate_start};
use crate::run::solve::equilibrium::{report, show, write};
use law::Law;
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::{ControlError, Evaluated};
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_io::write_atomically;
use nastic_language::number::{count, short};
use nastic_opt::{Constrained, Request};
use nastic_report::gains::{header, remarks, rows};
use nastic_report::record::{GainsOutputRecord, GainsRecord};
use nastic_result::files::Directory;
use rayon::prelude::*;

/// Names of the files.
const JSON: &str = "gains.json";
const CSV: &str = "gains.csv";
const HEADER: &str = "gains.h";
/// Outputs and scenarios that are said.
const SAID: usize = 12;

pub(super) fn run(opened: &mut Opened<'_>) -> Result<Exit, RunError> {
    refusal::check(&opened.input).map_err(|error| opened.destination.refuse(error))?;
    remove_earlier(&opened.input, &opened.destination)?;
    let (context, findings) = opened.parts();
    let CommandContext { input, destination, console } = context;
    let point = evaluate_start(context, findings, &mut EnsembleWorkspace::default())?;
    let found = findings.inspect(input, console, "equilibrium", &point);
    report(context, findings, &point, &found)?;
    let own = findings.timed(console, "solve", |_| nominal(context))?;
    let (problem, at) = own.as_ref().map_or((&input.problem, &point), |(problem, at)| (problem, at));
    let record = findings.timed(console, "gains", |_| find(context, problem.member(0), &at.members[0], &point))?;
    console.clear();
    say(console, &record);
    findings.record.gains = Some(record.clone());
    findings.write(console, destination, |own, out| {
        let mut files = write(&input.problem, own, &point, &found, &[], &[], out)?;
        files.extend(files_of(&record, out)?);
        Ok(files)
    })?;
    show(&input.problem, findings, point, None, found);
    Ok(Exit::Done)
}

/// The case without its scenarios, with its equilibrium at the start; `None` of a case without scenarios.
fn nominal(context: CommandContext<'_>) -> Result<Option<(CaseProblem, EnsemblePoint)>, RunError> {
    let CommandContext { input, destination, console } = context;
    if !input.problem.has_scenarios() {
        return Ok(None);
    }
    let document = input.problem.document.without(&["scenarios", "risk", "expect"]);
    let mut problem = CaseProblem::lower(document, input.signal.clone())?;
    progress::watch(&mut problem, console);
    let how = Request { accuracy: START_ACCURACY, ..Request::default() };
    let point = evaluate(&problem, console, &problem.start, how, &mut EnsembleWorkspace::default());
    let point = point.map_err(|failed| destination.evaluation_failed(input, &failed))?;
    Ok(Some((problem, point)))
}

/// The law at the case's own body, and what it does there and in the scenarios.
fn find(
    CommandContext { input, destination, .. }: CommandContext<'_>,
    own: CaseMember<'_>,
    at: &Evaluated,
    point: &EnsemblePoint,
) -> Result<GainsRecord, RunError> {
    let failed = |index: usize| move |error: ControlError| destination.member_failed(input, index, error);
    let (law, record) = Law::find(own, at).map_err(failed(0))?;
    let Some(law) = law else {
        let (key, message) = match record.outputs.as_slice() {
            [] => (
                "costs",
                format!("\"gains\" needs outputs with targets: costs of the kind {}", refusal::AIMING.join(", ")),
            ),
            all => (
                "controls",
                format!(
                    "no control moves an output with a target ({}): begin at other controls, or give other targets",
                    names(all)
                ),
            ),
        };
        return Err(input.problem.complain(key, message).into());
    };
    let steps = input.problem.case.gains.steps;
    let nominal = trial::of(&law, own, at, steps).map_err(failed(0))?;
    let members: Vec<(CaseMember<'_>, &Evaluated)> = match input.problem.has_scenarios() {
        true => input.problem.members().zip(&point.members).collect(),
        false => Vec::new(),
    };
    let trials: Vec<_> = members.par_iter().map(|(member, at)| trial::of(&law, *member, at, steps)).collect();
    let mut all = vec![nominal];
    for (index, trial) in trials.into_iter().enumerate() {
        all.push(trial.map_err(failed(index))?);
    }
    let jacobians: Vec<&[Vec<f64>]> = all.iter().map(|one| one.jacobian.as_slice()).collect();
    let damped = law.converging(&jacobians);
    let mut records = all.into_iter().map(|one| one.record);
    let nominal = records.next().unwrap_or_default();
    let scenarios = members.iter().map(|(member, _)| member.name()).zip(records).collect();
    let record = GainsRecord { nominal, scenarios: Some(scenarios).filter(|_| !members.is_empty()), ..record };
    let told = notes(&input.problem, own, at)?.into_iter().chain(remarks(&record, damped));
    Ok(GainsRecord { remarks: Some(told.collect()), ..record })
}

/// What of the case the law does not look at.
fn notes(problem: &CaseProblem, own: CaseMember<'_>, at: &Evaluated) -> Result<Vec<String>, RunError> {
    let mut left = own.reduced().without_outputs(at).map_err(|error| problem.complain("costs", error.to_string()))?;
    left.dedup();
    let costs = (!left.is_empty()).then(|| {
        format!(
            "the law does not look at the cost{} {}: no few numbers with targets",
            if left.len() == 1 { "" } else { "s" },
            left.join(", ")
        )
    });
    let constraints = problem.ensemble.constraints().len();
    let bounds = (constraints > 0).then(|| {
        format!(
            "the law does not look at the case's {}: bounds of controls are what it keeps",
            count(constraints, "constraint")
        )
    });
    Ok(costs.into_iter().chain(bounds).collect())
}

fn names(outputs: &[GainsOutputRecord]) -> String {
    outputs.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", ")
}

fn files_of(record: &GainsRecord, out: &Directory) -> Result<Vec<String>, RunError> {
    out.write_json(JSON, record)?;
    for (name, text) in [(CSV, rows(record)), (HEADER, header(record))] {
        write_atomically(out.own(name)?, |file| file.write_all(text.as_bytes()))?;
    }
    Ok([JSON, CSV, HEADER].map(str::to_owned).to_vec())
}

/// A few lines for people.
fn say(console: &Console, record: &GainsRecord) {
    let GainsRecord { controls, outputs, watched, damping, by, .. } = record;
    let (n, m) = (count(outputs.len(), "output"), count(controls.len(), "control"));
    let solves = if by == "adjoints" { "an adjoint for each output" } else { "a tangent for each control" };
    console.say(format!("gains       {n} by {m}, {solves}; damping {}", short(damping.unwrap_or(0.0))));
    for one in outputs.iter().chain(watched.iter().flatten()).take(SAID) {
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), short);
        let unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let target = one.target.map_or_else(String::new, |target| format!(", target {}", short(target)));
        let by: Vec<String> = one
            .sensitivities
            .iter()
            .take(SAID)
            .zip(controls)
            .map(|(value, control)| format!("{} by {}", number(**value), control.name))
            .collect();
        console.say(format!(
            "output      {} = {}{}{target}: {}",
            one.name,
            number(*one.value),
            unit(&one.unit),
            by.join(", ")
        ));
    }
    let more = (outputs.len() + watched.as_ref().map_or(0, Vec::len)).saturating_sub(SAID);
    if more > 0 {
        console.say(format!("            {} more in {JSON}", count(more, "output")));
    }
    record.remarks.iter().flatten().for_each(|remark| console.say(format!("note        {remark}")));
}
