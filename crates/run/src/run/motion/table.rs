//! [`Table`]: the numbers of every step of a motion, as CSV and as charts.

use crate::run::error::RunError;
use crate::run::state_columns::{AXES, BALANCE, Column, ENERGY, csv, probe_values, reaction_values};
use nastic_case::electric;
use nastic_case::lower::CaseMember;
use nastic_control::{ControlBlock, ControlError};
use nastic_fem::{EnergyBalance, Instant, State, TimeStep, Touch};
use nastic_picture::{Chart, Curve};
use nastic_report::record::ContributionRecord;
use nastic_result::files::Directory;
use nastic_result::summary;
use nastic_result::title::title;

/// Curves of a chart: colours that it has.
const CURVES: usize = 12;

/// Columns of every table.
pub(super) const KINETIC_ENERGY: usize = 1;
pub(super) const POTENTIAL: usize = 2;
pub(super) const MIN_J: usize = 3;

/// Entries of the balance of energy that are energies or losses.
const STACKED: usize = 5;

/// Columns of a table of a motion, one row for every step.
pub(crate) struct Table {
    columns: Vec<Column>,
    /// What contributions report, from this column on: names, and what their numbers are.
    reported: (usize, Vec<(String, &'static str)>),
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// How many columns it has.
    pub fn columns(&self) -> usize {
        self.columns.len()
    }

    /// What a contribution reports of every state, with its instant.
    pub fn contribution(&self, name: &str) -> impl Iterator<Item = (f64, ContributionRecord)> {
        let (first, reported) = &self.reported;
        let own = reported.iter().enumerate().filter(move |(_, (of, _))| of == name);
        let own: Vec<_> = own.map(|(k, (_, what))| (*what, first + k)).collect();
        self.rows
            .iter()
            .map(move |row| (row[0], own.iter().map(|(what, column)| (*what, row[*column])).collect::<Vec<_>>().into()))
    }

    /// Without rows.
    pub fn head(member: CaseMember<'_>, state: &State) -> Self {
        let (units, energy) = (member.problem().units(), member.problem().units().label(ENERGY));
        let first = [
            ("t", units.time().symbol),
            ("kinetic_energy", &energy),
            ("potential", &energy),
            ("min_J", ""),
            ("newton_iterations", ""),
        ];
        let mut columns: Vec<Column> = first.map(|(name, unit)| Column::new(name, unit)).into();
        columns.extend(Column::of_probes(member));
        for (block, field) in member.fields().filter(|(block, _)| is_uniform(block)) {
            let name = |c: usize| match block.components {
                1 => field.array.clone(),
                _ => format!("{}.{}", field.array, AXES[c]),
            };
            columns.extend((0..block.components).map(|c| Column::new(name(c), &field.unit)));
        }
        let quantities = quantities(member, None, state);
        let first = columns.len();
        columns.extend(Column::of_quantities(&quantities, &columns));
        let reported = (first, quantities.into_iter().map(|(name, what, _)| (name, what)).collect());
        columns.extend(Column::of_reactions(member, &summary::forces(member, None, state)));
        for (name, wanted) in aimed(member) {
            let unit = units.length().symbol;
            columns.extend(Column::along_axes(member, &format!("{name}.position"), unit));
            let targets = Column::along_axes(member, &format!("{name}.target"), unit).into_iter().zip(wanted);
            columns.extend(targets.filter_map(|(column, is_wanted)| is_wanted.then_some(column)));
        }
        // behind all others, and none is there twice: the kinetic energy stands at the front
        let balance = EnergyBalance::NAMES.iter().skip(1);
        columns.extend(balance.map(|name| Column::new(format!("{BALANCE}{name}"), &energy)));
        Self { columns, reported, rows: vec![] }
    }

    /// The row of a state, under the control vector m of the motion, and from where the step led there.
    pub fn add(
        &mut self,
        member: CaseMember<'_>,
        m: &[f64],
        before: Option<&State>,
        state: &State,
        balance: Option<EnergyBalance>,
    ) -> Result<(), ControlError> {
        let (report, [kinetic, potential]) = (&state.report, energies(member, state));
        let mut row = vec![state.time, kinetic, potential, report.min_j, report.newton as f64];
        let dim = member.mesh().dim();
        row.extend(probe_values(member, state));
        let m = member.layout().at(m, state.time)?;
        for block in member.reduced().layout_of_instant().blocks().iter().filter(|block| is_uniform(block)) {
            row.extend(block.values_of(block.of(&m)));
        }
        row.extend(quantities(member, before, state).into_iter().map(|(.., value)| value));
        row.extend(reaction_values(member, &summary::forces(member, before, state)));
        let aims = member.reduced().aims(self.rows.len(), &state.u);
        for ((_, wanted), (_, aim)) in aimed(member).iter().zip(&aims) {
            row.extend_from_slice(&aim.position[..dim]);
            let components = (0..dim).filter(|k| wanted[*k]);
            row.extend(components.map(|k| aim.target[k].unwrap_or(f64::NAN)));
        }
        let entries = balance.map_or([f64::NAN; EnergyBalance::NAMES.len()], |balance| balance.entries());
        row.extend_from_slice(&entries[1..]);
        self.rows.push(row);
        Ok(())
    }

    /// The balance of energy of every row.
    pub fn balances(&self) -> impl Iterator<Item = (f64, EnergyBalance)> {
        self.rows.iter().filter_map(|row| Some((*row.first()?, balance_of(row)?)))
    }

    /// That of the last row.
    pub fn last_balance(&self) -> Option<EnergyBalance> {
        balance_of(self.rows.last()?)
    }

    pub fn csv(&self) -> String {
        csv(&self.columns, self.rows.iter().map(|row| row.iter().map(|x| format!("{x:?}")).collect()))
    }

    /// Charts over the time: displacements of probes, energies, controls.
    pub fn charts(&self, member: CaseMember<'_>, out: &Directory) -> Result<Vec<String>, RunError> {
        let probes = member.problem().probes.len() * member.mesh().dim();
        let controls = member.fields().filter(|(block, _)| is_uniform(block));
        let controls: usize = controls.map(|(block, _)| block.components).sum();
        let first = 5; // behind the columns that every motion has
        let parts = [
            ("motion.svg", "displacement", first..first + probes),
            ("controls.svg", "control", first + probes..first + probes + controls),
        ];
        let mut files = Vec::new();
        for (file, what, columns) in parts.into_iter().filter(|(.., columns)| !columns.is_empty()) {
            let unit = &self.columns[columns.start].unit;
            let same = columns.clone().all(|c| self.columns[c].unit == *unit);
            let upwards = if same { format!("{what} ({unit})") } else { what.to_owned() };
            let heading = match columns.len() {
                more if more > CURVES => {
                    format!("{}: the first {CURVES} of {more} curves, all in motion.csv", title(member))
                }
                _ => title(member),
            };
            let mut chart = Chart::new(&heading, &format!("t ({})", self.columns[0].unit), &upwards);
            for c in columns.take(CURVES) {
                let Column { name, unit } = &self.columns[c];
                let label = if same { name.clone() } else { format!("{name} ({unit})") };
                chart = chart.curve(Curve::new(&label, self.rows.iter().map(|row| (row[0], row[c], true))));
            }
            let name = member.file(file);
            chart.write(out.own(&name)?)?;
            files.push(name);
        }
        files.extend(self.balance_chart(member, out)?);
        Ok(files)
    }

    /// Energies and losses one upon the other, and what was put in: what is between the two the scheme has added or taken.
    fn balance_chart(&self, member: CaseMember<'_>, out: &Directory) -> Result<Option<String>, RunError> {
        let all: Vec<(f64, [f64; 12])> = self.balances().map(|(t, balance)| (t, balance.entries())).collect();
        let Some((_, first)) = all.first() else { return Ok(None) };
        let unit = member.problem().units().label(ENERGY);
        let mut chart =
            Chart::new(&title(member), &format!("t ({})", self.columns[0].unit), &format!("energy ({unit})"));
        let mut below = vec![0.0; all.len()];
        for k in (0..STACKED).filter(|k| all.iter().any(|(_, entries)| entries[*k] != 0.0)) {
            below.iter_mut().zip(&all).for_each(|(sum, (_, entries))| *sum += entries[k]);
            let name = EnergyBalance::NAMES[k].replace('_', " ");
            let label = if chart.is_empty() { name } else { format!("+ {name}") };
            chart = chart.curve(Curve::new(&label, all.iter().zip(&below).map(|((t, _), sum)| (*t, *sum, true))));
        }
        let start: f64 = first[..STACKED].iter().sum();
        let put_in = |entries: &[f64; 12]| start + entries[STACKED..EnergyBalance::PHYSICAL].iter().sum::<f64>();
        chart = chart.curve(Curve::line("put in", 3.0, all.iter().map(|(t, entries)| (*t, put_in(entries), true))));
        let name = member.file("energies.svg");
        chart.write(out.own(&name)?)?;
        Ok(Some(name))
    }
}

/// The balance of energy of a row, whose last columns it is.
fn balance_of(row: &[f64]) -> Option<EnergyBalance> {
    let behind = row.len().checked_sub(EnergyBalance::NAMES.len() - 1)?;
    let mut entries = [*row.get(KINETIC_ENERGY)?; EnergyBalance::NAMES.len()];
    entries[1..].copy_from_slice(&row[behind..]);
    Some(EnergyBalance::from_entries(entries))
}

/// The costs that look at a place, and which components have a target.
fn aimed(member: CaseMember<'_>) -> Vec<(String, [bool; 3])> {
    let rest = vec![0.0; member.mesh().points().len() * member.mesh().dim()];
    let costs = member.reduced().costs().iter();
    let aims = costs.filter_map(|cost| Some((cost.name().to_owned(), cost.aim(member.solid(), &rest)?)));
    aims.map(|(name, aim)| (name, aim.target.map(|target| target.is_some()))).collect()
}

/// One value in space, or one vector.
fn is_uniform(block: &ControlBlock) -> bool {
    block.size() == block.components
}

/// What contributions report of a state; of contacts, whose friction depends on velocities, in the step that led there.
fn quantities(member: CaseMember<'_>, before: Option<&State>, state: &State) -> Vec<(String, &'static str, f64)> {
    let mut all = electric::quantities(member, &Instant::of(state)).unwrap_or_default();
    for (name, touch) in touches(member, before, state) {
        let own = touch.quantities(member.mesh().dim());
        let of_contact = all.iter_mut().filter(|(of, ..)| *of == name);
        of_contact.zip(own).for_each(|((.., known), (_, value))| *known = value);
    }
    all
}

/// What every contact carries in a state, and in the step that led there.
pub(crate) fn touches(member: CaseMember<'_>, before: Option<&State>, state: &State) -> Vec<(String, Touch)> {
    let (step, at) = (before.map(|before| TimeStep::between(before, state)), Instant::of(state));
    member.solid().model().contacts().touches(&step.as_ref().map_or(at, |step| at.in_step(step)))
}

/// Kinetic energy (none without inertia), and the potential of stresses, actuations and loads.
pub(crate) fn energies(member: CaseMember<'_>, state: &State) -> [f64; 2] {
    let without_inertia = member.reduced().timeline().is_some_and(|timeline| timeline.scheme().is_quasi_static());
    let kinetic = if without_inertia { Ok(0.0) } else { member.solid().model().energies().kinetic_energy(state) };
    [kinetic.unwrap_or(f64::NAN), summary::potential(member, state)]
}
