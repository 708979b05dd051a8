//! Charts of what equilibria along a parameter carry: forces of supports, energies, volumes.

use crate::run::error::RunError;
use crate::run::solve::series::{Carried, MOVES, Row, Series};
use crate::run::state_columns::{Column, ENERGY, reaction_values};
use nastic_language::quantity::Dimension;
use nastic_picture::{Chart, Curve};
use nastic_result::files::Directory;

/// Curves of a chart: colours that it has.
const CURVES: usize = 12;
/// What contributions call volumes.
const VOLUME: &str = ".volume";

/// A number of every row.
struct Drawn {
    name: String,
    values: Vec<f64>,
}

/// An energy by the name of its column, and its value.
type Energy = (&'static str, fn(&Carried) -> f64);

impl Series<'_> {
    /// Energies that rows have stored.
    pub(super) fn energies(&self) -> impl Iterator<Item = Energy> + use<> {
        let elastic = |row: &Carried| row.energy.map_or(f64::NAN, |energy| energy.elastic);
        let contact = |row: &Carried| row.energy.map_or(f64::NAN, |energy| energy.contact);
        let all: [Energy; 2] = [("elastic", elastic), ("contact", contact)];
        all.into_iter()
    }

    /// Writes `NAME_reactions.svg`, `NAME_energies.svg` and `NAME_volumes.svg`, each where there is something to draw; the names of the files.
    pub(super) fn write_charts(&self, out: &Directory) -> Result<Vec<String>, RunError> {
        let (units, dim) = (self.member.problem().units(), self.member.mesh().dim());
        let volume = units.label(Dimension::of(dim as i32, 0, 0, 0));
        let charts = [
            ("reactions", format!("reaction ({})", units.force().symbol), self.reactions()),
            ("energies", format!("energy ({})", units.label(ENERGY)), self.drawn_energies()),
            ("volumes", format!("volume ({volume})"), self.volumes()),
        ];
        let mut files = Vec::new();
        for (what, upwards, drawn) in charts {
            let name = self.member.file(&format!("{}_{what}.svg", self.name));
            if drawn.iter().flat_map(|own| &own.values).all(|x| !x.is_finite()) {
                out.remove(&name)?;
                continue;
            }
            let mut chart = Chart::new(&self.heading(), &self.axis(), &upwards);
            for Drawn { name, values } in drawn.iter().take(CURVES) {
                let point = |(row, y): (&Row, &f64)| (row.parameter, *y, row.negative == Some(0));
                chart = chart.curve(Curve::new(name, self.rows.iter().zip(values).map(point)));
            }
            chart.write(out.own(&name)?)?;
            files.push(name);
        }
        Ok(files)
    }

    /// The components of forces that are more than little beside the largest.
    fn reactions(&self) -> Vec<Drawn> {
        let columns = self.carried.first().map_or_else(Vec::new, |row| Column::of_reactions(self.member, &row.forces));
        let rows: Vec<Vec<f64>> = self.carried.iter().map(|row| reaction_values(self.member, &row.forces)).collect();
        let largest = |k: usize| rows.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
        let most = (0..columns.len()).map(largest).fold(0.0, f64::max);
        let shown = columns.into_iter().enumerate().filter(|(k, _)| largest(*k) > MOVES * most);
        shown
            .map(|(k, column)| Drawn {
                name: column.name.trim_start_matches("reactions.").to_owned(),
                values: rows.iter().map(|row| row[k]).collect(),
            })
            .collect()
    }

    /// Stored energies, and the potential of laws, actuations and loads.
    fn drawn_energies(&self) -> Vec<Drawn> {
        let stored = self.energies().map(|(name, of)| (name, self.carried.iter().map(of).collect::<Vec<f64>>()));
        let stored = stored.filter(|(name, values)| *name == "elastic" || values.iter().any(|x| *x != 0.0));
        let potential = self.rows.iter().map(|row| row.state.report.energy).collect();
        let all = stored.chain([("potential", potential)]);
        all.map(|(name, values)| Drawn { name: name.to_owned(), values }).collect()
    }

    /// What contributions call a volume.
    fn volumes(&self) -> Vec<Drawn> {
        let rows: Vec<Vec<f64>> = self.rows.iter().map(|row| self.values(&row.state)).collect();
        let columns = self.columns().into_iter().enumerate().filter(|(_, column)| column.name.ends_with(VOLUME));
        columns
            .map(|(k, column)| Drawn { name: column.name, values: rows.iter().map(|row| row[k]).collect() })
            .collect()
    }
}
