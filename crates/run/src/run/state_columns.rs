//! Columns that the tables of motions, ramps and paths have in common.

use nastic_case::lower::CaseMember;
use nastic_fem::State;
use nastic_language::quantity::Dimension;
use nastic_report::csv::column;

pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];
pub(crate) const ENERGY: Dimension = Dimension::of(1, 1, 0, 0);
/// What the columns of energies and works begin with.
pub(crate) const BALANCE: &str = "energy.";

/// A column of a table of states.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    pub name: String,
    pub unit: String,
}

impl Column {
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }

    /// One for every axis of the member's space.
    pub fn along_axes(member: CaseMember<'_>, name: &str, unit: &str) -> Vec<Self> {
        AXES.iter().take(member.mesh().dim()).map(|axis| Self::new(format!("{name}.{axis}"), unit)).collect()
    }

    /// The displacements of probes.
    pub fn of_probes(member: CaseMember<'_>) -> Vec<Self> {
        let unit = member.problem().units().length().symbol;
        member.problem().probes.iter().flat_map(|probe| Self::along_axes(member, &probe.name, unit)).collect()
    }

    /// What contributions report, behind other columns, whose names they do not take.
    pub fn of_quantities(quantities: &[(String, &'static str, f64)], others: &[Self]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for (name, what, _) in quantities {
            let name = format!("{name}.{what}");
            let is_taken = others.iter().chain(&all).any(|known| known.name == name);
            all.push(Self::new(if is_taken { format!("contributions.{name}") } else { name }, ""));
        }
        all
    }

    /// The forces of supports.
    pub fn of_reactions(member: CaseMember<'_>, forces: &[(String, [f64; 3])]) -> Vec<Self> {
        let unit = member.problem().units().force().symbol;
        forces.iter().flat_map(|(name, _)| Self::along_axes(member, &format!("reactions.{name}"), unit)).collect()
    }
}

/// The values of [`Column::of_probes`].
pub(crate) fn probe_values(member: CaseMember<'_>, state: &State) -> Vec<f64> {
    let dim = member.mesh().dim();
    let (probes, u) = (member.problem().probes.iter(), member.solid().model().displacement(&state.u));
    probes.flat_map(|probe| probe.displacement(&u, dim)[..dim].to_vec()).collect()
}

/// The values of [`Column::of_reactions`].
pub(crate) fn reaction_values(member: CaseMember<'_>, forces: &[(String, [f64; 3])]) -> Vec<f64> {
    forces.iter().flat_map(|(_, force)| &force[..member.mesh().dim()]).copied().collect()
}

/// A table as CSV.
pub(crate) fn csv<'c>(
    columns: impl IntoIterator<Item = &'c Column>,
    rows: impl Iterator<Item = Vec<String>>,
) -> String {
    let mut text = columns.into_iter().map(|own| column(&own.name)).collect::<Vec<_>>().join(",") + "\n";
    for row in rows {
        text += &(row.join(",") + "\n");
    }
    text
}
