//! Admissible sets: boxes, spheres, balls, and products of them.

mod ball;
mod bounds;
mod catalogue;
mod face;
mod product;
mod sphere;

pub use ball::Ball;
pub use bounds::{Bounds, Limit};
pub use catalogue::{CATALOGUE, SetRow};
pub use face::Face;
pub use product::Product;
pub use sphere::Sphere;

use crate::inner_product::InnerProduct;
use std::fmt::Debug;
use thiserror::Error;

/// A control that is not admissible.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("control component {index} is {value:e}, which is outside: {allowed}")]
pub struct Outside {
    /// Which component (or the first of the point).
    pub index: usize,
    /// Its value (or the norm at the point).
    pub value: f64,
    /// What is allowed there.
    pub allowed: String,
}

/// Why an admissible set was refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SetError {
    /// A lower bound above its upper bound, or a bound that is not a number.
    #[error("bounds of component {index} are crossed or not numbers: lower {lower:e}, upper {upper:e}")]
    Crossed {
        /// Which component (0 when the bounds are uniform).
        index: usize,
        /// Lower bound.
        lower: f64,
        /// Upper bound.
        upper: f64,
    },
    /// Lists of bounds of different lengths.
    #[error("{lower} lower bounds but {upper} upper bounds")]
    Lengths {
        /// Number of lower bounds.
        lower: usize,
        /// Number of upper bounds.
        upper: usize,
    },
    /// A radius that is not a positive number.
    #[error("the radius must be positive and finite, not {0:e}")]
    Radius(f64),
    /// Vectors of a dimension that is not 1, 2 or 3.
    #[error("vectors per point must have 1, 2 or 3 components, not {0}")]
    Dimension(usize),
    /// A block whose length is not a multiple of its vectors' dimension.
    #[error("a block of {len} components cannot hold vectors of {dim}")]
    Ragged {
        /// Components in the block.
        len: usize,
        /// Components per vector.
        dim: usize,
    },
}

/// Bounds of every component of a control; infinite ones are no bounds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Intervals {
    /// The lower ones.
    pub lower: Vec<f64>,
    /// The upper ones.
    pub upper: Vec<f64>,
}

/// A set that is more than bounds of components.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("control component {index} is one of {what}, which bounds do not describe")]
pub struct NotBounds {
    /// The first component that is not alone.
    pub index: usize,
    /// What it is one of.
    pub what: String,
}

/// The projected gradient's size and the constraints that act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optimality {
    /// Norm, in the metric, of the gradient on the face of free directions: zero exactly at a stationary point.
    pub norm: f64,
    /// Number of active bounds.
    pub active: usize,
}

/// The set a control must stay in. Methods take whole control vectors; those of a block of a [`Product`] see their
/// block alone.
///
/// Around a point m, a set offers a *local model*: the steps d with m + d in the set for convex sets (box, ball), the
/// tangent space for a sphere. Optimisers minimise quadratic models over it and come back by [`Admissible::retract`].
pub trait Admissible: Debug + Send + Sync {
    /// Whether m is admissible.
    ///
    /// # Errors
    /// The first component that is not, and what would be.
    fn check(&self, m: &[f64]) -> Result<(), Outside>;

    /// The nearest admissible control in every lumped product whose weights agree over the components of one point.
    fn project(&self, m: &mut [f64]);

    /// The nearest step of the local model at m, in the same products as [`Admissible::project`].
    fn restrict(&self, m: &[f64], d: &mut [f64]);

    /// The tangential part of v at m: v itself in a flat set, v - (v.n) n on a sphere. Derivatives and directions alike.
    fn tangent(&self, m: &[f64], v: &mut [f64]);

    /// The admissible curve m(t) with m(0) = m and m'(0) = d for d of the local model; a straight line in a convex set
    /// for t <= 1. Always admissible, whatever t.
    fn retract(&self, m: &[f64], d: &[f64], t: f64, out: &mut [f64]);

    /// Adds `derivative . m''(0)` as a bilinear form of the direction, `m(t)` the curve of [`Admissible::retract`] along v: what the set's
    /// own curvature adds to the second derivative of a cost with this (whole, not only tangential) derivative. Nothing in a flat set.
    fn add_curvature(&self, _m: &[f64], _derivative: &[f64], _v: &[f64], _out: &mut [f64]) {}

    /// Carries a tangential vector from one admissible control to another.
    fn transport(&self, _from: &[f64], to: &[f64], v: &mut [f64]) {
        self.tangent(to, v);
    }

    /// The largest t <= 1 with d + t s in the local model at m, which d is in; points that d holds at a curved boundary are left out.
    fn reach(&self, _m: &[f64], _d: &[f64], _s: &[f64]) -> f64 {
        1.0
    }

    /// The free directions of the local model at m + d, given the derivative there: a bound is active when the step has
    /// reached it and minus the derivative points out of it.
    fn face(&self, m: &[f64], d: &[f64], derivative: &[f64]) -> Face;

    /// Makes d a direction along which m(t) is smooth up to t = 1: turned inward at bounds, tangential on a sphere.
    fn inward(&self, m: &[f64], d: &mut [f64]);

    /// The set of controls of `len` components as bounds of each, where that is what it is.
    ///
    /// # Errors
    /// [`NotBounds`] of a set that bends or couples components (the default).
    fn intervals(&self, _len: usize) -> Result<Intervals, NotBounds> {
        Err(NotBounds { index: 0, what: format!("{self:?}") })
    }

    /// Natural size of a change of each component: the width of a box, a radius; zero where the set has none.
    fn extent(&self, m: &[f64]) -> Vec<f64>;

    /// Size of the gradient on the face at m: sqrt(d_F . (G_FF)^-1 d_F), d_F the derivative on the free directions. In a
    /// lumped product this is the norm of minus the gradient projected onto the tangent cone.
    fn optimality(&self, metric: &dyn InnerProduct, m: &[f64], derivative: &[f64]) -> Optimality {
        let face = self.face(m, &vec![0.0; m.len()], derivative);
        Optimality { norm: metric.norm(&face.gradient(metric, derivative)), active: face.active() }
    }
}

/// Checks the dimension of vectors and the radius they are measured by.
fn check_radius(dim: usize, radius: f64) -> Result<(), SetError> {
    if !(1..=3).contains(&dim) {
        return Err(SetError::Dimension(dim));
    }
    if radius.is_finite() && radius > 0.0 { Ok(()) } else { Err(SetError::Radius(radius)) }
}
