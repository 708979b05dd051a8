//! Constraints: conditions c(u, m) <= 0 or c(u, m) = 0 on state and control.

mod bound;
mod cost_limit;
mod obstacle_distance;

pub use bound::Bound;
pub use cost_limit::CostLimit;
pub use obstacle_distance::ObstacleDistance;

use crate::cost::{CostContext, MotionPartials, Partials};
use crate::time::Timeline;
use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_opt::ConstraintGroup;
use std::fmt::Debug;
use std::sync::Arc;

/// Constraints of one name bound to a body: one value c, or one for each of many points. What the augmented Lagrangian
/// ([`nastic_opt::AugmentedLagrangian`]) needs of them follows by one adjoint, as for [`Cost`](crate::Cost)s. Contract: as there.
pub trait Constraint: Debug + Send + Sync {
    /// Name, sense, number of values and scale; the same for every state.
    fn group(&self) -> ConstraintGroup;

    /// SI unit of the values; empty for plain numbers, and where it is not known.
    fn unit(&self) -> &'static str {
        ""
    }

    /// The bound on a functional that its only value comes from; `None` of other constraints.
    fn bound(&self) -> Option<Bound> {
        None
    }

    /// The nodes that its values belong to, in their order; none where they belong to none.
    fn nodes(&self) -> Option<&[u32]> {
        None
    }

    /// The smallest distance between nodes, for a distance constraint, which acts at nodes; `None` for other constraints.
    fn between_nodes(&self, _at: &CostContext) -> Option<BetweenNodes> {
        None
    }

    /// Whether they can hold in a motion, and at its beginning if they do there.
    ///
    /// # Errors
    /// What they need and the motion has not.
    fn check_in_motion(&self, _solid: &Solid, _timeline: &Timeline, _at_start: bool) -> Result<(), ControlError> {
        Ok(())
    }

    /// Whether they use [the step](CostContext::step) that led to a state.
    fn needs_step(&self) -> bool {
        false
    }

    /// Evaluated at a displacement and a control; `at.stage` does not matter.
    ///
    /// # Errors
    /// Where the constraint is not defined.
    fn at(&self, at: &CostContext) -> Result<Arc<dyn ConstraintPoint>, ControlError>;
}

/// The smallest signed distance from an obstacle at quadrature points of a body, which lie between its nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetweenNodes {
    /// Negative inside of the obstacle.
    pub distance: f64,
    /// Where the point of the deformed body is.
    pub position: [f64; 3],
}

/// Constraints evaluated at one (u, m). A value: it depends on nothing that changes.
pub trait ConstraintPoint: Debug + Send + Sync {
    /// The values c_k.
    fn values(&self) -> &[f64];

    /// Adds `sum_k y_k dc_k/du` and `sum_k y_k dc_k/dm`.
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn add_partials(&self, y: &[f64], out: &mut Partials) -> Result<(), ControlError>;

    /// The same of a state of a motion, as [`CostPoint::add_partials_in_motion`](crate::CostPoint::add_partials_in_motion).
    ///
    /// # Errors
    /// A derivative that is not finite.
    fn add_partials_in_motion(
        &self,
        y: &[f64],
        out: &mut Partials,
        _more: &mut MotionPartials,
    ) -> Result<(), ControlError> {
        self.add_partials(y, out)
    }

    /// The changes `dc_k` along a change `(du, v)`.
    ///
    /// # Errors
    /// As [`add_partials`](Self::add_partials).
    fn change(&self, along: &Partials) -> Result<Vec<f64>, ControlError>;

    /// Adds the change of `sum_k y_k dc_k/d(u, m)` along a change `(du, v)`.
    ///
    /// # Errors
    /// [`ControlError::NoSecondPartials`] of constraints without second derivatives.
    fn add_second_partials(&self, y: &[f64], along: &Partials, out: &mut Partials) -> Result<(), ControlError>;
}

/// What can become constraints once the body is known.
pub trait IntoConstraint {
    /// Looks up surfaces, checks.
    ///
    /// # Errors
    /// Unknown names, numbers that make no sense.
    fn bind(self, solid: &Solid) -> Result<Box<dyn Constraint>, ControlError>;
}

impl IntoConstraint for Box<dyn Constraint> {
    fn bind(self, _: &Solid) -> Result<Box<dyn Constraint>, ControlError> {
        Ok(self)
    }
}
