//! Armijo's test and the choice of a shorter step.

use crate::failed::Failed;

/// Backtracking: a trial is accepted when j(m(t)) <= reference + armijo * dj.(m(t) - m); otherwise the step is shortened
/// to the minimiser of the parabola through what is known, within limits. A failed evaluation shortens it by a fixed
/// factor, or to just before a limit that the evaluation reports. All of it is dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSearch {
    /// Share of the predicted decrease that must be had.
    pub armijo: f64,
    /// Factor after an evaluation that failed.
    pub after_failure: f64,
    /// Share of the way to a [known limit](crate::Failed::limit) that is tried next, in the place of `after_failure`.
    pub before_limit: f64,
    /// Smallest factor after a trial without enough decrease.
    pub shortest: f64,
    /// Largest factor after a trial without enough decrease.
    pub longest: f64,
    /// Trials per iteration.
    pub max_trials: usize,
}

impl Default for LineSearch {
    fn default() -> Self {
        Self { armijo: 1e-4, after_failure: 0.3, before_limit: 0.9, shortest: 0.1, longest: 0.5, max_trials: 25 }
    }
}

impl LineSearch {
    /// Whether a cost is low enough; `predicted` is dj.(m(t) - m), `slack` what rounding may add.
    pub fn accepts(&self, reference: f64, predicted: f64, slack: f64, cost: f64) -> bool {
        cost <= reference + self.armijo * predicted + slack
    }

    /// Factor by which to shorten a step whose evaluation failed.
    pub fn fall_back(&self, failed: &Failed) -> f64 {
        match failed.limit() {
            Some(limit) if limit > 0.0 && limit < 1.0 => self.before_limit * limit,
            _ => self.after_failure,
        }
    }

    /// Factor by which to shorten a step that did not lower the cost enough; what it changed says nothing of the branch before where it led to another one.
    pub fn come_back(&self, jump: Option<&Failed>, [from, predicted, to]: [f64; 3]) -> f64 {
        match jump.and_then(Failed::limit) {
            Some(limit) if limit > 0.0 && limit < 1.0 => self.before_limit * limit,
            _ if jump.is_some() => self.after_failure,
            _ => self.shorten(from, predicted, to),
        }
    }

    /// Factor by which to shorten a step that changed the cost from `from` to `to` where `predicted` was expected.
    pub fn shorten(&self, from: f64, predicted: f64, to: f64) -> f64 {
        let curvature = to - from - predicted;
        let factor = if curvature > 0.0 { -0.5 * predicted / curvature } else { self.longest };
        factor.clamp(self.shortest, self.longest)
    }
}
