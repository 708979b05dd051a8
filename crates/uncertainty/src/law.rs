//! [`Law`]: one random number.

use super::{Beta, Gamma, Normal, StochasticError};
use nastic_numeric::Random;
use std::fmt::Debug;

/// The law of one random number, with what the rules need of it.
///
/// Contract: the recurrence, the quantiles and the samples belong to the density of the stated mean and variance.
pub trait Law: Debug + Send + Sync {
    /// Name in case files and messages.
    fn name(&self) -> &'static str;

    /// Expectation.
    fn mean(&self) -> f64;

    /// Variance.
    fn variance(&self) -> f64;

    /// Coefficients `(a_k, b_k)` of the monic polynomials orthogonal under the law,
    /// `p_{k+1} = (x - a_k) p_k - b_k p_{k-1}`, with `b_0 = 1`.
    fn recurrence(&self, k: usize) -> (f64, f64);

    /// The probability of a value up to x.
    fn cumulative(&self, x: f64) -> f64;

    /// The x with `cumulative(x) = p`, for p in (0, 1).
    fn quantile(&self, p: f64) -> f64;

    /// A random value.
    fn draw(&self, random: &mut Random) -> f64;
}

/// A row of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct LawRow {
    /// Name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The law of a mean and a variance.
    pub from_mean_variance: fn(f64, f64) -> Result<Box<dyn Law>, StochasticError>,
    /// An example of mean and variance.
    pub example: (f64, f64),
}

/// Every law.
pub const CATALOGUE: &[LawRow] = &[
    LawRow {
        name: "gamma",
        about: "positive numbers, such as moduli",
        from_mean_variance: |mean, variance| Ok(Box::new(Gamma::from_mean_variance(mean, variance)?)),
        example: (1e5, 2.5e8),
    },
    LawRow {
        name: "beta",
        about: "numbers between 0 and 1, such as shares",
        from_mean_variance: |mean, variance| Ok(Box::new(Beta::from_mean_variance(mean, variance)?)),
        example: (0.7, 0.01),
    },
    LawRow {
        name: "normal",
        about: "all numbers, such as the coefficients of a Gaussian field",
        from_mean_variance: |mean, variance| Ok(Box::new(Normal::from_mean_variance(mean, variance)?)),
        example: (0.0, 1.0),
    },
];

/// Refuses a parameter that is not a positive number.
pub(super) fn positive(law: &'static str, name: &'static str, value: f64) -> Result<f64, StochasticError> {
    match value.is_finite() && value > 0.0 {
        true => Ok(value),
        false => Err(StochasticError::Parameter { law, name, value, must: "must be a positive number" }),
    }
}

/// A standard normal number (Marsaglia's polar method; the second of the pair is dropped, so that one draw follows
/// another whatever came before).
pub(super) fn standard_normal(random: &mut Random) -> f64 {
    loop {
        let (u, v) = (random.symmetric(), random.symmetric());
        let s = u * u + v * v;
        if s > 0.0 && s < 1.0 {
            return u * (-2.0 * s.ln() / s).sqrt();
        }
    }
}

/// Solves `cumulative(x) = p` by Newton's method inside a bracket, from `start`.
///
/// The bracket must hold the answer; it is halved where Newton leaves it.
pub(super) fn invert(
    p: f64,
    mut low: f64,
    mut high: f64,
    start: f64,
    cumulative: impl Fn(f64) -> f64,
    density: impl Fn(f64) -> f64,
) -> f64 {
    let mut x = if start > low && start < high { start } else { 0.5 * (low + high) };
    for _ in 0..MAX_STEPS {
        let excess = cumulative(x) - p;
        if excess == 0.0 {
            return x;
        }
        if excess > 0.0 {
            high = x
        } else {
            low = x
        }
        let newton = x - excess / density(x);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= 2.0 * f64::EPSILON * x.abs() {
            return next;
        }
        x = next;
    }
    x
}

const MAX_STEPS: usize = 200;
