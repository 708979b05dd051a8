//! [`Series`]: equilibria of one member along a parameter, as a table, CSV, a chart and snapshots.

use crate::run::error::RunError;
use crate::run::state_columns::{BALANCE, Column, csv, probe_values, reaction_values};
use nastic_case::electric;
use nastic_case::lower::CaseMember;
use nastic_case::warning::Warning;
use nastic_control::{ControlError, StateFields};
use nastic_fem::{Instant, State, StoredEnergy};
use nastic_io::write_atomically;
use nastic_language::number::short;
use nastic_mesh::Snapshot;
use nastic_picture::{Chart, Curve};
use nastic_report::record::{PointRecord, StateRecord};
use nastic_result::files::Directory;
use nastic_result::inspection::Inspection;
use nastic_result::title::title;
use nastic_result::{snapshot, summary};
use rayon::prelude::*;

/// Equilibria one after the other.
pub(super) struct Series<'p> {
    pub member: CaseMember<'p>,
    /// What the names of its files begin with: `ramp`, `path`.
    pub name: &'static str,
    /// Name of the parameter, and its unit (empty where it has none).
    pub parameter: (String, String),
    pub rows: Vec<Row>,
    /// What was found in each row, once they were inspected.
    found: Vec<Inspection>,
    /// What each row carries, once they were inspected.
    pub(super) carried: Vec<Carried>,
}

/// One equilibrium.
pub(super) struct Row {
    pub parameter: f64,
    /// The member's controls.
    pub m: Vec<f64>,
    pub state: State,
    /// Negative pivots of the tangent, where it has an inertia.
    pub negative: Option<usize>,
    /// Newton iterations that led to it.
    pub newton: usize,
}

/// Forces of supports and stored energies of an equilibrium.
pub(super) struct Carried {
    pub forces: Vec<(String, [f64; 3])>,
    pub energy: Option<StoredEnergy>,
}

/// A number of every state that is drawn.
struct Drawn {
    name: String,
    /// Its column; the largest displacement if none.
    column: Option<usize>,
}

/// Columns of values that the terminal shows.
const SHOWN: usize = 6;
/// A component that moves less than this share of the one that moves most is not drawn.
pub(super) const MOVES: f64 = 0.02;

impl<'p> Series<'p> {
    pub fn new(member: CaseMember<'p>, name: &'static str, parameter: (String, String)) -> Self {
        Self { member, name, parameter, rows: Vec::new(), found: Vec::new(), carried: Vec::new() }
    }

    /// Looks into the rows. What deserves attention is reported once for each kind, with the first row that has it.
    pub fn inspect(&mut self) -> Vec<Warning> {
        let member = self.member;
        let look = |row: &Row| Inspection::of_counted(member, &row.state, row.negative);
        self.found = self.rows.par_iter().with_max_len(1).map(look).collect();
        let carried = |row: &Row| Carried {
            forces: summary::forces(member, None, &row.state),
            energy: member.solid().model().energies().stored_energy(&row.state).ok(),
        };
        self.carried = self.rows.par_iter().with_max_len(1).map(carried).collect();
        let mut shown: Vec<(Warning, usize)> = Vec::new();
        for (row, found) in self.rows.iter().zip(&self.found) {
            let at = format!("{} at {}", self.name, short(row.parameter));
            for warning in found.warnings(member, &at) {
                match shown.iter_mut().find(|(known, _)| known.kind == warning.kind) {
                    Some((_, count)) => *count += 1,
                    None => shown.push((warning, 1)),
                }
            }
        }
        let rows = self.rows.len();
        let with_count = |(mut warning, count): (Warning, usize)| {
            warning.message += &format!(" (the first of {count} such states among {rows})");
            warning
        };
        shown.into_iter().map(with_count).collect()
    }

    /// A row as it is written, with the cells marked where the body intersects itself.
    pub fn snapshot(&self, index: usize) -> Result<Snapshot, ControlError> {
        let row = &self.rows[index];
        snapshot::inspected(self.member, &StateFields::new(&row.state, &row.m, 0), self.found.get(index))
    }

    /// What every equilibrium has: components of probes, then what contributions report.
    pub(super) fn columns(&self) -> Vec<Column> {
        let mut columns = Column::of_probes(self.member);
        let rest = self.member.solid().rest();
        // The parameter may be the added volume, `air.volume`.
        let parameter = Column::new(&self.parameter.0, &self.parameter.1);
        columns.extend(Column::of_quantities(&self.quantities(&rest), &[parameter]));
        columns
    }

    pub(super) fn values(&self, state: &State) -> Vec<f64> {
        let mut values = probe_values(self.member, state);
        values.extend(self.quantities(state).into_iter().map(|(.., value)| value));
        values
    }

    fn quantities(&self, state: &State) -> Vec<(String, &'static str, f64)> {
        let at = Instant::of(state);
        electric::quantities(self.member, &at).unwrap_or_default()
    }

    /// The head of the table.
    pub fn header(&self) -> String {
        let values = self.columns().iter().take(SHOWN).map(|own| format!(" {:>13}", own.name)).collect::<String>();
        format!("{:>14}{values} {:>13} {:>8} {:>8} {:>6}", self.parameter.0, "potential", "min J", "negative", "newton")
    }

    /// One line of the table.
    pub fn line(&self, row: &Row) -> String {
        let columns = self.values(&row.state).into_iter().zip(self.columns()).take(SHOWN);
        let value = |(x, own): (f64, Column)| format!(" {:>1$}", short(x), own.name.chars().count().max(13));
        let values = columns.map(value).collect::<String>();
        let negative = row.negative.map_or_else(|| "-".to_owned(), |n| n.to_string());
        let (potential, min_j) = (short(row.state.report.energy), format!("{:.4}", row.state.report.min_j));
        let rest = format!("{potential:>13} {min_j:>8} {negative:>8} {:>6}", row.newton);
        format!("{:>14}{values} {rest}", short(row.parameter))
    }

    /// Every row with all its numbers.
    pub fn points(&self) -> Vec<PointRecord> {
        let of = |(row, carried): (&Row, &Carried)| {
            let (inertia, newton_iterations) = (row.negative.into(), Some(row.newton));
            let (reactions, energy) = (Some(summary::named(&carried.forces)), carried.energy.map(summary::energy));
            let shape = summary::shape(self.member, &row.state);
            let state = StateRecord { inertia, newton_iterations, reactions, energy, ..shape };
            let restarts = Some(row.state.report.restarts);
            PointRecord { value: row.parameter.into(), restarts, state, ..PointRecord::default() }
        };
        self.rows.iter().zip(&self.carried).map(of).collect()
    }

    /// Writes `NAME.csv`, `NAME.svg`, `NAME_reactions.svg` .., `NAME.pvd` and a snapshot of every row; the names of the files.
    pub fn write(&self, chart: &Chart, out: &Directory) -> Result<Vec<String>, RunError> {
        let file = |ending: &str| self.member.file(&format!("{}{ending}", self.name));
        let stem = file("_");
        let (mut shots, mut states) = (Vec::new(), Vec::new());
        for (k, row) in self.rows.iter().enumerate() {
            let name = format!("{stem}{k:04}");
            states.extend(out.write_state(&name, &self.snapshot(k)?)?);
            shots.push((row.parameter, format!("{name}.vtu")));
        }
        out.remove_numbered(&stem, self.rows.len());
        let (csv, svg, pvd) = (file(".csv"), file(".svg"), file(".pvd"));
        let text = self.csv();
        write_atomically(out.own(&csv)?, |out| out.write_all(text.as_bytes()))?;
        // ParaView wants times that ascend; a path turns back.
        let ascends = shots.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if !ascends {
            shots.iter_mut().enumerate().for_each(|(k, shot)| shot.0 = k as f64);
        }
        nastic_io::write_pvd(out.own(&pvd)?, &shots)?;
        chart.write(out.own(&svg)?)?;
        let mut files = vec![csv, svg];
        files.extend(self.write_charts(out)?);
        files.push(pvd);
        files.extend(states);
        Ok(files)
    }

    fn csv(&self) -> String {
        let mut columns = vec![Column::new(&self.parameter.0, &self.parameter.1)];
        columns.extend(self.columns());
        columns
            .extend(["min_J", "negative_pivots", "potential", "newton_iterations"].map(|name| Column::new(name, "")));
        columns
            .extend(self.carried.first().map_or_else(Vec::new, |row| Column::of_reactions(self.member, &row.forces)));
        columns.extend(self.energies().map(|(name, _)| Column::new(format!("{BALANCE}{name}"), "")));
        let row = |(k, row): (usize, &Row)| {
            let numbers = [row.parameter].into_iter().chain(self.values(&row.state)).map(|x| format!("{x:?}"));
            let report = &row.state.report;
            let negative = row.negative.map_or_else(String::new, |n| n.to_string());
            let rest =
                [format!("{:?}", report.min_j), negative, format!("{:?}", report.energy), row.newton.to_string()];
            let forces = self.carried.get(k).map_or_else(Vec::new, |own| reaction_values(self.member, &own.forces));
            let more = forces.into_iter().chain(self.energies().map(|(_, of)| of(&self.carried[k])));
            numbers.chain(rest).chain(more.map(|x| format!("{x:?}"))).collect()
        };
        csv(&columns, self.rows.iter().enumerate().map(row))
    }

    /// What is drawn of every row: the columns of components of probes that move; none of them: the largest
    /// displacement.
    fn drawn(&self) -> Vec<Drawn> {
        let probes = self.member.problem().probes.len() * self.member.mesh().dim();
        let columns = self.columns().into_iter().take(probes).enumerate();
        let columns: Vec<Drawn> = columns.map(|(column, own)| Drawn { name: own.name, column: Some(column) }).collect();
        let range = |drawn: &Drawn| {
            let values = self.rows.iter().map(|row| self.value(&row.state, drawn));
            let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        let ranges: Vec<f64> = columns.iter().map(range).collect();
        let most = ranges.iter().fold(0.0, |most: f64, range| most.max(*range));
        if most > 0.0 {
            return columns
                .into_iter()
                .zip(ranges)
                .filter(|(_, r)| *r > MOVES * most)
                .map(|(drawn, _)| drawn)
                .collect();
        }
        vec![Drawn { name: "largest |u|".to_owned(), column: None }]
    }

    fn value(&self, state: &State, drawn: &Drawn) -> f64 {
        match drawn.column {
            Some(column) => self.values(state)[column],
            None => {
                self.member.solid().model().displacement(&state.u).iter().fold(0.0, |most: f64, u| most.max(u.abs()))
            }
        }
    }

    /// The first value that is drawn, of another state.
    pub fn first_value(&self, state: &State) -> f64 {
        self.drawn().first().map_or(f64::NAN, |drawn| self.value(state, drawn))
    }

    /// The chart of displacements: over the parameter, or the parameter over them. Unstable equilibria are dashed.
    pub fn chart(&self, parameter_upwards: bool) -> Chart {
        let length = self.member.problem().units().length().symbol;
        let parameter = self.axis();
        let displacement = format!("displacement ({length})");
        let heading = self.heading();
        let mut chart = match parameter_upwards {
            true => Chart::new(&heading, &displacement, &parameter),
            false => Chart::new(&heading, &parameter, &displacement),
        };
        for drawn in self.drawn() {
            let point = |row: &Row| match (self.value(&row.state, &drawn), row.negative == Some(0)) {
                (u, stable) if parameter_upwards => (u, row.parameter, stable),
                (u, stable) => (row.parameter, u, stable),
            };
            chart = chart.curve(Curve::new(&drawn.name, self.rows.iter().map(point)));
        }
        chart
    }

    pub(super) fn heading(&self) -> String {
        format!("{}: {}", title(self.member), self.name)
    }

    /// What the axis of the parameter is called.
    pub(super) fn axis(&self) -> String {
        match &self.parameter {
            (name, unit) if unit.is_empty() => name.clone(),
            (name, unit) => format!("{name} ({unit})"),
        }
    }
}
