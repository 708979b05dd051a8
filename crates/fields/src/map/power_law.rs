//! [`PowerLaw`]: what a design field is in front of a number of the body.

use super::ControlMap;

/// `y = low + (high - low) x^p`, entry by entry: a modulus between two by a density x (SIMP), a multiplier of one.
///
/// `y' = (high - low) p x^(p-1)`, `y'' = (high - low) p (p-1) x^(p-2)`. NaN for `x < 0` where p is not whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// y(0)
    pub low: f64,
    /// y(1)
    pub high: f64,
    /// p
    pub exponent: f64,
}

impl PowerLaw {
    /// `y = factor x`.
    pub const fn multiple_of(factor: f64) -> Self {
        PowerLaw { low: 0.0, high: factor, exponent: 1.0 }
    }

    fn slope(&self, x: f64) -> f64 {
        let power = if self.is_affine() { 1.0 } else { self.exponent * x.powf(self.exponent - 1.0) };
        (self.high - self.low) * power
    }

    fn second(&self, x: f64) -> f64 {
        (self.high - self.low) * self.exponent * (self.exponent - 1.0) * x.powf(self.exponent - 2.0)
    }
}

impl ControlMap for PowerLaw {
    fn describe(&self) -> String {
        format!("{} + ({} - {}) x^{}", self.low, self.high, self.low, self.exponent)
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|x| self.low + (self.high - self.low) * x.powf(self.exponent)).collect()
    }

    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        x.iter().zip(v).map(|(x, v)| self.slope(*x) * v).collect()
    }

    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64> {
        self.change(x, g)
    }

    fn second_vjp(&self, x: &[f64], v: &[f64], g: &[f64]) -> Option<Vec<f64>> {
        let own = || x.iter().zip(v).zip(g).map(|((x, v), g)| self.second(*x) * v * g).collect();
        (!self.is_affine()).then(own)
    }

    fn is_affine(&self) -> bool {
        self.exponent == 1.0
    }
}
