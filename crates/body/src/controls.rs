//! [`Controls`]: the values of everything that drives a body.

use crate::error::FemError;
use serde::{Deserialize, Serialize};

/// A point at which the controls of a contribution have values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlPoint {
    /// Where it is in the reference body.
    pub position: [f64; 3],
    /// Its weight in the inner product of the control space: the length or area that belongs to it.
    pub weight: f64,
}

/// What drives the body, in blocks: for each actuation of a `Solid`, in the order they were attached, the
/// values of its slots at every quadrature point, shape `[points][slots]`; then for each contribution with controls (a
/// cavity, say) one value per slot, or one for each of its [points](crate::contribution::Contribution::control_points).
///
/// Points where an actuation does not act keep zeros that nobody reads. Control fields with fewer unknowns (uniform,
/// by region, by cell, by node) are mapped to these values, and derivatives back from them, in `nastic-control`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Controls {
    blocks: Vec<Block>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Block {
    slots: usize,
    values: Vec<f64>,
}

impl Controls {
    /// All zero: for each block its slots, and the points at which they have values.
    pub fn zeros(blocks: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let block = |(slots, points)| Block { slots, values: vec![0.0; slots * points] };
        Controls { blocks: blocks.into_iter().map(block).collect() }
    }

    /// Those of one model after those of another.
    #[must_use]
    pub fn chain(mut self, other: Controls) -> Self {
        self.blocks.extend(other.blocks);
        self
    }

    /// Number of blocks.
    #[inline]
    pub fn len(&self) -> usize {
        self.blocks.len()
    }

    /// Whether nothing drives the body.
    pub fn is_empty(&self) -> bool {
        self.blocks.is_empty()
    }

    /// Number of slots of the k-th block.
    #[inline]
    pub fn slots(&self, k: usize) -> usize {
        self.blocks[k].slots
    }

    /// Values of the k-th block, shape `[points][slots]`.
    #[inline]
    pub fn values(&self, k: usize) -> &[f64] {
        &self.blocks[k].values
    }

    /// The same, to be written to.
    #[inline]
    pub fn values_mut(&mut self, k: usize) -> &mut [f64] {
        &mut self.blocks[k].values
    }

    /// Sets one slot of the k-th block from one value per point.
    ///
    /// # Errors
    /// No such block or slot, [`FemError::Length`], [`FemError::NotFinite`].
    pub fn set(&mut self, k: usize, slot: usize, at_points: &[f64]) -> Result<(), FemError> {
        let found = self.blocks.len();
        let no = |what: &str, found| FemError::Meaningless { what: format!("there is no {what}; there are {found}") };
        let block = self.blocks.get_mut(k).ok_or_else(|| no(&format!("block {k} of controls"), found))?;
        if slot >= block.slots {
            return Err(no(&format!("slot {slot} of actuation {k}"), block.slots));
        }
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

    /// The same blocks, all zero.
    #[must_use]
    pub fn zeroed(mut self) -> Self {
        self.blocks.iter_mut().for_each(|block| block.values.fill(0.0));
        self
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

    /// The change from the other set to this one.
    pub fn minus(&self, other: &Controls) -> Controls {
        let mut out = self.clone();
        for (own, other) in out.blocks.iter_mut().zip(&other.blocks) {
            own.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a -= b);
        }
        out
    }

    /// Whether the other set has the same blocks, slots and points.
    pub fn fits(&self, other: &Controls) -> bool {
        let same = |(a, b): (&Block, &Block)| a.slots == b.slots && a.values.len() == b.values.len();
        self.blocks.len() == other.blocks.len() && self.blocks.iter().zip(&other.blocks).all(same)
    }
}

/// The first entry that is not finite, as an error.
pub fn check_finite(what: &str, values: &[f64]) -> Result<(), FemError> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(index) => Err(FemError::NotFinite { what: what.to_owned(), index, value: values[index] }),
    }
}
