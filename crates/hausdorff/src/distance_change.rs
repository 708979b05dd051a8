//! The second derivative of the smoothed Hausdorff distance along a motion of the body.

use super::cloud::Cloud;
use super::distance::{Directed, Evaluation, Partials, finite};
use super::error::HausdorffError;
use super::second::{Motion, Seeds};

/// `Partials` along a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct SecondPartials {
    /// The changes of d rho / d x_q and of d rho / d w_q.
    pub change: Partials,
    /// d rho / d w_q itself, for second derivatives of weights that depend on displacements.
    pub weights: Vec<f64>,
}

/// One of the two directions along a motion: `d` its distances and D their mean, which the weights p of the points make.
struct DirectedChange {
    /// dd/d of every distance; zero where it is zero.
    relative: Vec<f64>,
    /// Changes of p over p, for those of the distances themselves: `omega_q / w_q - Omega`.
    weights: Vec<f64>,
    /// dD/D.
    mean: f64,
}

impl Evaluation {
    /// The change of `partials` along a motion of the body: the exact second derivative of the value, symmetric, in two passes over
    /// the pairs, one for the changes of log A and log B, one for that of the gradient.
    ///
    /// ```text
    /// dd = dlog A / (alpha l'(d)),  l = log phi,        dD1/D1 = sum_t s_t (d/D1)^beta dd/d
    /// da_t / a_t = dc1/c1 + (beta - 1) (dd/d - dD1/D1) - l''(d)/l'(d) dd,   a_t = c1 s_t (d/D1)^(beta-1) / (alpha l'(d)),  c1 = drho/dD1
    /// dc1 / c1 = (gamma - 1) (dD1/D1 - drho/rho)
    /// ```
    ///
    /// and the same for the body's points, whose weights p_q = w_q/|Omega| change too. Where points meet at a kink, zero.
    ///
    /// Errors: a motion of another number of points; a result out of the range of numbers.
    pub fn partials_change(&self, motion: &Motion) -> Result<SecondPartials, HausdorffError> {
        let (body, target) = (self.pairs.body(), self.pairs.target());
        let rates = self.pairs.rates(&self.sums, motion)?;
        let total = motion.weights.iter().sum::<f64>() / body.measure();
        let of_weights = body.weights().iter().zip(&motion.weights).map(|(w, d)| d / w - total).collect();
        let to_body = self.directed_change(&self.to_body, &rates.target, target, vec![0.0; target.len()]);
        let to_target = self.directed_change(&self.to_target, &rates.body, body, of_weights);
        let (by_d1, by_d2) = (self.by_mean(self.to_body.mean), self.by_mean(self.to_target.mean));
        // drho/rho, and of drho/dD over itself
        let directed = by_d1 * self.to_body.mean * to_body.mean + by_d2 * self.to_target.mean * to_target.mean;
        let rho = if self.rho > 0.0 { directed / self.rho } else { 0.0 };
        let bend = |mean: f64| (self.smoothing.gamma() - 1.0) * (mean - rho);
        let target_seeds = self.to_body.seeds(by_d1, &self.smoothing, target);
        let body_seeds = self.to_target.seeds(by_d2, &self.smoothing, body);
        let seeds = Seeds {
            target_change: self.seeds_change(&self.to_body, &target_seeds, &to_body, bend(to_body.mean)),
            target: target_seeds,
            body_change: self.seeds_change(&self.to_target, &body_seeds, &to_target, bend(to_target.mean)),
            body: body_seeds,
        };
        let through = self.pairs.second_vjp(&self.sums, motion, &rates, &seeds)?;
        let own = self.to_target.by_weight(by_d2, &self.smoothing, body);
        let scale = by_d2 * self.to_target.mean / body.measure();
        let own_change = |q: usize| {
            let power = self.share(&self.to_target, q).powf(self.smoothing.beta());
            let moved = power * (to_target.relative[q] - to_target.mean);
            own[q] * (bend(to_target.mean) + to_target.mean - total) + scale * moved
        };
        let change = through.weights.iter().enumerate().map(|(q, w)| w + own_change(q)).collect();
        let weights = through.first.iter().zip(&own).map(|(through, own)| through + own).collect();
        let found = SecondPartials { change: Partials { points: through.points, weights: change }, weights };
        let Partials { points, weights } = &found.change;
        points.iter().flatten().chain(weights).try_for_each(|&d| finite("second derivative", d))?;
        Ok(found)
    }

    /// d/D.
    fn share(&self, directed: &Directed, k: usize) -> f64 {
        if directed.mean > 0.0 { directed.distances[k] / directed.mean } else { 0.0 }
    }

    fn directed_change(&self, directed: &Directed, rates: &[f64], cloud: &Cloud, weights: Vec<f64>) -> DirectedChange {
        let phi = self.smoothing.phi();
        let relative = |(&d, rate): (&f64, &f64)| {
            let slope = self.smoothing.alpha() * phi.log_derivative(d);
            if d > 0.0 && slope < 0.0 { rate / (slope * d) } else { 0.0 }
        };
        let relative: Vec<f64> = directed.distances.iter().zip(rates).map(relative).collect();
        let beta = self.smoothing.beta();
        // of D^beta = sum p d^beta, over beta D^beta
        let term = |k: usize| {
            let p = cloud.weights()[k] / cloud.measure();
            p * self.share(directed, k).powf(beta) * (relative[k] + weights[k] / beta)
        };
        let mean = (0..cloud.len()).map(term).sum();
        DirectedChange { relative, weights, mean }
    }

    fn seeds_change(&self, directed: &Directed, seeds: &[f64], change: &DirectedChange, bend: f64) -> Vec<f64> {
        let (phi, beta) = (self.smoothing.phi(), self.smoothing.beta());
        let one = |k: usize| {
            let (d, relative) = (directed.distances[k], change.relative[k]);
            let slope = if d > 0.0 { phi.log_derivative_rate(d) * relative * d } else { 0.0 };
            seeds[k] * (bend + change.weights[k] + (beta - 1.0) * (relative - change.mean) - slope)
        };
        (0..seeds.len()).map(one).collect()
    }
}
