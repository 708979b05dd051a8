//! Motions as results: `motion_0000.vtu` .. with `motion.pvd`, `motion.csv` and charts of every step, the entry `time`.

use super::error::RunError;
use super::modes;
use super::number::{count, quantity, short};
use super::session::Session;
use super::solve::title;
use crate::lower::{CaseMember, CaseProblem};
use crate::quantity::Dimension;
use crate::result::csv::quoted;
use crate::result::files::Directory;
use crate::result::inspection::Inspection;
use crate::result::snapshot;
use crate::result::summary;
use crate::schema::Time;
use crate::warning::Warning;
use nastic_control::{ControlBlock, ControlError, EnsemblePoint, Evaluated, StateFields};
use nastic_fem::{Instant, State};
use nastic_io::write_atomically;
use nastic_mesh::Snapshot;
use nastic_picture::{Chart, Curve};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Columns of a table of a motion, one row for every step.
struct Table {
    names: Vec<String>,
    units: Vec<String>,
    rows: Vec<Vec<f64>>,
}

/// Instants drawn as glass behind the end of a motion.
const GHOSTS: usize = 4;
/// Curves of a chart.
const CURVES: usize = 6;

/// What a state is called in messages.
pub(super) fn state_name(problem: &CaseProblem) -> &'static str {
    if is_motion(problem) { "end of the motion" } else { "equilibrium" }
}

/// Whether the problem is one in time.
pub(super) fn is_motion(problem: &CaseProblem) -> bool {
    problem.case.time.is_some()
}

/// What is told of the motion of one member: the table of all steps, and the states that are written.
pub(super) struct Record {
    /// Index of the member.
    member: usize,
    table: Table,
    shown: Vec<State>,
}

/// The motions of all members. One that keeps few states in memory runs once more.
pub(super) fn records(session: &Session<'_>, point: &EnsemblePoint) -> Result<Vec<Record>, RunError> {
    if !is_motion(&session.problem) {
        return Ok(vec![]);
    }
    let members = session.problem.members().zip(&point.members);
    members.map(|(member, at)| record(session, member, at)).collect()
}

fn record(session: &Session<'_>, member: CaseMember<'_>, at: &Evaluated) -> Result<Record, RunError> {
    let (steps, stride) = member.case().time.as_ref().map_or((0, 1), |time| (time.steps(), time.stride()));
    let mut table = Table::head(member, at);
    let mut shown = Vec::new();
    let mut each = |n: usize, state: &State| {
        table.add(member, &at.m, state)?;
        if n.is_multiple_of(stride) || n == steps {
            shown.push(state.clone());
        }
        Ok(())
    };
    let all = member.reduced().for_each_state(at, &mut each);
    all.map_err(|error| session.member_failed((member.index(), error)))?;
    Ok(Record { member: member.index(), table, shown })
}

/// Looks into the states that are written, beside the last one, which is looked into with all others; what deserves attention is told
/// once for each kind, with the first instant that has it.
pub(super) fn warnings(problem: &CaseProblem, records: &[Record]) -> Vec<Warning> {
    records.iter().flat_map(|record| warnings_of(problem.member(record.member), record)).collect()
}

fn warnings_of(member: CaseMember<'_>, record: &Record) -> Vec<Warning> {
    let unit = member.problem().units().time().symbol;
    let before = &record.shown[..record.shown.len().saturating_sub(1)];
    let found: Vec<Inspection> = before.par_iter().map(|state| Inspection::of(member, state)).collect();
    let mut told: Vec<(Warning, usize)> = Vec::new();
    for (state, found) in before.iter().zip(&found) {
        let place = format!("motion at t = {} {unit}", short(state.time));
        for warning in found.warnings(member, &place) {
            match told.iter_mut().find(|(known, _)| known.kind == warning.kind) {
                Some((_, count)) => *count += 1,
                None => told.push((warning, 1)),
            }
        }
    }
    let tell = |(mut warning, count): (Warning, usize)| {
        warning.message += &format!(" (the first of {count} such states among {})", before.len());
        warning
    };
    told.into_iter().map(tell).collect()
}

/// The entry `time` of the result, and lines about the motions.
pub(super) fn report(session: &Session<'_>, records: &[Record], point: &EnsemblePoint) -> Vec<Value> {
    let Some(time) = &session.problem.case.time else { return vec![] };
    let units = session.problem.units();
    let of = |value: f64| quantity(value, Dimension::TIME, units);
    session.console.say(format!(
        "motion      {} of {} to {} by {}, {} cut",
        count(time.steps(), "step"),
        of(time.step),
        of(time.end),
        time.scheme.name(),
        count(point.members.iter().map(|at| at.work.cuts).sum::<usize>(), "step")
    ));
    records.iter().map(|record| entry(session, time, record)).collect()
}

fn entry(session: &Session<'_>, time: &Time, record: &Record) -> Value {
    let (member, unit) = (session.problem.member(record.member), session.problem.units().label(ENERGY));
    let ends = [record.shown.first(), record.shown.last()].map(|state| state.map(|state| energies(member, state)));
    let [start, end] = ends.map(Option::unwrap_or_default);
    let name = if member.name().is_empty() { String::new() } else { format!(" in {}", member.name()) };
    let pair = |[kinetic, potential]: [f64; 2]| format!("kinetic {}, potential {}", short(kinetic), short(potential));
    let console = session.console;
    console.say(format!("energy      at t = 0: {}; at the end: {} ({unit}){name}", pair(start), pair(end)));
    let both = |[kinetic, potential]: [f64; 2]| json!({ "kinetic": kinetic, "potential": potential });
    let mut entry = json!({
        "end": time.end, "step": time.step, "steps": time.steps(), "scheme": time.scheme.name(),
        "mass": time.mass.name(), "written": record.shown.len(),
        "energies": { "start": both(start), "end": both(end) },
    });
    // scenarios differ little in this
    let lead = member.part().scenario() == 0;
    if let Some(damping) =
        record.shown.first().filter(|_| lead).and_then(|state| modes::damping(session, member, state))
    {
        entry["damping"] = damping;
    }
    entry
}

/// Writes the files of all members; their names.
pub(super) fn write(
    problem: &CaseProblem,
    records: &[Record],
    point: &EnsemblePoint,
    out: &Directory,
) -> Result<Vec<String>, RunError> {
    let mut files = Vec::new();
    for Record { member, table, shown } in records {
        let (member, m) = (problem.member(*member), &point.members[*member].m);
        let (csv, pvd) = (member.file("motion.csv"), member.file("motion.pvd"));
        let text = table.csv();
        write_atomically(out.file(&csv), |out| out.write_all(text.as_bytes()))?;
        files.push(csv);
        files.extend(table.charts(member, out)?);
        let stem = member.file("motion_");
        out.remove_numbered(&stem);
        let mut shots = Vec::new();
        for (k, state) in shown.iter().enumerate() {
            let name = format!("{stem}{k:04}");
            out.write_state(&name, &snapshot::snapshot(member, &StateFields::new(state, m))?)?;
            shots.push((state.time, format!("{name}.vtu")));
        }
        nastic_io::write_pvd(out.file(&pvd), &shots)?;
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
        let shot = snapshot::plain(member, &StateFields::new(state, &at.m))?;
        Ok((format!("t = {} {unit}", short(state.time)), shot))
    };
    (0..GHOSTS.min(last)).map(of).collect()
}

/// Kinetic energy, and the potential of stresses, actuations and loads.
fn energies(member: CaseMember<'_>, state: &State) -> [f64; 2] {
    [member.solid().model().kinetic_energy(state), summary::potential(member, state)]
}

/// One value in space, or one vector.
fn is_uniform(block: &ControlBlock) -> bool {
    block.size() == block.components
}

/// What contributions report.
fn quantities(member: CaseMember<'_>, state: &State) -> Vec<(String, &'static str, f64)> {
    let at = Instant::new(&state.u, &state.controls, state.load);
    member.solid().model().quantities(&at).unwrap_or_default()
}

const AXES: [&str; 3] = ["x", "y", "z"];
const ENERGY: Dimension = Dimension::of(1, 1, 0, 0);

impl Table {
    /// Without rows.
    fn head(member: CaseMember<'_>, at: &Evaluated) -> Self {
        let (units, energy) = (member.problem().units(), member.problem().units().label(ENERGY));
        let first = [
            ("t", units.time().symbol),
            ("kinetic_energy", &energy),
            ("potential", &energy),
            ("min_J", ""),
            ("newton_iterations", ""),
        ];
        let mut columns: Vec<(String, String)> = first.map(|(name, unit)| (name.to_owned(), unit.to_owned())).into();
        for probe in &member.problem().probes {
            let axes = AXES.iter().take(member.mesh().dim());
            columns.extend(axes.map(|axis| (format!("{}.{axis}", probe.name), units.length().symbol.to_owned())));
        }
        for (block, field) in member.fields().filter(|(block, _)| is_uniform(block)) {
            let name = |c: usize| match block.components {
                1 => field.array.clone(),
                _ => format!("{}.{}", field.array, AXES[c]),
            };
            columns.extend((0..block.components).map(|c| (name(c), field.unit.clone())));
        }
        for (name, what, _) in quantities(member, &at.state) {
            let name = format!("{name}.{what}");
            let known = columns.iter().any(|(known, _)| *known == name);
            columns.push((if known { format!("contributions.{name}") } else { name }, String::new()));
        }
        let (names, units) = columns.into_iter().unzip();
        Self { names, units, rows: vec![] }
    }

    fn add(&mut self, member: CaseMember<'_>, m: &[f64], state: &State) -> Result<(), ControlError> {
        let (report, [kinetic, potential]) = (&state.report, energies(member, state));
        let mut row = vec![state.time, kinetic, potential, report.min_j, report.newton as f64];
        let dim = member.mesh().dim();
        for probe in &member.problem().probes {
            row.extend_from_slice(&probe.displacement(&state.u, dim)[..dim]);
        }
        let m = member.layout().at(m, state.time)?;
        for block in member.reduced().layout_of_instant().blocks().iter().filter(|block| is_uniform(block)) {
            row.extend_from_slice(block.of(&m));
        }
        row.extend(quantities(member, state).into_iter().map(|(.., value)| value));
        self.rows.push(row);
        Ok(())
    }

    fn csv(&self) -> String {
        let mut text = self.names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(",") + "\n";
        for row in &self.rows {
            text += &(row.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }

    /// Charts over the time: displacements of probes, energies, controls.
    fn charts(&self, member: CaseMember<'_>, out: &Directory) -> Result<Vec<String>, RunError> {
        let probes = member.problem().probes.len() * member.mesh().dim();
        let controls = member.fields().filter(|(block, _)| is_uniform(block));
        let controls: usize = controls.map(|(block, _)| block.components).sum();
        let first = 5; // behind the columns that every motion has
        let parts = [
            ("motion.svg", "displacement", first..first + probes),
            ("energies.svg", "energy", 1..3),
            ("controls.svg", "control", first + probes..first + probes + controls),
        ];
        let mut files = Vec::new();
        for (file, what, columns) in parts.into_iter().filter(|(.., columns)| !columns.is_empty()) {
            let unit = &self.units[columns.start];
            let same = columns.clone().all(|c| self.units[c] == *unit);
            let upwards = if same { format!("{what} ({unit})") } else { what.to_owned() };
            let mut chart = Chart::new(&title(member), &format!("t ({})", self.units[0]), &upwards);
            for c in columns.take(CURVES) {
                let label = if same { self.names[c].clone() } else { format!("{} ({})", self.names[c], self.units[c]) };
                chart = chart.curve(Curve::new(&label, self.rows.iter().map(|row| (row[0], row[c], true))));
            }
            let name = member.file(file);
            chart.write(out.file(&name))?;
            files.push(name);
        }
        Ok(files)
    }
}

/// The options of `solve` that look at one equilibrium.
pub(super) fn refused(problem: &CaseProblem, what: &str) -> RunError {
    let message = format!("{what} looks at equilibria, and this case moves: take \"time\" out of it");
    problem.complain("time", message).into()
}
