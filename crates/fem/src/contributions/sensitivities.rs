//! [`Sensitivities`]: `lambda . dr/dp` for everything p that a residual depends on besides the displacement.

use crate::contributions::controls::Controls;
use crate::contributions::instant::Instant;

/// Vector-Jacobian products of a residual, added up over contributions.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// By the controls: of every actuation by point, weights included, shape `[points][slots]`; of other contributions by slot.
    pub controls: Controls,
    /// By the velocity, flat; empty in a static problem.
    pub velocity: Vec<f64>,
    /// By the acceleration, flat; empty in a static problem.
    pub acceleration: Vec<f64>,
}

impl Sensitivities {
    /// Zero, for the controls of a model; with room for those by velocity and acceleration in a time step.
    pub fn zero(controls: Controls, at: &Instant) -> Self {
        let dofs = if at.step.is_some() { at.u.len() } else { 0 };
        Sensitivities { controls, velocity: vec![0.0; dofs], acceleration: vec![0.0; dofs] }
    }

    /// Adds to the derivative by a slot of the contribution that is asked.
    pub fn add_control(&mut self, at: &Instant, slot: usize, value: f64) {
        self.controls.values_mut(at.block)[slot] += value;
    }
}
