//! Motions as results: `motion_0000.vtu` .. with `motion.pvd`, `motion.csv` and charts of every step, the entry `time`.

mod energy;
pub(super) mod record;
mod recorder;
mod solved;
pub(super) mod table;

pub(super) use crate::run::motion::solved::solve;

use crate::console::Console;
use crate::run::error::RunError;
pub(crate) use crate::run::motion::record::Record;
pub(crate) use crate::run::motion::table::touches;
use crate::run::motion::table::{KINETIC_ENERGY, MIN_J, POTENTIAL, energies};
use crate::run::session::{CommandFindings, CommandInput, Destination};
use crate::run::state_columns::ENERGY;
use crate::run::{contacts, modes, time_steps};
use crate::saved::motion_checkpoint;
use nastic_case::inspect::{compression, flight};
use nastic_case::lower::{CaseMember, CaseProblem};
use nastic_case::warning::{TIME_STEP, Warning};
use nastic_control::{AdaptiveSteps, Evaluated, StateFields, Timeline};
use nastic_ensemble::EnsemblePoint;
use nastic_io::write_atomically;
use nastic_language::number::{count, quantity, short};
use nastic_language::quantity::Dimension;
use nastic_language::schema::{Command, Time};
use nastic_mesh::Snapshot;
use nastic_report::record::{EnergiesRecord, EnergyRecord, TimeRecord, VibrationInSteps};
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::snapshot;
use rayon::prelude::*;

/// Instants drawn as glass behind the end of a motion.
const GHOSTS: usize = 4;

/// What a state is called in messages.
pub(super) fn state_name(problem: &CaseProblem) -> &'static str {
    if problem.is_motion() { "end of the motion" } else { "equilibrium" }
}

/// Says what deserves attention in motions.
pub(super) fn warn(problem: &CaseProblem, console: &Console, findings: &mut CommandFindings, records: &[Record]) {
    findings.warn_all(console, warnings(problem, records));
}

/// Says how the motions went, and puts that into the result.
pub(super) fn report(
    input: &CommandInput,
    console: &Console,
    findings: &mut CommandFindings,
    records: &[Record],
    point: &EnsemblePoint,
) {
    let problem = &input.problem;
    for (record, entry) in records.iter().zip(entries(input, console, &findings.steps, records, point)) {
        let member = problem.member(record.member);
        let unresolved = entry.damping.as_ref().and_then(|seen| unresolved(record, seen));
        findings.entries_of(member).time = Some(entry);
        findings.warn_all(console, unresolved.map(|message| Warning::new(&TIME_STEP, message).of(member.name())));
    }
    contacts::report_motions(problem, console, findings, records);
    for record in records {
        findings.entries_of(problem.member(record.member)).reactions = record.reactions.clone();
    }
}

/// The motions of all members. One that keeps few states in memory runs once more.
pub(super) fn records(
    input: &CommandInput,
    destination: &Destination,
    point: &EnsemblePoint,
) -> Result<Vec<Record>, RunError> {
    if !input.problem.is_motion() {
        return Ok(vec![]);
    }
    let record = |(member, at): (CaseMember<'_>, &Evaluated)| {
        let mut record = Record::new(member, at.m.clone());
        let all = member.reduced().for_each_state(at, &mut |n, state| record.add(member, n, state));
        all.map_err(|error| destination.member_failed(input, member.index(), error))?;
        Ok(record)
    };
    input.problem.members().zip(&point.members).map(record).collect()
}

/// Looks into the states that are written, beside the last one, which is looked into with all others; what deserves attention is reported
/// once for each kind, with the first instant that has it; J and flight of all instants together.
fn warnings(problem: &CaseProblem, records: &[Record]) -> Vec<Warning> {
    records.iter().flat_map(|record| warnings_of(problem.member(record.member), record)).collect()
}

fn warnings_of(member: CaseMember<'_>, record: &Record) -> Vec<Warning> {
    let unit = member.problem().units().time().symbol;
    let before = &record.shown[..record.shown.len().saturating_sub(1)];
    let found: Vec<Inspection> = before.par_iter().map(|state| Inspection::of(member, state)).collect();
    let mut described: Vec<(Warning, usize)> = Vec::new();
    for (state, found) in before.iter().zip(&found) {
        let place = format!("motion at t = {} {unit}", short(state.time));
        for warning in found.warnings(member, &place) {
            match described.iter_mut().find(|(known, _)| known.kind == warning.kind) {
                Some((_, count)) => *count += 1,
                None => described.push((warning, 1)),
            }
        }
    }
    let with_count = |(mut warning, count): (Warning, usize)| {
        warning.message += &format!(" (the first of {count} such states among {})", before.len());
        warning
    };
    let rows = record.table.iter().flat_map(|table| &table.rows).map(|row| (row[MIN_J], row[0]));
    let smallest = rows.min_by(|a, b| a.0.total_cmp(&b.0));
    let of_all = smallest.and_then(|(min_j, time)| compression(member, min_j, Some(time)));
    let of_energy = record.table.iter().flat_map(|table| energy::warnings(member, table));
    let of_states = described.into_iter().map(with_count).chain(of_all);
    of_states.chain(flight(member, &record.shown, &record.touches)).chain(of_energy).collect()
}

/// The entry `time` of the result, and lines about the motions.
fn entries(
    input: &CommandInput,
    console: &Console,
    steps: &[AdaptiveSteps],
    records: &[Record],
    point: &EnsemblePoint,
) -> Vec<TimeRecord> {
    let Some(time) = &input.problem.case.time else { return vec![] };
    let units = input.problem.units();
    let of = |value: f64| quantity(value, Dimension::TIME, units);
    let most = input.problem.members().filter_map(|member| member.reduced().timeline()).map(Timeline::steps).max();
    let each = match time.step {
        Some(step) => format!("of {}", of(step)),
        None => format!("of at most {}", of(longest(&input.problem))),
    };
    console.say(format!(
        "motion      {} {each} to {} by {}, {} cut",
        count(most.unwrap_or(0), "step"),
        of(time.end),
        time.scheme().name(),
        count(point.members.iter().map(|at| at.work.cuts).sum::<usize>(), "step")
    ));
    if let Some(error) = point.members.iter().filter_map(|at| at.solved.error).map(|error| error.error).reduce(f64::max)
    {
        let error = quantity(error, Dimension::LENGTH, units);
        console.say(format!("            a step adds at most {error} to the error of displacements, by its estimate"));
    }
    let member = |record: &Record| entry(input, console, time, record, steps, &point.members[record.member]);
    records.iter().map(member).collect()
}

/// The longest step of any member.
fn longest(problem: &CaseProblem) -> f64 {
    let timelines = problem.members().filter_map(|member| member.reduced().timeline());
    timelines.map(Timeline::longest_step).fold(0.0, f64::max)
}

fn entry(
    input: &CommandInput,
    console: &Console,
    time: &Time,
    record: &Record,
    steps: &[AdaptiveSteps],
    at: &Evaluated,
) -> TimeRecord {
    let (member, unit) = (input.problem.member(record.member), input.problem.units().label(ENERGY));
    let ends = [record.shown.first(), record.shown.last()].map(|state| state.map(|state| energies(member, state)));
    let [start, end] = ends.map(Option::unwrap_or_default);
    let name = if member.name().is_empty() { String::new() } else { format!(" in {}", member.name()) };
    let pair = |[kinetic, potential]: [f64; 2]| format!("kinetic {}, potential {}", short(kinetic), short(potential));
    console.say(format!("energy      at t = 0: {}; at the end: {} ({unit}){name}", pair(start), pair(end)));
    let both = |[kinetic, potential]: [f64; 2]| EnergyRecord { kinetic: kinetic.into(), potential: potential.into() };
    // scenarios differ little in this; friction has no modes
    let lead = member.part().scenario() == 0 && member.case().contact.iter().all(|contact| contact.friction.is_none());
    let damping = record.shown.first().filter(|_| lead).and_then(|state| modes::damping(input, console, member, state));
    TimeRecord {
        end: time.end.into(),
        steps: record.states().saturating_sub(1),
        scheme: time.scheme().name().to_owned(),
        mass: time.mass.name().to_owned(),
        written: record.shown.len(),
        energies: EnergiesRecord { start: both(start), end: both(end) },
        energy_balance: record.table.as_ref().and_then(|table| energy::record(member, table)),
        damping,
        ..time_steps::record(steps, member, time, at)
    }
}

/// Share of the changes of potential energy that the kinetic one must reach for a vibration to matter.
const KINETIC: f64 = 0.01;
/// Share of its frequency at which the lowest vibration must be seen.
const SEEN: f64 = 0.8;
/// Damping by the steps, d/w, that counts beside the physical one.
const DAMPED: f64 = 0.1;

/// What is wrong with the lowest vibration as the steps move it, of a motion with inertia.
fn unresolved(record: &Record, seen: &VibrationInSteps) -> Option<String> {
    let rows = &record.table.as_ref()?.rows;
    let column = |k: usize| rows.iter().filter_map(move |row| row.get(k).copied());
    let largest = |k: usize| column(k).fold(f64::NEG_INFINITY, f64::max);
    let change = largest(POTENTIAL) - column(POTENTIAL).fold(f64::INFINITY, f64::min);
    if largest(KINETIC_ENERGY) <= KINETIC * change {
        return None;
    }
    // the lowest that vibrates; one that floats or is unstable has no numbers
    let k = seen.damping.iter().position(|damping| damping.is_some())?;
    let (physical, damped) = (seen.damping[k].unwrap_or(0.0), seen.damping_seen.get(k)?.unwrap_or(0.0));
    let ratio = seen.frequency_ratio.get(k)?.unwrap_or(0.0);
    let message = if ratio < SEEN {
        let at = if ratio == 0.0 { "not at all".to_owned() } else { format!("at {} of its frequency", short(ratio)) };
        format!("the lowest vibration is seen {at}")
    } else if damped - physical > physical.max(DAMPED) {
        format!(
            "the steps damp the lowest vibration by d/w = {}, the body by {}",
            short(damped - physical),
            short(physical)
        )
    } else {
        return None;
    };
    Some(format!(
        "{message}, and kinetic energy is up to {} of what the potential energy changes by",
        short(largest(KINETIC_ENERGY) / change)
    ))
}

/// Writes the files of all members; their names.
pub(super) fn write(problem: &CaseProblem, records: &[Record], out: &Directory) -> Result<Vec<String>, RunError> {
    let mut files = Vec::new();
    for record in records {
        let (member, Some(table)) = (problem.member(record.member), &record.table) else { continue };
        let (csv, pvd) = (member.file("motion.csv"), member.file("motion.pvd"));
        let text = table.csv();
        write_atomically(out.own(&csv)?, |out| out.write_all(text.as_bytes()))?;
        files.push(csv);
        files.extend(table.charts(member, out)?);
        let stem = member.file("motion_");
        let mut shots = Vec::new();
        for (k, state) in record.shown.iter().enumerate() {
            let name = format!("{stem}{k:04}");
            let shot = snapshot::snapshot(member, &StateFields::new(state, &record.m, 0))?;
            let own = out.write_state(&name, &shot)?;
            shots.extend(own.into_iter().map(|file| (state.time, file)));
        }
        // the last of an earlier motion, behind those that were replaced: no state is gone before another is there
        out.remove_numbered(&stem, record.shown.len());
        nastic_io::write_pvd(out.own(&pvd)?, &shots)?;
        files.push(pvd);
        files.extend(shots.into_iter().map(|(_, name)| name));
    }
    Ok(files)
}

/// A few states before the end, with what they are called, for a picture.
pub(super) fn ghosts(
    records: &[Record],
    member: CaseMember<'_>,
    at: &Evaluated,
) -> Result<Vec<(String, Snapshot)>, RunError> {
    let Some(record) = records.iter().find(|record| record.member == member.index()) else { return Ok(vec![]) };
    let (unit, last) = (member.problem().units().time().symbol, record.shown.len() - 1);
    let of = |k: usize| {
        let state = &record.shown[k * last / GHOSTS];
        let shot = snapshot::plain(member, &StateFields::new(state, &at.m, at.stage))?;
        Ok((format!("t = {} {unit}", short(state.time)), shot))
    };
    (0..GHOSTS.min(last)).map(of).collect()
}

/// Removes the checkpoint of a motion that has come to its end, after all results are written.
pub(super) fn record_end(input: &CommandInput, destination: &Destination) -> Result<(), RunError> {
    match &destination.out {
        Some(out) if input.command == Command::Solve => Ok(out.remove(motion_checkpoint::NAME)?),
        _ => Ok(()),
    }
}

/// Whether the checkpoint of a motion in the directory, if any, may be replaced; if not, nothing is written.
pub(super) fn may_replace(destination: &mut Destination, restart: bool) -> Result<(), RunError> {
    match destination.out.take_if(|out| !restart && out.file(motion_checkpoint::NAME).is_file()) {
        None => Ok(()),
        Some(out) => Err(RunError::InterruptedMotion { directory: out.path().to_owned() }),
    }
}

/// The options of `solve` that look at one equilibrium.
pub(super) fn refused(problem: &CaseProblem, what: &str) -> RunError {
    let message = format!("{what} looks at equilibria, and this case moves: take \"time\" out of it");
    problem.complain("time", message).into()
}
