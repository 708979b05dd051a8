//! The trust-region subproblem: a quadratic model of the cost, minimised over the local model of an admissible set.

use crate::admissible::Face;
use crate::failed::Failed;
use crate::method::Current;
use crate::model::{Steepest, minimise};
use nastic_numeric::vector::{add, axpy, dot, scale, sub};

/// min q(d) = derivative . d + d . H d / 2 over steps d of the set's local model with |d| <= radius in the control's inner product.
///
/// Rounds of face identification: the bounds that the last round reached and whose multiplier keeps them are fixed; on the rest, conjugate
/// gradients in that product (Steihaug 1983) end at the tolerance, at the radius, or along a direction of negative curvature, which is followed to the radius;
/// their step is taken to the first bound that it meets, or to a point of its projection where q is lower. Where the set cuts off most of
/// the way to the radius, that way is left out and the step so far is the last: the rest would be bounds that are met one after the other.
/// q falls from round to round, from q(0) = 0.
///
/// Source: Lin and Moré (1999), "Newton's method for large bound-constrained optimization problems"; Steihaug (1983), "The conjugate
/// gradient method and trust regions in large scale optimization".
pub(crate) struct Subproblem<'a> {
    pub here: Current<'a>,
    pub radius: f64,
    /// The model's projected gradient is to fall to this share.
    pub forcing: f64,
    /// Products with H at most.
    pub max_products: usize,
}

/// A step with what the model says of it.
#[derive(Clone, Debug)]
pub(crate) struct ModelStep {
    pub d: Vec<f64>,
    /// H d.
    pub image: Vec<f64>,
    /// Whether the radius held it back.
    pub at_radius: bool,
}

impl ModelStep {
    /// q(t d).
    pub fn model(&self, derivative: &[f64], t: f64) -> f64 {
        t * dot(derivative, &self.d) + 0.5 * t * t * dot(&self.d, &self.image)
    }
}

/// Rounds of face identification.
const MAX_ROUNDS: usize = 50;
/// Restarts of a round with the bounds that its step would pass: each step meets fewer bounds.
const MAX_JOINS: usize = 2;
/// Points on the projection of a step that are tried.
const MAX_HALVINGS: usize = 4;
/// Least decrease of q there, as a share of the linear prediction.
const MIN_DECREASE_RATIO: f64 = 1e-4;

/// Least cosine between a step and the steepest descent for a line search along the step.
const MIN_DESCENT_COSINE: f64 = 1e-12;
/// Share of a step that may lie outside the set before conjugate gradients stop.
const MAX_OUTSIDE_SHARE: f64 = 0.2;

type Product<'p> = dyn FnMut(&[f64]) -> Result<Vec<f64>, Failed> + 'p;

impl Subproblem<'_> {
    /// A step, zero only at a stationary point.
    ///
    /// # Errors
    /// A product that failed.
    pub fn solve(&self, product: &mut Product) -> Result<ModelStep, Failed> {
        let n = self.here.m.len();
        let mut at = ModelStep { d: vec![0.0; n], image: vec![0.0; n], at_radius: false };
        let mut left = self.max_products;
        let mut first = None;
        for _ in 0..MAX_ROUNDS {
            let gradient = add(self.here.derivative, &at.image);
            let mut face = self.here.set.face(self.here.m, &at.d, &gradient);
            let size = self.here.metric.dual_norm(&face.projected(&gradient));
            let goal = self.forcing * *first.get_or_insert(size);
            if size <= goal || left == 0 || at.at_radius {
                break;
            }
            let mut joins = 0;
            let moved = loop {
                let moved = self.conjugate_gradient(&mut at, &face, &gradient, goal, &mut left, product)?;
                // Bounds that the step so far has reached and this one would pass are active too.
                let before = face.active();
                face.join(&self.here.set.face(self.here.m, &at.d, &moved.s.iter().map(|s| -s).collect::<Vec<_>>()));
                // After the last restart the step is kept as it is: it is taken no farther than its first bound, or where q falls.
                if face.active() == before || joins == MAX_JOINS {
                    break Some(moved);
                }
                joins += 1;
                if left == 0 {
                    break None;
                }
            };
            // The products are used up, and none is left for the face with these bounds.
            let Some(moved) = moved else { break };
            let last = moved.cut_short;
            let before = (at.d.clone(), at.image.clone());
            let falls = self.bring_back(&mut at, &face, &gradient, moved, &mut left, product)?;
            if dot(self.here.derivative, &at.d)
                >= -MIN_DESCENT_COSINE * self.here.metric.dual_norm(self.here.derivative) * self.here.metric.norm(&at.d)
            {
                // q fell by negative curvature alone: a line search would not find that it does.
                (at.d, at.image) = before;
                break;
            }
            if !falls || last {
                break;
            }
        }
        let stays = at.d.iter().all(|d| *d == 0.0);
        if stays && first.is_some_and(|size| size > 0.0) { self.gradient_step(product) } else { Ok(at) }
    }

    /// The projected gradient step as long as the radius: a descent direction for any H.
    ///
    /// # Errors
    /// A product that failed.
    pub fn gradient_step(&self, product: &mut Product) -> Result<ModelStep, Failed> {
        let Current { set, metric, m, derivative, .. } = self.here;
        let size = set.optimality(metric, m, derivative).norm;
        let curvature = Steepest { metric, step: if size > 0.0 { self.radius / size } else { 1.0 } };
        let d = minimise(set, metric, m, derivative, &curvature);
        let image = product(&d)?;
        Ok(ModelStep { d, image, at_radius: true })
    }

    /// The minimiser of q on the face of the step so far, relative to it: s and H s.
    fn conjugate_gradient(
        &self,
        at: &mut ModelStep,
        face: &Face,
        gradient: &[f64],
        goal: f64,
        left: &mut usize,
        product: &mut Product,
    ) -> Result<Moved, Failed> {
        let metric = self.here.metric;
        let precondition = |r: &[f64]| face.projected(&metric.riesz(r));
        let mut s = vec![0.0; gradient.len()];
        let mut image = s.clone();
        let mut r = face.projected(gradient);
        scale(-1.0, &mut r);
        let mut z = precondition(&r);
        let mut p = z.clone();
        let mut rz = dot(&r, &z);
        let mut cut_short = false;
        while *left > 0 && rz > 0.0 {
            *left -= 1;
            let hp = product(&p)?;
            let curvature = dot(&p, &hp);
            let whole = add(&at.d, &s);
            let to_radius = self.to_radius(&whole, &p);
            let alpha = if curvature > 0.0 { rz / curvature } else { f64::INFINITY };
            let step = alpha.min(to_radius);
            if curvature <= 0.0 && s.iter().any(|s| *s != 0.0) {
                let mut far = s.clone();
                axpy(step, &p, &mut far);
                if self.is_mostly_outside(face, &at.d, &far) {
                    cut_short = true;
                    break;
                }
            }
            axpy(step, &p, &mut s);
            axpy(step, &hp, &mut image);
            at.at_radius = step == to_radius;
            if at.at_radius {
                break;
            }
            axpy(-step, &face.projected(&hp), &mut r);
            if metric.dual_norm(&r) <= goal || self.is_mostly_outside(face, &at.d, &s) {
                break;
            }
            z = precondition(&r);
            let next = dot(&r, &z);
            for (p, z) in p.iter_mut().zip(&z) {
                *p = z + next / rz * *p;
            }
            rz = next;
        }
        Ok(Moved { s, image, cut_short })
    }

    /// Whether bringing the step back into the set would take away much of it: going on would be for nothing.
    fn is_mostly_outside(&self, face: &Face, d: &[f64], s: &[f64]) -> bool {
        let straight = add(d, s);
        let mut inside = straight.clone();
        self.restrict(face, &mut inside);
        self.here.metric.norm(&sub(&straight, &inside)) > MAX_OUTSIDE_SHARE * self.here.metric.norm(s)
    }

    /// The t >= 0 with |d + t p| = radius.
    fn to_radius(&self, d: &[f64], p: &[f64]) -> f64 {
        let metric = self.here.metric;
        let (pp, dp, dd) = (metric.inner(p, p), metric.inner(d, p), metric.inner(d, d));
        let room = (self.radius * self.radius - dd).max(0.0);
        if pp == 0.0 { 0.0 } else { ((dp * dp + pp * room).sqrt() - dp) / pp }
    }

    /// Brings a step back into the set, but where it is tangential at a curved boundary: there H has that curvature, of points that
    /// were at the boundary before the step.
    fn restrict(&self, face: &Face, d: &mut [f64]) {
        let unbent = d.to_vec();
        self.here.set.restrict(self.here.m, d);
        face.keep_tangential(&unbent, d);
    }

    /// Takes the step to the first bound, or further along its projection if q falls more there; false if q does not fall.
    fn bring_back(
        &self,
        at: &mut ModelStep,
        face: &Face,
        gradient: &[f64],
        Moved { mut s, mut image, .. }: Moved,
        left: &mut usize,
        product: &mut Product,
    ) -> Result<bool, Failed> {
        let set = self.here.set;
        let reach = set.reach(self.here.m, &at.d, &s);
        let straight = reach * dot(gradient, &s) + 0.5 * reach * reach * dot(&s, &image);
        let mut length = 1.0;
        for _ in 0..MAX_HALVINGS {
            let mut d = at.d.clone();
            axpy(length, &s, &mut d);
            let unbent = d.clone();
            self.restrict(face, &mut d);
            if *left == 0 || length <= reach && d == unbent {
                break;
            }
            let step = sub(&d, &at.d);
            let slope = dot(gradient, &step);
            if slope < 0.0 {
                *left -= 1;
                let step_image = product(&step)?;
                let change = slope + 0.5 * dot(&step, &step_image);
                if change <= straight.min(MIN_DECREASE_RATIO * slope) {
                    axpy(1.0, &step_image, &mut at.image);
                    at.d = d;
                    // Bent back, it may be far inside the radius.
                    at.at_radius &= self.here.metric.norm(&at.d) >= 0.99 * self.radius;
                    return Ok(true);
                }
            }
            length *= 0.5;
        }
        at.at_radius &= reach == 1.0;
        scale(reach, &mut s);
        scale(reach, &mut image);
        axpy(1.0, &s, &mut at.d);
        axpy(1.0, &image, &mut at.image);
        self.restrict(face, &mut at.d);
        Ok(straight < 0.0)
    }
}

/// A step on a face and its image under H.
struct Moved {
    s: Vec<f64>,
    image: Vec<f64>,
    /// Whether a direction of negative curvature was left out.
    cut_short: bool,
}
