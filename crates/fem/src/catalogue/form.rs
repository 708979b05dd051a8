//! [`Form`]: how a contribution stands in case files.

use super::key::Key;
use crate::solid::Solid;
use nastic_body::contribution::body_point::BodyPoint;
use nastic_body::error::FemError;
use nastic_energy::Slot;
use std::collections::{BTreeMap, BTreeSet};

/// A contribution in a case file.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    /// What it is, in a sentence.
    pub about: &'static str,
    /// Its keys beside `name` and `kind`.
    pub keys: &'static [Key],
    /// Its slots: what can be controlled, or have a fixed value. In a unit `m^d` d is the dimension of the body.
    pub slots: &'static [Slot],
    /// Whether it acts where all its slots are zero: an elastic tendon resists to being stretched.
    pub passive: bool,
    /// Whether one of the slots drives it, and the others follow: the first unless another one is controlled or has a value.
    pub one_of: bool,
    /// Adds one of that name to a body.
    pub add: fn(Solid, &str, &FormValues) -> Result<Solid, FemError>,
}

/// The values of a form's keys.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FormValues {
    /// Names, by key.
    pub names: BTreeMap<&'static str, Vec<String>>,
    /// Flags that are true.
    pub flags: BTreeSet<&'static str>,
    /// Points of the body, by key.
    pub points: BTreeMap<&'static str, Vec<BodyPoint>>,
    /// Points of space that were given, by key.
    pub places: BTreeMap<&'static str, [f64; 3]>,
    /// Components that were given, 0 to 2, by key.
    pub components: BTreeMap<&'static str, Vec<usize>>,
    /// Numbers that were given, by key.
    pub numbers: BTreeMap<&'static str, f64>,
    /// The slot that drives a contribution of which one does; the first if `None`.
    pub slot: Option<&'static str>,
}

impl FormValues {
    /// The name under a key; empty where there is none.
    pub fn name(&self, key: &str) -> &str {
        self.names.get(key).and_then(|names| names.first()).map_or("", String::as_str)
    }
}
