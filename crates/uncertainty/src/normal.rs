//! [`Normal`]: Gaussian random numbers.

use super::StochasticError;
use super::law::{Law, invert, positive, standard_normal};
use super::special::normal_cumulative;
use nastic_numeric::Random;

/// The normal law of a mean and a variance.
///
/// Orthogonal polynomials: Hermite (of the probabilists), `a_n = mean`, `b_n = n variance`. Samples: Marsaglia's polar
/// method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal {
    mean: f64,
    deviation: f64,
}

impl Normal {
    /// Name in case files and messages.
    pub const NAME: &str = "normal";

    /// Mean 0, variance 1.
    pub const STANDARD: Normal = Normal { mean: 0.0, deviation: 1.0 };

    /// From mean and variance.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] unless the mean is finite and the variance positive.
    pub fn from_mean_variance(mean: f64, variance: f64) -> Result<Self, StochasticError> {
        if !mean.is_finite() {
            let (law, name, value) = (Self::NAME, "mean", mean);
            return Err(StochasticError::Parameter { law, name, value, must: "must be finite" });
        }
        Ok(Normal { mean, deviation: positive(Self::NAME, "variance", variance)?.sqrt() })
    }
}

/// Beyond this many deviations no double is left of the probability.
const FAR: f64 = 40.0;

impl Law for Normal {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn mean(&self) -> f64 {
        self.mean
    }

    fn variance(&self) -> f64 {
        self.deviation * self.deviation
    }

    fn recurrence(&self, k: usize) -> (f64, f64) {
        (self.mean, if k == 0 { 1.0 } else { k as f64 * self.variance() })
    }

    fn cumulative(&self, x: f64) -> f64 {
        normal_cumulative((x - self.mean) / self.deviation)
    }

    fn quantile(&self, p: f64) -> f64 {
        let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
        self.mean + self.deviation * invert(p, -FAR, FAR, 0.0, normal_cumulative, density)
    }

    fn draw(&self, random: &mut Random) -> f64 {
        self.mean + self.deviation * standard_normal(random)
    }
}
