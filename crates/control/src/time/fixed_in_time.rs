//! [`FixedInTime`]: a slot that follows given values.

use nastic_fem::{Controls, FemError};
use nastic_fields::ControlError;
use std::fmt;

type Values = dyn Fn(f64) -> Result<Vec<f64>, ControlError> + Send + Sync;

/// The values at the points of a slot that nobody controls, over the time.
pub(crate) struct FixedInTime {
    actuation: usize,
    slot: usize,
    values: Box<Values>,
    /// Those at the instants of the timeline, which every evaluation asks for.
    at_instants: Vec<Vec<f64>>,
}

impl FixedInTime {
    /// # Errors
    /// What `values` returns at an instant.
    pub fn new(
        actuation: usize,
        slot: usize,
        values: impl Fn(f64) -> Result<Vec<f64>, ControlError> + Send + Sync + 'static,
        instants: &[f64],
    ) -> Result<Self, ControlError> {
        let at_instants = instants.iter().map(|t| values(*t)).collect::<Result<_, _>>()?;
        Ok(FixedInTime { actuation, slot, values: Box::new(values), at_instants })
    }

    /// Sets those at the n-th instant.
    pub fn put(&self, n: usize, controls: &mut Controls) -> Result<(), FemError> {
        controls.set(self.actuation, self.slot, &self.at_instants[n])
    }

    /// Sets those at any instant.
    pub fn put_at(&self, t: f64, controls: &mut Controls) -> Result<(), ControlError> {
        Ok(controls.set(self.actuation, self.slot, &(self.values)(t)?)?)
    }
}

impl fmt::Debug for FixedInTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FixedInTime(slot {} of actuation {})", self.slot, self.actuation)
    }
}
