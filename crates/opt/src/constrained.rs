//! [`Constrained`]: an objective with constraints on what it computes.

use crate::failed::Failed;
use crate::hessian::Hessian;
use crate::objective::{NoSecondDerivatives, Objective};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use thiserror::Error;

/// What a constraint asks of its values c.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sense {
    /// `c <= 0`
    AtMost,
    /// `c = 0`
    Equal,
}

impl Sense {
    /// By how much a value violates it: `max(0, c)` or `|c|`.
    pub fn violation(self, c: f64) -> f64 {
        match self {
            Self::AtMost => c.max(0.0),
            Self::Equal => c.abs(),
        }
    }
}

/// Constraints of one kind and name: one value, or one for each of many points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstraintGroup {
    /// Its name in results.
    pub name: String,
    /// What is asked of its values.
    pub sense: Sense,
    /// How many values it has.
    pub len: usize,
    /// A value that counts as one, > 0, in the values' own unit: violations are measured in it (the body's length for distances,
    /// the bound for a functional).
    pub scale: f64,
}

/// An objective j(m) with constraints c_k(m) <= 0 or c_k(m) = 0 that a point knows the values of: conditions on the state, which no
/// [`Admissible`](crate::Admissible) set can hold, since trials violate them. [`AugmentedLagrangian`](crate::AugmentedLagrangian)
/// minimises it, by multipliers around a method or by a method that [holds them itself](crate::Optimizer::holds_constraints).
///
/// The values belong to the point: of one state the same in all continuation stages, others where [`restage`](Objective::restage) leads to another state.
pub trait Constrained: Objective {
    /// All groups; the values of a point stand in their order. The same for every point; empty without constraints.
    fn constraints(&self) -> Vec<ConstraintGroup>;

    /// The values c_k at an evaluated point, group by group.
    fn constraint_values(&self, point: &Self::Point) -> Vec<f64>;

    /// `dj/dm + sum_k y_k dc_k/dm`, a dual vector: one adjoint solve for the sum. With y = 0 the same bits as
    /// [`Objective::derivative`].
    ///
    /// # Errors
    /// As [`Objective::derivative`].
    fn lagrangian_derivative(
        &self,
        point: &mut Self::Point,
        y: &[f64],
        workspace: &mut Self::Workspace,
    ) -> Result<Vec<f64>, Failed>;

    /// The derivatives `dc_k/dm`, a dual vector for each value: an adjoint solve for each that depends on the state.
    ///
    /// # Errors
    /// [`NoConstraintDerivatives`] of an objective that gives sums alone (the default); else as [`Objective::derivative`].
    fn constraint_derivatives(
        &self,
        _point: &mut Self::Point,
        _workspace: &mut Self::Workspace,
    ) -> Result<Vec<Vec<f64>>, Failed> {
        Err(Failed::new(NoConstraintDerivatives { objective: std::any::type_name::<Self>() }))
    }

    /// `(d2j/dm2 + sum_k y_k d2c_k/dm2 + sum_k w_k dc_k/dm dc_k/dm^T) v`, a dual vector; with Gauss-Newton's second derivatives if so asked.
    ///
    /// # Errors
    /// [`NoSecondDerivatives`] of an objective that has none (the default); [`Failed`] where they cannot be had.
    fn lagrangian_hessian_vector(
        &self,
        _point: &Self::Point,
        [_y, _w]: [&[f64]; 2],
        (_v, _which): (&[f64], Hessian),
        _workspace: &mut Self::Workspace,
    ) -> Result<Vec<f64>, Failed> {
        Err(Failed::new(NoSecondDerivatives { objective: std::any::type_name::<Self>() }))
    }
}

/// An objective that gives derivatives of sums of constraints alone.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the objective gives no derivative of every single constraint; take a method with multipliers around it (lbfgs); in the library: \
     `Constrained::constraint_derivatives` of {objective}"
)]
pub struct NoConstraintDerivatives {
    /// Type of the objective.
    pub objective: &'static str,
}

/// Passes every method on to what `$pointer` points to.
macro_rules! forward {
    ($(($($generics:tt)*) $pointer:ty;)*) => {$(
        impl<$($generics)*> Constrained for $pointer {
            fn constraints(&self) -> Vec<ConstraintGroup> {
                (**self).constraints()
            }

            fn constraint_values(&self, point: &T::Point) -> Vec<f64> {
                (**self).constraint_values(point)
            }

            fn lagrangian_derivative(
                &self,
                point: &mut T::Point,
                y: &[f64],
                workspace: &mut T::Workspace,
            ) -> Result<Vec<f64>, Failed> {
                (**self).lagrangian_derivative(point, y, workspace)
            }

            fn constraint_derivatives(
                &self,
                point: &mut T::Point,
                workspace: &mut T::Workspace,
            ) -> Result<Vec<Vec<f64>>, Failed> {
                (**self).constraint_derivatives(point, workspace)
            }

            fn lagrangian_hessian_vector(
                &self,
                point: &T::Point,
                weights: [&[f64]; 2],
                along: (&[f64], Hessian),
                workspace: &mut T::Workspace,
            ) -> Result<Vec<f64>, Failed> {
                (**self).lagrangian_hessian_vector(point, weights, along, workspace)
            }
        }
    )*};
}

forward! {
    (T: Constrained + ?Sized) &T;
    (T: Constrained + Send + ?Sized) Arc<T>;
}
