//! The decreasing function of the distance inside the smoothed Hausdorff distance.

use super::error::{HausdorffError, positive};

/// A strictly decreasing, positive function of the distance r >= 0 (metres, like its parameter).
///
/// Everything is offered in logarithms: `phi(r)^alpha` itself leaves the range of numbers for the alpha in use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phi {
    /// exp(-r / length); has a kink at r = 0.
    Exponential {
        /// Decay length.
        length: f64,
    },
    /// 1 / (r + eps); has a kink at r = 0.
    Inverse {
        /// Distance at which the value has fallen to half.
        eps: f64,
    },
    /// (r^2 + eps^2)^(-1/2); smooth.
    SmoothInverse {
        /// Radius of the rounding.
        eps: f64,
    },
}

impl Phi {
    /// The parameter that carries the length.
    pub fn length(&self) -> f64 {
        match *self {
            Phi::Exponential { length } => length,
            Phi::Inverse { eps } | Phi::SmoothInverse { eps } => eps,
        }
    }

    /// phi(r).
    pub fn value(&self, r: f64) -> f64 {
        self.log(r).exp()
    }

    /// log phi(r).
    pub fn log(&self, r: f64) -> f64 {
        match *self {
            Phi::Exponential { length } => -r / length,
            Phi::Inverse { eps } => -(r / eps).ln_1p() - eps.ln(),
            Phi::SmoothInverse { eps } => -0.5 * (r / eps).powi(2).ln_1p() - eps.ln(),
        }
    }

    /// phi'(r).
    pub fn derivative(&self, r: f64) -> f64 {
        self.value(r) * self.log_derivative(r)
    }

    /// (log phi)'(r) = phi'(r) / phi(r), never positive.
    pub fn log_derivative(&self, r: f64) -> f64 {
        match *self {
            Phi::Exponential { length } => -1.0 / length,
            Phi::Inverse { eps } => -1.0 / (r + eps),
            Phi::SmoothInverse { eps } => -(r / eps) / (r * (r / eps) + eps),
        }
    }

    /// The distance at which log phi equals `log`; zero where `log` exceeds log phi(0) by rounding.
    pub fn inverse_of_log(&self, log: f64) -> f64 {
        match *self {
            Phi::Exponential { length } => (-length * log).max(0.0),
            Phi::Inverse { eps } => (eps * (-log - eps.ln()).exp_m1()).max(0.0),
            Phi::SmoothInverse { eps } => eps * (-2.0 * (log + eps.ln())).exp_m1().max(0.0).sqrt(),
        }
    }

    pub(super) fn check(&self) -> Result<(), HausdorffError> {
        let name = if matches!(self, Phi::Exponential { .. }) { "length" } else { "eps" };
        positive(name, self.length()).map(|_| ())
    }
}
