//! Costs in units of their own spread.

use super::RiskError;

/// Mean, deviation and standardised costs `y_i = (j_i - mean)/deviation`.
pub(super) struct Standard {
    pub mean: f64,
    pub deviation: f64,
    /// Empty where the deviation is nothing but rounding.
    pub y: Vec<f64>,
}

/// A spread below this share of the largest cost is rounding.
const ROUNDING: f64 = 1e-14;

impl Standard {
    pub fn new(p: &[f64], j: &[f64]) -> Self {
        let mean: f64 = p.iter().zip(j).map(|(p, j)| p * j).sum();
        let variance: f64 = p.iter().zip(j).map(|(p, j)| p * (j - mean).powi(2)).sum();
        let deviation = variance.max(0.0).sqrt();
        let largest = j.iter().fold(0.0, |a: f64, j| a.max(j.abs()));
        if deviation <= ROUNDING * largest {
            return Standard { mean, deviation: 0.0, y: vec![] };
        }
        Standard { mean, deviation, y: j.iter().map(|j| (j - mean) / deviation).collect() }
    }

    /// Whether all costs are the same.
    pub fn is_flat(&self) -> bool {
        self.y.is_empty()
    }

    /// The change of `y` along a change of the costs: `dy_i = (dj_i - dE)/D - y_i dD/D`.
    ///
    /// # Errors
    /// [`RiskError::Kink`] where all costs are the same; a single scenario has none.
    pub fn change(&self, measure: &'static str, p: &[f64], dj: &[f64]) -> Result<Vec<f64>, RiskError> {
        if self.is_flat() {
            return if p.len() == 1 { Ok(vec![]) } else { Err(RiskError::Kink { measure }) };
        }
        let mean: f64 = p.iter().zip(dj).map(|(p, d)| p * d).sum();
        let deviation: f64 = self.deviation_slope(p).iter().zip(dj).map(|(s, d)| s * d).sum();
        Ok(self.y.iter().zip(dj).map(|(y, d)| (d - mean - y * deviation) / self.deviation).collect())
    }

    /// `d deviation / d j_i = p_i y_i`.
    pub fn deviation_slope(&self, p: &[f64]) -> Vec<f64> {
        p.iter().zip(&self.y).map(|(p, y)| p * y).collect()
    }
}
