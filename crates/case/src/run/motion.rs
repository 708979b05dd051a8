//! Motions as results: `motion_0000.vtu` .. with `motion.pvd`, `motion.csv` and charts of every step, the entry `time`.

use super::error::RunError;
use super::number::{count, quantity, short};
use super::session::Session;
use super::solve::title;
use crate::lower::{CaseMember, CaseProblem};
use crate::quantity::Dimension;
use crate::result::csv::quoted;
use crate::result::files::Directory;
use crate::result::inspection::Inspection;
use crate::result::snapshot;
use crate::warning::Warning;
use nastic_control::{EnsemblePoint, Evaluated, StateFields};
use nastic_fem::{Demand, Instant, State};
use nastic_io::write_atomically;
use nastic_mesh::Snapshot;
use nastic_picture::{Chart, Curve};
use rayon::prelude::*;
use serde_json::json;

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

/// Looks into the states that are written, beside the last one, which is looked into with all others; what deserves attention is told
/// once for each kind, with the first instant that has it.
pub(super) fn inspect(session: &mut Session<'_>, point: &EnsemblePoint) {
    let unit = session.problem.units().time().symbol;
    let mut warnings: Vec<Warning> = Vec::new();
    for (member, at) in session.problem.members().zip(&point.members) {
        let shown = shown(member, at);
        let before = &shown[..shown.len().saturating_sub(1)];
        let found: Vec<Inspection> = before.par_iter().map(|n| Inspection::of(member, &at.states()[*n])).collect();
        let mut told: Vec<(Warning, usize)> = Vec::new();
        for (n, found) in before.iter().zip(&found) {
            let place = format!("motion at t = {} {unit}", short(at.states()[*n].time));
            for warning in found.warnings(member, &place) {
                match told.iter_mut().find(|(known, _)| known.kind == warning.kind) {
                    Some((_, count)) => *count += 1,
                    None => told.push((warning, 1)),
                }
            }
        }
        warnings.extend(told.into_iter().map(|(mut warning, count)| {
            warning.message += &format!(" (the first of {count} such states among {})", before.len());
            warning
        }));
    }
    warnings.into_iter().for_each(|warning| session.warn(warning));
}

/// The entry `time` of the result, and a line about the motion.
pub(super) fn report(session: &mut Session<'_>, point: &EnsemblePoint) {
    let Some(time) = session.problem.case.time.clone() else { return };
    let units = session.problem.units();
    let of = |value: f64| quantity(value, Dimension::TIME, units);
    session.console.say(format!(
        "motion      {} of {} to {} by {}, {} steps of the load cut",
        count(time.steps(), "step"),
        of(time.step),
        of(time.end),
        time.scheme.name(),
        point.members.iter().map(|at| at.work.cuts).sum::<usize>()
    ));
    let mut entries = Vec::new();
    for (member, at) in session.problem.members().zip(&point.members) {
        let energies: Vec<[f64; 2]> = [0, at.states().len() - 1].map(|n| energies(member, &at.states()[n])).to_vec();
        let name = if member.name().is_empty() { String::new() } else { format!(" in {}", member.name()) };
        let pair =
            |[kinetic, potential]: [f64; 2]| format!("kinetic {}, potential {}", short(kinetic), short(potential));
        let unit = units.label(ENERGY);
        session.console.say(format!(
            "energy      at t = 0: {}; at the end: {} ({unit}){name}",
            pair(energies[0]),
            pair(energies[1])
        ));
        let entry = |[kinetic, potential]: [f64; 2]| json!({ "kinetic": kinetic, "potential": potential });
        entries.push(json!({
            "end": time.end, "step": time.step, "steps": time.steps(), "scheme": time.scheme.name(),
            "mass": time.mass.name(), "written": shown(member, at).len(),
            "energies": { "start": entry(energies[0]), "end": entry(energies[1]) },
        }));
    }
    for (index, entry) in entries.into_iter().enumerate() {
        session.put_of_member(index, "time", entry);
    }
}

/// Writes the files of all members; their names.
pub(super) fn write(problem: &CaseProblem, point: &EnsemblePoint, out: &Directory) -> Result<Vec<String>, RunError> {
    let mut files = Vec::new();
    for (member, at) in problem.members().zip(&point.members) {
        let table = Table::of(member, at);
        let (csv, pvd) = (member.file("motion.csv"), member.file("motion.pvd"));
        let text = table.csv();
        write_atomically(out.file(&csv), |out| out.write_all(text.as_bytes()))?;
        files.push(csv);
        files.extend(table.charts(member, out)?);
        let stem = member.file("motion_");
        out.remove_numbered(&stem);
        let mut shots = Vec::new();
        for (k, n) in shown(member, at).into_iter().enumerate() {
            let name = format!("{stem}{k:04}");
            let state = &at.states()[n];
            out.write_state(&name, &snapshot::snapshot(member, &StateFields::new(state, &at.m))?)?;
            shots.push((state.time, format!("{name}.vtu")));
        }
        nastic_io::write_pvd(out.file(&pvd), &shots)?;
        files.push(pvd);
        files.extend(shots.into_iter().map(|(_, name)| name));
    }
    Ok(files)
}

/// A few states before the end, with what they are called, for a picture.
pub(super) fn ghosts(member: CaseMember<'_>, at: &Evaluated) -> Result<Vec<(String, Snapshot)>, RunError> {
    let Some(time) = &member.case().time else { return Ok(vec![]) };
    let steps = at.states().len() - 1;
    let unit = member.problem().units().time().symbol;
    let of = |k: usize| {
        let n = k * steps / GHOSTS;
        let shot = snapshot::plain(member, &StateFields::new(&at.states()[n], &at.m))?;
        Ok((format!("t = {} {unit}", short(time.step * n as f64)), shot))
    };
    (0..GHOSTS.min(steps)).map(of).collect()
}

/// The numbers of the states that are written: the first, the last, and those between at equal distances.
fn shown(member: CaseMember<'_>, at: &Evaluated) -> Vec<usize> {
    let stride = member.case().time.as_ref().map_or(1, crate::schema::Time::stride);
    let last = at.states().len() - 1;
    let mut out: Vec<usize> = (0..last).step_by(stride).collect();
    out.push(last);
    out
}

/// Kinetic energy, and the potential of stresses, actuations and loads.
fn energies(member: CaseMember<'_>, state: &State) -> [f64; 2] {
    let model = member.solid().model();
    let at = Instant::new(&state.u, &state.controls, 1.0);
    let demand = Demand { energy: true, force: false };
    [model.kinetic_energy(state), model.evaluate(&at, demand).map_or(f64::NAN, |sums| sums.energy)]
}

const ENERGY: Dimension = Dimension::of(1, 1, 0, 0);

impl Table {
    fn of(member: CaseMember<'_>, at: &Evaluated) -> Self {
        let units = member.problem().units();
        let mut names: Vec<String> =
            ["t", "kinetic_energy", "potential", "min_J", "newton_iterations"].map(str::to_owned).into();
        let mut labels: Vec<String> =
            [units.time().symbol, &units.label(ENERGY), &units.label(ENERGY), "", ""].map(str::to_owned).into();
        let axes = &["x", "y", "z"][..member.mesh().dim()];
        for probe in &member.problem().probes {
            for axis in axes {
                names.push(format!("{}.{axis}", probe.name));
                labels.push(units.length().symbol.to_owned());
            }
        }
        for (block, field) in member.fields().filter(|(block, _)| block.size() == block.components) {
            let name = |c: usize| {
                if block.components == 1 {
                    field.array.clone()
                } else {
                    format!("{}.{}", field.array, ["x", "y", "z"][c])
                }
            };
            names.extend((0..block.components).map(name));
            labels.extend((0..block.components).map(|_| field.unit.clone()));
        }
        let quantities = |state: &State| {
            let at = Instant::new(&state.u, &state.controls, state.load);
            member.solid().model().quantities(&at).unwrap_or_default()
        };
        for (name, what, _) in quantities(&at.state) {
            let name = format!("{name}.{what}");
            names.push(if names.contains(&name) { format!("contributions.{name}") } else { name });
            labels.push(String::new());
        }
        let row = |state: &State| {
            let report = &state.report;
            let [kinetic, potential] = energies(member, state);
            let mut row = vec![state.time, kinetic, potential, report.min_j, report.newton as f64];
            for probe in &member.problem().probes {
                row.extend_from_slice(&probe.displacement(&state.u, axes.len())[..axes.len()]);
            }
            let m = member.layout().at(&at.m, state.time).unwrap_or_default();
            for block in member.reduced().layout_of_instant().blocks().iter().filter(|b| b.size() == b.components) {
                row.extend_from_slice(block.of(&m));
            }
            row.extend(quantities(state).into_iter().map(|(.., value)| value));
            row
        };
        let rows = at.states().par_iter().map(row).collect();
        Self { names, units: labels, rows }
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
        let controls = member.fields().filter(|(block, _)| block.size() == block.components);
        let controls: usize = controls.map(|(block, _)| block.components).sum();
        let first = 5;
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
    let message = format!("{what} looks at equilibria, and this case moves: take \"time\" out, as by --set time=null");
    problem.complain("time", message).into()
}
