//! Why a run, or a stage of it, ended.

use crate::failed::Failed;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Why it ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Stop {
    /// The projected gradient is small enough.
    Converged {
        /// Its norm in the metric.
        gradient_norm: f64,
        /// That of the stage's first point.
        first: f64,
        /// The tolerance that it met.
        tolerance: Tolerance,
    },
    /// No further decrease is to be had.
    Stalled(Stall),
    /// The iterations are used up.
    MaxIterations {
        /// How many were done.
        iterations: usize,
        /// The projected gradient's norm relative to the stage's first.
        relative_gradient: f64,
    },
    /// The constraints cannot be met from here: ten times the penalty, several times over, hardly changes their violation. The point is
    /// (nearly) a stationary point of the squared violation.
    Infeasible {
        /// The constraint that is violated most, relative to its scale.
        constraint: String,
        /// Which of its values, from 0.
        index: usize,
        /// The largest violation, relative to its scale.
        violation: f64,
        /// The penalty reached, as a multiple of the first.
        penalty: f64,
        /// Norm of the projected gradient of half the squared violations (relative to their scales) in the metric.
        gradient: f64,
    },
    /// One of several runs was stopped before its end, since another is ahead of what it may yet reach.
    Outperformed {
        /// Its cost.
        cost: f64,
        /// The cost that it may yet reach, extrapolated from its own decrease.
        within_reach: f64,
        /// The lowest cost of all runs at that time.
        best: f64,
    },
    /// The cancellation flag was raised.
    Cancelled,
    /// An evaluation failed for a reason that has nothing to do with the control ([`Failed::is_fatal`]). The run stands before the
    /// step in which that happened, as after a cancellation.
    Aborted(Failed),
}

/// On the projected gradient's norm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Tolerance {
    /// Relative to that of the stage's first point.
    Relative(f64),
    /// On the norm itself.
    Absolute(f64),
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Relative(tolerance) => write!(f, "tolerance {tolerance:.1e}"),
            Self::Absolute(tolerance) => write!(f, "absolute tolerance {tolerance:.1e}"),
        }
    }
}

/// How a run stalled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Stall {
    /// Changes of the cost are below its rounding.
    Flat {
        /// The cost.
        cost: f64,
        /// The predicted change of a step of this iteration.
        predicted: f64,
        /// The projected gradient's norm relative to the stage's first.
        relative_gradient: f64,
    },
    /// No trial of a line search was good enough.
    LineSearch {
        /// Trials made in this iteration.
        trials: usize,
        /// How many of them could not be evaluated.
        failed: usize,
        /// The shortest move tried, in the metric's norm.
        shortest: f64,
        /// What became of the last.
        last: String,
        /// The projected gradient's norm relative to the stage's first.
        relative_gradient: f64,
    },
    /// The cost decreases too slowly.
    Stagnation {
        /// Over how many iterations.
        window: usize,
        /// How much it fell in them.
        decrease: f64,
        /// How much it fell since the stage began.
        total: f64,
        /// The projected gradient's norm relative to the stage's first.
        relative_gradient: f64,
    },
    /// The second derivatives that the method needs cannot be had at this point.
    SecondDerivatives {
        /// What the objective said.
        why: Failed,
    },
    /// The next stage has no value at this point.
    Stage {
        /// Which stage.
        stage: usize,
        /// What the objective said.
        why: Failed,
    },
}

impl Stop {
    /// Whether the run was interrupted, and may continue.
    pub fn is_interrupted(&self) -> bool {
        matches!(self, Self::Cancelled | Self::Aborted(_))
    }

    /// Whether the run's own test was met.
    pub fn is_converged(&self) -> bool {
        matches!(self, Self::Converged { .. })
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Converged { gradient_norm, first, tolerance } => write!(
                f,
                "converged: projected gradient {gradient_norm:.3e}, {:.1e} of the first ({tolerance})",
                if *first > 0.0 { gradient_norm / first } else { 0.0 }
            ),
            Self::Stalled(stall) => write!(f, "stalled: {stall}"),
            Self::MaxIterations { iterations, relative_gradient } => write!(
                f,
                "stopped after {iterations} iterations: projected gradient {relative_gradient:.1e} of the first"
            ),
            Self::Infeasible { constraint, index, violation, penalty, gradient } => write!(
                f,
                "infeasible: the largest violation of the constraints, value {index} of \"{constraint}\", stays {violation:.3e} of its scale, with {penalty:.0e} times the \
                 first penalty; gradient of the squared violation {gradient:.1e} (constraints that contradict each other or the \
                 bounds? a start from which they cannot be met? try another start, wider bounds, a looser constraint)"
            ),
            Self::Outperformed { cost, within_reach, best } => write!(
                f,
                "stopped early: the cost {cost:.3e} may yet fall to {within_reach:.3e}, extrapolated from its own decrease; another run is \
                 at {best:.3e}"
            ),
            Self::Cancelled => write!(f, "cancelled"),
            Self::Aborted(why) => write!(f, "aborted: {why}"),
        }
    }
}

impl fmt::Display for Stall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flat { cost, predicted, relative_gradient } => write!(
                f,
                "the predicted change {predicted:.1e} of a step is below the rounding of the cost {cost:.6e}; \
                 projected gradient {relative_gradient:.1e} of the first"
            ),
            Self::LineSearch { trials, failed, shortest, last, relative_gradient } => write!(
                f,
                "no decrease in {trials} trials ({failed} failed) down to a move of {shortest:.1e}; last: {last}; \
                 projected gradient {relative_gradient:.1e} of the first (a derivative that is wrong, or a cost \
                 evaluated too coarsely? try the gradient check, or a finer accuracy)"
            ),
            Self::Stagnation { window, decrease, total, relative_gradient } => write!(
                f,
                "the cost fell by {decrease:.1e} in {window} iterations, of {total:.1e} in all; \
                 projected gradient {relative_gradient:.1e} of the first"
            ),
            Self::SecondDerivatives { why } => {
                write!(f, "the method needs second derivatives, and has none here: {why}; \"lbfgs\" does without")
            }
            Self::Stage { stage, why } => write!(f, "stage {stage} cannot begin here: {why}"),
        }
    }
}
