//! [`Held`]: values of a field that stay as they are.

use super::basis::entities;
use super::{Basis, ControlMap, Space, WholeBody};
use crate::error::ControlError;
use nastic_fem::Discretization;
use nastic_mesh::GroupNames;
use std::collections::BTreeSet;

/// `y = x`, but `y = c` at some of the unknowns, whatever x is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    entries: Vec<usize>,
    value: f64,
    regions: String,
}

impl Held {
    /// The unknowns of the cells of regions, of a field by node those at their corners too: the field is c on all of these cells.
    ///
    /// # Errors
    /// An unknown name; a field that is neither by cell nor by node, one of vectors, one without unknowns there; a value that is not finite.
    pub fn new(
        disc: &Discretization,
        basis: &Basis,
        components: usize,
        regions: &GroupNames,
        value: f64,
    ) -> Result<Self, ControlError> {
        let fail = |what: String| Err(ControlError::Cost { what });
        let space = basis.space();
        if !matches!(space, Space::Cell | Space::Node) || basis.is_of_contribution() {
            return fail(format!(
                "a field is held by region in the spaces \"cell\" and \"node\", not in \"{}\"",
                space.name()
            ));
        }
        if components > 1 || !value.is_finite() {
            return fail("what is held is a scalar field, at a finite value".to_owned());
        }
        let whole = WholeBody::of(disc);
        let numbers = whole.numbers(space)?;
        let in_whole = |own: u32| numbers.as_ref().map_or(own, |numbers| numbers[own as usize]);
        let own: BTreeSet<u32> =
            entities(disc, &disc.mesh().cells_of(regions)?, space, None).into_iter().map(in_whole).collect();
        let held = whole.joined(own)?;
        let entries: Vec<usize> =
            held.iter().filter_map(|entity| basis.entities().binary_search(entity).ok()).collect();
        match entries.is_empty() {
            true => fail(format!("the field has no unknown in \"{regions}\", where it is to be held")),
            false => Ok(Held { entries, value, regions: regions.to_string() }),
        }
    }

    /// The unknowns that are held, ascending.
    pub fn entries(&self) -> &[usize] {
        &self.entries
    }

    fn with(&self, x: &[f64], value: f64) -> Vec<f64> {
        let mut out = x.to_vec();
        self.entries.iter().for_each(|entry| out[*entry] = value);
        out
    }
}

impl ControlMap for Held {
    fn describe(&self) -> String {
        format!("{} in {}", self.value, self.regions)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.with(x, self.value)
    }

    fn change(&self, _: &[f64], v: &[f64]) -> Vec<f64> {
        self.with(v, 0.0)
    }

    fn vjp(&self, _: &[f64], g: &[f64]) -> Vec<f64> {
        self.with(g, 0.0)
    }
}
