//! [`Mean`] and [`MeanDeviation`].

use super::standard::Standard;
use super::{Risk, RiskError, check_probabilities};

/// The expected cost, `R = sum p_i j_i`. Weights: `p_i`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mean;

impl Risk for Mean {
    fn name(&self) -> &'static str {
        "mean"
    }

    fn value(&self, p: &[f64], j: &[f64]) -> f64 {
        p.iter().zip(j).map(|(p, j)| p * j).sum()
    }

    fn weights(&self, p: &[f64], _: &[f64]) -> Vec<f64> {
        p.to_vec()
    }

    fn weights_change(&self, p: &[f64], _: &[f64], _: &[f64]) -> Result<Vec<f64>, RiskError> {
        Ok(vec![0.0; p.len()])
    }

    fn is_linear(&self) -> bool {
        true
    }

    /// Negative weights are welcome.
    fn check(&self, p: &[f64]) -> Result<(), RiskError> {
        check_probabilities(p)
    }
}

/// Expected cost and its spread, `R = E + lambda D`.
///
/// Weights: `p_i (1 + lambda y_i)`, `y_i = (j_i - E)/D`; `p_i` where all costs are equal (a subgradient). Convex,
/// scales with the costs; not monotone: a scenario that costs much less than the mean is pushed up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDeviation {
    /// Number of standard deviations, not negative.
    pub lambda: f64,
}

impl Default for MeanDeviation {
    fn default() -> Self {
        MeanDeviation { lambda: 1.0 }
    }
}

impl Risk for MeanDeviation {
    fn name(&self) -> &'static str {
        "mean_deviation"
    }

    fn value(&self, p: &[f64], j: &[f64]) -> f64 {
        let costs = Standard::new(p, j);
        costs.mean + self.lambda * costs.deviation
    }

    fn weights(&self, p: &[f64], j: &[f64]) -> Vec<f64> {
        let costs = Standard::new(p, j);
        match costs.is_flat() {
            true => p.to_vec(),
            false => p.iter().zip(&costs.y).map(|(p, y)| p * (1.0 + self.lambda * y)).collect(),
        }
    }

    /// `p_i lambda dy_i`.
    fn weights_change(&self, p: &[f64], j: &[f64], dj: &[f64]) -> Result<Vec<f64>, RiskError> {
        let costs = Standard::new(p, j);
        let dy = costs.change(self.name(), p, dj)?;
        Ok(if costs.is_flat() {
            vec![0.0; p.len()]
        } else {
            p.iter().zip(dy).map(|(p, dy)| p * self.lambda * dy).collect()
        })
    }

    fn check(&self, p: &[f64]) -> Result<(), RiskError> {
        let (measure, value) = (self.name(), self.lambda);
        if !(value.is_finite() && value >= 0.0) {
            return Err(RiskError::Parameter { measure, name: "lambda", value, must: "must not be negative" });
        }
        super::check_signs(measure, p)
    }
}
