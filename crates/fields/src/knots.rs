//! [`Knots`]: the instants between which a control is interpolated.

use crate::error::ControlError;

/// How a control goes from knot to knot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// One value in each interval `(t_k, t_{k+1}]`, the first one at the beginning too. Where it jumps, the time steps bridge
    /// the jump linearly in the first step of the interval: controls are linear within a step.
    Constant,
    /// Linear between values at the knots.
    Linear,
}

/// Increasing instants from 0 to the end of a motion, at (or between) which a control has values:
/// `m(t) = sum_k phi_k(t) m_k` with hat functions or with those of the intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    times: Vec<f64>,
    interpolation: Interpolation,
}

/// Difference up to which instants are the same, as a share of the whole time.
const TIME_TOLERANCE: f64 = 1e-9;

impl Knots {
    /// At given instants, from 0 on.
    ///
    /// # Errors
    /// Fewer than two instants, one that is not finite, a first one that is not 0, or instants that do not increase.
    pub fn at(times: Vec<f64>, interpolation: Interpolation) -> Result<Self, ControlError> {
        let increasing = times.windows(2).all(|pair| pair[1] > pair[0]);
        if times.len() < 2 || times[0] != 0.0 || !increasing || !times.iter().all(|t| t.is_finite()) {
            let what = format!("knots of a control at {times:?}: take 0 and increasing instants behind it");
            return Err(ControlError::Cost { what });
        }
        Ok(Knots { times, interpolation })
    }

    /// At equal distances close to `every`, from 0 to the end.
    ///
    /// # Errors
    /// Lengths that are not positive, or more than a million knots.
    pub fn every(every: f64, end: f64, interpolation: Interpolation) -> Result<Self, ControlError> {
        let count = (end / every).round().max(1.0);
        if !(every.is_finite() && every > 0.0 && end.is_finite() && end > 0.0 && count <= 1e6) {
            let what = format!("knots of a control every {every} until {end}: both are positive, of at most 1e6 knots");
            return Err(ControlError::Cost { what });
        }
        let times = (0..=count as usize).map(|k| end * k as f64 / count).collect();
        Knots::at(times, interpolation)
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        match self.interpolation {
            Interpolation::Constant => self.times.len() - 1,
            Interpolation::Linear => self.times.len(),
        }
    }

    /// Never.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The knots.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The last instant.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Where values are: knots, or the middles of intervals.
    pub fn instants(&self) -> Vec<f64> {
        match self.interpolation {
            Interpolation::Linear => self.times.clone(),
            Interpolation::Constant => self.times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect(),
        }
    }

    /// How it goes from knot to knot.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The values that make up that at an instant, with their factors; beyond the ends those of the ends.
    pub fn weights(&self, t: f64) -> [(usize, f64); 2] {
        let t = t.clamp(0.0, self.end());
        let slack = match self.interpolation {
            // an instant at a knot belongs to the interval before it, whatever its rounding
            Interpolation::Constant => TIME_TOLERANCE * self.end(),
            Interpolation::Linear => 0.0,
        };
        let k = self.times.partition_point(|knot| *knot < t - slack).clamp(1, self.times.len() - 1) - 1;
        match self.interpolation {
            Interpolation::Constant => [(k, 1.0), (k, 0.0)],
            Interpolation::Linear => {
                let s = (t - self.times[k]) / (self.times[k + 1] - self.times[k]);
                [(k, 1.0 - s), (k + 1, s)]
            }
        }
    }

    /// `int phi_k dt` over the whole time, as shares of it: they add up to 1.
    pub(crate) fn shares(&self) -> Vec<f64> {
        let mut shares = vec![0.0; self.len()];
        for (k, pair) in self.times.windows(2).enumerate() {
            let share = (pair[1] - pair[0]) / self.end();
            match self.interpolation {
                Interpolation::Constant => shares[k] += share,
                Interpolation::Linear => {
                    shares[k] += 0.5 * share;
                    shares[k + 1] += 0.5 * share;
                }
            }
        }
        shares
    }
}
