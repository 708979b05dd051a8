//! Costs: terms j(u, m) of the objective functional.

mod bound_hausdorff;
mod catalogue;
mod cost_form;
mod figure;
mod regularization;
mod smoothed_hausdorff;
mod tracking;

pub use bound_hausdorff::BoundHausdorff;
pub use catalogue::{CATALOGUE, CostExample, CostRow};
pub use cost_form::{CostForm, MakeCost};
pub use figure::{Figure, FigureKind};
pub use regularization::{ControlNorm, ControlSmoothness};
pub use smoothed_hausdorff::SmoothedHausdorff;
pub use tracking::{BoundTracking, Target, Tracking};

use crate::error::ControlError;
use crate::layout::Layout;
use nastic_fem::Solid;
use std::fmt::Debug;
use std::sync::Arc;

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

/// Partial derivatives of a cost, to be added to; also a change of what they are by.
#[derive(Debug, Clone, PartialEq)]
pub struct Partials {
    /// `dj/du`, flat, supported unknowns included; of a change, that of u.
    pub u: Vec<f64>,
    /// `dj/dm`; of a change, that of m.
    pub m: Vec<f64>,
}

impl Partials {
    /// Zero, for so many displacements and controls.
    pub fn zero(u: usize, m: usize) -> Self {
        Partials { u: vec![0.0; u], m: vec![0.0; m] }
    }
}

/// A term of the objective, j(u, m), bound to a body.
///
/// Implement it for your own target; the derivative through the state equation comes for free. Contract: `add_partials`
/// of a [`CostPoint`] is the exact derivative of its `value` (the same quadrature), `add_second_partials`, where it is
/// implemented, that of `add_partials`, and all are deterministic.
pub trait Cost: Debug + Send + Sync {
    /// Name of the term in tables and results.
    fn name(&self) -> &str;

    /// The cost evaluated at a displacement and a control: its value, and what its partials and figures need of what the
    /// value took. The point outlives the context; a line search drops it, an accepted trial asks it for its partials.
    ///
    /// # Errors
    /// Where the cost is not defined.
    fn at(&self, at: &CostContext) -> Result<Arc<dyn CostPoint>, ControlError>;

    /// Number of continuation stages.
    fn stages(&self) -> usize {
        1
    }

    /// What decides how long it takes, for whoever looks at a problem before solving it: its numbers of points, say.
    fn size(&self) -> Option<String> {
        None
    }

    /// Things the user should know (a smoothing length below the point spacing, say).
    fn warnings(&self, _solid: &Solid) -> Vec<String> {
        vec![]
    }
}

/// A cost evaluated at one (u, m). A value: it depends on nothing that changes.
pub trait CostPoint: Debug + Send + Sync {
    /// j(u, m), weight included.
    fn value(&self) -> f64;

    /// Adds `dj/du` and `dj/dm`.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn add_partials(&self, out: &mut Partials) -> Result<(), ControlError>;

    /// Adds the change of `dj/du` and `dj/dm` along a change `(du, v)`: `j_uu du + j_um v` and `j_mu du + j_mm v`.
    ///
    /// # Errors
    /// [`ControlError::NoSecondPartials`] where the cost does not implement it (the default).
    fn add_second_partials(&self, _along: &Partials, _out: &mut Partials) -> Result<(), ControlError> {
        Err(ControlError::NoSecondPartials { cost: std::any::type_name::<Self>() })
    }

    /// Figures worth reporting beside the value, more expensive than it: for accepted points alone.
    ///
    /// # Errors
    /// Where they are not defined.
    fn figures(&self) -> Result<Vec<Figure>, ControlError> {
        Ok(vec![])
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

impl IntoCost for Box<dyn Cost> {
    fn bind(self, _: &Solid) -> Result<Box<dyn Cost>, ControlError> {
        Ok(self)
    }
}

/// A weight must be a positive number.
pub(crate) fn check_weight(what: &str, weight: f64) -> Result<f64, ControlError> {
    if weight.is_finite() && weight > 0.0 {
        return Ok(weight);
    }
    Err(ControlError::Cost { what: format!("{what} has weight {weight}; weights are positive numbers") })
}
