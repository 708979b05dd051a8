//! What an optimisation leaves behind, and what it says at the end.

use super::super::error::RunError;
use super::super::number::{count, short};
use super::super::session::Session;
use super::super::solve::{inertia, say_probes, title};
use super::{fall, revalued, valued, why};
use crate::result::picture::{self, Drawing};
use crate::result::snapshot::{self, View};
use crate::result::summary;
use nastic_control::Evaluated;
use nastic_mesh::Snapshot;
use nastic_opt::{Best, Stop};
use serde_json::{Value, json};

/// Writes `start.vtu`.
pub(super) fn write_start(session: &Session<'_>, start: &Evaluated, derivative: &[f64]) -> Result<(), RunError> {
    let Some(out) = &session.out else { return Ok(()) };
    Ok(out.write_vtu("start.vtu", &snapshot_of(session, start, derivative)?)?)
}

fn snapshot_of(session: &Session<'_>, point: &Evaluated, derivative: &[f64]) -> Result<Snapshot, RunError> {
    let view = View { state: &point.state, m: &point.m, adjoint: point.adjoint(), derivative: Some(derivative) };
    Ok(snapshot::snapshot(&session.problem, &view)?)
}

/// Fills the result, writes files, says how it went.
pub(super) fn report(session: &mut Session<'_>, start: &Evaluated, best: &Best<Evaluated>) -> Result<(), RunError> {
    let entries = valued(session, &best.point)?;
    session.put_all(entries);
    let begin = revalued(session, start).map(|start| valued(session, &start)).transpose()?;
    if let Some(begin) = begin {
        session.put("start", Value::Object(begin));
    }
    let norm = summary::derivative_norm(&session.problem, &best.derivative);
    session.put("derivative_norm", norm);
    session.put("gradient_norm", json!(best.gradient_norm));
    session.put("stop", json!(best.stop.to_string()));
    session.put("converged", json!(best.stop.is_converged()));
    session.put("iterations", json!(best.counts.iterations));
    session.put("trials", json!(best.counts.trials));
    session.put("failed_solves", json!(best.counts.failed));
    let stages: Vec<Value> = best
        .stages
        .iter()
        .map(|s| json!({ "stage": s.stage, "iterations": s.iterations, "converged": s.converged, "why": s.why }))
        .collect();
    session.put("stages", json!(stages));
    let entries = summary::state(&session.problem, &best.point.state, &best.m);
    session.put_all(entries);
    say(session, best);
    session.timed("write", |session| write(session, start, best))
}

fn say(session: &Session<'_>, best: &Best<Evaluated>) {
    let (console, result) = (session.console, session.result_value());
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    console.say("");
    console.say(format!("end         {}", why(&best.stop)));
    for stage in best.stages.iter().filter(|_| best.stages.len() > 1) {
        console.say(format!(
            "            stage {}: {}: {}",
            stage.stage + 1,
            count(stage.iterations, "iteration"),
            stage.why
        ));
    }
    let (from, to) = (number(&result["start"]["cost"]["total"]), number(&result["cost"]["total"]));
    console.say(format!("cost        {}", fall(from, to)));
    if let Some(terms) = result["cost"]["terms"].as_object().filter(|terms| terms.len() > 1) {
        for (name, value) in terms {
            let from = number(&result["start"]["cost"]["terms"][name]);
            console.say(format!("            {name} {}", fall(from, number(value))));
        }
    }
    if result["hausdorff"].is_object() {
        let unit = session.problem.units().length().symbol;
        let (from, to) = (number(&result["start"]["hausdorff"]["true"]), number(&result["hausdorff"]["true"]));
        console.say(format!("distance    true Hausdorff [{unit}] {}", fall(from, to)));
        console.say(format!(
            "            smoothed {} {unit}, target to itself {} {unit}",
            short(number(&result["hausdorff"]["smoothed"])),
            short(number(&result["hausdorff"]["self"]))
        ));
    }
    console.say(format!(
        "work        {}, {} ({} failed), {} Newton iterations, {} factorisations ({} reused)",
        count(best.counts.iterations, "iteration"),
        count(best.counts.trials, "trial"),
        best.counts.failed,
        result["newton_iterations"],
        result["factorisations"],
        result["reused_factorisations"]
    ));
    console.say(format!("stability   min J {}, {}", short(number(&result["min_J"])), inertia(&result)));
    for (name, control) in result["controls"].as_object().into_iter().flatten() {
        console.say(format!(
            "control     {name} from {} to {}, {} of {} on their bounds",
            short(number(&control["min"])),
            short(number(&control["max"])),
            control["active"],
            control["unknowns"]
        ));
    }
    say_probes(session, &result);
    if !best.stop.is_converged() {
        say_how_to_go_on(session, &best.stop);
    }
}

/// A run that stopped short can be taken up from its last control.
fn say_how_to_go_on(session: &Session<'_>, stop: &Stop) {
    let Some(out) = &session.out else { return };
    let console = session.console;
    match stop {
        Stop::Cancelled => console.say("to go on    start from the control that was reached:"),
        Stop::MaxIterations { .. } => {
            console.say("to go on    raise optimizer/max_iterations, or start from the control that was reached:");
        }
        _ => {
            console.say("to go on    try another optimizer/method or other stages, from the control that was reached:")
        }
    }
    let file = std::path::absolute(out.file("optimum.vtu")).unwrap_or_else(|_| out.file("optimum.vtu"));
    for (k, field) in session.problem.controls.iter().enumerate() {
        let start = json!({ "file": file.display().to_string(), "array": field.name });
        console.say(format!("            --set 'controls/{k}/start={start}'"));
    }
}

fn write(session: &mut Session<'_>, start: &Evaluated, best: &Best<Evaluated>) -> Result<(), RunError> {
    let Some(out) = session.out.clone() else { return Ok(()) };
    let optimum = snapshot_of(session, &best.point, &best.derivative)?;
    out.write_vtu("optimum.vtu", &optimum)?;
    let begin = View { state: &start.state, m: &start.m, adjoint: None, derivative: None };
    let begin = snapshot::snapshot(&session.problem, &begin)?;
    let drawing = Drawing {
        title: title(session),
        subtitle: format!("{}; cost {}", why(&best.stop), short(best.cost)),
        body: ("optimum", &optimum),
        ghost: Some(("start", &begin)),
    };
    picture::write(&session.problem, &drawing, &out)?;
    let iterations = if session.problem.case.output.every > 0 { ", iterations.pvd" } else { "" };
    let target = if session.problem.targets.is_empty() { "" } else { ", target.vtu" };
    session.console.say(format!(
        "files       start.vtu, optimum.vtu{target}{iterations}, history.jsonl, picture.png, picture.svg, result.json"
    ));
    Ok(())
}
