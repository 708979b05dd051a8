//! What to try after trials that met a limit point: another control there, or bounds before it.

use crate::run::optimize::advice::{Advice, optimize};
use crate::run::optimize::starts::start_run::FinishedRun;
use crate::run::session::{CommandInput, Destination};
use nastic_case::lower::{CaseProblem, ControlField};
use nastic_ensemble::EnsemblePoint;
use nastic_language::number::short;
use nastic_language::schema::Control;
use nastic_result::summary;

/// Upper bound of an added volume that takes the place of a pressure, in volumes added so far.
const FARTHER: f64 = 10.0;
/// Share of the value at a limit point that a bound leaves.
const BEFORE: f64 = 0.95;

/// Nothing where no trial met a limit point, or the run converged all the same.
pub(super) fn of(input: &CommandInput, destination: &Destination, ended: &FinishedRun) -> Vec<Advice> {
    if ended.limits.count == 0 || ended.best.stop.is_converged() {
        return vec![];
    }
    let mut out = Vec::new();
    let volumes = volumes(&input.problem, ended);
    if !volumes.names.is_empty() {
        let names = volumes.names.join(", ");
        let why = format!(
            "control the added volume in the place of the pressure of {names}, which has a limit point where the volume goes on growing \
             (bounds: {} times what was added so far)",
            short(FARTHER)
        );
        out.push(Advice { why, command: optimize(input, destination, &volumes.set) });
    }
    let bounds = bounds(&input.problem, ended);
    if !bounds.is_empty() {
        let why = "or keep the controls before the limit point, if that is enough".to_owned();
        out.push(Advice { why, command: optimize(input, destination, &bounds) });
    }
    out
}

/// Cavities whose pressure is to be left for their volume, and what to set for that.
struct Volumes {
    names: Vec<String>,
    set: Vec<String>,
}

fn volumes(problem: &CaseProblem, ended: &FinishedRun) -> Volumes {
    let mut out = Volumes { names: vec![], set: vec![] };
    for (field, control) in met(problem, ended) {
        if let Some(added) = added_volume(problem, &ended.limits.member, &ended.best.point, &control.of) {
            let (at, upper) = (&field.at, FARTHER * added);
            out.names.push(field.name.clone());
            out.set.push(format!("{at}/of={}.volume", control.of));
            out.set.push(format!("{at}/start={}", short(added)));
            out.set.push(format!("{at}/lower={}", short(added.min(0.0))));
            out.set.push(format!("{at}/upper={}", short(upper.max(0.0))));
        }
    }
    out
}

/// Bounds of scalars before their values at the limit point.
fn bounds(problem: &CaseProblem, ended: &FinishedRun) -> Vec<String> {
    let values = |name: &str| ended.limits.at.iter().find(|met| met.name == name).map(|met| met.range);
    let of = |(field, _): (&ControlField, &Control)| {
        let [low, high] = values(&field.name)?;
        let (key, value) = if high > -low { ("upper", high) } else { ("lower", low) };
        Some(format!("{}/{key}={}", field.at, short(BEFORE * value)))
    };
    met(problem, ended).filter_map(of).collect()
}

/// The scalar control fields of all load cases that change on the way to the limit point.
fn met<'s>(problem: &'s CaseProblem, ended: &'s FinishedRun) -> impl Iterator<Item = (&'s ControlField, &'s Control)> {
    let controls = &problem.case.controls;
    let of = |field: &'s ControlField| {
        let control = controls.iter().find(|control| control.at == field.at)?;
        let is_met = ended.limits.at.iter().any(|met| met.name == field.name);
        (is_met && field.bounds.is_some()).then_some((field, control))
    };
    problem.controls.iter().filter_map(of)
}

/// The volume added so far to the cavity of that name, whose pressure has limit points that its volume passes; in the member that met one last.
fn added_volume(problem: &CaseProblem, met: &str, best: &EnsemblePoint, name: &str) -> Option<f64> {
    let mut members = problem.members().zip(&best.members);
    let (member, at) = members.find(|(member, _)| member.name() == met)?;
    let [volume, rest] = summary::contributions(member, at.state()).ok()?.get(name)?.volumes()?;
    Some(volume - rest)
}
