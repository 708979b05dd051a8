//! [`Series`]: equilibria of one member along a parameter, as a table, CSV, a chart and snapshots.

use crate::lower::CaseMember;
use crate::result::files::Directory;
use crate::result::{snapshot, summary};
use crate::run::error::RunError;
use crate::run::number::short;
use crate::run::solve::title;
use nastic_control::StateFields;
use nastic_fem::{Instant, State};
use nastic_io::write_atomically;
use nastic_picture::{Chart, Curve};
use serde_json::{Map, Value, json};

/// Equilibria one after the other.
pub(super) struct Series<'p> {
    pub member: CaseMember<'p>,
    /// What the names of its files begin with: `ramp`, `path`.
    pub name: &'static str,
    /// Name of the parameter, and its unit (empty where it has none).
    pub parameter: (String, String),
    pub rows: Vec<Row>,
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

/// Columns of values that the terminal shows.
const SHOWN: usize = 6;
/// A component that moves less than this share of the one that moves most is not drawn.
const MOVES: f64 = 0.02;

impl<'p> Series<'p> {
    pub fn new(member: CaseMember<'p>, name: &'static str, parameter: (String, String)) -> Self {
        Self { member, name, parameter, rows: Vec::new() }
    }

    /// Names of what every equilibrium has: components of probes, then what contributions report.
    fn columns(&self) -> Vec<String> {
        let problem = self.member.problem();
        let axes = ["x", "y", "z"].into_iter().take(self.member.mesh().dim());
        let of = |probe: &crate::lower::LocatedProbe| axes.clone().map(|c| format!("{}.{c}", probe.name)).collect();
        let mut names: Vec<String> = problem.probes.iter().flat_map(|probe| -> Vec<String> { of(probe) }).collect();
        let rest = self.member.solid().rest();
        names.extend(self.quantities(&rest).into_iter().map(|(name, what, _)| format!("{name}.{what}")));
        names
    }

    fn values(&self, state: &State) -> Vec<f64> {
        let dim = self.member.mesh().dim();
        let probes = self.member.problem().probes.iter();
        let mut values: Vec<f64> = probes.flat_map(|probe| probe.displacement(&state.u, dim)[..dim].to_vec()).collect();
        values.extend(self.quantities(state).into_iter().map(|(.., value)| value));
        values
    }

    fn quantities(&self, state: &State) -> Vec<(String, &'static str, f64)> {
        let at = Instant::new(&state.u, &state.controls, state.load);
        self.member.solid().model().quantities(&at).unwrap_or_default()
    }

    /// The head of the table.
    pub fn header(&self) -> String {
        let names = self.columns().into_iter().take(SHOWN).map(|name| format!(" {name:>13}"));
        let values = names.collect::<String>();
        format!("{:>14}{values} {:>8} {:>8} {:>6}", self.parameter.0, "min J", "negative", "newton")
    }

    /// One line of the table.
    pub fn line(&self, row: &Row) -> String {
        let values = self.values(&row.state).into_iter().take(SHOWN).map(|x| format!(" {:>13}", short(x)));
        let values = values.collect::<String>();
        let negative = row.negative.map_or_else(|| "-".to_owned(), |n| n.to_string());
        let min_j = format!("{:.4}", row.state.report.min_j);
        format!("{:>14}{values} {min_j:>8} {negative:>8} {:>6}", short(row.parameter), row.newton)
    }

    /// Every row with all its numbers.
    pub fn points(&self) -> Value {
        let of = |row: &Row| {
            let mut entry = Map::new();
            entry.insert("value".into(), json!(row.parameter));
            entry.insert("inertia".into(), json!(row.negative));
            entry.insert("newton_iterations".into(), json!(row.newton));
            entry.extend(summary::shape(self.member, &row.state));
            Value::Object(entry)
        };
        self.rows.iter().map(of).collect()
    }

    /// Writes `NAME.csv`, `NAME.svg`, `NAME.pvd` and a snapshot of every row; the names of the files.
    pub fn write(&self, chart: &Chart, out: &Directory) -> Result<Vec<String>, RunError> {
        let file = |ending: &str| self.member.file(&format!("{}{ending}", self.name));
        let stem = file("_");
        out.remove_numbered(&stem);
        let mut shots = Vec::new();
        for (k, row) in self.rows.iter().enumerate() {
            let shot = snapshot::snapshot(self.member, &StateFields::new(&row.state, &row.m))?;
            let name = format!("{stem}{k:04}.vtu");
            out.write_vtu(&name, &shot)?;
            shots.push((row.parameter, name));
        }
        let (csv, svg, pvd) = (file(".csv"), file(".svg"), file(".pvd"));
        let text = self.csv();
        write_atomically(out.file(&csv), |out| out.write_all(text.as_bytes()))?;
        // ParaView wants times that ascend; a path turns back.
        let ascends = shots.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if !ascends {
            shots.iter_mut().enumerate().for_each(|(k, shot)| shot.0 = k as f64);
        }
        nastic_io::write_pvd(out.file(&pvd), &shots)?;
        chart.write(out.file(&svg))?;
        let mut files = vec![csv, svg, pvd];
        files.extend(shots.into_iter().map(|(_, name)| name));
        Ok(files)
    }

    fn csv(&self) -> String {
        let head = [quoted(&self.parameter.0)].into_iter().chain(self.columns().into_iter().map(|name| quoted(&name)));
        let head = head.chain(["min_J", "negative_pivots", "potential", "newton_iterations"].map(str::to_owned));
        let mut text = head.collect::<Vec<_>>().join(",") + "\n";
        for row in &self.rows {
            let numbers = [row.parameter].into_iter().chain(self.values(&row.state)).map(|x| format!("{x:?}"));
            let report = &row.state.report;
            let negative = row.negative.map_or_else(String::new, |n| n.to_string());
            let rest =
                [format!("{:?}", report.min_j), negative, format!("{:?}", report.energy), row.newton.to_string()];
            text += &(numbers.chain(rest).collect::<Vec<_>>().join(",") + "\n");
        }
        text
    }

    /// What is drawn of every row: components of probes that move, or else the largest displacement; with names.
    fn drawn(&self) -> Vec<(String, Vec<f64>)> {
        let dim = self.member.mesh().dim();
        let probes = self.member.problem().probes.len() * dim;
        let all: Vec<Vec<f64>> = self.rows.iter().map(|row| self.values(&row.state)).collect();
        let column = |c: usize| -> Vec<f64> { all.iter().map(|values| values[c]).collect() };
        let range = |values: &[f64]| {
            let (low, high) =
                values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
            high - low
        };
        let columns: Vec<(String, Vec<f64>)> =
            self.columns().into_iter().take(probes).enumerate().map(|(c, name)| (name, column(c))).collect();
        let most = columns.iter().map(|(_, values)| range(values)).fold(0.0, f64::max);
        if most > 0.0 {
            return columns.into_iter().filter(|(_, values)| range(values) > MOVES * most).collect();
        }
        let largest = |row: &Row| row.state.u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        vec![("largest |u|".to_owned(), self.rows.iter().map(largest).collect())]
    }

    /// The chart of displacements: over the parameter, or the parameter over them. Unstable equilibria are dashed.
    pub fn chart(&self, parameter_upwards: bool) -> Chart {
        let length = self.member.problem().units().length().symbol;
        let (name, unit) = &self.parameter;
        let parameter = if unit.is_empty() { name.clone() } else { format!("{name} ({unit})") };
        let displacement = format!("displacement ({length})");
        let heading = format!("{}: {}", title(self.member), self.name);
        let mut chart = match parameter_upwards {
            true => Chart::new(&heading, &displacement, &parameter),
            false => Chart::new(&heading, &parameter, &displacement),
        };
        for (name, values) in self.drawn() {
            let point = |(row, u): (&Row, f64)| match parameter_upwards {
                true => (u, row.parameter, row.negative == Some(0)),
                false => (row.parameter, u, row.negative == Some(0)),
            };
            chart = chart.curve(Curve::new(&name, self.rows.iter().zip(values).map(point)));
        }
        chart
    }
}

fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}
