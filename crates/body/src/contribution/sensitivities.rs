//! [`Sensitivities`]: `lambda . dr/dp` for everything p that a residual depends on besides the displacement;
//! [`SecondSensitivities`]: how `lambda . dr/d(u, controls)` changes along an [`Increment`].

use crate::controls::Controls;
use crate::history::BeforeStep;
use crate::instant::Instant;

/// Vector-Jacobian products of a residual, added up over contributions.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// By the controls: of every actuation by point, weights included, shape `[points][slots]`; of other contributions by slot, or by point and slot.
    pub controls: Controls,
    /// By the velocity, flat; empty in a static problem.
    pub velocity: Vec<f64>,
    /// By the acceleration, flat; empty in a static problem.
    pub acceleration: Vec<f64>,
    /// By the state that the time step begins at; by the internal variables alone in a static problem.
    pub before: BeforeStep,
}

impl Sensitivities {
    /// Zero, for the controls of a model; with room for those by velocity and acceleration in a time step.
    pub fn zero(controls: Controls, at: &Instant) -> Self {
        let dofs = if at.step.is_some() { at.u.len() } else { 0 };
        let (controls, history) = (controls.zeroed(), at.history().zeroed());
        let before = BeforeStep { u: vec![0.0; dofs], controls: controls.clone(), history };
        Sensitivities { controls, velocity: vec![0.0; dofs], acceleration: vec![0.0; dofs], before }
    }

    /// Adds to the derivative by a slot of the contribution that is asked.
    pub fn add_control(&mut self, at: &Instant, slot: usize, value: f64) {
        self.controls.values_mut(at.block)[slot] += value;
    }

    /// Adds to the derivative by a slot at a [point](crate::contribution::Contribution::control_points) of the contribution that is asked.
    pub fn add_control_at(&mut self, at: &Instant, point: usize, slot: usize, value: f64) {
        let width = self.controls.slots(at.block);
        self.controls.values_mut(at.block)[point * width + slot] += value;
    }
}

/// A change of the displacement and of the controls.
#[derive(Debug, Clone, Copy)]
pub struct Increment<'a> {
    /// Of the displacement, flat.
    pub u: &'a [f64],
    /// Of the controls.
    pub controls: &'a Controls,
}

/// Second derivatives of `lambda . r` along an [`Increment`] `(du, v)`, added up over contributions.
#[derive(Debug, Clone, PartialEq)]
pub struct SecondSensitivities {
    /// `(lambda . r)_uu du + (lambda . r)_um v`, flat: the change of `K^T lambda`.
    pub u: Vec<f64>,
    /// `(lambda . r)_mu du + (lambda . r)_mm v`, as [`Sensitivities::controls`]: the change of those.
    pub controls: Controls,
}

impl SecondSensitivities {
    /// Zero, for the unknowns and controls of a model.
    pub fn zero(controls: Controls, dofs: usize) -> Self {
        SecondSensitivities { u: vec![0.0; dofs], controls: controls.zeroed() }
    }

    /// Adds to the change of the derivative by a slot of the contribution that is asked.
    pub fn add_control(&mut self, at: &Instant, slot: usize, value: f64) {
        self.controls.values_mut(at.block)[slot] += value;
    }

    /// Adds to the change of the derivative by a slot at a point of the contribution that is asked.
    pub fn add_control_at(&mut self, at: &Instant, point: usize, slot: usize, value: f64) {
        let width = self.controls.slots(at.block);
        self.controls.values_mut(at.block)[point * width + slot] += value;
    }
}
