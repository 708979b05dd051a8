//! Newton's method with conjugate gradients within a trust region and an admissible set, with the exact second derivative or Gauss-Newton's.

use crate::failed::Failed;
use crate::hessian::Hessian;
use crate::method::{Current, HessianProducts, Memory, Method};
use crate::optimizer::{Optimizer, Options};
use crate::trust_region::{ModelStep, Subproblem};
use nastic_numeric::vector::sub;

/// Trust-region Newton method. Each iteration minimises the quadratic model of the cost over the local model of the set by conjugate gradients
/// (Steihaug 1983; active bounds fixed, see Lin and Moré 1999), as far as `forcing` asks; the step is shortened by backtracking where the
/// cost does not fall (Nocedal and Yuan 1998, "Combining trust region and line search techniques"), and the radius follows the ratio of the
/// cost's decrease to the model's.
///
/// It needs products with second derivatives ([`Objective::hessian_vector`](crate::Objective::hessian_vector)): two linear solves each with the
/// factor of the accepted state, where a trial takes a whole equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct NewtonCg {
    /// When to stop, and what to ask of evaluations.
    pub options: Options,
    /// Which second derivative.
    pub hessian: Hessian,
    /// The model's projected gradient is reduced to `min(forcing, sqrt(relative))` of the cost's, `relative` the projected gradient's norm
    /// relative to the stage's first: so the steps become exact as the run converges. More than 0.5 counts as 0.5.
    pub forcing: f64,
    /// Products with the second derivative per iteration, at most.
    pub max_products: usize,
}

impl NewtonCg {
    /// With the exact second derivative.
    pub fn exact() -> Self {
        Self { options: Options::default(), hessian: Hessian::Exact, forcing: 0.1, max_products: 100 }
    }

    /// With the linearised state: for tracking costs.
    pub fn gauss_newton() -> Self {
        Self { hessian: Hessian::GaussNewton, ..Self::exact() }
    }
}

impl Optimizer for NewtonCg {
    fn name(&self) -> &'static str {
        match self.hessian {
            Hessian::Exact => "newton_cg",
            Hessian::GaussNewton => "gauss_newton",
        }
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn method(&self) -> Box<dyn Method> {
        let Self { hessian, forcing, max_products, .. } = *self;
        Box::new(TrustRegion {
            hessian,
            forcing,
            max_products,
            first_step: 0.0,
            first: 0.0,
            radius: 0.0,
            step: None,
            gradient_alone: false,
        })
    }
}

#[derive(Clone, Debug)]
struct TrustRegion {
    hessian: Hessian,
    forcing: f64,
    max_products: usize,
    /// A sensible length t of a first step -t gradient.
    first_step: f64,
    /// Norm of the stage's first derivative; 0 before it.
    first: f64,
    radius: f64,
    step: Option<ModelStep>,
    /// After a search that found nothing along the model's step.
    gradient_alone: bool,
}

/// Largest share of the projected gradient that the solution of a model may leave.
const MAX_FORCING: f64 = 0.5;

impl TrustRegion {
    /// First radius over the length of the first gradient step: the model is better than a gradient, and a trial too far costs one evaluation.
    const FIRST_RADIUS_RATIO: f64 = 10.0;
    /// Ratio of actual to predicted decrease below which the radius shrinks.
    const SHRINK_RATIO: f64 = 0.25;
    /// Ratio of decreases above which the radius grows.
    const GROWTH_RATIO: f64 = 0.75;
    /// Factor by which the radius grows.
    const RADIUS_GROWTH: f64 = 4.0;
}

impl Method for TrustRegion {
    fn restart(&mut self, step: f64, _cost: f64) {
        (self.first_step, self.first, self.radius, self.step) = (step, 0.0, 0.0, None);
        self.gradient_alone = false;
    }

    fn prepare(&mut self, here: &Current<'_>, hessian: &mut dyn HessianProducts) -> Result<(), Failed> {
        let size = here.set.optimality(here.metric, here.m, here.derivative).norm;
        if self.first == 0.0 {
            self.first = size;
            self.radius = Self::FIRST_RADIUS_RATIO * self.first_step * size;
        }
        let subproblem = Subproblem {
            here: *here,
            radius: self.radius,
            forcing: self.forcing.min(MAX_FORCING).min((size / self.first).sqrt()),
            max_products: self.max_products.max(1),
        };
        let mut product = |v: &[f64]| hessian.product(v, self.hessian);
        self.step = Some(match self.gradient_alone {
            true => subproblem.gradient_step(&mut product)?,
            false => subproblem.solve(&mut product)?,
        });
        Ok(())
    }

    fn trial(&self, here: &Current<'_>, fraction: f64) -> Vec<f64> {
        let mut out = here.m.to_vec();
        if let Some(step) = &self.step {
            here.set.retract(here.m, &step.d, fraction, &mut out);
        }
        out
    }

    fn step(&self, fraction: f64) -> f64 {
        fraction
    }

    fn accepted(&mut self, from: &Current<'_>, to: &Current<'_>, fraction: f64, _trials: usize) {
        self.gradient_alone = false;
        let Some(step) = &self.step else { return };
        let predicted = step.model(from.derivative, fraction);
        let length = to.metric.norm(&sub(to.m, from.m));
        let ratio = (to.cost - from.cost) / predicted;
        if predicted.abs() <= 10.0 * f64::EPSILON * from.cost.abs() {
            return;
        }
        if ratio < Self::SHRINK_RATIO {
            self.radius = 0.5 * length;
        } else if fraction < 1.0 {
            self.radius = length;
        } else if ratio > Self::GROWTH_RATIO && step.at_radius {
            self.radius = self.radius.max(Self::RADIUS_GROWTH * length);
        }
    }

    fn recover(&mut self) -> bool {
        !std::mem::replace(&mut self.gradient_alone, true)
    }

    fn save(&self) -> Memory {
        Memory { numbers: vec![self.first_step, self.first, self.radius], vectors: vec![] }
    }

    fn load(&mut self, memory: &Memory) -> bool {
        let [first_step, first, radius] = memory.numbers[..] else { return false };
        (self.first_step, self.first, self.radius) = (first_step, first, radius);
        memory.vectors.is_empty() && first_step > 0.0 && first >= 0.0 && radius >= 0.0
    }
}
