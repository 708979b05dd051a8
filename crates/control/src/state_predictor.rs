//! [`StatePredictor`]: the points before this one, from which the state of the next is guessed.

use nastic_numeric::vector::{axpy, dot, norm, sub};
use std::sync::Arc;

/// Points that are remembered: steps of quasi-Newton methods lie mostly in the span of the last two or three.
const LENGTH: usize = 4;
/// Directions of which less than this share is left beside the newer ones say nothing new.
const NEW: f64 = 0.1;
/// Share of a step that the directions must reach for a guess to be worth having.
const REACHED: f64 = 0.7;
/// A guess goes no farther along a direction than this times the way that was gone there.
const FARTHEST: f64 = 4.0;

/// A point, those it was evaluated from before it, the newest first.
#[derive(Debug, Clone, Default)]
pub(crate) struct StatePredictor(Vec<Footprint>);

#[derive(Debug, Clone)]
struct Footprint {
    m: Arc<[f64]>,
    u: Arc<Vec<f64>>,
}

/// A step of length one in the controls and what it did to the state.
struct Direction {
    m: Vec<f64>,
    u: Vec<f64>,
    /// How far it was gone.
    length: f64,
}

impl StatePredictor {
    /// The predictor that has come to m.
    pub fn then(&self, m: &[f64], u: &Arc<Vec<f64>>) -> Self {
        let newest = Footprint { m: m.into(), u: u.clone() };
        StatePredictor(std::iter::once(newest).chain(self.0.iter().take(LENGTH - 1).cloned()).collect())
    }

    /// A guess of the state at m: with differences `dm_i`, `du_i` from the newest point to those before it,
    /// `u + sum_i c_i du_i` where `sum_i c_i dm_i` is nearest to the step to m. `None` where that is not near.
    pub fn guess(&self, m: &[f64]) -> Option<Vec<f64>> {
        let (here, before) = self.0.split_first()?;
        let step = sub(m, &here.m);
        let mut directions: Vec<Direction> = Vec::with_capacity(before.len());
        for footprint in before {
            directions.extend(Direction::new(here, footprint, &directions));
        }
        let mut u = here.u.to_vec();
        let mut reached = 0.0;
        for direction in &directions {
            let c = dot(&direction.m, &step);
            if c.abs() <= FARTHEST * direction.length {
                axpy(c, &direction.u, &mut u);
                reached += c * c;
            }
        }
        (reached > REACHED * REACHED * dot(&step, &step)).then_some(u)
    }
}

impl Direction {
    /// What of a difference is at right angles to the directions there are.
    fn new(here: &Footprint, there: &Footprint, others: &[Direction]) -> Option<Self> {
        let (mut m, mut u) = (sub(&there.m, &here.m), sub(&there.u, &here.u));
        let whole = norm(&m);
        for other in others {
            let c = dot(&other.m, &m);
            axpy(-c, &other.m, &mut m);
            axpy(-c, &other.u, &mut u);
        }
        let length = norm(&m);
        if length <= NEW * whole {
            return None;
        }
        m.iter_mut().chain(&mut u).for_each(|x| *x /= length);
        Some(Direction { m, u, length })
    }
}
