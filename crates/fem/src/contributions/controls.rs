//! [`Controls`]: the values of every actuation at every quadrature point.

use crate::error::FemError;

/// What drives the body: for each actuation of a [`Solid`](crate::Solid), in the order they were attached, the values of
/// its slots at every quadrature point of the body, shape `[points][slots]`.
///
/// Points where an actuation does not act keep zeros that nobody reads. Control fields with fewer unknowns (uniform,
/// by region, by cell, by node) are mapped to these values, and derivatives back from them, in `nastic-control`.
#[derive(Debug, Clone, PartialEq)]
pub struct Controls {
    blocks: Vec<Block>,
}

#[derive(Debug, Clone, PartialEq)]
struct Block {
    slots: usize,
    values: Vec<f64>,
}

impl Controls {
    /// All zero: `slots[k]` components for the k-th actuation, at `points` points.
    pub fn zeros(slots: &[usize], points: usize) -> Self {
        Controls { blocks: slots.iter().map(|&slots| Block { slots, values: vec![0.0; slots * points] }).collect() }
    }

    /// Number of actuations.
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Whether the body has no actuation.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Number of slots of the k-th actuation.
    pub fn slots(&self, k: usize) -> usize {
        self.blocks[k].slots
    }

    /// Values of the k-th actuation, shape `[points][slots]`.
    pub fn values(&self, k: usize) -> &[f64] {
        &self.blocks[k].values
    }

    /// The same, to be written to.
    pub fn values_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.blocks[k].values
    }

    /// Sets one slot of the k-th actuation from one value per point.
    ///
    /// # Errors
    /// [`FemError::Length`] and [`FemError::NotFinite`].
    pub fn set(&mut self, k: usize, slot: usize, at_points: &[f64]) -> Result<(), FemError> {
        let block = &mut self.blocks[k];
        let expected = block.values.len() / block.slots;
        if at_points.len() != expected {
            let what = format!("slot {slot} of actuation {k}");
            return Err(FemError::Length { what, found: at_points.len(), expected });
        }
        check_finite(&format!("slot {slot} of actuation {k}"), at_points)?;
        for (entry, &value) in block.values.chunks_exact_mut(block.slots).zip(at_points) {
            entry[slot] = value;
        }
        Ok(())
    }

    /// `(1 - s) self + s other`: the straight way from one set of controls to another.
    pub fn blend(&self, other: &Controls, s: f64) -> Controls {
        let mix = |(a, b): (&Block, &Block)| {
            // exact at both ends, so that a full step lands on the controls asked for, to the bit
            let mix = |(&a, &b): (&f64, &f64)| if s == 1.0 { b } else { a + s * (b - a) };
            Block { slots: a.slots, values: a.values.iter().zip(&b.values).map(mix).collect() }
        };
        Controls { blocks: self.blocks.iter().zip(&other.blocks).map(mix).collect() }
    }

    /// Whether the other set has the same actuations, slots and points.
    pub fn fits(&self, other: &Controls) -> bool {
        let same = |(a, b): (&Block, &Block)| a.slots == b.slots && a.values.len() == b.values.len();
        self.blocks.len() == other.blocks.len() && self.blocks.iter().zip(&other.blocks).all(same)
    }
}

/// The first entry that is not finite, as an error.
pub(crate) fn check_finite(what: &str, values: &[f64]) -> Result<(), FemError> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(index) => Err(FemError::NotFinite { what: what.to_owned(), index, value: values[index] }),
    }
}
