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

/// A row of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct PhiRow {
    /// Name in case files.
    pub name: &'static str,
    /// phi(r).
    pub formula: &'static str,
    /// Name of its parameter, a length.
    pub parameter: &'static str,
    /// The function with this parameter.
    pub make: fn(f64) -> Phi,
}

/// Every function phi.
pub const CATALOGUE: &[PhiRow] = &[
    PhiRow {
        name: "exponential",
        formula: "exp(-r / length)",
        parameter: "length",
        make: |length| Phi::Exponential { length },
    },
    PhiRow { name: "inverse", formula: "1 / (r + eps)", parameter: "eps", make: |eps| Phi::Inverse { eps } },
    PhiRow {
        name: "smooth_inverse",
        formula: "(r^2 + eps^2)^(-1/2)",
        parameter: "eps",
        make: |eps| Phi::SmoothInverse { eps },
    },
];

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

    /// (log phi)''(r) / (log phi)'(r), for r > 0.
    pub fn log_derivative_rate(&self, r: f64) -> f64 {
        match *self {
            Phi::Exponential { .. } => 0.0,
            Phi::Inverse { eps } => -1.0 / (r + eps),
            Phi::SmoothInverse { eps } => 1.0 / r - 2.0 * (r / eps) / (r * (r / eps) + eps),
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

    /// Its row in the catalogue.
    fn row(&self) -> usize {
        match self {
            Phi::Exponential { .. } => 0,
            Phi::Inverse { .. } => 1,
            Phi::SmoothInverse { .. } => 2,
        }
    }

    pub(super) fn check(&self) -> Result<(), HausdorffError> {
        let row = &CATALOGUE[self.row()];
        positive(row.parameter, self.length()).map(|_| ())
    }
}
