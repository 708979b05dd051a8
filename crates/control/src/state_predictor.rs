//! [`StatePredictor`]: the next state, extrapolated by least squares from the states of the last accepted points, and what these took.

use nastic_numeric::vector::{axpy, dot, norm, sub};
use std::sync::Arc;

/// Points that are held: steps of quasi-Newton methods lie mostly in the span of the last two or three.
const MAX_POINTS: usize = 4;
/// Share of a direction that is orthogonal to the newer ones, below which it is left out.
const MIN_NEW_SHARE: f64 = 0.1;
/// Least share of a step that its projection onto the directions has, for a prediction.
const MIN_PROJECTED_SHARE: f64 = 0.7;
/// Largest step of a prediction along a direction over the recorded step there.
const MAX_EXTRAPOLATION: f64 = 4.0;

/// The last accepted points of a run, the newest first.
#[derive(Debug, Clone, Default)]
pub(crate) struct StatePredictor(Vec<Record>);

#[derive(Debug, Clone)]
struct Record {
    m: Arc<[f64]>,
    u: Arc<Vec<f64>>,
    /// Newton iterations of its solve.
    newton: usize,
}

/// A step of length one in the controls and what it did to the state.
struct Direction {
    m: Vec<f64>,
    u: Vec<f64>,
    /// Length of the recorded step.
    length: f64,
}

impl StatePredictor {
    /// Takes up the point from which the next one is evaluated: it becomes the newest, wherever it stood before.
    pub fn record(&mut self, m: &[f64], u: &Arc<Vec<f64>>, newton: usize) {
        if self.0.first().is_some_and(|newest| Arc::ptr_eq(&newest.u, u)) {
            return;
        }
        self.0.retain(|known| !Arc::ptr_eq(&known.u, u));
        self.0.insert(0, Record { m: m.into(), u: u.clone(), newton });
        self.0.truncate(MAX_POINTS);
    }

    /// Newton iterations of the last three points, the lower median: one that took many does not count for the next ones.
    pub fn usual_work(&self) -> Option<usize> {
        let mut last: Vec<usize> = self.0.iter().take(3).map(|record| record.newton).collect();
        last.sort_unstable();
        last.get(last.len().saturating_sub(1) / 2).copied()
    }

    /// A guess of the state at m: with differences `dm_i`, `du_i` from the newest point to those before it,
    /// `u + sum_i c_i du_i` where `sum_i c_i dm_i` is nearest to the step to m. `None` where that is not near.
    pub fn guess(&self, m: &[f64]) -> Option<Vec<f64>> {
        let (here, before) = self.0.split_first()?;
        let step = sub(m, &here.m);
        let mut directions: Vec<Direction> = Vec::with_capacity(before.len());
        for record in before {
            directions.extend(Direction::new(here, record, &directions));
        }
        let mut u = here.u.to_vec();
        let mut reached = 0.0;
        for direction in &directions {
            let c = dot(&direction.m, &step);
            if c.abs() <= MAX_EXTRAPOLATION * direction.length {
                axpy(c, &direction.u, &mut u);
                reached += c * c;
            }
        }
        (reached > MIN_PROJECTED_SHARE * MIN_PROJECTED_SHARE * dot(&step, &step)).then_some(u)
    }
}

impl Direction {
    /// What of a difference is at right angles to the directions there are.
    fn new(here: &Record, there: &Record, others: &[Direction]) -> Option<Self> {
        let (mut m, mut u) = (sub(&there.m, &here.m), sub(&there.u, &here.u));
        let whole = norm(&m);
        for other in others {
            let c = dot(&other.m, &m);
            axpy(-c, &other.m, &mut m);
            axpy(-c, &other.u, &mut u);
        }
        let length = dot(&m, &m).sqrt();
        if length <= MIN_NEW_SHARE * whole {
            return None;
        }
        m.iter_mut().chain(&mut u).for_each(|x| *x /= length);
        Some(Direction { m, u, length })
    }
}
