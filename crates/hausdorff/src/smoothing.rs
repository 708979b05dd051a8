//! The parameters of the smoothed Hausdorff distance.

use super::error::{HausdorffError, positive};
use super::phi::Phi;

/// phi and the exponents alpha (soft nearest point), beta (soft farthest point), gamma (soft larger of the two directed distances).
///
/// The distance tends to the Hausdorff distance as all three grow; alpha makes the problem stiff first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothing {
    phi: Phi,
    alpha: f64,
    beta: f64,
    gamma: f64,
}

impl Smoothing {
    /// Errors: a parameter that is not positive and finite.
    pub fn new(phi: Phi, alpha: f64, beta: f64, gamma: f64) -> Result<Self, HausdorffError> {
        phi.check()?;
        positive("alpha", alpha)?;
        positive("beta", beta)?;
        positive("gamma", gamma)?;
        Ok(Self { phi, alpha, beta, gamma })
    }

    /// The decreasing function.
    pub fn phi(&self) -> Phi {
        self.phi
    }

    /// Exponent of phi.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Exponent of the distances in each one-sided mean.
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// Exponent that joins the two directed distances.
    pub fn gamma(&self) -> f64 {
        self.gamma
    }

    /// length / alpha (metres): over this distance phi^alpha falls by a factor e (exactly for the exponential, at r = 0
    /// for the inverse, roughly for the smooth one). Below the spacing of the points the clouds are seen as separate
    /// points and the distance no longer describes the bodies.
    pub fn resolution(&self) -> f64 {
        self.phi.length() / self.alpha
    }
}
