//! [`Stop`] and `Iterate`: where an iteration stands, and why it stopped short.

use crate::model::ModelPoint;
use nastic_body::contribution::Sums;
use nastic_body::error::{Cause, Inadmissible, StateError};
use nastic_body::state::State;
use nastic_linear::LinearError;

/// Why an iteration stopped short.
#[derive(Debug)]
pub enum Stop {
    /// Outside of the admissible set.
    Inadmissible(Inadmissible),
    /// Progress was too small.
    Slow {
        /// Relative residual of the last iterate.
        residual: f64,
    },
    /// A body that is held by contact alone moves away, or finds no equilibrium.
    Lost {
        /// Relative residual of the last iterate.
        residual: f64,
    },
    /// All iterations that the solve was allowed are used up.
    Spent {
        /// Relative residual of the last iterate.
        residual: f64,
    },
    /// A linear system was not solved.
    Linear(LinearError),
    /// The caller has cancelled.
    Cancelled,
}

impl Stop {
    /// Whether no other way would mend it.
    pub fn is_final(&self) -> bool {
        match self {
            Stop::Cancelled | Stop::Spent { .. } => true,
            Stop::Linear(error) => error.is_lack_of_memory(),
            Stop::Inadmissible(at) => at.problem().is_some(),
            Stop::Slow { .. } | Stop::Lost { .. } => false,
        }
    }

    /// The error of what no other way would mend; a budget that is used up ends the way that is left, which shows how far it came.
    pub fn final_error(self) -> Option<StateError> {
        match self {
            Stop::Linear(error) if error.is_lack_of_memory() => Some(error.into()),
            Stop::Inadmissible(at) => at.problem().map(StateError::from),
            Stop::Cancelled => Some(StateError::Cancelled),
            _ => None,
        }
    }

    /// The error of a solve that cannot continue from a state.
    pub fn into_error(self, newton: usize, last: &State) -> StateError {
        let (load, last) = (last.load, Box::new(last.clone()));
        match self {
            Stop::Inadmissible(at) => StateError::inadmissible(at, load, 0, last),
            Stop::Linear(error) => error.into(),
            Stop::Slow { residual } | Stop::Lost { residual } | Stop::Spent { residual } => {
                let (reached, cause, budget) = (load, Cause::Unknown, None);
                StateError::NoConvergence { load, cuts: 0, newton, residual, reached, cause, budget, last }
            }
            Stop::Cancelled => StateError::Cancelled,
        }
    }
}

impl From<Inadmissible> for Stop {
    fn from(at: Inadmissible) -> Self {
        Stop::Inadmissible(at)
    }
}

impl From<LinearError> for Stop {
    fn from(error: LinearError) -> Self {
        Stop::Linear(error)
    }
}

/// Where an iteration stands.
pub(crate) struct Iterate<'a> {
    pub x: &'a [f64],
    pub now: &'a Sums,
    /// The model there: derivatives are taken from it.
    pub point: &'a ModelPoint<'a>,
    /// Free residual.
    pub residual: &'a [f64],
    /// Its norm relative to the sums of absolute forces.
    pub relative: f64,
}
