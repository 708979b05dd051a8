//! Costs: how far a body is from the wish.

mod regularization;
mod smoothed_hausdorff;
mod tracking;

pub use regularization::{ControlNorm, ControlSmoothness};
pub use smoothed_hausdorff::{BoundHausdorff, SmoothedHausdorff};
pub use tracking::{BoundTracking, Target, Tracking};

use crate::error::ControlError;
use crate::layout::Layout;
use nastic_fem::Solid;
use std::fmt::Debug;

/// What a cost may look at.
#[derive(Clone, Copy)]
pub struct CostContext<'a> {
    /// The body.
    pub solid: &'a Solid,
    /// The control fields.
    pub layout: &'a Layout,
    /// Displacement, flat.
    pub u: &'a [f64],
    /// Control vector.
    pub m: &'a [f64],
    /// Continuation stage; a cost with fewer stages stays at its last.
    pub stage: usize,
}

/// Partial derivatives of a cost, to be added to.
#[derive(Debug, Clone, PartialEq)]
pub struct Partials {
    /// `dj/du`, flat, supported unknowns included.
    pub u: Vec<f64>,
    /// `dj/dm`.
    pub m: Vec<f64>,
}

/// A term of the objective, j(u, m), bound to a body.
///
/// Implement it for your own wish; the derivative through the state equation comes for free. Contract: `partials` is the
/// exact derivative of `value` (the same quadrature), and both are deterministic.
pub trait Cost: Debug + Send + Sync {
    /// Name of the term in tables and results.
    fn name(&self) -> &str;

    /// The value, weight included. Line searches need no more than this.
    ///
    /// # Errors
    /// Where the cost is not defined.
    fn value(&self, at: &CostContext) -> Result<f64, ControlError>;

    /// Adds the partial derivatives and returns the value.
    ///
    /// # Errors
    /// Where the cost is not defined.
    fn partials(&self, at: &CostContext, out: &mut Partials) -> Result<f64, ControlError>;

    /// Number of continuation stages.
    fn stages(&self) -> usize {
        1
    }

    /// Figures worth reporting beside the value, dearer than it (for accepted points alone): a true distance, say.
    ///
    /// # Errors
    /// Where they are not defined.
    fn figures(&self, _at: &CostContext) -> Result<Vec<(String, f64)>, ControlError> {
        Ok(vec![])
    }

    /// Things the user should know (a smoothing length below the point spacing, say).
    fn warnings(&self, _solid: &Solid) -> Vec<String> {
        vec![]
    }
}

/// What can become a cost once the body is known.
pub trait IntoCost {
    /// Looks up surfaces, samples the target, checks.
    ///
    /// # Errors
    /// Unknown names, empty targets, arrays of the wrong size.
    fn bind(self, solid: &Solid) -> Result<Box<dyn Cost>, ControlError>;
}

impl<C: Cost + 'static> IntoCost for C {
    fn bind(self, _: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        Ok(Box::new(self))
    }
}

/// A weight must be a positive number.
pub(crate) fn check_weight(what: &str, weight: f64) -> Result<f64, ControlError> {
    if weight.is_finite() && weight > 0.0 {
        return Ok(weight);
    }
    Err(ControlError::Cost { what: format!("{what} has weight {weight}; weights are positive numbers") })
}
