//! Warnings about an optimisation that ended: nothing moved, bounds decide, terms that do not count, branches left.

use crate::run::constraints::Known;
use crate::run::error::RunError;
use crate::run::optimize::starts::start_run::FinishedRun;
use crate::run::session::{CommandContext, CommandFindings};
use crate::run::time_steps;
use nastic_case::inspect::determination;
use nastic_case::lower::{CaseProblem, ControlField};
use nastic_case::warning::{ALL_ON_BOUNDS, IDLE, NEGLIGIBLE_TERM, NO_MOVEMENT, NOT_VERIFIED, OTHER_SIGN, Warning};
use nastic_control::Evaluated;
use nastic_ensemble::{EnsembleBlock, EnsembleWorkspace};
use nastic_language::number::{count, short};
use nastic_language::schema::pulling;
use nastic_numeric::format::scientific;
use nastic_numeric::vector::{norm, sub};
use nastic_opt::{Bounds, DEFAULT_ACCURACY};
use nastic_result::controls;

/// A change of the control, relative to its size, that counts as none.
const STILL: f64 = 1e-12;
/// A cost that falls by a smaller part of itself has not changed.
const UNCHANGED: f64 = 1e-3;
/// Displacements of two solves of one equilibrium differ by less, relative to their norm.
const SAME: f64 = 1e-5;
/// A term this many times smaller than the largest does not count.
const NEGLIGIBLE: f64 = 1e-6;

/// Of a run that was interrupted only what does not hang on its end.
pub(super) fn warn(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    run: &FinishedRun,
    constraints: &[Known],
    interrupted: bool,
) -> Result<(), RunError> {
    let CommandContext { input, console, .. } = context;
    let mut found = Vec::new();
    let problem = &input.problem;
    for (block, field) in problem.ensemble.blocks().iter().zip(&problem.controls).filter(|_| !interrupted) {
        found.extend(bounds(run, block, field, problem));
        found.extend(idle(run, block, field, problem));
    }
    if !interrupted && found.iter().all(|warning| warning.kind != &OTHER_SIGN) {
        found.extend(movement(run));
    }
    if !interrupted {
        found.extend(determination(problem, &run.best.m));
    }
    found.extend(terms(problem, run));
    found.extend(crate::run::constraints::warnings(problem, &run.constraints, constraints));
    if !interrupted {
        found.extend(verify(context, run)?);
    }
    findings.warn_all(console, found);
    time_steps::check_errors(problem, console, findings, &run.best.point);
    Ok(())
}

fn movement(run: &FinishedRun) -> Option<Warning> {
    let (start, best) = (&run.start, &run.best);
    let moved = norm(&sub(&best.m, &start.m));
    if moved > STILL * norm(&best.m) {
        let fell = start.risk - best.cost;
        let same = best.stage == 0 && fell >= 0.0 && fell < UNCHANGED * start.risk.abs() && !best.stop.is_converged();
        let message = || {
            let cost = scientific(best.cost, 6);
            format!(
                "the cost has fallen by {:.1e} of itself alone, to {cost}: it began at an optimum, or the controls hardly act on what is wanted",
                fell / start.risk.abs()
            )
        };
        return same.then(|| Warning::new(&NO_MOVEMENT, message()));
    }
    let slope = match best.gradient_norm {
        _ if best.derivative.iter().all(|d| *d == 0.0) => "the derivative of the cost is exactly zero there".to_owned(),
        0.0 => "the bounds forbid every direction in which the cost falls".to_owned(),
        slope => format!("projected gradient {slope:.3e}"),
    };
    let trials = count(best.counts.trials, "trial");
    Some(Warning::new(&NO_MOVEMENT, format!("the control is that of the start after {trials}; {slope}")))
}

/// A control on which nothing depends at the optimum, between its bounds: a slack cable.
fn idle(run: &FinishedRun, block: &EnsembleBlock, field: &ControlField, problem: &CaseProblem) -> Option<Warning> {
    let (m, derivative) = (block.of(&run.best.m), block.of(&run.best.derivative));
    let inside = |limits: &Bounds| (0..m.len()).any(|i| limits.at(i).0 < m[i] && m[i] < limits.at(i).1);
    // where the whole derivative is zero nothing moves, which is said
    let some = run.best.derivative.iter().any(|d| *d != 0.0);
    if m.is_empty() || !some || derivative.iter().any(|d| *d != 0.0) || !field.bounds.as_ref().is_none_or(inside) {
        return None;
    }
    let owner = problem.member(block.owner);
    let own = &owner.layout().blocks()[block.field];
    let pulls = controls::only_pulls(owner, own) || controls::slot(owner, own) == Some("pull");
    let why =
        if pulls { ": the cable is slack there, whatever would come of pulling it further is not seen" } else { "" };
    let message = format!("{}: the derivative is exactly zero at the optimum, inside the bounds{why}", field.name);
    Some(Warning::new(&IDLE, message))
}

/// A control all of whose values lie on bounds.
fn bounds(run: &FinishedRun, block: &EnsembleBlock, field: &ControlField, problem: &CaseProblem) -> Option<Warning> {
    let m = block.of(&run.best.m);
    let components = problem.control_block(block).components;
    let on_bounds = controls::active(m, components, field);
    // a design that is 0 or 1 everywhere is what is looked for
    let is_design = problem.case.has_design(&problem.control_block(block).name);
    if is_design || m.is_empty() || on_bounds * components < m.len() {
        return None;
    }
    if let Some(limits) = &field.bounds {
        let derivative = block.of(&run.best.derivative);
        let own = problem.member(block.owner).reduced().layout_in_stage(run.best.stage);
        let values = own.blocks()[block.field].values_of(m);
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let (falls_below, falls_above) = (derivative.iter().all(|d| *d > 0.0), derivative.iter().all(|d| *d < 0.0));
        let at_zero =
            !field.log && (0..m.len()).all(|i| m[i] == 0.0 && (limits.at(i).0 == 0.0 || limits.at(i).1 == 0.0));
        if at_zero && (falls_below || falls_above) {
            let (bound, side) = if falls_below { ("lower", "below") } else { ("upper", "above") };
            let mut message =
                format!("{}: all values are 0, the {bound} bound, and the cost falls {side} it", field.name);
            let owner = problem.member(block.owner);
            let block = &owner.layout().blocks()[block.field];
            if controls::only_pulls(owner, block) {
                let noun = pulling(controls::slot(owner, block).unwrap_or_default()).noun;
                if noun != "muscle" && run.best.m.iter().any(|value| *value != 0.0) {
                    return None; // the antagonist of one that pulls
                }
                message += &format!(": this {noun} would have to push");
            }
            return Some(Warning::new(&OTHER_SIGN, message));
        }
        let outward = |i: usize| {
            let (lower, upper) = limits.at(i);
            (m[i] <= lower && derivative[i] > 0.0) || (m[i] >= upper && derivative[i] < 0.0)
        };
        if !(0..m.len()).all(outward) {
            return None; // the cost has its minimum there
        }
        let range = format!("from {} to {} {}", short(low), short(high), field.unit);
        let message = format!("{}: all {} values lie on a bound ({range})", field.name, m.len());
        return Some(Warning::new(&ALL_ON_BOUNDS, message));
    }
    let message = format!("{}: all {} vectors have the largest length allowed", field.name, on_bounds);
    Some(Warning::new(&ALL_ON_BOUNDS, message))
}

/// Terms that are small at the start and at the end.
fn terms(problem: &CaseProblem, run: &FinishedRun) -> Vec<Warning> {
    let ensemble = &problem.ensemble;
    let of = |point: &nastic_ensemble::EnsemblePoint| {
        ensemble.expected_terms(point.members.iter().map(|at| at.terms.as_slice()))
    };
    let (start, end) = (of(&run.start), of(&run.best.point));
    let size = |(name, value): &(String, f64)| {
        let before = start.iter().find(|(other, _)| other == name).map_or(0.0, |(_, value)| value.abs());
        (name.clone(), before.max(value.abs()))
    };
    let sizes: Vec<(String, f64)> = end.iter().map(size).collect();
    let Some((largest, most)) = sizes.iter().max_by(|a, b| a.1.total_cmp(&b.1)).cloned() else { return vec![] };
    let small = sizes.into_iter().filter(|(_, size)| *size > 0.0 && *size < NEGLIGIBLE * most);
    let warning_of = |(name, size): (String, f64)| {
        let (size, most) = (scientific(size, 2), scientific(most, 2));
        Warning::new(&NEGLIGIBLE_TERM, format!("{name} is at most {size}, {largest} {most}"))
    };
    small.map(warning_of).collect()
}

/// The optimum solved again from rest, in states as exact as those of the run, where the case asks for it.
pub(super) fn verify(context: CommandContext<'_>, run: &FinishedRun) -> Result<Option<Warning>, RunError> {
    let CommandContext { input, destination, console } = context;
    let (best, ensemble) = (&run.best, &input.problem.ensemble);
    if !input.problem.case.optimizer.verify {
        return Ok(None);
    }
    let again = match input.evaluate(console, &best.m, DEFAULT_ACCURACY, &mut EnsembleWorkspace::default()) {
        Ok(again) => again,
        Err(failed) => {
            return Ok(Some(Warning::new(&NOT_VERIFIED, format!("from rest it could not be solved: {failed}"))));
        }
    };
    let apart = |k: usize, b: &Evaluated| {
        let model = input.problem.member(k).solid().model();
        let Some(a) = best.point.member(k) else { return f64::NAN };
        let (a, b) = (model.displacement(&a.state().u), model.displacement(&b.state().u));
        norm(&sub(&a, &b)) / norm(&a).max(f64::MIN_POSITIVE)
    };
    let apart = ensemble.gathered(&again, apart).map_err(|error| destination.forward_failed(input, error))?;
    let most = apart.into_iter().fold(0.0, f64::max);
    Ok((most > SAME).then(|| {
        let (cost, other) = (scientific(best.point.risk, 6), scientific(again.risk, 6));
        let message =
            format!("displacements differ by {most:.1e} of their norm, the cost is {other} instead of {cost}");
        Warning::new(&NOT_VERIFIED, message)
    }))
}
