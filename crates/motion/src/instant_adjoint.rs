//! Derivatives of a functional by the quantities of one instant.

use crate::scheme::Quantity;
use nastic_numeric::vector::axpy;

/// Partial derivatives of a functional at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StatePartials {
    /// `dj/du`, flat; empty for zero.
    pub u: Vec<f64>,
    /// `dj/dv`, flat; empty for zero.
    pub velocity: Vec<f64>,
    /// `dj/dR`, flat, by the forces R that supports exert at held unknowns ([`PrescribedUnknowns::held_forces`](nastic_equilibrium::model::views::PrescribedUnknowns::held_forces)), zero on free ones; empty for zero.
    pub held: Vec<f64>,
}

impl StatePartials {
    /// Of a functional that depends on the displacement alone.
    pub fn by_displacement(u: Vec<f64>) -> Self {
        StatePartials { u, ..StatePartials::default() }
    }
}

/// Derivatives of the functional by u, v and a of one instant through all later ones; empty for zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct InstantAdjoint {
    pub u: Vec<f64>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
}

impl InstantAdjoint {
    pub fn of(&mut self, of: Quantity) -> &mut Vec<f64> {
        match of {
            Quantity::Displacement => &mut self.u,
            Quantity::Velocity => &mut self.velocity,
            Quantity::Acceleration => &mut self.acceleration,
        }
    }

    pub fn is_zero(&self) -> bool {
        [&self.u, &self.velocity, &self.acceleration].into_iter().all(|d| d.iter().all(|&d| d == 0.0))
    }

    /// Adds partial derivatives at its own instant.
    pub fn add_partials(&mut self, partials: &StatePartials) {
        add(1.0, &partials.u, &mut self.u);
        add(1.0, &partials.velocity, &mut self.velocity);
    }
}

/// `into += factor d`, where either may be empty for zero.
pub(crate) fn add(factor: f64, d: &[f64], into: &mut Vec<f64>) {
    if !d.is_empty() {
        into.resize(d.len(), 0.0);
        axpy(factor, d, into);
    }
}
