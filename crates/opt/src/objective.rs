//! What an optimiser asks of a problem.

use crate::failed::Failed;
use crate::held::Held;
use crate::hessian::Hessian;
use crate::inner_product::InnerProduct;
use crate::summary::Summary;
use std::sync::Arc;
use thiserror::Error;

/// How a trial is to be evaluated.
#[derive(Debug)]
pub struct Request<'a, P> {
    /// An evaluated point to start from (warm start): the last accepted one. Without one the evaluation starts from rest
    /// and from an empty workspace.
    pub near: Option<&'a P>,
    /// Relative accuracy asked of the state solve.
    pub accuracy: f64,
    /// The continuation stage whose value is asked for, below [`Objective::stages`].
    pub stage: usize,
    /// The work that the state solve may take before it is given up.
    pub budget: Budget,
}

/// Limit of the work of a state solve, in the unit of the objective: Newton iterations. A solve that reaches it fails.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Budget {
    /// No limit.
    #[default]
    Unlimited,
    /// This amount.
    Of(usize),
    /// A multiple of the work of the last accepted points, the one that it [starts near](Request::near) among them, and not less than the least
    /// budget of the objective; without such a point no limit.
    Times(f64),
}

impl Budget {
    /// The limit in units of work, by the work of accepted points, and at least `least`; `None` without a limit.
    pub fn work(self, accepted: Option<usize>, least: usize) -> Option<usize> {
        match (self, accepted) {
            (Self::Unlimited, _) | (Self::Times(_), None) => None,
            (Self::Of(most), _) => Some(most),
            // the conversion saturates where the product exceeds all integers
            (Self::Times(factor), Some(usual)) => Some(((factor * usual as f64).ceil() as usize).max(least)),
        }
    }
}

/// Default relative accuracy of state solves.
pub const DEFAULT_ACCURACY: f64 = 1e-8;

impl<P> Default for Request<'_, P> {
    fn default() -> Self {
        Self { near: None, accuracy: DEFAULT_ACCURACY, stage: 0, budget: Budget::Unlimited }
    }
}

impl<'a, P> Request<'a, P> {
    /// Starts from an evaluated point.
    pub fn near(point: &'a P) -> Self {
        Self { near: Some(point), ..Self::default() }
    }
}

impl<P> Clone for Request<'_, P> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P> Copy for Request<'_, P> {}

/// A cost j(m) of a control vector m. A *point* is an evaluated trial; its derivative is asked for only when the trial is
/// accepted.
///
/// Every method is a function of its arguments: the objective holds no current point and no current stage. Factors and
/// predictors for the next evaluation are in a [`Workspace`](Self::Workspace) that belongs to the caller, one per sequence
/// of evaluations. Results depend on it within [`Request::accuracy`] only, and the same sequence of calls gives the same
/// bits.
///
/// `&T` and `Arc<T>` are objectives if `T` is one, so that a run may borrow a problem, share it or own it.
pub trait Objective: Sync {
    /// An evaluated trial: the state, the value, and the data of a derivative.
    type Point;

    /// Data that one evaluation holds for the next; `()` if none.
    type Workspace: Default + Send;

    /// Evaluates the cost of stage `how.stage` at `m`.
    ///
    /// # Errors
    /// [`Failed`] when there is no value there; the driver tries a shorter step, or stops the run if the failure is
    /// [fatal](Failed::fatal).
    fn evaluate(
        &self,
        m: &[f64],
        how: &Request<'_, Self::Point>,
        workspace: &mut Self::Workspace,
    ) -> Result<Self::Point, Failed>;

    /// The cost at an evaluated point.
    fn value(&self, point: &Self::Point) -> f64;

    /// The derivative dj/dm_i at an evaluated point: a dual vector, not yet a gradient (see
    /// [`InnerProduct::riesz`]). The point may store intermediate results (an adjoint state, for output).
    ///
    /// # Errors
    /// [`Failed`] when the adjoint solve fails; the driver treats the trial as failed.
    fn derivative(&self, point: &mut Self::Point, workspace: &mut Self::Workspace) -> Result<Vec<f64>, Failed>;

    /// The second derivative of j at an evaluated point, applied to a direction v: `H v`, a dual vector. Symmetric:
    /// `w . H v = v . H w`.
    ///
    /// # Errors
    /// [`NoSecondDerivatives`] of an objective that has none (the default); [`Failed`] where their solve fails.
    fn hessian_vector(
        &self,
        _point: &Self::Point,
        _v: &[f64],
        _which: Hessian,
        _workspace: &mut Self::Workspace,
    ) -> Result<Vec<f64>, Failed> {
        Err(Failed::new(NoSecondDerivatives { objective: std::any::type_name::<Self>() }))
    }

    /// Whether the states of two evaluated points lie on different branches of the state equation, between which the cost is discontinuous, and why. It is called
    /// for a trial from `from` whose cost is too high; [`Failed::limit`] then shortens the step. `None` where the branch is the same or unknown (the default).
    fn jump(&self, _from: &Self::Point, _to: &Self::Point, _workspace: &mut Self::Workspace) -> Option<Failed> {
        None
    }

    /// Number of continuation stages, which differ in the value (alpha, beta, gamma of a smoothed distance), or in the state too (the sharpness of a projection of controls).
    fn stages(&self) -> usize {
        1
    }

    /// The same control with the value of another stage, and the state of that stage where controls have stages.
    ///
    /// # Errors
    /// [`Failed`] when that stage has no value there, or no state.
    fn restage(&self, stage: usize, point: &Self::Point) -> Result<Self::Point, Failed>;

    /// The values of those constraints that the method is to hold itself, relative to their scales; none by default.
    fn held_values(&self, _point: &Self::Point) -> Vec<f64> {
        Vec::new()
    }

    /// The same with their derivatives and that of the cost, without multipliers; `None` by default: there are none.
    ///
    /// # Errors
    /// As [`derivative`](Self::derivative).
    fn held(&self, _point: &mut Self::Point, _workspace: &mut Self::Workspace) -> Result<Option<Held>, Failed> {
        Ok(None)
    }

    /// Numbers of this point for a line of the history.
    fn summary(&self, _point: &Self::Point) -> Summary {
        Summary::default()
    }

    /// Further numbers of an accepted point, more expensive than its value, such as distances from targets
    /// ([`TRUE_DISTANCE`](crate::TRUE_DISTANCE)). Reports of a run call it, the run itself never does.
    fn figures(&self, _point: &Self::Point) -> Summary {
        Summary::default()
    }

    /// The logical or of `here` over all ranks that make the same calls, each with its own optimiser, the same on all of them: a driver calls it before each
    /// trial to agree on cancellation. The default is a single rank.
    ///
    /// # Errors
    /// [Fatal](Failed::fatal) ones, where messages to other ranks fail.
    fn any(&self, here: bool) -> Result<bool, Failed> {
        Ok(here)
    }

    /// A point as bytes for a checkpoint. The default saves nothing, and [`Objective::load`] evaluates the point again.
    fn save(&self, _point: &Self::Point) -> Vec<u8> {
        Vec::new()
    }

    /// The point that [`Objective::save`] wrote. For a resumed run to have the same bits, later results must not depend
    /// on whether a point was computed or loaded. The default evaluates `m` from rest, which gives the same bits only if
    /// values do not depend on the warm start.
    ///
    /// # Errors
    /// [`Failed`] when the bytes are not a point of this objective, or the evaluation fails.
    fn load(&self, m: &[f64], _bytes: &[u8], how: &Request<'_, Self::Point>) -> Result<Self::Point, Failed> {
        self.evaluate(m, how, &mut Self::Workspace::default())
    }
}

/// An objective without second derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the objective gives no second derivatives; take a method that needs first ones alone (lbfgs, spectral, projected_gradient); in the library: `Objective::hessian_vector` of {objective}"
)]
pub struct NoSecondDerivatives {
    /// Type of the objective.
    pub objective: &'static str,
}

/// An objective that knows the inner product of its control space.
pub trait Problem: Objective {
    /// The inner product (a, b) = a . G b; its length is the number of controls.
    ///
    /// # Errors
    /// [`Failed`] when it cannot be built. There is no fallback.
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed>;
}

/// Forwards every method to the target of `$self`.
macro_rules! forward {
    ($(($($generics:tt)*) $pointer:ty;)*) => {$(
        impl<$($generics)*> Objective for $pointer {
            type Point = T::Point;
            type Workspace = T::Workspace;

            fn evaluate(
                &self,
                m: &[f64],
                how: &Request<'_, T::Point>,
                workspace: &mut T::Workspace,
            ) -> Result<T::Point, Failed> {
                (**self).evaluate(m, how, workspace)
            }

            fn value(&self, point: &T::Point) -> f64 {
                (**self).value(point)
            }

            fn derivative(&self, point: &mut T::Point, workspace: &mut T::Workspace) -> Result<Vec<f64>, Failed> {
                (**self).derivative(point, workspace)
            }

            fn hessian_vector(
                &self,
                point: &T::Point,
                v: &[f64],
                which: Hessian,
                workspace: &mut T::Workspace,
            ) -> Result<Vec<f64>, Failed> {
                (**self).hessian_vector(point, v, which, workspace)
            }

            fn jump(&self, from: &T::Point, to: &T::Point, workspace: &mut T::Workspace) -> Option<Failed> {
                (**self).jump(from, to, workspace)
            }

            fn stages(&self) -> usize {
                (**self).stages()
            }

            fn restage(&self, stage: usize, point: &T::Point) -> Result<T::Point, Failed> {
                (**self).restage(stage, point)
            }

            fn held_values(&self, point: &T::Point) -> Vec<f64> {
                (**self).held_values(point)
            }

            fn held(&self, point: &mut T::Point, workspace: &mut T::Workspace) -> Result<Option<Held>, Failed> {
                (**self).held(point, workspace)
            }

            fn summary(&self, point: &T::Point) -> Summary {
                (**self).summary(point)
            }

            fn figures(&self, point: &T::Point) -> Summary {
                (**self).figures(point)
            }

            fn any(&self, here: bool) -> Result<bool, Failed> {
                (**self).any(here)
            }

            fn save(&self, point: &T::Point) -> Vec<u8> {
                (**self).save(point)
            }

            fn load(&self, m: &[f64], bytes: &[u8], how: &Request<'_, T::Point>) -> Result<T::Point, Failed> {
                (**self).load(m, bytes, how)
            }
        }
    )*};
}

forward! {
    (T: Objective + ?Sized) &T;
    (T: Objective + Send + ?Sized) Arc<T>;
}

impl<T: Problem + ?Sized> Problem for &T {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        (**self).inner_product()
    }
}

impl<T: Problem + Send + ?Sized> Problem for Arc<T> {
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        (**self).inner_product()
    }
}
