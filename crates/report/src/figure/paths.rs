//! Rows of `motion.csv`: paths of probes, values at an instant.

use super::state::State;
use crate::error::ReportError;
use crate::folder::ResultFolder;
use crate::record::{ProbeRecord, ProbesRecord};

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
}

/// The positions of a probe over all instants.
pub(super) fn of_probe(folder: &ResultFolder, state: &State<'_>, name: &str) -> Result<Vec<[f64; 3]>, ReportError> {
    let table = Table::of(folder, state)?;
    let probes = probes(state);
    let point = probes.iter().find(|(own, _)| own == name).map(|(_, probe)| &probe.point);
    let point = point.ok_or_else(|| ReportError::Unknown {
        what: "probe",
        name: name.to_owned(),
        has: probes.iter().map(|(own, _)| own.clone()).collect(),
    })?;
    let mut columns = Vec::new();
    for axis in ["x", "y", "z"].iter().take(state.shot.mesh.dim()) {
        columns.push(table.column(&format!("{name}.{axis}"))?);
    }
    let rest: [f64; 3] = std::array::from_fn(|i| point.get(i).and_then(|x| **x).unwrap_or(0.0));
    let at = |row: &Vec<f64>| std::array::from_fn(|i| rest[i] + columns.get(i).map_or(0.0, |column| row[*column]));
    Ok(table.rows.iter().map(at).filter(|at: &[f64; 3]| at.iter().all(|x| x.is_finite())).collect())
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
