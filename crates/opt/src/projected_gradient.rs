//! Projected gradient with Armijo backtracking along the projection arc.

use crate::failed::Failed;
use crate::method::{Current, HessianProducts, Memory, Method, Secant};
use crate::model::{Steepest, minimise};
use crate::optimizer::{Optimizer, Options};

/// The survey's algorithm 1: m(t) = P(m - t G^-1 dj), t shortened until Armijo's test j(m(t)) <= j(m) + 1e-4 dj.(m(t) - m) holds
/// ([`LineSearch`](crate::LineSearch)). P is the projection in the control's inner product G: clamping when it is lumped, an active-set solve when
/// it is not. The cost never rises.
///
/// First trial of an iteration, with the step s and the change y of the derivative in the last one (y dual): the shorter length of Barzilai and Borwein
/// (1988), `t = s.y / y.G^-1 y`, one over a mean of the curvatures met that weighs the largest most. Where s.y <= 0 it is twice the length
/// accepted last; of the first iteration of a run, that of [`Options::first_move`]. Nothing else is remembered: shortening for one trial, also one
/// that failed, does not shorten those of later iterations.
///
/// Against doubling the length after every first trial that was accepted (near 2/L, L the largest curvature, where iterates zigzag) it takes
/// a third to a sixth of the iterations on bodies and fewer trials for each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProjectedGradient {
    /// When to stop, and what to ask of evaluations.
    pub options: Options,
}

impl Optimizer for ProjectedGradient {
    fn name(&self) -> &'static str {
        "projected_gradient"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn method(&self) -> Box<dyn Method> {
        Box::new(ProjectionArc { step: 0.0 })
    }
}

/// The step length of the next first trial.
#[derive(Clone, Debug)]
struct ProjectionArc {
    step: f64,
}

impl ProjectionArc {
    /// Growth of the step where the curvature of the cost is not positive.
    const STEP_GROWTH: f64 = 2.0;
}

impl Method for ProjectionArc {
    fn restart(&mut self, step: f64, _cost: f64) {
        self.step = step;
    }

    fn prepare(&mut self, _: &Current<'_>, _: &mut dyn HessianProducts) -> Result<(), Failed> {
        Ok(())
    }

    fn trial(&self, here: &Current<'_>, fraction: f64) -> Vec<f64> {
        let curvature = Steepest { metric: here.metric, step: self.step(fraction) };
        let d = minimise(here.set, here.metric, here.m, here.derivative, &curvature);
        let mut out = here.m.to_vec();
        here.set.retract(here.m, &d, 1.0, &mut out);
        out
    }

    fn step(&self, fraction: f64) -> f64 {
        self.step * fraction
    }

    fn slack(&self, _cost: f64) -> f64 {
        0.0
    }

    fn accepted(&mut self, from: &Current<'_>, to: &Current<'_>, fraction: f64, _trials: usize) {
        let secant = Secant::between(from, to);
        self.step = if secant.is_convex() { secant.sy / secant.yy } else { Self::STEP_GROWTH * fraction * self.step };
    }

    fn save(&self) -> Memory {
        Memory { numbers: vec![self.step], vectors: Vec::new() }
    }

    fn load(&mut self, memory: &Memory) -> bool {
        match memory.numbers[..] {
            [step] if step > 0.0 => self.step = step,
            _ => return false,
        }
        memory.vectors.is_empty()
    }
}
