//! [`CostForm`]: how case files name a cost and its keys.

use super::body_points::BodyPart;
use super::cost_value::{CostTaken, CostValue, CostWords};
use super::{Cost, Key};
use crate::time::{TrajectoryCost, When};
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use std::collections::BTreeMap;

/// How case files name a cost and its keys: of a built-in row of the catalogue, or of a cost that a program adds.
#[derive(Clone, Copy, Debug)]
pub struct CostForm {
    /// Its `kind` in case files.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub about: &'static str,
    /// Its keys beside `kind`, `name`, `weight` and `when`.
    pub keys: &'static [Key],
    /// The part of a motion over which it counts.
    pub counts: Counts,
    /// Whether it is the square of what it measures: where it is zero its derivative is zero too, so that no constraint can hold it there.
    pub is_square: bool,
    /// The key that errors of `make` speak of; the whole block if `None`.
    pub reported_at: Option<&'static str>,
    /// It and its values in words; `about` if `None`.
    pub words: Option<fn(&CostWords) -> String>,
    /// How it is made.
    pub make: MakeCost,
}

/// The part of a motion over which a cost counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counts {
    /// As `when` says; at the end without it.
    AtEnd,
    /// As `when` says; over the whole time without it.
    OverTime,
    /// Over the whole time: it has no `when`.
    Always,
}

/// How a cost is made of its values.
#[derive(Clone, Copy, Debug)]
pub enum MakeCost {
    /// One of states and controls.
    OfStates(fn(&CostInputs) -> Result<Box<dyn Cost>, ControlError>),
    /// One of a whole motion.
    OfMotion(fn(&CostInputs) -> Result<Box<dyn TrajectoryCost>, ControlError>),
}

impl CostForm {
    /// A cost of states, which counts at the end of a motion unless `when` says otherwise.
    pub const fn new(
        name: &'static str,
        about: &'static str,
        keys: &'static [Key],
        make: fn(&CostInputs) -> Result<Box<dyn Cost>, ControlError>,
    ) -> Self {
        let (counts, make) = (Counts::AtEnd, MakeCost::OfStates(make));
        CostForm { name, about, keys, counts, is_square: false, reported_at: None, words: None, make }
    }

    /// A cost of a whole motion.
    pub const fn of_motion(
        name: &'static str,
        about: &'static str,
        keys: &'static [Key],
        make: fn(&CostInputs) -> Result<Box<dyn TrajectoryCost>, ControlError>,
    ) -> Self {
        let (counts, make) = (Counts::Always, MakeCost::OfMotion(make));
        CostForm { name, about, keys, counts, is_square: false, reported_at: None, words: None, make }
    }

    /// The same, which counts so.
    pub const fn counts(self, counts: Counts) -> Self {
        CostForm { counts, ..self }
    }

    /// The same, of a cost that is a square.
    pub const fn square(self) -> Self {
        CostForm { is_square: true, ..self }
    }

    /// The same with the key that errors of `make` speak of.
    pub const fn reported_at(self, key: &'static str) -> Self {
        CostForm { reported_at: Some(key), ..self }
    }

    /// The same, which is put into words so.
    pub const fn words(self, words: fn(&CostWords) -> String) -> Self {
        CostForm { words: Some(words), ..self }
    }
}

/// What a cost is made of.
#[derive(Clone, Copy, Debug)]
pub struct CostInputs<'a> {
    /// The body.
    pub solid: &'a Solid,
    /// Positive: a term of weight zero is left out before. Its values include it.
    pub weight: f64,
    /// Whether the body moves in time.
    pub in_motion: bool,
    /// Whether second derivatives are wanted.
    pub second: bool,
    /// The part of a motion over which it counts.
    pub when: &'a When,
    /// The values of its keys, which those left out without a default are not among.
    pub values: &'a BTreeMap<&'static str, CostValue>,
}

impl CostInputs<'_> {
    /// The value of a key, where it has one.
    pub fn given<T: CostTaken>(&self, key: &str) -> Option<T> {
        self.values.get(key).and_then(T::of)
    }

    /// The value of a key.
    ///
    /// # Errors
    /// [`ControlError::Cost`] of a key that has none.
    pub fn get<T: CostTaken>(&self, key: &str) -> Result<T, ControlError> {
        let missing = || ControlError::Cost { what: format!("\"{key}\" has no value of its kind") };
        self.given(key).ok_or_else(missing)
    }

    /// What is named by one of the keys "surface", "region" and "nodes".
    ///
    /// # Errors
    /// [`ControlError::Cost`] where none of them is given.
    pub(crate) fn place(&self) -> Result<BodyPart, ControlError> {
        let named = |key| self.given::<GroupNames>(key);
        let place = named("surface").map(BodyPart::Surface).or(named("region").map(BodyPart::Region));
        place.map_or_else(|| Ok(BodyPart::Nodes(self.get("nodes")?)), Ok)
    }
}
