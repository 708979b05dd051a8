//! [`Direction`]: vectors along a fixed direction.

use super::ControlMap;

/// `y = x d` at every point, an amplitude x to three components; d as it is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction(pub [f64; 3]);

impl ControlMap for Direction {
    fn describe(&self) -> String {
        format!("along {:?}", self.0)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        x.iter().flat_map(|x| self.0.map(|d| x * d)).collect()
    }

    fn change(&self, _x: &[f64], v: &[f64]) -> Vec<f64> {
        self.values(v)
    }

    fn vjp(&self, _x: &[f64], g: &[f64]) -> Vec<f64> {
        g.chunks_exact(3).map(|g| g.iter().zip(self.0).map(|(g, d)| g * d).sum()).collect()
    }
}
