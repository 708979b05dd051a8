//! [`Optimizer`]: a method with its options, those that all share.

use crate::admissible::{Admissible, NotBounds};
use crate::line_search::LineSearch;
use crate::method::Method;
use crate::objective::DEFAULT_ACCURACY;
use crate::within::Within;
use std::fmt::Debug;
use thiserror::Error;

/// What all optimisers share. Every default is dimensionless: none depends on the unit system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The last stage has converged when the projected gradient's norm in the metric, relative to the stage's first, is
    /// no larger.
    pub tolerance: f64,
    /// The last stage has converged also where that norm itself is no larger (0: it never is): a run from the end of another, whose
    /// first gradient is small, stops at once when given the norm at which that one ended.
    pub absolute_tolerance: f64,
    /// `tolerance` for the stages before the last; `tolerance` if that is larger.
    pub stage_tolerance: f64,
    /// Iterations of the whole run. Stage s of S may use at most its share, (what is left)/(S - s); what a stage does
    /// not use goes to those after it.
    pub max_iterations: usize,
    /// Length of the first step of a run, as a share of the set's extent (both in the metric's norm); it is not longer
    /// than the step |j|/|gradient|^2, at which a linear model of the cost reaches zero.
    pub first_move: f64,
    /// A stage stagnates when over `window` iterations the cost falls by less than `stagnation` times its fall since the
    /// stage began, and the projected gradient finds no new minimum.
    pub stagnation: f64,
    /// See `stagnation`.
    pub window: usize,
    /// Relative accuracy asked of state solves, at the end: see [`accuracy_at`](Self::accuracy_at).
    pub accuracy: f64,
    /// Limit of the work of a trial's state solve over that of the last accepted ones: see [`Budget::Times`](crate::Budget::Times).
    pub patience: f64,
    /// How steps are accepted and shortened.
    pub line_search: LineSearch,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-4,
            absolute_tolerance: 0.0,
            stage_tolerance: 1e-2,
            max_iterations: 100,
            first_move: 0.1,
            stagnation: 1e-5,
            window: 10,
            accuracy: DEFAULT_ACCURACY,
            patience: MAX_NEWTON_RATIO,
            line_search: LineSearch::default(),
        }
    }
}

/// Newton iterations of a trial over those of the last accepted ones.
const MAX_NEWTON_RATIO: f64 = 3.0;
/// Accuracy of states per remaining share of the projected gradient.
const ACCURACY_PER_GRADIENT: f64 = 1e-5;
/// Coarsest accuracy of states.
const MAX_STATE_ACCURACY: f64 = 1e-7;

impl Options {
    /// Relative accuracy asked of trials while the projected gradient is `relative` of the stage's first: as far below as
    /// `1e-5 relative`, between `1e-7` and [`accuracy`](Self::accuracy). Far from the optimum more is of no use.
    pub fn accuracy_at(&self, relative: f64) -> f64 {
        // not `clamp`, which panics where an accuracy is NaN
        (ACCURACY_PER_GRADIENT * relative).min(MAX_STATE_ACCURACY).max(self.accuracy)
    }
}

/// A problem that a method is not made for.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Unfit {
    /// A set that is more than bounds.
    #[error("{set}; \"{method}\" takes bounds alone: keep these components fixed, or take \"lbfgs\"")]
    Set {
        /// The method.
        method: &'static str,
        /// What it met.
        set: NotBounds,
    },
    /// A component without a range.
    #[error(
        "control component {index} lies between {lower:e} and {upper:e}; \"{method}\" moves a component by a share of its range: give it both bounds, \
         or take \"lbfgs\""
    )]
    Range {
        /// The method.
        method: &'static str,
        /// Which component.
        index: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// A constraint c = 0.
    #[error(
        "the constraint \"{constraint}\" asks for c = 0; \"{method}\" holds c <= 0 alone: take \"lbfgs\", or a bound from one side"
    )]
    Equality {
        /// The method.
        method: &'static str,
        /// The constraint's name.
        constraint: String,
    },
}

/// An optimiser: a method with its options. Several runs at once may share one.
pub trait Optimizer: Debug + Sync {
    /// The name in case files.
    fn name(&self) -> &'static str;

    /// When to stop, and what to ask of evaluations.
    fn options(&self) -> &Options;

    /// The strategy, with an empty memory.
    fn method(&self) -> Box<dyn Method>;

    /// Whether its method holds constraints itself: [`AugmentedLagrangian`](crate::AugmentedLagrangian) then gives it their values and derivatives
    /// in place of multipliers around it.
    fn holds_constraints(&self) -> bool {
        false
    }

    /// Whether its method is made for controls of `len` components in this set.
    ///
    /// # Errors
    /// [`Unfit`], what is in the way.
    fn check_set(&self, _set: &dyn Admissible, _len: usize) -> Result<(), Unfit> {
        Ok(())
    }

    /// This optimiser within a set, to be given a problem and a start: see [`Within`].
    fn within(self, set: impl Admissible + 'static) -> Within<Self>
    where
        Self: Sized,
    {
        Within::new(self, set)
    }
}

/// An optimiser chosen at run time is one too.
impl<T: Optimizer + ?Sized> Optimizer for Box<T> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn options(&self) -> &Options {
        (**self).options()
    }

    fn method(&self) -> Box<dyn Method> {
        (**self).method()
    }

    fn holds_constraints(&self) -> bool {
        (**self).holds_constraints()
    }

    fn check_set(&self, set: &dyn Admissible, len: usize) -> Result<(), Unfit> {
        (**self).check_set(set, len)
    }
}
