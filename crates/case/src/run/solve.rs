//! `nastic solve`: the equilibrium at the start controls.

mod equilibria;
mod minimum;
mod modes;
mod moving;
mod path;
mod ramp;
mod ramp_failure;
mod ramp_jumps;
mod series;

pub(super) use modes::with_fields as with_modes;
pub(super) use moving::resume;

use super::analysis::Analysis;
use super::error::{Exit, RunError};
use super::motion;
use super::number::{quantity, scientific, short, vector};
use super::report::remove_earlier;
use super::session::Session;
use super::states::Shown;
use crate::lower::{CaseMember, CaseProblem, TargetShape, file_name};
use crate::quantity::Dimension;
use crate::result::files::Directory;
use crate::result::inspection::Inspection;
use crate::result::member_report::{self, Detail};
use crate::result::obstacle_shape;
use crate::result::picture::{self, Drawing};
use crate::result::snapshot;
use crate::result::summary;
use nastic_control::{EnsemblePoint, EnsembleWorkspace, StateFields};
use nastic_fem::{Modes, SolveReport};
use nastic_report::case_name;
use serde_json::{Map, Value, json};

pub(super) fn run(session: &mut Session<'_>, analysis: &Analysis) -> Result<Exit, RunError> {
    if let Some(option) = analysis.option().filter(|_| motion::is_motion(&session.problem)) {
        let refused = motion::refused(&session.problem, option);
        return Err(session.refuse(refused));
    }
    // a ramp is read first
    if !matches!(analysis, Analysis::Ramp(_)) {
        remove_earlier(session)?;
    }
    if let Some(out) = &session.out {
        // It belongs to an earlier command, and would stand beside the files of this one.
        out.remove("failure.vtu")?;
    }
    if motion::is_motion(&session.problem) {
        return moving::run(session, None);
    }
    match analysis {
        Analysis::Equilibrium | Analysis::Minimum | Analysis::Modes(_) | Analysis::Equilibria(_) => {
            equilibrium(session, analysis)
        }
        Analysis::Ramp(text) => ramp::run(session, text),
        Analysis::Path => path::run(session, false),
        Analysis::PathToLimit => path::run(session, true),
    }
}

/// The equilibrium at the start controls, with its modes or others beside it.
fn equilibrium(session: &mut Session<'_>, analysis: &Analysis) -> Result<Exit, RunError> {
    let mut point = session.evaluate_start(&mut EnsembleWorkspace::default())?;
    if *analysis == Analysis::Minimum {
        point = session.timed("descent", |session| minimum::descend(session, point))?;
    }
    let found = session.inspect(motion::state_name(&session.problem), &point);
    report(session, &point, &found)?;
    let modes = match analysis {
        Analysis::Modes(count) => session.timed("modes", |session| modes::find(session, &point, *count))?,
        _ => Vec::new(),
    };
    modes::report(session, &modes);
    session.timed("write", |session| write(session, &point, (&found, &[]), &modes))?;
    let exit = match analysis {
        Analysis::Equilibria(count) => equilibria::run(session, &point, *count)?,
        _ => Exit::Done,
    };
    show(session, point, None, found);
    Ok(exit)
}

/// Keeps the equilibria at the start controls for whoever runs the command.
pub(super) fn show(
    session: &mut Session<'_>,
    point: EnsemblePoint,
    derivative: Option<Vec<f64>>,
    inspections: Vec<Inspection>,
) {
    let subtitle = subtitle(session, point.members.iter().map(|at| at.min_j()).fold(f64::INFINITY, f64::min));
    let what = motion::state_name(&session.problem);
    session.shown = Some(Shown { what, subtitle, point, derivative, start: None, inspections });
}

/// The line below the title of a picture.
fn subtitle(session: &Session<'_>, min_j: f64) -> String {
    let result = session.result_value();
    let distance = picture::distance(&result, session.problem.units().length().symbol);
    let what = motion::state_name(&session.problem);
    format!("{what} at the start control, min J {}{distance}{}", short(min_j), session.warned())
}

/// Puts what the equilibria are into the result and says it.
pub(super) fn report(session: &mut Session<'_>, point: &EnsemblePoint, found: &[Inspection]) -> Result<(), RunError> {
    let reports = member_report::of_inspected(&session.problem, point, found);
    let reports = reports.map_err(|error| session.member_failed(error))?;
    let entries = member_report::entries(&session.problem, &reports, Detail::Full);
    let entries = entries.map_err(|error| session.member_failed(error))?;
    let controls = summary::controls(&session.problem, &point.m);
    drop(reports);
    session.put_all(entries);
    session.put("controls", controls);
    session.put("load_steps", json!(point.members.iter().map(|at| at.state().report.load_steps).max()));
    say(session, point);
    Ok(())
}

fn say(session: &Session<'_>, point: &EnsemblePoint) {
    let states = || point.members.iter().map(|at| at.state());
    let (console, result) = (session.console, session.result_value());
    let mut work = SolveReport::default();
    point.members.iter().for_each(|at| work.add_work(&at.work));
    if work.newton == 0 && states().all(|state| state.u.iter().all(|u| *u == 0.0)) {
        console.say("equilibrium the state of rest: nothing deforms the body at the start controls");
    }
    let of_steps =
        format!(" in {} load steps ({} cut)", states().map(|state| state.report.load_steps).sum::<usize>(), work.cuts);
    let moves = motion::is_motion(&session.problem);
    console.say(format!(
        "{:<12}{} Newton iterations{}, {} factorisations ({} reused), residual {}",
        if moves { "work" } else { "equilibrium" },
        work.newton,
        if moves { "" } else { of_steps.as_str() },
        work.factorisations,
        work.reused,
        scientific(states().map(|state| state.report.residual).fold(0.0, f64::max), 1)
    ));
    if work.cycles > 0 {
        console.say(format!("linear      multigrid: {} cycles on {} sets of levels", work.cycles, work.hierarchies));
    }
    say_stability(session, &result);
    say_cost(session, &result);
    say_members(session, &result);
    say_tracked(session, &result);
    say_probes(session, &result);
    say_reactions(session, &result);
}

/// Smallest J and inertia, of the worst member.
pub(super) fn say_stability(session: &Session<'_>, result: &Value) {
    let min_j = result["min_J"].as_f64().unwrap_or(f64::NAN);
    if motion::is_motion(&session.problem) {
        session.console.say(format!("deformation min J {} over the motion", short(min_j)));
        return;
    }
    session.console.say(format!("stability   min J {}, {}", short(min_j), inertia(result)));
}

/// Entries of all members with their names, of a case that is not plain.
pub(super) fn members_of(result: &Value) -> Vec<(String, &Map<String, Value>)> {
    let mut out = Vec::new();
    for (name, scenario) in result["scenarios"].as_object().into_iter().flatten() {
        match scenario["load_cases"].as_object() {
            Some(cases) => {
                let own = cases.iter().filter_map(|(case, entry)| Some((format!("{name}/{case}"), entry.as_object()?)));
                out.extend(own);
            }
            None => out.extend(scenario.as_object().map(|entry| (name.clone(), entry))),
        }
    }
    let cases = result["load_cases"].as_object().into_iter().flatten();
    out.extend(cases.filter_map(|(name, entry)| Some((name.clone(), entry.as_object()?))));
    out
}

/// Members whose numbers are said; the result has them all.
const SAID: usize = 12;

/// One line per member, and one about their risk.
pub(super) fn say_members(session: &Session<'_>, result: &Value) {
    let members = members_of(result);
    let width = members.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (k, (name, entry)) in members.iter().enumerate().take(SAID) {
        let head = if k == 0 { "members" } else { "" };
        let number = |value: Option<&Value>| value.and_then(Value::as_f64);
        let cost = number(entry.get("cost").and_then(|cost| cost.get("total")));
        let cost = cost.map_or_else(String::new, |cost| format!("cost {}, ", scientific(cost, 6)));
        let weight = match (number(entry.get("probability")), number(entry.get("weight"))) {
            (Some(p), _) => format!("probability {}, ", short(p)),
            (None, Some(weight)) => format!("weight {}, ", short(weight)),
            (None, None) => String::new(),
        };
        let stable = inertia(&Value::Object((*entry).clone()));
        let min_j = number(entry.get("min_J")).unwrap_or(f64::NAN);
        session.console.say(format!("{head:<12}{name:<width$}  {weight}{cost}min J {}, {stable}", short(min_j)));
    }
    if members.len() > SAID {
        session.console.say(format!("            and {} more, in result.json", members.len() - SAID));
    }
    if let Some(measures) = result["risk"]["measures"].as_object() {
        let of = |(name, measure): (&String, &Value)| {
            let level =
                measure["level"].as_f64().map_or_else(String::new, |level| format!(" (level {})", short(level)));
            let value = measure["value"].as_f64().map_or_else(|| "-".to_owned(), |x| scientific(x, 4));
            format!("{name}{level} {value}")
        };
        let all: Vec<String> = measures.iter().map(of).collect();
        let deviation = scientific(result["risk"]["deviation"].as_f64().unwrap_or(f64::NAN), 4);
        session.console.say(format!("risk        {}; standard deviation {deviation}", all.join(", ")));
    }
}

/// What the inertia means.
pub(super) fn inertia(result: &Value) -> String {
    match result["inertia"].as_u64() {
        Some(0) => "stable (no negative pivot of the tangent)".to_owned(),
        Some(1) => "UNSTABLE: 1 negative pivot of the tangent".to_owned(),
        Some(n) => format!("UNSTABLE: {n} negative pivots of the tangent"),
        None if result["inertia_missing"]["singular"] == true => "the tangent is singular: a bifurcation".to_owned(),
        None => {
            let why = result["inertia_missing"]["why"].as_str().unwrap_or("no reason is known");
            format!("negative pivots not counted: {why}")
        }
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

/// Means and standard deviations of the probes' displacements over the scenarios.
fn say_spread(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().length().symbol;
    for (place, probe) in nested(&result["probes"]).into_iter().filter(|(_, probe)| probe["deviation"].is_array()) {
        let [mean, deviation] = ["displacement", "deviation"].map(|key| vector(&numbers(&probe[key])));
        session.console.say(format!(
            "probe       {place} moves by {mean} {unit} in the mean, standard deviation {deviation} {unit}"
        ));
    }
}

/// Probes by their names, those of load cases as `CASE/NAME`.
fn nested(probes: &Value) -> Vec<(String, &Value)> {
    let mut out = Vec::new();
    for (name, entry) in probes.as_object().into_iter().flatten() {
        if entry["point"].is_array() {
            out.push((name.clone(), entry));
        } else {
            out.extend(nested(entry).into_iter().map(|(own, entry)| (format!("{name}/{own}"), entry)));
        }
    }
    out
}

/// The probes' displacements and the volumes of cavities, of every member.
pub(super) fn say_probes(session: &Session<'_>, result: &Value) {
    say_spread(session, result);
    let unit = session.problem.units().length().symbol;
    for (member, entry) in with_plain(result) {
        for (name, cavity) in entry.get("contributions").and_then(Value::as_object).into_iter().flatten() {
            let number = |key: &str| cavity.get(key).and_then(Value::as_f64);
            if let (Some(volume), Some(rest)) = (number("volume"), number("reference_volume")) {
                let size = format!("{} {unit}^{}", short(volume), session.problem.mesh().dim());
                let times = short(volume / rest);
                let units = session.problem.units();
                let pressure = quantity(number("pressure").unwrap_or(f64::NAN), Dimension::PRESSURE, units);
                session.console.say(format!(
                    "volume      {name} {size}, {times} times that at rest, at {pressure}{}",
                    inside(&member)
                ));
            }
        }
        for (name, probe) in entry.get("probes").and_then(Value::as_object).into_iter().flatten() {
            let u = numbers(&probe["displacement"]);
            let digits = u.iter().map(|x| format!("{x:.9}")).collect::<Vec<_>>().join(", ");
            session.console.say(format!("probe       {name} moves by ({digits}) {unit}{}", inside(&member)));
        }
    }
}

fn say_reactions(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().force().symbol;
    for (member, entry) in with_plain(result) {
        for (name, force) in entry.get("reactions").and_then(Value::as_object).into_iter().flatten() {
            let force = vector(&numbers(force));
            session.console.say(format!("reaction    {name} holds with {force} {unit}{}", inside(&member)));
        }
    }
}

/// The entries of the members that are said; of a plain case the result itself.
fn with_plain(result: &Value) -> Vec<(String, &Map<String, Value>)> {
    let mut members = members_of(result);
    if !members.is_empty() {
        members.truncate(SAID);
        return members;
    }
    result.as_object().map(|result| (String::new(), result)).into_iter().collect()
}

fn inside(member: &str) -> String {
    if member.is_empty() { String::new() } else { format!(" in {member}") }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

fn write(
    session: &mut Session<'_>,
    point: &EnsemblePoint,
    (found, records): (&[Inspection], &[motion::Record]),
    modes: &[Modes],
) -> Result<(), RunError> {
    let Some(out) = session.out.clone() else { return Ok(()) };
    let problem = &session.problem;
    let mut files = Vec::new();
    for (member, at) in problem.members().zip(&point.members) {
        let found = found.get(member.index());
        let mut shot = snapshot::inspected(member, &StateFields::new(at.state(), &at.m), found)?;
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
    files.extend(motion::write(problem, records, &out)?);
    say_files(session, files);
    Ok(())
}

/// Puts the names of files into the result and says them, the first of many.
pub(super) fn say_files(session: &mut Session<'_>, files: Vec<String>) {
    const NAMED: usize = 9;
    let more = if files.len() > NAMED { format!(" and {} more", files.len() - NAMED) } else { String::new() };
    let said: Vec<&str> = files.iter().take(NAMED).map(String::as_str).collect();
    session.console.say(format!("files       result.json, {}{more}", said.join(", ")));
    session.list_files(files);
}

/// `target.vtu` of the first target; further ones bear their cost's name, and those that members have alone begin as
/// the members' files do. Obstacles besides.
pub(super) fn write_targets(problem: &CaseProblem, out: &Directory) -> Result<Vec<String>, RunError> {
    let targets = named_targets(problem);
    for (name, shape) in &targets {
        out.write_vtu(name, &snapshot::target(shape)?)?;
    }
    for (name, shape) in obstacle_shape::files(problem).0 {
        out.write_vtu(&name, &shape)?;
    }
    Ok(target_files(problem))
}

/// The names of the files with targets and obstacles.
pub(super) fn target_files(problem: &CaseProblem) -> Vec<String> {
    let obstacles = obstacle_shape::files(problem).0.into_iter().map(|(name, _)| name);
    named_targets(problem).into_iter().map(|(name, _)| name).chain(obstacles).collect()
}

/// The names of every member's own targets.
pub(super) fn target_names(problem: &CaseProblem) -> Vec<Vec<String>> {
    let named = named_targets_by_member(problem);
    named.into_iter().map(|own| own.into_iter().map(|(name, _)| name).collect()).collect()
}

fn named_targets(problem: &CaseProblem) -> Vec<(String, &TargetShape)> {
    let mut out: Vec<(String, &TargetShape)> = Vec::new();
    for (name, shape) in named_targets_by_member(problem).into_iter().flatten() {
        if !out.iter().any(|(known, _)| *known == name) {
            out.push((name, shape));
        }
    }
    out
}

fn named_targets_by_member(problem: &CaseProblem) -> Vec<Vec<(String, &TargetShape)>> {
    let mut out = Vec::new();
    for member in problem.members() {
        let mut own = Vec::new();
        let same = |other: &CaseMember<'_>| {
            other.targets().len() == member.targets().len()
                && other.targets().iter().zip(member.targets()).all(|(a, b)| a.is_same(b))
        };
        let mut of_case = problem.members().filter(|other| other.load_case() == member.load_case());
        for (k, shape) in member.targets().iter().enumerate() {
            let name = if k == 0 { "target.vtu".to_owned() } else { format!("target_{}.vtu", file_name(&shape.cost)) };
            let name = match () {
                () if problem.members().all(|other| same(&other)) => name,
                () if of_case.all(|other| same(&other)) => member.case_file(&name),
                () => member.file(&name),
            };
            own.push((name, shape));
        }
        out.push(own);
    }
    out
}

/// `scenarios.pvd`: the scenarios' files one after the other, for every load case.
pub(super) fn write_collections(problem: &CaseProblem, what: &str, out: &Directory) -> Result<Vec<String>, RunError> {
    let mut files = Vec::new();
    for lead in problem.leads().filter(|_| problem.has_scenarios()) {
        let own = problem.members().filter(|member| member.load_case() == lead.load_case());
        let entry = |member: CaseMember<'_>| (member.part().scenario() as f64, member.file(&format!("{what}.vtu")));
        let entries: Vec<(f64, String)> = own.map(entry).collect();
        let name = lead.case_file("scenarios.pvd");
        nastic_io::write_pvd(out.file(&name), &entries)?;
        files.push(name);
    }
    Ok(files)
}

/// How far tracked points are from their targets, and were at the start of an optimisation.
pub(super) fn say_tracked(session: &Session<'_>, result: &Value) {
    let unit = session.problem.units().length().symbol;
    for (name, now) in result["tracking"].as_object().into_iter().flatten() {
        let of = |key: &str| {
            let before = result["start"]["tracking"][name][key].as_f64();
            let before = before.map_or_else(String::new, |before| format!("{} -> ", scientific(before, 3)));
            format!("{before}{} {unit}", scientific(now[key].as_f64().unwrap_or(f64::NAN), 3))
        };
        let (mean, most) = (of("root_mean_square"), of("largest"));
        session.console.say(format!("distance    {name}: root mean square {mean}, largest {most}"));
    }
    for (name, now) in result["figures"].as_object().into_iter().flatten() {
        let of = |(key, value): (&String, &Value)| {
            let before = result["start"]["figures"][name][key].as_f64();
            let before = before.map_or_else(String::new, |before| format!("{} -> ", short(before)));
            format!("{} {before}{}", key.replace('_', " "), short(value.as_f64().unwrap_or(f64::NAN)))
        };
        let told: Vec<String> = now.as_object().into_iter().flatten().map(of).collect();
        session.console.say(format!("reached     {name}: {}", told.join(", ")));
    }
}

/// The title of pictures of a member.
pub(super) fn title(member: CaseMember<'_>) -> String {
    titled(member.problem(), &member.name())
}

/// The title of pictures of all scenarios together.
pub(super) fn title_of_scenarios(lead: CaseMember<'_>) -> String {
    titled(lead.problem(), lead.load_case().unwrap_or(""))
}

fn titled(problem: &CaseProblem, name: &str) -> String {
    let file = || case_name(problem.document.name());
    let title = problem.case.title.clone().unwrap_or_else(file);
    if name.is_empty() { title } else { format!("{title}: {name}") }
}
