//! The equilibrium at the start controls, with its modes or others beside it.

use crate::run::error::{Exit, RunError};
use crate::run::motion;
use crate::run::report::say_files;
use crate::run::session::Session;
use crate::run::solve::{equilibria, exact_contact, half_thickness, minimum, modes};
use crate::run::states::Shown;
use crate::run::terminal::{say_cost, say_members, say_probes, say_reactions, say_stability, say_tracked};
use nastic_case::analysis::Analysis;
use nastic_case::inspect::stillness;
use nastic_case::warning::Warning;
use nastic_control::StateFields;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_fem::{Modes, SolveReport};
use nastic_language::number::short;
use nastic_numeric::format::scientific;
use nastic_result::collections::write_collections;
use nastic_result::inspection::Inspection;
use nastic_result::picture::Drawing;
use nastic_result::target_files::write_targets;
use nastic_result::title::title;
use nastic_result::{controls, picture, snapshot};

/// The equilibrium at the start controls, with its modes or others beside it.
pub(crate) fn equilibrium(session: &mut Session<'_>, analysis: &Analysis) -> Result<Exit, RunError> {
    if *analysis == Analysis::ExactContact {
        exact_contact::check(session)?;
    }
    if *analysis == Analysis::HalfThickness {
        half_thickness::check(&session.input.problem)?;
    }
    let mut point = session.evaluate_start(&mut EnsembleWorkspace::default())?;
    if *analysis == Analysis::Minimum {
        point = session.timed("descent", |session| minimum::descend(session, point))?;
    }
    let found = session.inspect(motion::state_name(&session.input.problem), &point);
    let still = session.input.problem.members().zip(&point.members);
    let still: Vec<Warning> = still.filter_map(|(member, at)| stillness(member, [at.state()])).collect();
    still.into_iter().for_each(|warning| session.warn(warning));
    report(session, &point, &found)?;
    let modes = match analysis {
        Analysis::Modes(count) => session.timed("modes", |session| modes::find(session, &point, *count))?,
        _ => Vec::new(),
    };
    modes::report(session, &modes);
    session.timed("write", |session| write(session, &point, &found, &[], &modes))?;
    let exit = match analysis {
        Analysis::Equilibria(count) => equilibria::run(session, &point, *count)?,
        Analysis::ExactContact => exact_contact::run(session, &point)?,
        Analysis::HalfThickness => half_thickness::run(session, &point)?,
        _ => Exit::Done,
    };
    show(session, point, None, found);
    Ok(exit)
}

/// Keeps the equilibria at the start controls for the caller of the command.
pub(crate) fn show(
    session: &mut Session<'_>,
    point: EnsemblePoint,
    derivative: Option<Vec<f64>>,
    inspections: Vec<Inspection>,
) {
    let subtitle = subtitle(session, point.members.iter().map(|at| at.min_j()).fold(f64::INFINITY, f64::min));
    let what = motion::state_name(&session.input.problem);
    session.findings.shown = Some(Shown { what, subtitle, point, derivative, start: None, inspections });
}

/// The line below the title of a picture.
fn subtitle(session: &Session<'_>, min_j: f64) -> String {
    let distance = picture::distance(&session.findings.record.state, session.input.problem.units().length().symbol);
    let what = motion::state_name(&session.input.problem);
    let at = if session.input.problem.start.is_empty() { "" } else { " at the start controls" };
    format!("{what}{at}, min J {}{distance}{}", short(min_j), session.warned())
}

/// Puts what the equilibria are into the result and says it.
pub(crate) fn report(session: &mut Session<'_>, point: &EnsemblePoint, found: &[Inspection]) -> Result<(), RunError> {
    let entries = session.entries(point, found)?;
    session.findings.record.state = entries;
    session.findings.record.controls = Some(controls::controls(&session.input.problem, &point.m, 0));
    session.findings.record.load_steps = point.members.iter().map(|at| at.state().report.load_steps).max();
    say(session, point);
    session.report_contacts(point);
    session.look_at_unmet(point)?;
    Ok(())
}

fn say(session: &Session<'_>, point: &EnsemblePoint) {
    let states = || point.members.iter().map(|at| at.state());
    let (console, result) = (session.console, &session.findings.record);
    let mut work = SolveReport::default();
    point.members.iter().for_each(|at| work.add_work(&at.work));
    if work.newton == 0 && states().all(|state| state.u.iter().all(|u| *u == 0.0)) {
        console.say("equilibrium the state of rest: nothing deforms the body at the start controls");
    }
    let of_steps =
        format!(" in {} load steps ({} cut)", states().map(|state| state.report.load_steps).sum::<usize>(), work.cuts);
    let moves = session.input.problem.is_motion();
    let by_levels = work.cycles > 0 && work.factorisations == 0;
    let factors = format!(", {} factorisations ({} reused)", work.factorisations, work.reused);
    console.say(format!(
        "{:<12}{} Newton iterations{}{}, residual {}",
        if moves { "work" } else { "equilibrium" },
        work.newton,
        if moves { "" } else { of_steps.as_str() },
        if by_levels { "" } else { factors.as_str() },
        scientific(states().map(|state| state.report.residual).fold(0.0, f64::max), 1)
    ));
    if work.unpredicted > 0 {
        console.say(format!(
            "pressures   predicted ones led nowhere {} times: steps by the displacement alone",
            work.unpredicted
        ));
    }
    if work.cycles > 0 {
        let tangents = match work.unassembled {
            0 => "tangents assembled".to_owned(),
            systems => format!("{systems} systems by products of cells, without an assembled tangent"),
        };
        let (cycles, levels) = (work.cycles, work.hierarchies);
        let kept = if by_levels && work.reused > 0 {
            format!(", which served {} systems more", work.reused)
        } else {
            String::new()
        };
        let then = if by_levels { "" } else { "; a factor where these did not serve" };
        console
            .say(format!("linear      multigrid: {cycles} cycles on {levels} sets of levels{kept}, {tangents}{then}"));
    }
    say_stability(session, result);
    say_cost(session, result);
    say_members(session, result);
    say_tracked(session, result);
    say_probes(session, result);
    say_reactions(session, result);
}

pub(crate) fn write(
    session: &mut Session<'_>,
    point: &EnsemblePoint,
    found: &[Inspection],
    records: &[motion::Record],
    modes: &[Modes],
) -> Result<(), RunError> {
    let Some(out) = session.destination.out.clone() else { return Ok(()) };
    let problem = &session.input.problem;
    // first the numbers of a motion, which nothing else holds
    let of_motion = motion::write(problem, records, &out)?;
    let mut files = Vec::new();
    for (member, at) in problem.members().zip(&point.members) {
        let found = found.get(member.index());
        let mut shot = snapshot::inspected(member, &StateFields::of(at), found)?;
        if let Some(modes) = modes.get(member.index()) {
            shot = modes::with_fields(shot, modes.shapes.iter().map(Vec::as_slice))?;
        }
        let write = || out.write_state(&member.file("start"), &shot);
        if member.part().scenario() > 0 {
            files.extend(write()?);
            continue;
        }
        let ghosts = motion::ghosts(records, member, at)?;
        let drawing = Drawing {
            title: title(member),
            subtitle: subtitle(session, at.min_j()) + &picture::legend(&shot),
            body: (motion::state_name(problem), &shot),
            ghosts: picture::named(&ghosts),
            scenarios: Vec::new(),
            mean: None,
        };
        let draw = || picture::write(member, picture::compose(member, &drawing), &out);
        let (written, drawn) = rayon::join(write, draw);
        files.extend(written?);
        drawn?;
        files.extend(["picture.png", "picture.svg"].map(|name| member.case_file(name)));
    }
    files.extend(write_targets(problem, &out)?);
    files.extend(write_collections(problem, "start", &out)?);
    files.extend(of_motion);
    say_files(session, files);
    Ok(())
}
