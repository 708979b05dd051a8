//! [`TrajectoryCost`]: a term of the objective functional that depends on a whole motion.

use crate::time::Timeline;
use nastic_fem::{Solid, StatePartials, Trajectory};
use nastic_fields::{ControlError, Layout};
use std::fmt::Debug;

/// The arguments of a cost of a motion.
#[derive(Clone, Copy)]
pub struct TrajectoryContext<'a> {
    /// The body.
    pub solid: &'a Solid,
    /// The control fields, those in time with the values of all their knots.
    pub layout: &'a Layout,
    /// The instants.
    pub timeline: &'a Timeline,
    /// The states, one for each instant; of a motion that keeps few states ([`MotionMemory`](crate::MotionMemory)) a part of them.
    pub trajectory: &'a Trajectory,
    /// Control vector.
    pub m: &'a [f64],
    /// Continuation stage.
    pub stage: usize,
}

/// Partial derivatives of a cost of a motion, to be added to.
#[derive(Debug, Clone, PartialEq)]
pub struct TrajectoryPartials {
    /// By displacement and velocity, for each instant.
    pub states: Vec<StatePartials>,
    /// By the control vector.
    pub m: Vec<f64>,
}

impl TrajectoryPartials {
    /// Zero, for these numbers of instants and controls.
    pub fn zero(instants: usize, m: usize) -> Self {
        TrajectoryPartials { states: vec![StatePartials::default(); instants], m: vec![0.0; m] }
    }
}

/// A term `j(y_0, .., y_N; m)` of the objective of a motion, bound to a body. Contract: `add_partials` adds the exact
/// derivative of `value`, and both are deterministic.
pub trait TrajectoryCost: Debug + Send + Sync {
    /// Name of the term in tables and results.
    fn name(&self) -> &str;

    /// Whether it can be evaluated on such a problem.
    ///
    /// # Errors
    /// A control it does not find, an invalid instant.
    fn check(&self, _layout: &Layout, _timeline: &Timeline) -> Result<(), ControlError> {
        Ok(())
    }

    /// Whether it uses states; otherwise motions may store few of them.
    fn needs_states(&self) -> bool {
        true
    }

    /// j, weight included.
    ///
    /// # Errors
    /// Where it is not defined.
    fn value(&self, at: &TrajectoryContext) -> Result<f64, ControlError>;

    /// Adds its partial derivatives.
    ///
    /// # Errors
    /// Where they are not defined.
    fn add_partials(&self, at: &TrajectoryContext, out: &mut TrajectoryPartials) -> Result<(), ControlError>;
}
