//! [`SweepTable`]: the runs of a sweep as a table, and its files.

mod chart;
mod convergence;
mod figure;
mod page;
mod row;
mod shown;

pub use chart::SweepAxis;
pub use row::SweepRow;

use crate::csv;
use crate::record::{ConvergenceRecord, SweepRecord};
use crate::sweep::figure::Figure;
use crate::sweep::shown::ShownTable;
use nastic_io::{WriteError, write_atomically, write_pvd};
use std::path::Path;

/// The runs of a sweep. Nothing in it depends on clocks, nor on which process made which run, nor on when.
pub struct SweepTable {
    /// Title of the plot.
    pub title: String,
    /// What was asked for; [`Self::record`] adds what was found.
    pub asked: SweepRecord,
    /// The first swept option.
    pub axis: SweepAxis,
    /// The time of every planned run in `sweep.pvd`.
    pub times: Vec<f64>,
    /// The runs that were made, in their order.
    pub rows: Vec<SweepRow>,
    /// Directories of those that were not.
    pub missing: Vec<String>,
    /// The exit code.
    pub exit: u8,
}

impl SweepTable {
    /// The content of `sweep.json`.
    #[must_use]
    pub fn record(&self) -> SweepRecord {
        SweepRecord {
            runs: self.rows.iter().map(SweepRow::record).collect(),
            convergence: self.convergence().map(|(_, records)| records),
            missing: self.missing.clone(),
            exit: self.exit,
            ..self.asked.clone()
        }
    }

    /// Whether the quantity that was asked for is a number of some run; `None` where none was, or no run has found a state yet. If not, what there is.
    #[must_use]
    pub fn lacks_quantity(&self) -> Option<Vec<String>> {
        let quantity = self.asked.quantity.as_deref()?;
        // one that found no state has few numbers
        let with_state = self.rows.iter().filter(|row| row.figures.contains_key("min_J"));
        let known = chart::known(with_state);
        let lacks = !known.is_empty() && !known.contains(&quantity);
        lacks.then(|| known.into_iter().map(str::to_owned).collect())
    }

    /// What is shown of every run.
    fn figures(&self) -> Vec<Figure> {
        let paths = match &self.asked.quantity {
            Some(quantity) => vec![quantity.clone()],
            None => chart::usual(&self.asked.command, &self.rows),
        };
        paths.iter().map(|path| Figure::of(path, &self.rows)).collect()
    }

    /// The first figure, and how it converges over meshes.
    fn convergence(&self) -> Option<(Figure, Vec<ConvergenceRecord>)> {
        let figure = self.figures().into_iter().next()?;
        let records = convergence::convergence(&self.asked.swept, &figure.path, &self.rows)?;
        Some((figure, records))
    }

    /// The table for papers.
    fn shown(&self) -> ShownTable {
        match self.convergence() {
            Some((figure, records)) => ShownTable::of_convergence(&figure, &records, &self.rows),
            None => ShownTable::of_figures(&self.figures(), &self.rows),
        }
    }

    /// Writes `sweep.json`, `sweep.csv`, `sweep_table.csv`, `sweep_table.tex`, `sweep.html`, `sweep.svg` and a `sweep.pvd` for every load case.
    ///
    /// # Errors
    /// A file that cannot be written, or an old one that cannot be removed.
    pub fn write(&self, directory: &Path) -> Result<(), WriteError> {
        let record = self.record();
        write_atomically(directory.join("sweep.json"), |out| {
            serde_json::to_writer_pretty(&mut *out, &record)?;
            out.write_all(b"\n")
        })?;
        let text = csv::table(&self.rows.iter().map(SweepRow::cells).collect::<Vec<_>>());
        write_atomically(directory.join("sweep.csv"), |out| out.write_all(text.as_bytes()))?;
        let shown = self.shown();
        for (name, text) in [("sweep_table.csv", shown.csv()), ("sweep_table.tex", shown.latex())] {
            write_atomically(directory.join(name), |out| out.write_all(text.as_bytes()))?;
        }
        let chart = chart::chart(&self.title, &self.asked.swept, &self.axis, &self.figures(), &self.rows);
        match &chart {
            Some(chart) => chart.write(directory.join("sweep.svg"))?,
            None => remove(&directory.join("sweep.svg"))?,
        }
        let page = self.page(chart.and_then(|chart| chart.svg()).as_deref());
        write_atomically(directory.join("sweep.html"), |out| out.write_all(page.as_bytes()))?;
        let collections = self.collections();
        if collections.is_empty() {
            remove(&directory.join("sweep.pvd"))?;
        }
        for (name, entries) in collections {
            write_pvd(directory.join(&name), &entries)?;
        }
        Ok(())
    }

    /// The names of these files.
    #[must_use]
    pub fn files(&self) -> Vec<String> {
        let always = ["sweep.json", "sweep.csv", "sweep_table.csv", "sweep_table.tex", "sweep.html", "sweep.svg"];
        let always = always.map(str::to_owned);
        always.into_iter().chain(self.collections().into_iter().map(|(name, _)| name)).collect()
    }

    /// Names of collections, and the states that the runs found.
    fn collections(&self) -> Vec<(String, Vec<(f64, String)>)> {
        let file = if self.asked.command == "optimize" { "optimum.vtu" } else { "start.vtu" };
        let mut out: Vec<(String, Vec<(f64, String)>)> = vec![];
        for row in self.rows.iter().filter(|row| row.figures.contains_key("min_J")) {
            for (stem, case) in &row.stems {
                let name = format!("{case}sweep.pvd");
                let entry = (self.times[row.index], format!("{}/{stem}{file}", row.directory));
                match out.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, entries)) => entries.push(entry),
                    None => out.push((name, vec![entry])),
                }
            }
        }
        out
    }
}

/// Removes a file, if it is there.
fn remove(file: &Path) -> Result<(), WriteError> {
    match std::fs::remove_file(file) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(WriteError::System { file: file.to_owned(), source })
        }
        _ => Ok(()),
    }
}
