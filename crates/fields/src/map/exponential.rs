//! [`Exponential`]: positive numbers by their logarithm.

use super::ControlMap;

/// `y = exp x`, entry by entry: `y' = exp x`, `y'' = exp x`. What is positive has its logarithm as the unknown, and steps are shares of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Exponential;

impl ControlMap for Exponential {
    fn describe(&self) -> String {
        "exp x".to_owned()
    }

    fn values(&self, x: &[f64]) -> Vec<f64> {
        x.iter().map(|x| x.exp()).collect()
    }

    fn change(&self, x: &[f64], v: &[f64]) -> Vec<f64> {
        x.iter().zip(v).map(|(x, v)| x.exp() * v).collect()
    }

    fn vjp(&self, x: &[f64], g: &[f64]) -> Vec<f64> {
        self.change(x, g)
    }

    fn second_vjp(&self, x: &[f64], v: &[f64], g: &[f64]) -> Option<Vec<f64>> {
        Some(x.iter().zip(v).zip(g).map(|((x, v), g)| x.exp() * v * g).collect())
    }

    fn is_affine(&self) -> bool {
        false
    }
}
