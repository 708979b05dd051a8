//! [`Layout`]: how the control fields of a problem stand one after the other in one vector.

use crate::error::ControlError;
use crate::map::{ControlMap, Space};
use nastic_fem::{Controls, Solid};

/// One control field: some slots of one actuation, with a space.
#[derive(Debug, Clone)]
pub struct ControlBlock {
    /// Name: the actuation's, or `ACTUATION.SLOTS` where it has several groups of slots.
    pub name: String,
    /// Index of the actuation in the body.
    pub actuation: usize,
    /// First slot.
    pub slot: usize,
    /// Number of components (consecutive slots).
    pub components: usize,
    /// The map to the points.
    pub map: ControlMap,
    /// First entry of this field in the vector.
    pub first: usize,
    /// Unit kind of the values ("Pa", "T").
    pub unit: &'static str,
}

impl ControlBlock {
    /// Number of entries in the vector: entry `first + components * unknown + component`.
    pub fn len(&self) -> usize {
        self.map.len() * self.components
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.map.is_empty()
    }

    /// Its part of the vector.
    pub fn of<'m>(&self, m: &'m [f64]) -> &'m [f64] {
        &m[self.first..self.first + self.len()]
    }
}

/// The control fields of a problem, in the order of the case file, on top of fixed values of all slots.
#[derive(Debug, Clone)]
pub struct Layout {
    blocks: Vec<ControlBlock>,
    fixed: Controls,
    len: usize,
}

impl Layout {
    /// No control field yet; every slot has its fixed value.
    pub fn new(fixed: Controls) -> Self {
        Layout { blocks: vec![], fixed, len: 0 }
    }

    /// Adds a control field. `of` names an actuation with one group of slots, or `ACTUATION.SLOT` with the slot's name.
    ///
    /// # Errors
    /// Unknown names, a field controlled twice, or a space that does not fit the region.
    pub fn control(&mut self, solid: &Solid, of: &str, space: Space) -> Result<&ControlBlock, ControlError> {
        let (actuation, slot, components, unit) = resolve(solid, of)?;
        let overlaps =
            |b: &ControlBlock| b.actuation == actuation && b.slot < slot + components && slot < b.slot + b.components;
        if let Some(other) = self.blocks.iter().find(|b| overlaps(b)) {
            return Err(ControlError::ControlledTwice { name: of.to_owned(), other: other.name.clone() });
        }
        let attached = &solid.body().actuations()[actuation];
        let map = ControlMap::new(solid.discretization(), &attached.cells, space)?;
        let block = ControlBlock { name: of.to_owned(), actuation, slot, components, map, first: self.len, unit };
        self.len += block.len();
        self.blocks.push(block);
        Ok(&self.blocks[self.blocks.len() - 1])
    }

    /// The control fields.
    pub fn blocks(&self) -> &[ControlBlock] {
        &self.blocks
    }

    /// The field of a name.
    ///
    /// # Errors
    /// [`ControlError::UnknownControl`] with the names there are.
    pub fn block(&self, name: &str) -> Result<&ControlBlock, ControlError> {
        self.blocks.iter().find(|b| b.name == name).ok_or_else(|| ControlError::UnknownControl {
            name: name.to_owned(),
            known: self.blocks.iter().map(|b| b.name.clone()).collect::<Vec<_>>().join(", "),
        })
    }

    /// Length of the control vector.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing is controlled.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The fixed values of slots nobody controls.
    pub fn fixed_mut(&mut self) -> &mut Controls {
        &mut self.fixed
    }

    /// Values of all actuations at the points.
    ///
    /// # Errors
    /// [`ControlError::Length`].
    pub fn to_points(&self, m: &[f64]) -> Result<Controls, ControlError> {
        self.check(m)?;
        let mut controls = self.fixed.clone();
        for block in &self.blocks {
            let stride = controls.slots(block.actuation);
            let out = controls.values_mut(block.actuation);
            for c in 0..block.components {
                block.map.to_points(block.of(m), block.components, c, stride, block.slot + c, out);
            }
        }
        Ok(controls)
    }

    /// The transpose: derivative by control vector from the derivative by values at the points.
    pub fn pull_back(&self, by_point: &Controls) -> Vec<f64> {
        let mut out = vec![0.0; self.len];
        for block in &self.blocks {
            let stride = by_point.slots(block.actuation);
            let values = by_point.values(block.actuation);
            let part = &mut out[block.first..block.first + block.len()];
            for c in 0..block.components {
                block.map.from_points(values, stride, block.slot + c, block.components, c, part);
            }
        }
        out
    }

    pub(crate) fn check(&self, m: &[f64]) -> Result<(), ControlError> {
        match m.len() == self.len {
            true => Ok(()),
            false => Err(ControlError::Length { found: m.len(), expected: self.len }),
        }
    }
}

/// Actuation, first slot, number of components and unit of a control's name.
fn resolve(solid: &Solid, of: &str) -> Result<(usize, usize, usize, &'static str), ControlError> {
    let actuations = solid.body().actuations();
    let mut known = Vec::new();
    for (k, attached) in actuations.iter().enumerate() {
        let groups = slot_groups(attached.law.slots());
        for &(name, first, count, unit) in &groups {
            let full = if groups.len() == 1 { attached.name.clone() } else { format!("{}.{name}", attached.name) };
            if full == of {
                return Ok((k, first, count, unit));
            }
            known.push(full);
        }
    }
    Err(ControlError::UnknownControl { name: of.to_owned(), known: known.join(", ") })
}

/// Slots named `NAME.x`, `NAME.y`, `NAME.z` in a row form one vector group; others stand alone.
fn slot_groups(slots: &[nastic_energy::Slot]) -> Vec<(&'static str, usize, usize, &'static str)> {
    let mut groups: Vec<(&'static str, usize, usize, &'static str)> = Vec::new();
    for (s, slot) in slots.iter().enumerate() {
        let stem = slot.name.split_once('.').map_or(slot.name, |(stem, _)| stem);
        match groups.last_mut() {
            Some(last) if last.0 == stem => last.2 += 1,
            _ => groups.push((stem, s, 1, slot.unit)),
        }
    }
    groups
}
