//! [`Step`]: from grey to black and white at once.

use super::ControlMap;

/// `y = 1` above a level, 0 elsewhere, entry by entry: what a design becomes that is made. It has no derivative: 0 is what is left beside the jump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The level.
    pub level: f64,
}

impl ControlMap for Step {
    fn describe(&self) -> String {
        format!("cut at {}", self.level)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        // a NaN stays: it marks what no unknown determines
        x.iter().map(|x| if x.is_nan() { *x } else { f64::from(u8::from(*x > self.level)) }).collect()
    }

    fn change(&self, x: &[f64], _v: &[f64]) -> Vec<f64> {
        vec![0.0; x.len()]
    }

    fn vjp(&self, x: &[f64], _g: &[f64]) -> Vec<f64> {
        vec![0.0; x.len()]
    }
}
