//! `nastic solve`: the equilibrium at the start controls.

use super::error::{Exit, RunError};
use super::number::{scientific, short, vector};
use super::session::Session;
use crate::result::picture::{self, Drawing};
use crate::result::snapshot::{self, View};
use crate::result::summary;
use nastic_control::ControlError;
use nastic_fem::{Progress, Request, Solved, Solver, State};
use serde_json::{Value, json};

/// Relative residual asked for: as near to exact as it is cheap to be.
pub(super) const ACCURACY: f64 = 1e-12;

pub(super) fn run(session: &mut Session<'_>) -> Result<Exit, RunError> {
    let solved = session.timed("solve", |session| equilibrium(session));
    let Solved { state, .. } = solved.map_err(|error| session.forward_failed(error))?;
    let m = session.problem.start.clone();
    report(session, &state, &m)?;
    session.timed("write", |session| write(session, &state, &m))?;
    Ok(Exit::Done)
}

fn equilibrium(session: &Session<'_>) -> Result<Solved, ControlError> {
    let problem = &session.problem;
    let controls = problem.layout().to_points(&problem.start)?;
    let watch = |progress: &Progress| {
        session.console.pass(format!(
            "solving: load {:.4}, Newton iteration {}, residual {:.1e}",
            progress.load, progress.newton, progress.residual
        ));
    };
    let how = Request { accuracy: ACCURACY, cancel: Some(&session.cancel), watch: Some(&watch), ..Request::default() };
    let solved = problem.solid().solve(&controls, &how);
    session.console.clear();
    Ok(solved?)
}

fn report(session: &mut Session<'_>, state: &State, m: &[f64]) -> Result<(), RunError> {
    if !session.problem.reduced.costs().is_empty() {
        let problem = &session.problem;
        let terms = problem.terms(state, m, 0).map_err(|error| session.forward_failed(error))?;
        let figures = summary::hausdorff(problem, state, m, 0).map_err(|error| session.forward_failed(error))?;
        let cost = summary::cost(problem, &terms);
        session.put("stage", json!(0));
        session.put("cost", cost);
        if !figures.is_null() {
            session.put("hausdorff", figures);
        }
    }
    let entries = summary::state(&session.problem, state, m);
    session.put_all(entries);
    session.put_all(summary::work(&state.report));
    session.put("load_steps", json!(state.report.load_steps));
    say(session, state);
    Ok(())
}

fn say(session: &Session<'_>, state: &State) {
    let (console, result) = (session.console, session.result_value());
    let work = &state.report;
    console.say(format!(
        "equilibrium {} Newton iterations in {} load steps ({} cut), {} factorisations ({} reused), residual {}",
        work.newton,
        work.load_steps,
        work.cuts,
        work.factorisations,
        work.reused,
        scientific(work.residual, 1)
    ));
    if work.solver == Solver::Multigrid {
        console.say(format!("linear      multigrid: {} cycles on {} sets of levels", work.cycles, work.hierarchies));
    }
    console.say(format!("stability   min J {}, {}", short(work.min_j), inertia(&result)));
    say_cost(session, &result);
    say_probes(session, &result);
    say_reactions(session, &result);
}

/// What the inertia means.
pub(super) fn inertia(result: &Value) -> String {
    match result["inertia"].as_u64() {
        Some(0) => "stable (no negative pivot of the tangent)".to_owned(),
        Some(1) => "UNSTABLE: 1 negative pivot of the tangent".to_owned(),
        Some(n) => format!("UNSTABLE: {n} negative pivots of the tangent"),
        None => "the tangent is singular: a bifurcation".to_owned(),
    }
}

/// Cost and distance, where there are any.
pub(super) fn say_cost(session: &Session<'_>, result: &Value) {
    let number = |value: &Value| value.as_f64().map_or_else(|| "-".to_owned(), |x| scientific(x, 9));
    if let Some(terms) = result["cost"]["terms"].as_object() {
        session.console.say(format!("cost        {}", number(&result["cost"]["total"])));
        if terms.len() > 1 {
            for (name, value) in terms {
                session.console.say(format!("            {name} {}", number(value)));
            }
        }
    }
    if let Some(distance) = result["hausdorff"].as_object() {
        let entry = |key: &str| distance.get(key).and_then(Value::as_f64).map_or_else(|| "-".to_owned(), short);
        let unit = session.problem.units().length().symbol;
        session.console.say(format!(
            "distance    true Hausdorff {} {unit}, smoothed {} {unit}, target to itself {} {unit}",
            entry("true"),
            entry("smoothed"),
            entry("self")
        ));
    }
}

/// The probes' displacements.
pub(super) fn say_probes(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().length().symbol;
    for (name, probe) in result["probes"].as_object().into_iter().flatten() {
        let u = numbers(&probe["displacement"]);
        let digits = u.iter().map(|x| format!("{x:.9}")).collect::<Vec<_>>().join(", ");
        session.console.say(format!("probe       {name} moves by ({digits}) {unit}"));
    }
}

fn say_reactions(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().force().symbol;
    for (name, force) in result["reactions"].as_object().into_iter().flatten() {
        session.console.say(format!("reaction    {name} holds with {} {unit}", vector(&numbers(force))));
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

fn write(session: &mut Session<'_>, state: &State, m: &[f64]) -> Result<(), RunError> {
    let Some(out) = session.out.clone() else { return Ok(()) };
    let problem = &session.problem;
    let start = snapshot::snapshot(problem, &View { state, m, adjoint: None, derivative: None })?;
    out.write_vtu("start.vtu", &start)?;
    write_target(session)?;
    let drawing = Drawing {
        title: title(session),
        subtitle: format!("equilibrium at the start control, min J {}", short(state.report.min_j)),
        body: ("equilibrium", &start),
        ghost: None,
    };
    picture::write(problem, &drawing, &out)?;
    session.put("files", json!(["start.vtu", "picture.png", "picture.svg"]));
    session.console.say("files       start.vtu (the equilibrium), picture.png, picture.svg, result.json");
    Ok(())
}

/// `target.vtu` of the first target; further ones bear their cost's name.
pub(super) fn write_target(session: &Session<'_>) -> Result<(), RunError> {
    let Some(out) = &session.out else { return Ok(()) };
    for (k, shape) in session.problem.targets.iter().enumerate() {
        let name = if k == 0 { "target.vtu".to_owned() } else { format!("target_{}.vtu", file_name(&shape.cost)) };
        out.write_vtu(&name, &snapshot::target(shape)?)?;
    }
    Ok(())
}

/// A name without what file systems dislike.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' || c == '.' { c } else { '_' }).collect()
}

/// The title of pictures.
pub(super) fn title(session: &Session<'_>) -> String {
    let problem = &session.problem;
    problem.case.title.clone().unwrap_or_else(|| problem.document.name().to_owned())
}
