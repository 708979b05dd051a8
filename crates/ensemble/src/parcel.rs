//! [`Parcel`]: what ranks send each other of their members.

use nastic_control::{ControlError, ControlLimit, Evaluated, RemoteFailure};
use nastic_fem::{SolveReport, StateError};
use nastic_opt::saved::unpack;
use nastic_team::TeamError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// What is sent of a member to the other ranks.
pub trait Parcel: Serialize + DeserializeOwned {}

impl<T: Serialize + DeserializeOwned> Parcel for T {}

/// The whole message of a rank.
pub(crate) fn unpacked<T: DeserializeOwned>(rank: usize, bytes: &[u8]) -> Result<T, TeamError> {
    unpack(bytes).map_err(|_| TeamError::Unexpected { rank, what: "a report of another form" })
}

/// What all ranks know of a member that has been evaluated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MemberValues {
    /// Value of every cost term, weights included.
    pub terms: Vec<f64>,
    /// Value of every constraint.
    pub constraints: Vec<f64>,
    /// Work of the state solve.
    pub work: SolveReport,
    /// Work of the adjoint, once the derivative was taken.
    pub adjoint: Option<SolveReport>,
    /// The smallest J of its state; of a motion at the end.
    pub min_j: f64,
}

impl MemberValues {
    pub(crate) fn of(at: &Evaluated) -> Self {
        Self {
            terms: at.terms.clone(),
            constraints: at.constraints.clone(),
            work: at.work,
            adjoint: at.adjoint.as_ref().map(|adjoint| adjoint.work),
            min_j: at.state().report.min_j,
        }
    }

    /// Sum of the terms.
    pub fn cost(&self) -> f64 {
        self.terms.iter().sum()
    }

    /// Work of the state solve and, if there is one, of the adjoint.
    pub fn total_work(&self) -> SolveReport {
        let mut work = self.work;
        self.adjoint.iter().for_each(|adjoint| work.add_work(adjoint));
        work
    }
}

/// A failure as other ranks hear of it. Limit points and cancelled solves stay what they are; of others what a run asks of them is kept, and how
/// they read.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) enum ReportedFailure {
    LimitPoint { limit: ControlLimit, newton: usize },
    Cancelled,
    Other(RemoteFailure),
}

impl ReportedFailure {
    /// Of an error on a rank.
    pub fn of(rank: usize, error: &ControlError) -> Self {
        match error {
            ControlError::LimitPoint { limit, newton } => Self::LimitPoint { limit: limit.clone(), newton: *newton },
            ControlError::State(StateError::Cancelled) => Self::Cancelled,
            ControlError::Remote(failure) => Self::Other(RemoteFailure::clone(failure)),
            error => Self::Other(RemoteFailure {
                rank,
                message: error.to_string(),
                newton: error.newton(),
                lacks_memory: error.is_lack_of_memory(),
                lacks_second_derivatives: error.lacks_second_derivatives(),
            }),
        }
    }
}

impl From<ReportedFailure> for ControlError {
    fn from(failure: ReportedFailure) -> Self {
        match failure {
            ReportedFailure::LimitPoint { limit, newton } => Self::LimitPoint { limit, newton },
            ReportedFailure::Cancelled => Self::State(StateError::Cancelled),
            ReportedFailure::Other(failure) => Self::Remote(Box::new(failure)),
        }
    }
}
