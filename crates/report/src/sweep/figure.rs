//! [`Figure`]: a number of results with its unit.

use crate::sweep::row::SweepRow;

/// A number of results by its path there.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    pub path: String,
    /// Empty where it has none, or where that is not known.
    pub unit: String,
}

impl Figure {
    /// With the unit that it has in the first row that has it.
    pub fn of(path: &str, rows: &[SweepRow]) -> Self {
        let row = rows.iter().find(|row| row.figures.contains_key(path));
        Self { path: path.to_owned(), unit: row.map_or_else(String::new, |row| unit(path, row)) }
    }

    /// `energy/elastic (N m)`.
    pub fn label(&self) -> String {
        labelled(&self.path, &self.unit)
    }
}

/// A name with its unit.
pub(super) fn labelled(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// The unit of a figure in a row's units.
fn unit(path: &str, row: &SweepRow) -> String {
    let units = &row.units;
    let dimensions = row.discretization.as_ref().map_or(3, |size| size.dimensions);
    // of a load case the same
    let mut parts = path.split('/').peekable();
    if parts.next_if_eq(&"load_cases").is_some() {
        parts.next();
    }
    let parts: Vec<&str> = parts.collect();
    let last = parts.last().copied().unwrap_or_default();
    match parts.first().copied().unwrap_or_default() {
        "probes" | "hausdorff" | "tracking" => units.length.clone(),
        "reactions" => units.force.clone(),
        "energy" | "potential" => format!("{} {}", units.force, units.length),
        "controls" => {
            let own = |(name, _): &&(String, String)| parts.get(1) == Some(&name.as_str());
            row.control_units.iter().find(own).map_or_else(String::new, |(_, unit)| unit.clone())
        }
        "contributions" => match last {
            "pressure" | "largest_pressure" => units.pressure.clone(),
            "volume" | "reference_volume" | "swept_volume" => format!("{}^{dimensions}", units.length),
            "area" => power(&units.length, dimensions - 1),
            "length" | "reference_length" | "rest_length" | "smallest_gap" | "gap_between" => units.length.clone(),
            "force" | "force_x" | "force_y" | "force_z" | "pressing" | "tension" => units.force.clone(),
            _ => String::new(),
        },
        _ => String::new(),
    }
}

fn power(unit: &str, exponent: usize) -> String {
    if exponent == 1 { unit.to_owned() } else { format!("{unit}^{exponent}") }
}
