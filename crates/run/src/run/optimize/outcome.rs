//! What an optimisation leaves behind, and what it says at the end.

use crate::run::constraints::Known;
use crate::run::error::RunError;
use crate::run::gradient::write_states;
use crate::run::optimize::advice;
use crate::run::optimize::cut;
use crate::run::optimize::identification::Identified;
use crate::run::optimize::spectrum::Diagnosis;
use crate::run::optimize::starts::start_run::FinishedRun;
use crate::run::optimize::starts::table;
use crate::run::options::Options;
use crate::run::session::{CommandContext, CommandFindings, CommandInput, Destination};
use crate::run::spectrum_request::SpectrumRequest;
use crate::run::states::Shown;
use crate::run::terminal::{
    known as known_number, say_first_order, say_members, say_probes, say_stability, say_tracked,
};
use crate::run::{constraints, contacts, motion};
use crate::saved::checkpoint::Place;
use nastic_case::film::kilovolts;
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_control::StateFields;
use nastic_ensemble::EnsemblePoint;
use nastic_fem::SolveReport;
use nastic_language::number::{count, short};
use nastic_mesh::Snapshot;
use nastic_numeric::format::scientific;
use nastic_opt::{Best, Objective, StageEnd, Stop};
use nastic_picture::Picture;
use nastic_report::record::{OptimumRecord, RunRecord, StageRecord, StartRecord, number_of};
use nastic_result::collections::write_collections;
use nastic_result::cut_design::MemberShape;
use nastic_result::files::{Directory, state_files};
use nastic_result::inspection::Inspection;
use nastic_result::member_report::Detail;
use nastic_result::picture::Drawing;
use nastic_result::target_files::write_targets;
use nastic_result::title::{title, title_of_scenarios};
use nastic_result::{controls, convergence, cut_design, member_report, picture, snapshot, summary};

/// What is reported of an optimisation.
pub(super) struct Reported<'r> {
    /// The number of the best start, and its run.
    pub index: usize,
    pub ended: &'r FinishedRun,
    /// Its start as the stage in which it ended values it.
    pub begin: Option<&'r EnsemblePoint>,
    pub known: &'r [Known],
    pub diagnosis: Option<&'r Diagnosis>,
    pub identified: Option<&'r Identified>,
    /// The entries of all starts.
    pub starts: &'r [StartRecord],
    /// Where an interrupted one goes on.
    pub resumable: Option<Place>,
}

/// Writes the states at the start and the targets.
pub(super) fn write_start(
    problem: &CaseProblem,
    destination: &Destination,
    start: &EnsemblePoint,
    derivative: &[f64],
    found: &[Inspection],
) -> Result<(), RunError> {
    let Some(out) = &destination.out else { return Ok(()) };
    write_targets(problem, out)?;
    write_states(problem, "start", start, derivative, found, out).map(|_| ())
}

/// Fills the result, writes files, says how it went.
pub(super) fn report(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    reported: &Reported<'_>,
) -> Result<Vec<Inspection>, RunError> {
    let CommandContext { input, destination, console } = context;
    let &Reported { index, ended, begin, known, starts, .. } = reported;
    let FinishedRun { best, work, .. } = ended;
    let found = findings.inspect(input, console, "optimum", &best.point);
    let problem = &input.problem;
    let records = motion::records(input, destination, &best.point)?;
    motion::warn(problem, console, findings, &records);
    let reports = member_report::of_inspected(problem, &best.point, &found);
    let mut reports = reports.map_err(|error| destination.member_failed(input, error.0, error.1))?;
    reports.iter_mut().zip(work).for_each(|(one, work)| one.work = *work);
    let entries = member_report::entries(problem, &reports, Detail::Full);
    let entries = entries.map_err(|error| destination.member_failed(input, error.0, error.1))?;
    drop(reports);
    let begin =
        begin.map(|start| member_report::entries(problem, &member_report::of_point(problem, start)?, Detail::Costs));
    let begin = begin.transpose().map_err(|error| destination.member_failed(input, error.0, error.1))?;
    let derivative_norm = controls::derivative_norm(problem, &best.derivative);
    let controls = controls::controls(problem, &best.m, best.stage);
    findings.record.state = entries;
    findings.record.start = begin.unwrap_or_default();
    findings.record.controls = Some(controls);
    findings.record.derivative_norm = derivative_norm;
    motion::report(input, console, findings, &records, &best.point);
    add_run(&mut findings.record.optimum, ended, known);
    if starts.len() > 1 {
        findings.record.optimum.starts = Some(starts.to_vec());
        findings.record.optimum.best_start = Some(index);
    }
    let mut total = SolveReport::default();
    work.iter().for_each(|work| total.add_work(work));
    summary::add_work(&mut findings.record, &total);
    console.say("");
    table::say(problem, console, starts, index);
    say(context, &findings.record, reported);
    contacts::report(problem, console, findings, &best.point);
    findings.write(console, destination, |own, out| write(context, own, reported, &found, &records, out))?;
    cut::solve(context, findings, best);
    Ok(found)
}

/// How the run went, into the result.
fn add_run(record: &mut OptimumRecord, FinishedRun { best, constraints, limits, .. }: &FinishedRun, known: &[Known]) {
    let stage = |s: &StageEnd| StageRecord {
        stage: s.stage,
        iterations: s.iterations,
        converged: s.converged,
        why: s.why.to_string(),
    };
    record.constraints = constraints::record(constraints, known);
    record.gradient_norm = best.gradient_norm.into();
    record.stop = Some(best.stop.to_string());
    record.converged = Some(best.stop.is_converged());
    record.iterations = Some(best.counts.iterations);
    record.trials = Some(best.counts.trials);
    record.failed_solves = Some(best.counts.failed);
    record.limit_points = limits.record();
    record.hessian_products = Some(best.counts.products).filter(|products| *products > 0);
    let mut stages: Vec<StageRecord> = best.stages.iter().map(stage).collect();
    if best.stages.last().is_none_or(|last| last.stage < best.stage) {
        // an interruption ends no stage
        let iterations = best.counts.iterations - best.stages.iter().map(|stage| stage.iterations).sum::<usize>();
        stages.push(StageRecord { stage: best.stage, iterations, converged: false, why: best.stop.to_string() });
    }
    record.stages = Some(stages);
}

/// The line below the title of a picture.
fn subtitle(problem: &CaseProblem, findings: &CommandFindings, best: &Best<EnsemblePoint>) -> String {
    let distance = picture::distance(&findings.record.state, problem.units().length().symbol);
    let (why, iterations) = (why(&best.stop), count(best.counts.iterations, "iteration"));
    // A limit of iterations names them itself.
    let end = if why.contains("iteration") { why } else { format!("{iterations}: {why}") };
    format!("{end}; cost {}{distance}{}", short(best.cost), findings.warned())
}

/// Whether results of an optimisation lie there that a program before has found: what it began with removed those of others.
pub(super) fn has_results(input: &CommandInput, destination: &Destination) -> bool {
    let text = destination.out.as_ref().and_then(|out| std::fs::read(out.file("result.json")).ok());
    let earlier = text.and_then(|text| serde_json::from_slice::<Earlier>(&text).ok()).unwrap_or_default();
    earlier.iterations.is_some() && earlier.command == input.command.name()
}

/// What an earlier result says of itself.
#[derive(Default, serde::Deserialize)]
#[serde(default)]
struct Earlier {
    command: String,
    iterations: Option<usize>,
}

/// Keeps the best states for the caller of the command.
pub(super) fn show(
    problem: &CaseProblem,
    findings: &mut CommandFindings,
    ended: FinishedRun,
    inspections: Vec<Inspection>,
) {
    let FinishedRun { start, best, .. } = ended;
    let subtitle = subtitle(problem, findings, &best);
    let (derivative, start) = (Some(best.derivative), Some(start));
    findings.shown = Some(Shown { what: "optimum", subtitle, point: best.point, derivative, start, inspections });
}

fn say(context: CommandContext<'_>, result: &RunRecord, reported: &Reported<'_>) {
    let CommandContext { input, console, .. } = context;
    let &Reported { ended, known, diagnosis, identified, resumable, .. } = reported;
    let (problem, best) = (&input.problem, &ended.best);
    console.say(format!("end         {}", why(&best.stop)));
    for stage in best.stages.iter().filter(|_| best.stages.len() > 1) {
        console.say(format!(
            "            stage {}: {}: {}",
            stage.stage + 1,
            count(stage.iterations, "iteration"),
            stage.why
        ));
    }
    let (from, now) = (&result.start.cost, &result.cost);
    match result.risk.unsmoothed() {
        Some(exact) => {
            let what = result.risk.words(problem.ensemble.scenarios().len());
            console.say(format!("cost        {}; {what}", fall(result.start.risk.unsmoothed(), Some(exact))));
            console.say(format!("            smoothed, as it is optimised, {}", fall(*from.total, *now.total)));
        }
        None => console.say(format!("cost        {}", fall(*from.total, *now.total))),
    }
    for (name, value) in now.terms.iter().filter(|_| now.terms.len() > 1) {
        console.say(format!("            {name} {}", fall(number_of(&from.terms, name), **value)));
    }
    say_first_order(console, result);
    constraints::say(problem, console, &ended.constraints, known);
    if let Some(now) = &result.hausdorff {
        let unit = problem.units().length().symbol;
        let from = result.start.hausdorff.as_ref().and_then(|distances| *distances.exact);
        let [smoothed, floor] = [now.smoothed, now.floor].map(|x| short(known_number(*x)));
        console.say(format!("distance    true Hausdorff [{unit}] {}", fall(from, *now.exact)));
        console.say(format!("            smoothed {smoothed} {unit}, target to itself {floor} {unit}"));
    }
    say_tracked(problem, console, result);
    console.say(format!(
        "work        {}, {} ({} failed){}, {} Newton iterations, {} factorisations ({} reused)",
        count(best.counts.iterations, "iteration"),
        count(best.counts.trials, "trial"),
        best.counts.failed,
        match best.counts.products {
            0 => String::new(),
            products => format!(", {}", count(products, "Hessian product")),
        },
        result.newton_iterations.unwrap_or_default(),
        result.factorisations.unwrap_or_default(),
        result.reused_factorisations.unwrap_or_default()
    ));
    ended.limits.say().into_iter().for_each(|line| console.say(line));
    say_stability(problem, console, result);
    say_members(console, result);
    for (name, control) in result.controls.iter().flatten() {
        let unit = control.unit.as_ref().filter(|unit| *unit != "1");
        let unit = unit.map_or_else(String::new, |unit| format!(" {unit}"));
        let area = format!("{}^{}", problem.units().length().symbol, problem.mesh().dim() - 1);
        let variation = control.total_variation.filter(|_| control.space.as_deref() != Some("uniform"));
        let variation =
            variation.map(|v| format!(", total variation {}{unit} {}", short(v), area.trim_end_matches("^1")));
        let volts = control.voltage.as_ref().map(|range| kilovolts([range.min, range.max].map(|u| known_number(*u))));
        let volts = volts.map_or_else(String::new, |volts| format!(" ({volts} over the film at rest)"));
        let design = (*control.volume).zip(*control.greyness).map_or_else(String::new, |(volume, greyness)| {
            format!(", mean {}, greyness {}", short(volume), short(greyness))
        });
        console.say(format!(
            "control     {name} from {} to {}{unit}{volts}, {} of {} on their bounds{}{design}",
            short(known_number(*control.min)),
            short(known_number(*control.max)),
            control.active.unwrap_or_default(),
            control.unknowns.unwrap_or_default(),
            variation.unwrap_or_default()
        ));
    }
    if let Some(diagnosis) = diagnosis {
        diagnosis.say(input, console);
    }
    if let Some(identified) = identified {
        identified.say(input, console);
    }
    say_probes(problem, console, result);
    match resumable {
        Some(checkpoint) => say_how_to_resume(context, checkpoint),
        None => advice::say(context, ended),
    }
}

/// A run that was interrupted goes on from its last checkpoint.
pub(super) fn say_how_to_resume(context: CommandContext<'_>, Place { start, iteration }: Place) {
    let CommandContext { input, destination, console } = context;
    let Some(out) = &destination.out else { return };
    let of = if input.problem.case.optimizer.starts > 1 { format!(" of start {}", start + 1) } else { String::new() };
    match input.problem.case_file() {
        Some(_) => {
            console.say(format!("to go on    nastic resume {}{}", out.path().display(), spectrum(&input.options)))
        }
        None => console.say(format!("to go on    Study::resume, with the results in {}", out.path().display())),
    }
    console.say(format!("            from iteration {iteration}{of}, with the result of a run without interruption"));
}

fn write(
    context: CommandContext<'_>,
    findings: &mut CommandFindings,
    reported: &Reported<'_>,
    found: &[Inspection],
    records: &[motion::Record],
    out: &Directory,
) -> Result<Vec<String>, RunError> {
    let CommandContext { input, destination, console } = context;
    let &Reported { index, ended, diagnosis, identified, starts, .. } = reported;
    let (problem, FinishedRun { start, best, .. }) = (&input.problem, ended);
    // first the numbers of a motion, which nothing else holds
    let of_motion = motion::write(problem, records, out)?;
    let mut files = vec!["history.jsonl".to_owned()];
    let lead = problem.leads().next().map_or_else(String::new, title);
    let several = problem.case.optimizer.starts > 1;
    files.extend(convergence::write(out, &lead, several.then_some(index))?);
    out.write_json("controls.json", &controls::control_values(problem, &best.m))?;
    files.push("controls.json".to_owned());
    if let Some(diagnosis) = diagnosis {
        files.extend(diagnosis.write(problem, out)?);
    }
    if let Some(identified) = identified {
        files.extend(identified.write(out)?);
    }
    files.extend(write_states(problem, "optimum", &best.point, &best.derivative, found, out)?);
    let (mut together, mut shapes): (Vec<Picture>, _) = (Vec::new(), Vec::new());
    for member in problem.leads() {
        let shot = |point: &EnsemblePoint, member: CaseMember<'_>| {
            let at = &point.members[member.index()];
            snapshot::plain(member, &StateFields::of(at))
        };
        let (begin, end) = (shot(start, member)?, shot(&best.point, member)?);
        let state = &best.point.members[member.index()];
        shapes.push(MemberShape::new(member, StateFields::of(state).state, end.positions()));
        let others = problem.members().filter(|other| other.load_case() == member.load_case()).skip(1);
        let others = others.take(picture::SCENARIOS).map(|other| Ok((title(other), shot(&best.point, other)?)));
        let mean =
            problem.has_scenarios().then(|| mean(input, destination, member.load_case().unwrap_or(""), &best.point));
        let moving = motion::ghosts(records, member, &best.point.members[member.index()])?;
        let drawing = Drawing {
            title: title(member),
            subtitle: subtitle(problem, findings, best)
                + &distance(&findings.record, member)
                + &left_out(problem)
                + &picture::legend(&end),
            body: ("optimum", &end),
            ghosts: if moving.is_empty() { vec![("start", &begin)] } else { picture::named(&moving) },
            scenarios: others.collect::<Result<_, RunError>>()?,
            mean: mean.transpose()?.map(|mean| (title_of_scenarios(member), mean)),
        };
        let pictures = picture::compose(member, &drawing);
        together.extend(pictures.first().cloned());
        picture::write(member, pictures, out)?;
        files.extend(["picture.png", "picture.svg"].map(|name| member.case_file(name)));
        if let Some((_, mean)) = &drawing.mean {
            let name = member.case_file("mean_optimum.vtu");
            out.write_vtu(&name, mean)?;
            files.push(name);
        }
    }
    if together.len() > 1 {
        together.truncate(picture::LOAD_CASES);
        picture::write_together(together, out)?;
        files.extend(["picture.png", "picture.svg"].map(str::to_owned));
    }
    let controls = findings.record.controls.get_or_insert_default();
    let cut = cut_design::write(problem, (&best.m, best.stage), controls, &shapes, out)?;
    files.extend(cut.files);
    files.extend(write_collections(problem, "optimum", out)?);
    files.extend(of_motion);
    files.extend(problem.members().flat_map(|member| state_files(&member.file("start"), snapshot::beside(member))));
    files.extend(nastic_result::target_files::target_files(problem));
    let number = if several { format!("start_{index}_") } else { String::new() };
    files.extend(problem.leads().map(|lead| lead.case_file(&format!("{number}iterates.bin"))));
    if problem.case.output.every > 0 && starts.len() == 1 {
        files.extend(problem.leads().map(|lead| lead.case_file("iterations.pvd")));
    }
    cut.lines.into_iter().for_each(|line| console.say(line));
    findings.warn_all(console, cut.warnings);
    Ok(files)
}

/// The distance of one of several members from its target, for a subtitle; that of all stands there anyway.
fn distance(record: &RunRecord, member: CaseMember<'_>) -> String {
    let own = record.state.members().into_iter().find(|(name, _)| *name == member.name());
    let unit = member.problem().units().length().symbol;
    own.map_or_else(String::new, |(_, state)| picture::distance(state, unit))
}

/// Members that pictures leave out, for a subtitle.
fn left_out(problem: &CaseProblem) -> String {
    let of = |all: usize, drawn: usize, what: &str| {
        if all > drawn { format!("; the first {drawn} of {all} {what} are drawn") } else { String::new() }
    };
    let (scenarios, cases) = (problem.ensemble.scenarios().len(), problem.leads().count());
    of(scenarios, picture::SCENARIOS + 1, "scenarios") + &of(cases, picture::LOAD_CASES, "load cases")
}

/// The mean shape over the scenarios, and how far they lie from it.
fn mean(
    input: &CommandInput,
    destination: &Destination,
    load_case: &str,
    point: &EnsemblePoint,
) -> Result<Snapshot, RunError> {
    let mean = input.problem.ensemble.mean_shape(point, load_case);
    mean.map_err(|error| destination.forward_failed(input, error))
}

/// What the command line must say once more for the same results.
fn spectrum(options: &Options) -> String {
    let Some(SpectrumRequest { count, cost_rise }) = options.spectrum else { return String::new() };
    format!(" --spectrum {count}") + &cost_rise.map_or_else(String::new, |rise| format!(" --cost-rise {rise}"))
}

/// Why it ended, for people.
pub(crate) fn why(stop: &Stop) -> String {
    match stop {
        stop if stop.is_interrupted() => format!("{stop}: what was found so far is kept"),
        other => other.to_string(),
    }
}

/// The start as the stage in which a run ended values it, at the first rank: what the end can be compared with. None where that takes solves, of another projection,
/// which an interruption leaves out.
pub(super) fn revalued(
    input: &CommandInput,
    destination: &Destination,
    FinishedRun { start, best, .. }: &FinishedRun,
) -> Result<Option<EnsemblePoint>, RunError> {
    match input.problem.ensemble.restage(best.stage, start) {
        Ok(begin) => input.whole(destination, &begin),
        Err(_) => Ok(None),
    }
}

/// "1.2e-03 -> 4.5e-06, a factor of 267"; the end alone where nothing is known of the start.
fn fall(from: Option<f64>, to: Option<f64>) -> String {
    let to = known_number(to);
    let Some(from) = from else { return scientific(to, 6) };
    let factor =
        if to > 0.0 && from > to { format!(", a factor of {}", short(round(from / to))) } else { String::new() };
    format!("{} -> {}{factor}", scientific(from, 6), scientific(to, 6))
}

/// Three digits.
fn round(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
