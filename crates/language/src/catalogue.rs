//! [`Catalogue`]: the names a case may use.

use nastic_control::{COSTS, CostForm, Counts, MOTION_COSTS};
use nastic_energy::catalogue::{ActuationRow, MaterialRow, actuations, materials};
use nastic_fem::catalogue::{CATALOGUE as CONTRIBUTIONS, Entry, Form};

/// The laws, actuations and costs that case files may name: the built-in ones, and those a program adds.
///
/// A row makes its member known to the reader of case files, to their JSON Schema and to the commands. Check a law of your
/// own with [`nastic_energy::check`] before you rely on it.
#[derive(Clone, Debug)]
pub struct Catalogue {
    materials: Vec<&'static MaterialRow>,
    actuations: Vec<&'static ActuationRow>,
    contributions: Vec<&'static Entry>,
    costs: Vec<&'static CostForm>,
}

impl Catalogue {
    /// The built-in laws, actuations and costs.
    #[must_use]
    pub fn standard() -> Self {
        Self {
            materials: materials().iter().collect(),
            actuations: actuations().iter().collect(),
            contributions: CONTRIBUTIONS.iter().collect(),
            costs: costs(),
        }
    }

    /// With a further law. It takes the place of one of the same name.
    #[must_use]
    pub fn with_material(mut self, row: &'static MaterialRow) -> Self {
        self.materials.retain(|known| known.name != row.name);
        self.materials.push(row);
        self
    }

    /// With a further actuation. It takes the place of one of the same name.
    #[must_use]
    pub fn with_actuation(mut self, row: &'static ActuationRow) -> Self {
        self.actuations.retain(|known| known.name != row.name);
        self.actuations.push(row);
        self
    }

    /// With a further contribution. It takes the place of one of the same name.
    #[must_use]
    pub fn with_contribution(mut self, row: &'static Entry) -> Self {
        self.contributions.retain(|known| known.name != row.name);
        self.contributions.push(row);
        self
    }

    /// With a further cost. It takes the place of one of the same name; "smoothed_hausdorff" stays what it is.
    #[must_use]
    pub fn with_cost(mut self, row: &'static CostForm) -> Self {
        self.costs.retain(|known| known.name != row.name);
        self.costs.push(row);
        self
    }

    /// The laws.
    #[must_use]
    pub fn materials(&self) -> &[&'static MaterialRow] {
        &self.materials
    }

    /// The contributions that stand in case files, as kinds of `actuation`.
    pub fn contributions(&self) -> impl Iterator<Item = (&'static str, &'static Form)> {
        self.contributions.iter().filter_map(|entry| Some((entry.name, entry.form.as_ref()?)))
    }

    /// The actuations.
    #[must_use]
    pub fn actuations(&self) -> &[&'static ActuationRow] {
        &self.actuations
    }

    /// The costs but smoothed Hausdorff distances.
    #[must_use]
    pub fn costs(&self) -> &[&'static CostForm] {
        &self.costs
    }
}

/// Costs of motions stand behind those of controls.
fn costs() -> Vec<&'static CostForm> {
    let mut out: Vec<&CostForm> = COSTS.iter().filter_map(|row| row.form).collect();
    let behind = out.iter().rposition(|form| form.counts == Counts::OverTime).map_or(out.len(), |last| last + 1);
    out.splice(behind..behind, MOTION_COSTS.iter().copied());
    out
}

impl Default for Catalogue {
    fn default() -> Self {
        Self::standard()
    }
}
