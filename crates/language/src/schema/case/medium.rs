//! The blocks of `media`: a row of the case's blocks.

use crate::number::quantity;
use crate::quantity::{Dimension, Units};
use crate::schema::block::Block;
use crate::schema::hints::{Hint, hint};
use crate::syntax::At;
use nastic_fem::{FemError, Solid};
use nastic_mesh::GroupNames;

object! {
    /// What keeps the cells of a void from folding, and lets parts touch across it: (k/2) int |F - mean of F over the cell|^2.
    pub struct Medium {
        /// Name in results; "medium" and its number, from 0, if left out.
        pub name: Option<String>,
        /// Regions it fills: those of a density near 0.
        pub region: GroupNames,
        /// k: some 1e-6 (L/h)^2 of the bulk modulus of the body, L its size and h that of the cells.
        pub stiffness: f64 as PRESSURE,
    }
}

/// What people try in its place.
pub(super) const HINTS: &[Hint] = &[hint(
    "",
    &["medium", "third_medium", "void"],
    "a medium stands in \"media\": [ { \"region\": \"body\", \"stiffness\": \"1 Pa\" } ]",
)];

impl Block for Medium {
    fn kind(&self) -> &'static str {
        "medium"
    }

    fn head(&self) -> &'static str {
        "media"
    }

    fn at(&self) -> &At {
        &self.at
    }

    fn name(&self) -> String {
        let number = || self.at.as_str().rsplit('/').next().unwrap_or_default().to_owned();
        self.name.clone().unwrap_or_else(|| format!("medium {}", number()))
    }

    fn attach(&self, solid: Solid) -> Result<Solid, FemError> {
        solid.medium(nastic_fem::Medium::over(&self.name(), self.region.clone(), self.stiffness))
    }

    fn words(&self, _: &Solid, units: &Units) -> String {
        let stiffness = quantity(self.stiffness, Dimension::PRESSURE, units);
        format!("{}: of stiffness {stiffness} over {}", self.name(), self.region)
    }
}
