//! Quadratic models of the cost, minimised over the local model of the admissible set.

use crate::admissible::{Admissible, Face};
use crate::conjugate_gradient::conjugate_gradient;
use crate::inner_product::InnerProduct;
use nastic_numeric::vector::{add, axpy, dot, norm, scale, sub};

/// A symmetric positive definite bilinear form B, close to theta G.
pub(crate) trait Curvature {
    /// B v, a dual vector.
    fn apply(&self, v: &[f64]) -> Vec<f64>;
    /// B^-1 d, exactly or nearly.
    fn solve(&self, d: &[f64]) -> Vec<f64>;
    /// theta.
    fn size(&self) -> f64;
}

/// B = G/t: the model whose minimiser is the projected gradient step of length t.
pub(crate) struct Steepest<'a> {
    pub metric: &'a dyn InnerProduct,
    pub step: f64,
}

impl Curvature for Steepest<'_> {
    fn apply(&self, v: &[f64]) -> Vec<f64> {
        let mut out = self.metric.apply(v);
        scale(1.0 / self.step, &mut out);
        out
    }

    fn solve(&self, d: &[f64]) -> Vec<f64> {
        let mut out = self.metric.riesz(d);
        scale(self.step, &mut out);
        out
    }

    fn size(&self) -> f64 {
        1.0 / self.step
    }
}

/// Rounds of face identification.
const MAX_ROUNDS: usize = 25;
/// Ratio of the last to the first projected gradient of the model.
const GRADIENT_REDUCTION: f64 = 1e-4;
/// Halvings of a step within the model.
const MAX_HALVINGS: usize = 8;

/// A step d of the set's local model at m that (nearly) minimises q(d) = derivative . d + d . B d / 2.
///
/// Begins with the projected gradient step of length 1/theta, which is the answer for B = theta G in a lumped product.
/// Then Newton steps on faces: where the last step reached a bound and the model's gradient pushes on, that bound is
/// active; the rest is solved by conjugate gradients preconditioned with B^-1, and brought back into the set. q decreases
/// all the way from q(0) = 0, so d is a descent direction of the cost whenever it is not zero.
pub(crate) fn minimise(
    set: &dyn Admissible,
    metric: &dyn InnerProduct,
    m: &[f64],
    derivative: &[f64],
    b: &dyn Curvature,
) -> Vec<f64> {
    let model = Model { set, metric, m, derivative, b };
    let mut at = model.at(vec![0.0; m.len()]);
    let first = model.residual(&at).1;
    if first == 0.0 {
        return at.d;
    }
    if let Some(next) = model.gradient_step(&at) {
        at = next;
    }
    for _ in 0..MAX_ROUNDS {
        let (face, size) = model.residual(&at);
        if size <= GRADIENT_REDUCTION * first {
            break;
        }
        match model.newton_step(&at, &face).or_else(|| model.gradient_step(&at)) {
            Some(next) => at = next,
            None => break,
        }
    }
    at.d
}

struct Model<'a> {
    set: &'a dyn Admissible,
    metric: &'a dyn InnerProduct,
    m: &'a [f64],
    derivative: &'a [f64],
    b: &'a dyn Curvature,
}

/// A step, the model's gradient (dual) and value there.
struct At {
    d: Vec<f64>,
    gradient: Vec<f64>,
    value: f64,
}

impl Model<'_> {
    fn at(&self, d: Vec<f64>) -> At {
        let bd = self.b.apply(&d);
        let value = dot(self.derivative, &d) + 0.5 * dot(&d, &bd);
        At { gradient: add(self.derivative, &bd), value, d }
    }

    /// The face at d and the dual norm of the model's gradient on it.
    fn residual(&self, at: &At) -> (Face, f64) {
        let face = self.set.face(self.m, &at.d, &at.gradient);
        let size = self.metric.dual_norm(&face.projected(&at.gradient));
        (face, size)
    }

    /// A gradient step of length 1/theta, brought back into the set, then shortened to the best point of its segment. Where bringing back is not
    /// the projection in the metric (one that is not lumped, or weighs the components of a point differently) that may be no
    /// descent; then the step is along the Euclidean gradient, in whose product it is.
    fn gradient_step(&self, at: &At) -> Option<At> {
        let gradient = self.metric.riesz(&at.gradient);
        let length = 1.0 / self.b.size();
        self.step_along(at, &gradient, length).or_else(|| {
            let ratio = norm(&gradient) / norm(&at.gradient);
            self.step_along(at, &at.gradient, ratio * length)
        })
    }

    /// The best point on the segment from d to d - length v brought back into the set, if q is smaller there.
    fn step_along(&self, at: &At, v: &[f64], length: f64) -> Option<At> {
        let mut d = at.d.clone();
        axpy(-length, v, &mut d);
        self.set.restrict(self.m, &mut d);
        let mut step = sub(&d, &at.d);
        let slope = dot(&at.gradient, &step);
        let curvature = dot(&step, &self.b.apply(&step));
        if !(slope < 0.0 && curvature > 0.0) {
            return None;
        }
        if -slope < curvature {
            scale(-slope / curvature, &mut step);
            d = add(&at.d, &step);
        }
        Some(self.at(d)).filter(|next| next.value < at.value)
    }

    /// The minimiser on the face, brought back into the set; halved until the model decreases.
    fn newton_step(&self, at: &At, face: &Face) -> Option<At> {
        let mut rhs = face.projected(&at.gradient);
        scale(-1.0, &mut rhs);
        let apply = |v: &[f64]| face.projected(&self.b.apply(v));
        let precondition = |r: &[f64]| face.projected(&self.b.solve(r));
        let newton = conjugate_gradient(apply, precondition, &rhs, 1e-5, 200);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let mut d = at.d.clone();
            axpy(length, &newton, &mut d);
            self.set.restrict(self.m, &mut d);
            let slope = dot(&at.gradient, &sub(&d, &at.d));
            let next = self.at(d);
            if slope < 0.0 && next.value <= at.value + 1e-4 * slope {
                return Some(next);
            }
            length *= 0.5;
        }
        None
    }
}
