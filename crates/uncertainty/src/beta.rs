//! [`Beta`]: random numbers between 0 and 1.

use super::law::{Law, invert, positive};
use super::special::{incomplete_beta, ln_gamma};
use super::{Gamma, StochasticError};
use nastic_numeric::Random;

/// The Beta law, density `x^(alpha-1) (1-x)^(beta-1) / B(alpha, beta)` on (0, 1).
///
/// Mean `alpha/(alpha+beta)`. Orthogonal polynomials: Jacobi, of exponents `beta - 1` and `alpha - 1`, moved to (0, 1).
/// Samples: `g/(g+h)` of two Gamma samples. The values have no unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beta {
    alpha: f64,
    beta: f64,
}

impl Beta {
    /// Name in case files and messages.
    pub const NAME: &str = "beta";

    /// From the two shapes.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] unless both are positive.
    pub fn new(alpha: f64, beta: f64) -> Result<Self, StochasticError> {
        Ok(Beta { alpha: positive(Self::NAME, "alpha", alpha)?, beta: positive(Self::NAME, "beta", beta)? })
    }

    /// From mean and variance: `alpha + beta = mean (1 - mean)/variance - 1`.
    ///
    /// # Errors
    /// [`StochasticError::Parameter`] unless the mean lies in (0, 1) and the variance in (0, mean (1 - mean)).
    pub fn from_mean_variance(mean: f64, variance: f64) -> Result<Self, StochasticError> {
        let refuse = |name, value, must| Err(StochasticError::Parameter { law: Self::NAME, name, value, must });
        if !(mean > 0.0 && mean < 1.0) {
            return refuse("mean", mean, "must lie between 0 and 1, ends excluded");
        }
        if !(variance > 0.0 && variance < mean * (1.0 - mean)) {
            return refuse("variance", variance, "must be positive and below mean (1 - mean)");
        }
        let sum = mean * (1.0 - mean) / variance - 1.0;
        Self::new(mean * sum, (1.0 - mean) * sum)
    }

    /// The shapes alpha and beta.
    pub fn shapes(&self) -> (f64, f64) {
        (self.alpha, self.beta)
    }
}

impl Law for Beta {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn mean(&self) -> f64 {
        self.alpha / (self.alpha + self.beta)
    }

    fn variance(&self) -> f64 {
        let sum = self.alpha + self.beta;
        self.alpha * self.beta / (sum * sum * (sum + 1.0))
    }

    fn recurrence(&self, k: usize) -> (f64, f64) {
        // Jacobi exponents of (1-t) and (1+t), t = 2x - 1; source: Gautschi, "Orthogonal Polynomials", table 1.1.
        let (p, q, n) = (self.beta - 1.0, self.alpha - 1.0, k as f64);
        let s = 2.0 * n + p + q;
        // At n = 0, and in b at n = 1, a factor cancels that may be zero.
        let centre = if k == 0 { (q - p) / (p + q + 2.0) } else { (q - p) * (q + p) / (s * (s + 2.0)) };
        let square = match k {
            0 => return (0.5 * (1.0 + centre), 1.0),
            1 => 4.0 * (1.0 + p) * (1.0 + q) / ((2.0 + p + q).powi(2) * (3.0 + p + q)),
            _ => 4.0 * n * (n + p) * (n + q) * (n + p + q) / (s * s * (s + 1.0) * (s - 1.0)),
        };
        (0.5 * (1.0 + centre), 0.25 * square)
    }

    fn cumulative(&self, x: f64) -> f64 {
        incomplete_beta(self.alpha, self.beta, x)
    }

    fn quantile(&self, p: f64) -> f64 {
        let (a, b) = (self.alpha, self.beta);
        let log_scale = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b);
        let density = |x: f64| (log_scale + (a - 1.0) * x.ln() + (b - 1.0) * (-x).ln_1p()).exp();
        invert(p, 0.0, 1.0, self.mean(), |x| self.cumulative(x), density)
    }

    fn draw(&self, random: &mut Random) -> f64 {
        let g = Gamma::draw_standard(self.alpha, random);
        let h = Gamma::draw_standard(self.beta, random);
        g / (g + h)
    }
}
