//! Projected gradient with Armijo backtracking along the projection arc.

use crate::failed::Failed;
use crate::method::{Current, HessianProducts, Memory, Method};
use crate::model::{Steepest, minimise};
use crate::optimizer::{Optimizer, Options};

/// The survey's algorithm 1: m(t) = P(m - t gradient), t halved (or shortened by a parabola) until Armijo's test holds,
/// and begun at twice the last length when that was accepted at once. P is the projection in the control's inner product:
/// clamping when it is lumped, an active-set solve when it is not. The cost never rises.
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
    /// Growth of the step after an iteration whose first trial was accepted.
    const GROWTH: f64 = 2.0;
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

    fn accepted(&mut self, _from: &Current<'_>, _to: &Current<'_>, fraction: f64, trials: usize) {
        self.step *= if trials == 1 { Self::GROWTH } else { fraction };
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
