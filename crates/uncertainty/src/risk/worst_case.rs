//! [`WorstCase`]: the largest cost, smoothed.

use super::standard::Standard;
use super::{Risk, RiskError, check_signs, check_smoothing, conditional_value_at_risk};

/// The largest cost, smoothed by a log-sum-exp weighted by probability: `R = e log sum p_i exp(j_i/e)`.
///
/// `max_i (j_i - e log(1/p_i)) <= R <= max j`, and R tends to the mean as e grows. The width is `e = s D`,
/// 0.1 standard deviations by default.
///
/// Weights: `q_i + (dR/de) (de/dj_i)` with `q_i ~ p_i exp(j_i/e)`, `sum q_i = 1`, `dR/de = (R - sum q_i j_i)/e`,
/// `de/dj_i = s p_i y_i`; `p_i` where all costs are equal. Evaluated after subtracting the largest cost: nothing
/// overflows.
///
/// Source: the entropic risk measure, Föllmer & Schied, "Stochastic Finance", example 4.13.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstCase {
    /// Width of the log-sum-exp, as a share of the standard deviation.
    pub smoothing: f64,
}

impl Default for WorstCase {
    fn default() -> Self {
        WorstCase { smoothing: 0.1 }
    }
}

impl WorstCase {
    /// `r = e log sum p_i exp(y_i/e)` and `q_i`, all in units of the deviation.
    fn soft_maximum(p: &[f64], y: &[f64], width: f64) -> (f64, Vec<f64>) {
        // Scenarios without probability do not count, so they must not set the shift either.
        let real = p.iter().zip(y).filter(|(p, _)| **p > 0.0);
        let top = real.fold(f64::NEG_INFINITY, |a, (_, y)| a.max(*y));
        let mass = |(p, y): (&f64, &f64)| if *p > 0.0 { p * ((y - top) / width).exp() } else { 0.0 };
        let mut q: Vec<f64> = p.iter().zip(y).map(mass).collect();
        let sum: f64 = q.iter().sum();
        q.iter_mut().for_each(|q| *q /= sum);
        (top + width * sum.ln(), q)
    }
}

impl Risk for WorstCase {
    fn name(&self) -> &'static str {
        "worst_case"
    }

    fn value(&self, p: &[f64], j: &[f64]) -> f64 {
        let costs = Standard::new(p, j);
        if costs.is_flat() {
            return costs.mean;
        }
        let (r, _) = Self::soft_maximum(p, &costs.y, self.smoothing);
        costs.mean + costs.deviation * r
    }

    fn weights(&self, p: &[f64], j: &[f64]) -> Vec<f64> {
        let costs = Standard::new(p, j);
        if costs.is_flat() {
            return p.to_vec();
        }
        let (r, q) = Self::soft_maximum(p, &costs.y, self.smoothing);
        let expected: f64 = q.iter().zip(&costs.y).map(|(q, y)| q * y).sum();
        let by_deviation = r - expected;
        q.iter().zip(costs.deviation_slope(p)).map(|(q, slope)| q + by_deviation * slope).collect()
    }

    /// With `b = dR/dD = r - sum q y` in units of the deviation: `dq_i + db p_i y_i + b p_i dy_i`,
    /// `dq_i = q_i (dy_i - sum q dy)/s`, `db = -sum y dq`.
    fn weights_change(&self, p: &[f64], j: &[f64], dj: &[f64]) -> Result<Vec<f64>, RiskError> {
        let costs = Standard::new(p, j);
        let dy = costs.change(self.name(), p, dj)?;
        if costs.is_flat() {
            return Ok(vec![0.0; p.len()]);
        }
        let y = &costs.y;
        let (r, q) = Self::soft_maximum(p, y, self.smoothing);
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (b, mean) = (r - sum(&q, y), sum(&q, &dy));
        let dq: Vec<f64> = q.iter().zip(&dy).map(|(q, dy)| q * (dy - mean) / self.smoothing).collect();
        let db = -sum(&dq, y);
        Ok((0..p.len()).map(|i| dq[i] + p[i] * (db * y[i] + b * dy[i])).collect())
    }

    /// The largest cost among scenarios that have a probability.
    fn exact(&self, p: &[f64], j: &[f64]) -> Option<f64> {
        Some(conditional_value_at_risk(p, j, 1.0))
    }

    fn check(&self, p: &[f64]) -> Result<(), RiskError> {
        check_smoothing(self.name(), self.smoothing)?;
        check_signs(self.name(), p)
    }
}
