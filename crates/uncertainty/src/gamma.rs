//! [`Gamma`]: positive random numbers.

use super::StochasticError;
use super::law::{Law, invert, positive, standard_normal};
use super::special::{incomplete_gamma, ln_gamma};
use nastic_numeric::Random;

/// The Gamma law, density `x^(k-1) exp(-x/theta) / (Gamma(k) theta^k)` on x > 0.
///
/// Mean `k theta`, variance `k theta^2`. Orthogonal polynomials: generalised Laguerre of order k - 1, so
/// `a_n = theta (2n + k)`, `b_n = theta^2 n (n + k - 1)`. Samples: Marsaglia & Tsang, ACM TOMS 26 (2000).
/// Units: theta and the values have one unit, k none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gamma {
    shape: f64,
    scale: f64,
}

impl Gamma {
    /// Name in case files and messages.
    pub const NAME: &str = "gamma";

    /// From the shape k and the scale theta.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] unless both are positive.
    pub fn new(shape: f64, scale: f64) -> Result<Self, StochasticError> {
        Ok(Gamma { shape: positive(Self::NAME, "shape", shape)?, scale: positive(Self::NAME, "scale", scale)? })
    }

    /// From mean and variance: `k = mean^2/variance`, `theta = variance/mean`.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] unless both are positive.
    pub fn from_mean_variance(mean: f64, variance: f64) -> Result<Self, StochasticError> {
        let (mean, variance) = (positive(Self::NAME, "mean", mean)?, positive(Self::NAME, "variance", variance)?);
        Self::new(mean * mean / variance, variance / mean)
    }

    /// From the mean and the coefficient of variation (standard deviation relative to the mean): `k = 1/cv^2`.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] unless both are positive.
    pub fn from_mean_variation(mean: f64, variation: f64) -> Result<Self, StochasticError> {
        let mean = positive(Self::NAME, "mean", mean)?;
        Self::from_mean_variance(mean, (positive(Self::NAME, "variation", variation)? * mean).powi(2))
    }

    /// The shape k.
    pub fn shape(&self) -> f64 {
        self.shape
    }

    /// The scale theta.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// A sample of shape k and scale one.
    pub(super) fn draw_standard(shape: f64, random: &mut Random) -> f64 {
        if shape < 1.0 {
            let boost = open_unit(random).powf(1.0 / shape);
            return boost * Self::draw_standard(shape + 1.0, random);
        }
        let d = shape - 1.0 / 3.0;
        let c = 1.0 / (9.0 * d).sqrt();
        loop {
            let x = standard_normal(random);
            let v = (1.0 + c * x).powi(3);
            if v > 0.0 && open_unit(random).ln() < 0.5 * x * x + d - d * v + d * v.ln() {
                return d * v;
            }
        }
    }
}

/// Uniform in (0, 1].
fn open_unit(random: &mut Random) -> f64 {
    1.0 - random.unit()
}

impl Law for Gamma {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn mean(&self) -> f64 {
        self.shape * self.scale
    }

    fn variance(&self) -> f64 {
        self.shape * self.scale * self.scale
    }

    fn recurrence(&self, k: usize) -> (f64, f64) {
        let n = k as f64;
        let b = if k == 0 { 1.0 } else { self.scale * self.scale * n * (n + self.shape - 1.0) };
        (self.scale * (2.0 * n + self.shape), b)
    }

    fn cumulative(&self, x: f64) -> f64 {
        incomplete_gamma(self.shape, x / self.scale).0
    }

    fn quantile(&self, p: f64) -> f64 {
        let k = self.shape;
        let cumulative = |x: f64| incomplete_gamma(k, x).0;
        let mut high = k + 1.0;
        while cumulative(high) < p && high < 1e6 * (k + 1.0) {
            high *= 2.0;
        }
        let density = |x: f64| ((k - 1.0) * x.ln() - x - ln_gamma(k)).exp();
        self.scale * invert(p, 0.0, high, k, cumulative, density)
    }

    fn draw(&self, random: &mut Random) -> f64 {
        self.scale * Self::draw_standard(self.shape, random)
    }
}
