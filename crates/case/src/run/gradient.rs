//! `nastic gradient`: cost and derivative at the start controls, for optimisers of others.

use super::error::{Exit, RunError};
use super::number::{scientific, short};
use super::session::Session;
use super::solve::{ACCURACY, say_cost, say_probes, write_target};
use crate::result::snapshot::{self, View};
use crate::result::summary;
use nastic_control::Evaluated;
use nastic_opt::Request;
use serde_json::{Map, Value, json};

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    session.require(true, true)?;
    let point = session.timed("solve", |session| {
        session.console.pass("solving");
        let problem = &session.problem;
        // A request asks for the state's accuracy, which is a hundred times the residual's.
        let how = Request { near: None, accuracy: 100.0 * ACCURACY, stage: 0 };
        problem.reduced.try_evaluate(&problem.start, &how)
    });
    let point = point.map_err(|error| session.forward_failed(error))?;
    let derivative = session.timed("adjoint", |session| session.problem.reduced.derivative_of(&point, None));
    let derivative = derivative.map_err(|error| session.forward_failed(error))?;
    session.console.clear();
    report(session, &point, &derivative)?;
    session.timed("write", |session| write(session, &point, &derivative))?;
    Ok(Exit::Done)
}

fn report(session: &mut Session<'_>, point: &Evaluated, derivative: &[f64]) -> Result<(), RunError> {
    let valued = summary::valued(&session.problem, point).map_err(|error| session.forward_failed(error))?;
    session.put_all(valued);
    let norm = summary::derivative_norm(&session.problem, derivative);
    session.put("derivative_norm", norm);
    let entries = summary::state(&session.problem, &point.state, &point.m);
    session.put_all(entries);
    session.put_all(summary::work(&point.total_work()));
    let result = session.result_value();
    say_cost(session, &result);
    let entry =
        |key: &str| result["derivative_norm"][key].as_f64().map_or_else(|| "-".to_owned(), |x| scientific(x, 9));
    session.console.say(format!(
        "derivative  Euclidean norm {}, norm in the metric {}",
        entry("euclidean"),
        entry("metric")
    ));
    for (block, field) in session.problem.layout().blocks().iter().zip(&session.problem.controls) {
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
    say_probes(session, &result);
    Ok(())
}

fn write(session: &mut Session<'_>, point: &Evaluated, derivative: &[f64]) -> Result<(), RunError> {
    let Some(out) = session.out.clone() else { return Ok(()) };
    let problem = &session.problem;
    let blocks = problem.layout().blocks().iter().zip(&problem.controls);
    let arrays: Map<String, Value> =
        blocks.map(|(block, field)| (field.name.clone(), json!(block.of(derivative)))).collect();
    out.write_json("derivative.json", &Value::Object(arrays))?;
    let view = View { state: &point.state, m: &point.m, adjoint: point.adjoint(), derivative: Some(derivative) };
    out.write_vtu("start.vtu", &snapshot::snapshot(problem, &view)?)?;
    write_target(session)?;
    session.put("files", json!(["derivative.json", "start.vtu"]));
    session.console.say("files       derivative.json, start.vtu, result.json");
    Ok(())
}
