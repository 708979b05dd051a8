//! The equilibrium at the start controls, with its modes or others beside it.

use crate::console::Console;
use crate::run::error::{Exit, RunError};
use crate::run::motion;
use crate::run::report::entries;
use crate::run::session::{CommandContext, CommandFindings, evaluate_start};
use crate::run::solve::{equilibria, exact_contact, half_thickness, minimum, modes};
use crate::run::states::Shown;
use crate::run::terminal::{say_cost, say_members, say_probes, say_reactions, say_stability, say_tracked};
use crate::run::{contacts, unmet};
use nastic_case::analysis::Analysis;
use nastic_case::inspect::stillness;
use nastic_case::lower::CaseProblem;
use nastic_control::StateFields;
use nastic_ensemble::{EnsemblePoint, EnsembleWorkspace};
use nastic_fem::{Modes, SolveReport};
use nastic_language::number::short;
use nastic_numeric::format::scientific;
use nastic_report::record::RunRecord;
use nastic_result::collections::write_collections;
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::picture::Drawing;
use nastic_result::target_files::write_targets;
use nastic_result::title::title;
use nastic_result::{controls, picture, snapshot};

/// The equilibrium at the start controls, with its modes or others beside it.
pub(crate) fn equilibrium(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    analysis: &Analysis,
) -> Result<Exit, RunError> {
    let CommandContext { input, destination, console } = context;
    if *analysis == Analysis::ExactContact {
        exact_contact::check(input, destination)?;
    }
    if *analysis == Analysis::HalfThickness {
        half_thickness::check(&input.problem)?;
    }
    let mut point = evaluate_start(context, findings, &mut EnsembleWorkspace::default())?;
    if *analysis == Analysis::Minimum {
        point = findings.timed(console, "descent", |_| minimum::descend(context, point))?;
    }
    let found = findings.inspect(input, console, motion::state_name(&input.problem), &point);
    let still = input.problem.members().zip(&point.members);
    findings.warn_all(console, still.filter_map(|(member, at)| stillness(member, [at.state()])));
    report(context, findings, &point, &found)?;
    let modes = match analysis {
        Analysis::Modes(count) => {
            findings.timed(console, "modes", |_| modes::find(input, destination, &point, *count))?
        }
        _ => Vec::new(),
    };
    modes::report(&input.problem, console, findings, &modes);
    findings.write(console, destination, |own, out| write(&input.problem, own, &point, &found, &[], &modes, out))?;
    let exit = match analysis {
        Analysis::Equilibria(count) => equilibria::run(context, findings, &point, *count)?,
        Analysis::ExactContact => exact_contact::run(context, findings, &point)?,
        Analysis::HalfThickness => half_thickness::run(context, findings, &point)?,
        _ => Exit::Done,
    };
    show(&input.problem, findings, point, None, found);
    Ok(exit)
}

/// Keeps the equilibria at the start controls for the caller of the command.
pub(crate) fn show(
    problem: &CaseProblem,
    findings: &mut CommandFindings,
    point: EnsemblePoint,
    derivative: Option<Vec<f64>>,
    inspections: Vec<Inspection>,
) {
    let subtitle = subtitle(problem, findings, point.members.iter().map(|at| at.min_j()).fold(f64::INFINITY, f64::min));
    let what = motion::state_name(problem);
    findings.shown = Some(Shown { what, subtitle, point, derivative, start: None, inspections });
}

/// The line below the title of a picture.
fn subtitle(problem: &CaseProblem, findings: &CommandFindings, min_j: f64) -> String {
    let distance = picture::distance(&findings.record.state, problem.units().length().symbol);
    let what = motion::state_name(problem);
    let at = if problem.start.is_empty() { "" } else { " at the start controls" };
    format!("{what}{at}, min J {}{distance}{}", short(min_j), findings.warned())
}

/// Puts what the equilibria are into the result and says it.
pub(crate) fn report(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    point: &EnsemblePoint,
    found: &[Inspection],
) -> Result<(), RunError> {
    let CommandContext { input, destination, console } = context;
    findings.record.state = entries(input, destination, point, found)?;
    findings.record.controls = Some(controls::controls(&input.problem, &point.m, 0));
    findings.record.load_steps = point.members.iter().map(|at| at.state().report.load_steps).max();
    say(&input.problem, console, &findings.record, point);
    contacts::report(&input.problem, console, findings, point);
    unmet::look_at(context, findings, point)
}

fn say(problem: &CaseProblem, console: &Console, result: &RunRecord, point: &EnsemblePoint) {
    let states = || point.members.iter().map(|at| at.state());
    let mut work = SolveReport::default();
    point.members.iter().for_each(|at| work.add_work(&at.work));
    if work.newton == 0 && states().all(|state| state.u.iter().all(|u| *u == 0.0)) {
        console.say("equilibrium the state of rest: nothing deforms the body at the start controls");
    }
    let of_steps =
        format!(" in {} load steps ({} cut)", states().map(|state| state.report.load_steps).sum::<usize>(), work.cuts);
    let moves = problem.is_motion();
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
    say_stability(problem, console, result);
    say_cost(problem, console, result);
    say_members(console, result);
    say_tracked(problem, console, result);
    say_probes(problem, console, result);
    say_reactions(problem, console, result);
}

pub(crate) fn write(
    problem: &CaseProblem,
    findings: &CommandFindings,
    point: &EnsemblePoint,
    found: &[Inspection],
    records: &[motion::Record],
    modes: &[Modes],
    out: &Directory,
) -> Result<Vec<String>, RunError> {
    // first the numbers of a motion, which nothing else holds
    let of_motion = motion::write(problem, records, out)?;
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
            subtitle: subtitle(problem, findings, at.min_j()) + &picture::legend(&shot),
            body: (motion::state_name(problem), &shot),
            ghosts: picture::named(&ghosts),
            scenarios: Vec::new(),
            mean: None,
        };
        let draw = || picture::write(member, picture::compose(member, &drawing), out);
        let (written, drawn) = rayon::join(write, draw);
        files.extend(written?);
        drawn?;
        files.extend(["picture.png", "picture.svg"].map(|name| member.case_file(name)));
    }
    files.extend(write_targets(problem, out)?);
    files.extend(write_collections(problem, "start", out)?);
    files.extend(of_motion);
    Ok(files)
}
