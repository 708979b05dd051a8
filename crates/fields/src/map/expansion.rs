//! [`Expansion`]: the map that the basis functions of a control field are.

use super::{Basis, ControlMap};
use std::sync::Arc;

/// `m(q) = sum_i phi_i(q) m_i` by component: from unknowns to points.
#[derive(Debug, Clone)]
pub struct Expansion {
    /// The basis functions.
    pub basis: Arc<Basis>,
    /// Number of components.
    pub components: usize,
}

impl ControlMap for Expansion {
    fn describe(&self) -> String {
        format!("{} of {} components", self.basis.space().name(), self.components)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        self.basis.values(x, self.components)
    }

    fn change(&self, _x: &[f64], v: &[f64]) -> Vec<f64> {
        self.values(v)
    }

    fn vjp(&self, _x: &[f64], g: &[f64]) -> Vec<f64> {
        self.basis.transposed(g, self.components)
    }
}
