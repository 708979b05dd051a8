//! Rows of `motion.csv`: paths of probes, values at an instant.

use super::state::State;
use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::record::{ProbeRecord, ProbesRecord};

const AXES: [&str; 3] = ["x", "y", "z"];
/// What follows the name of a cost in the columns of the place that it looks at, and of where that should be.
const POSITION: &str = ".position.";
const TARGET: &str = ".target.";

/// The table of a motion.
struct Table {
    head: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    fn of(folder: &ResultFolder, state: &State<'_>) -> Result<Self, ReportError> {
        let file = format!("{}motion.csv", state.stem());
        let text = if folder.wrote(&file) { folder.text(&file)? } else { None };
        let text = text.ok_or_else(|| ReportError::NoMotion { file: file.clone() })?;
        let mut lines = text.lines();
        let head: Vec<String> = lines.next().unwrap_or_default().split(',').map(str::to_owned).collect();
        let number = |cell: &str| cell.parse().unwrap_or(f64::NAN);
        let rows =
            lines.map(|line| line.split(',').map(number).collect::<Vec<f64>>()).filter(|row| row.len() == head.len());
        Ok(Self { rows: rows.collect(), head })
    }

    fn column(&self, name: &str) -> Result<usize, ReportError> {
        self.head.iter().position(|own| own == name).ok_or_else(|| ReportError::Unknown {
            what: "column of motion.csv",
            name: name.to_owned(),
            has: self.head.clone(),
        })
    }

    /// The costs with columns of this kind, in order.
    fn costs(&self, kind: &str) -> Vec<String> {
        let of = |name: &String| {
            let mut cost = AXES.iter().filter_map(|axis| name.strip_suffix(&format!("{kind}{axis}")));
            cost.next().map(str::to_owned)
        };
        let mut names: Vec<String> = self.head.iter().filter_map(of).collect();
        names.dedup();
        names
    }

    /// Three columns in all rows in which they are numbers; zero where there is no column.
    fn places(&self, columns: &[Option<usize>; 3]) -> Vec<[f64; 3]> {
        let at = |row: &Vec<f64>| columns.map(|column| column.map_or(0.0, |column| row[column]));
        self.rows.iter().map(at).filter(|at| at.iter().all(|x| x.is_finite())).collect()
    }
}

/// The positions over all instants of a probe, or of the place that a cost looks at.
pub(super) fn of(folder: &ResultFolder, state: &State<'_>, name: &str) -> Result<Vec<[f64; 3]>, ReportError> {
    let table = Table::of(folder, state)?;
    let probes = probes(state);
    let Some((_, probe)) = probes.iter().find(|(own, _)| own == name) else {
        let costs = table.costs(POSITION);
        if costs.iter().any(|own| own == name) {
            return Ok(table.places(&AXES.map(|axis| table.column(&format!("{name}{POSITION}{axis}")).ok())));
        }
        let has = probes.iter().map(|(own, _)| own.clone()).chain(costs).collect();
        return Err(ReportError::Unknown { what: "probe", name: name.to_owned(), has });
    };
    let mut columns = [None; 3];
    for (k, axis) in AXES.iter().enumerate().take(state.shot.mesh.dim()) {
        columns[k] = Some(table.column(&format!("{name}.{axis}"))?);
    }
    let rest: [f64; 3] = std::array::from_fn(|i| probe.point.get(i).and_then(|x| **x).unwrap_or(0.0));
    Ok(table.places(&columns).iter().map(|u| std::array::from_fn(|i| rest[i] + u[i])).collect())
}

/// The path of a target that moves, and the cost that it is of.
pub(super) struct TargetPath {
    pub cost: String,
    pub points: Vec<[f64; 3]>,
}

/// The paths of targets that move; components that are free are those of the place itself.
pub(super) fn moving_targets(folder: &ResultFolder, state: &State<'_>) -> Result<Vec<TargetPath>, ReportError> {
    if !folder.wrote(&format!("{}motion.csv", state.stem())) {
        return Ok(Vec::new());
    }
    let table = Table::of(folder, state)?;
    let moving = |name: String| {
        let target = AXES.map(|axis| table.column(&format!("{name}{TARGET}{axis}")).ok());
        let own = AXES.map(|axis| table.column(&format!("{name}{POSITION}{axis}")).ok());
        let wanted = table.places(&target);
        let moves = wanted.windows(2).any(|pair| pair[0] != pair[1]);
        let columns: [Option<usize>; 3] = std::array::from_fn(|i| target[i].or(own[i]));
        moves.then(|| TargetPath { cost: name, points: table.places(&columns) })
    };
    Ok(table.costs(TARGET).into_iter().filter_map(moving).collect())
}

/// The paths that are drawn unless others are asked for: of what should follow targets that move, in the motion that the table is of.
pub(super) fn usual(state: &State<'_>, folder: &ResultFolder, targets: &[TargetPath]) -> Vec<String> {
    let own = state.name.strip_prefix(state.stem()).unwrap_or(&state.name);
    let of_motion = own == "optimum" || own.starts_with("motion_");
    let is_end = own == "start" && !folder.wrote(&format!("{}optimum.vtu", state.stem()));
    if of_motion || is_end { targets.iter().map(|target| target.cost.clone()).collect() } else { Vec::new() }
}

fn probes(state: &State<'_>) -> Vec<(String, ProbeRecord)> {
    let of = |(name, probe): (&String, &ProbesRecord)| match probe {
        ProbesRecord::One(probe) => Some((name.clone(), probe.clone())),
        ProbesRecord::OfLoadCase(_) => None,
    };
    state.record.and_then(|record| record.probes.as_ref()).into_iter().flatten().filter_map(of).collect()
}

/// What a column says of the instant that is shown.
pub(super) fn at_instant(folder: &ResultFolder, state: &State<'_>, column: &str) -> Result<f64, ReportError> {
    let file = format!("{}.vtu", state.name);
    let instants = folder.instants(&format!("{}motion.pvd", state.stem()))?;
    let table = Table::of(folder, state)?;
    let (index, time) = (table.column(column)?, table.column("t")?);
    let t = instants.into_iter().find(|(own, _)| *own == file).map(|(_, t)| t);
    let near = |t: f64| table.rows.iter().min_by(|a, b| (a[time] - t).abs().total_cmp(&(b[time] - t).abs()));
    let found = t.and_then(near).map(|row| row[index]);
    found.ok_or_else(|| folder.content("motion.csv", format!("it has no row for the instant of {file}")))
}
