//! [`KnownLimits`]: limit points that the evaluations of a run have met, as planes in the space of controls.

use nastic_fem::{LimitAhead, State};
use nastic_numeric::vector::{axpy, dot, norm, sub};

/// Planes that are held.
const MAX_PLANES: usize = 8;
/// States before the last limit point that are held.
const MAX_STATES: usize = 3;

/// Limit points met before. Where equilibria end, a surface in the space of controls, its normal is `phi . dr/dm`, phi the
/// direction in which the tangent is singular; its tangent plane shows which trials probably lie beyond. A trial behind one is looked for along the path of
/// equilibria, and given up where that turns back: a state on another branch, which it might have found by chance, is then not looked for.
#[derive(Debug, Clone, Default)]
pub(crate) struct KnownLimits {
    planes: Vec<Plane>,
    way: Option<Way>,
}

#[derive(Debug, Clone)]
struct Plane {
    m: Vec<f64>,
    /// Towards controls without an equilibrium.
    normal: Vec<f64>,
}

/// The straight way in the space of controls on which a limit point was met last, and states before it.
#[derive(Debug, Clone)]
struct Way {
    from: Vec<f64>,
    step: Vec<f64>,
    /// Shares of the way and their equilibria, in order.
    passed: Vec<(f64, State)>,
}

/// Distance of a control from a straight way, as a share of the length, up to which it lies on the way.
const MAX_OFFSET_RATIO: f64 = 1e-9;

impl KnownLimits {
    /// Notes a limit point on a step from a control, and the normal of the surface there, to whichever side.
    pub fn add(&mut self, at: &LimitAhead, from: &[f64], step: Vec<f64>, mut normal: Vec<f64>) {
        if dot(&normal, &step) < 0.0 {
            normal.iter_mut().for_each(|n| *n = -*n);
        }
        let mut m = from.to_vec();
        axpy(at.share, &step, &mut m);
        self.planes.insert(0, Plane { m, normal });
        self.planes.truncate(MAX_PLANES);
        let passed = at.passed[at.passed.len().saturating_sub(MAX_STATES)..].to_vec();
        self.way = Some(Way { from: from.to_vec(), step, passed });
    }

    /// Drops the states, which take memory, not the planes.
    pub fn forget_states(&mut self) {
        self.way = None;
    }

    /// The last state before a control on the way on which a limit point was met last.
    pub fn before(&self, from: &[f64], m: &[f64]) -> Option<&State> {
        let way = self.way.as_ref().filter(|way| way.from == from)?;
        let length = dot(&way.step, &way.step);
        let mut off = sub(m, from);
        let share = dot(&off, &way.step) / length;
        axpy(-share, &way.step, &mut off);
        let passed = way.passed.iter().rev().find(|(passed, _)| *passed <= share);
        passed.filter(|_| norm(&off) <= MAX_OFFSET_RATIO * length.sqrt()).map(|(_, state)| state)
    }

    /// Whether a step seems to lead beyond one of them.
    pub fn are_crossed(&self, from: &[f64], to: &[f64]) -> bool {
        self.planes.iter().any(|plane| plane.is_crossed(from, to))
    }

    /// Forgets those that a step seemed to cross: there was a state behind them.
    pub fn leave(&mut self, from: &[f64], to: &[f64]) {
        self.planes.retain(|plane| !plane.is_crossed(from, to));
    }
}

impl Plane {
    fn height(&self, m: &[f64]) -> f64 {
        dot(&self.normal, &sub(m, &self.m))
    }

    fn is_crossed(&self, from: &[f64], to: &[f64]) -> bool {
        let height = self.height(to);
        height > 0.0 && height > self.height(from)
    }
}
