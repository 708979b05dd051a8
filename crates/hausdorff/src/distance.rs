//! The smoothed Hausdorff distance and its exact partial derivatives.

use std::f64::consts::SQRT_2;
use std::sync::Arc;

use rayon::prelude::*;

use super::cloud::Cloud;
use super::error::HausdorffError;
use super::pairs::{LogSums, Pairs};
use super::smoothing::Smoothing;
use super::summation::Summation;
use super::together::Together;

/// rho and its two directions (metres).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    /// ((D1^gamma + D2^gamma) / sqrt 2)^(1/gamma).
    pub rho: f64,
    /// D1: soft largest distance from a target point to the body.
    pub target_to_body: f64,
    /// D2: soft largest distance from a body point to the target.
    pub body_to_target: f64,
}

/// Partial derivatives of rho by the body's points and weights, taken as independent of each other.
///
/// A point that moves with the displacement and a weight w_q = J_q w_q^0 together give the derivative of the cost:
/// `drho[v] = sum_q points_q . v(x_q) + weights_q w_q^0 (H : grad v)(x_q)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Partials {
    /// d rho / d x_q (dimensionless).
    pub points: Vec<[f64; 3]>,
    /// d rho / d w_q (metres per unit of weight).
    pub weights: Vec<f64>,
}

/// A distance that has been evaluated, ready for its derivative.
///
/// ```text
/// d_Omega(y_t) = phi^-1(A_t^(1/alpha)),              d_T(x_q) = phi^-1(B_q^(1/alpha)),       see `Pairs`
/// D1 = (sum_t s_t d_Omega(y_t)^beta)^(1/beta),       D2 = (sum_q p_q d_T(x_q)^beta)^(1/beta)
/// rho = ((D1^gamma + D2^gamma) / sqrt 2)^(1/gamma)
/// ```
///
/// rho of a cloud with itself is not zero; it is the bias of the smoothing, and worth reporting beside rho.
#[derive(Debug)]
pub struct Evaluation {
    pub(super) pairs: Pairs,
    pub(super) smoothing: Smoothing,
    pub(super) sums: LogSums,
    pub(super) to_body: Directed,
    pub(super) to_target: Directed,
    pub(super) rho: f64,
}

impl Evaluation {
    /// The value alone: what a line search needs.
    ///
    /// Errors: a result out of the range of numbers.
    pub fn new(
        body: &Cloud,
        target: &Cloud,
        smoothing: Smoothing,
        summation: Summation,
    ) -> Result<Self, HausdorffError> {
        Self::together(body, target, smoothing, summation, None)
    }

    /// The same by several processes that have the same clouds and form the sums over pairs together; so they do those of [`partials`](Self::partials).
    ///
    /// Errors: a result out of the range of numbers.
    pub fn together(
        body: &Cloud,
        target: &Cloud,
        smoothing: Smoothing,
        summation: Summation,
        together: Option<Arc<dyn Together>>,
    ) -> Result<Self, HausdorffError> {
        let pairs = Pairs::new(body, target, smoothing.phi(), smoothing.alpha(), summation)?.together(together);
        let sums = pairs.log_sums();
        let to_body = Directed::new("D1", &smoothing, &sums.target, target)?;
        let to_target = Directed::new("D2", &smoothing, &sums.body, body)?;
        let rho = join(to_body.mean, to_target.mean, smoothing.gamma());
        finite("rho", rho)?;
        Ok(Self { pairs, smoothing, sums, to_body, to_target, rho })
    }

    /// The value.
    pub fn distance(&self) -> Distance {
        Distance { rho: self.rho, target_to_body: self.to_body.mean, body_to_target: self.to_target.mean }
    }

    /// Smoothed distance of every target point to the body, d_Omega(y_t).
    pub fn distances_to_body(&self) -> &[f64] {
        &self.to_body.distances
    }

    /// Smoothed distance of every body point to the target, d_T(x_q).
    pub fn distances_to_target(&self) -> &[f64] {
        &self.to_target.distances
    }

    /// The parameters.
    pub fn smoothing(&self) -> &Smoothing {
        &self.smoothing
    }

    /// The pair sums.
    pub fn pairs(&self) -> &Pairs {
        &self.pairs
    }

    /// The exact derivative of the value (a subgradient where a body point meets a target point and phi has a kink,
    /// or where a distance is zero).
    ///
    /// Errors: a result out of the range of numbers.
    pub fn partials(&self) -> Result<Partials, HausdorffError> {
        let (body, target) = (self.pairs.body(), self.pairs.target());
        let by_d1 = self.by_mean(self.to_body.mean);
        let by_d2 = self.by_mean(self.to_target.mean);
        let by_target = self.to_body.seeds(by_d1, &self.smoothing, target);
        let by_body = self.to_target.seeds(by_d2, &self.smoothing, body);
        let vjp = self.pairs.vjp(&self.sums, &by_target, &by_body)?;
        let own = self.to_target.by_weight(by_d2, &self.smoothing, body);
        let weights = vjp.weights.iter().zip(own).map(|(through_a, own)| through_a + own).collect();
        let partials = Partials { points: vjp.points, weights };
        partials.points.iter().flatten().chain(&partials.weights).try_for_each(|&d| finite("derivative", d))?;
        Ok(partials)
    }

    /// drho/dD = (D / rho)^(gamma - 1) / sqrt 2
    pub(super) fn by_mean(&self, d: f64) -> f64 {
        if d > 0.0 { (d / self.rho).powf(self.smoothing.gamma() - 1.0) / SQRT_2 } else { 0.0 }
    }
}

/// One of the two directions: distances at the points of a cloud and their mean of power beta.
#[derive(Debug)]
pub(super) struct Directed {
    pub distances: Vec<f64>,
    pub mean: f64,
}

impl Directed {
    fn new(what: &'static str, smoothing: &Smoothing, logs: &[f64], cloud: &Cloud) -> Result<Self, HausdorffError> {
        let phi = smoothing.phi();
        let distances: Vec<f64> = logs.par_iter().map(|log| phi.inverse_of_log(log / smoothing.alpha())).collect();
        let largest = distances.iter().copied().fold(0.0, f64::max);
        let mean = if largest > 0.0 {
            let power = |(d, w): (&f64, &f64)| w * (d / largest).powf(smoothing.beta());
            let powers: Vec<f64> = distances.par_iter().zip(cloud.weights()).map(power).collect();
            let share = powers.iter().sum::<f64>() / cloud.measure();
            largest * share.powf(1.0 / smoothing.beta())
        } else {
            0.0
        };
        finite(what, mean)?;
        Ok(Self { distances, mean })
    }

    /// dJ/dlog of the sum at each point, given dJ/dD: the chain through d^beta and phi^-1.
    pub fn seeds(&self, by_mean: f64, smoothing: &Smoothing, cloud: &Cloud) -> Vec<f64> {
        let phi = smoothing.phi();
        let seed = |(&d, &w): (&f64, &f64)| {
            let slope = smoothing.alpha() * phi.log_derivative(d);
            if d > 0.0 && slope < 0.0 {
                by_mean * w / cloud.measure() * (d / self.mean).powf(smoothing.beta() - 1.0) / slope
            } else {
                0.0
            }
        };
        self.distances.par_iter().zip(cloud.weights()).map(seed).collect()
    }

    /// dJ/dw of the weights in the mean itself: D / (beta |cloud|) ((d/D)^beta - 1) dJ/dD.
    pub fn by_weight(&self, by_mean: f64, smoothing: &Smoothing, cloud: &Cloud) -> Vec<f64> {
        let scale = by_mean * self.mean / (smoothing.beta() * cloud.measure());
        let own = |&d: &f64| {
            if self.mean > 0.0 { scale * ((d / self.mean).powf(smoothing.beta()) - 1.0) } else { 0.0 }
        };
        self.distances.par_iter().map(own).collect()
    }
}

/// ((a^gamma + b^gamma) / sqrt 2)^(1/gamma) without overflow of intermediate values.
fn join(a: f64, b: f64, gamma: f64) -> f64 {
    let (small, large) = (a.min(b), a.max(b));
    if large == 0.0 {
        return 0.0;
    }
    large * ((((small / large).powf(gamma)).ln_1p() - 0.5 * std::f64::consts::LN_2) / gamma).exp()
}

pub(super) fn finite(what: &'static str, value: f64) -> Result<(), HausdorffError> {
    if value.is_finite() { Ok(()) } else { Err(HausdorffError::Overflow { what, value }) }
}
