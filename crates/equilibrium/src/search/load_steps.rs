//! [`LoadSteps`]: the lengths of load steps on the way from one equilibrium to another.

use crate::stability::limit_point::LimitPoint;

/// Shortest load step, as a share of the way.
const MIN_LOAD_STEP: f64 = 1.0 / 4096.0;
/// A load that failed is tried again from a distance below this share of that of its failure.
const RETRY_DISTANCE_RATIO: f64 = 0.25;
/// Distance from a limit point below which loads behind it are not tried.
const LIMIT_POINT_DISTANCE: f64 = 1.0 / 64.0;

/// Where the way stands; 0 is its start, 1 its end.
#[derive(Debug)]
pub(crate) struct LoadSteps {
    /// The last load with an equilibrium.
    pub done: f64,
    step: f64,
    /// The last load that failed, and from how far.
    failed: Option<(f64, f64)>,
    limit: LimitPoint,
}

impl Default for LoadSteps {
    fn default() -> Self {
        Self { done: 0.0, step: 1.0, failed: None, limit: LimitPoint::default() }
    }
}

impl LoadSteps {
    /// The load to try: a step ahead, but half way to one that failed until that is near.
    pub fn next(&self) -> f64 {
        let ahead = (self.done + self.step).min(1.0);
        match self.failed {
            Some((at, from)) if ahead >= at && at - self.done > RETRY_DISTANCE_RATIO * from => 0.5 * (self.done + at),
            Some((at, _)) => ahead.min(at),
            None => ahead,
        }
    }

    /// An equilibrium was found there; `change` is the norm of the change of the displacement.
    pub fn succeeded(&mut self, at: f64, change: f64) {
        self.limit.record(self.done, at, change);
        self.step = 2.0 * (at - self.done);
        self.done = at;
        self.failed = self.failed.filter(|(failed, _)| *failed > at);
    }

    /// None was found there. True when it is time to give up.
    pub fn failed(&mut self, at: f64) -> bool {
        let distance = at - self.done;
        self.failed = Some((at, distance));
        self.step = 0.5 * distance;
        let beyond = self.limit.load().is_some_and(|limit| at > limit && limit - self.done < LIMIT_POINT_DISTANCE);
        beyond || distance <= MIN_LOAD_STEP
    }

    /// The load at which the path turns back, if it seems to.
    pub fn limit_point(&self) -> Option<f64> {
        self.limit.load().filter(|_| self.failed.is_some())
    }
}
