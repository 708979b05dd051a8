//! [`EnsemblePoint`] and [`EnsembleWorkspace`]: an evaluated control of an ensemble, and what it leaves for the next.

use crate::evaluated::Evaluated;
use crate::workspace::ReducedWorkspace;
use nastic_opt::{EvaluatedStart, Start};

/// An evaluated control of an ensemble. A value.
#[derive(Debug, Clone)]
pub struct EnsemblePoint {
    /// The control vector.
    pub m: Vec<f64>,
    /// Every member's state and terms, in the order of [`Ensemble::members`](super::Ensemble::members).
    pub members: Vec<Evaluated>,
    /// Cost `j_s` of every scenario.
    pub costs: Vec<f64>,
    /// R of these.
    pub risk: f64,
}

impl From<EnsemblePoint> for Start<EnsemblePoint> {
    fn from(point: EnsemblePoint) -> Self {
        Start::Evaluated(EvaluatedStart { m: point.m.clone(), point, derivative: None })
    }
}

impl From<&EnsemblePoint> for Start<EnsemblePoint> {
    fn from(point: &EnsemblePoint) -> Self {
        point.clone().into()
    }
}

/// A workspace for every member.
#[derive(Debug, Default)]
pub struct EnsembleWorkspace {
    pub(super) members: Vec<ReducedWorkspace>,
}

impl EnsembleWorkspace {
    /// Memory of the factors kept for the next solves, in bytes: at most one per member.
    pub fn factor_bytes(&self) -> usize {
        self.members.iter().map(ReducedWorkspace::factor_bytes).sum()
    }

    /// One for each of so many members.
    pub(super) fn of(&mut self, members: usize) -> &mut [ReducedWorkspace] {
        self.members.resize_with(members, ReducedWorkspace::default);
        &mut self.members
    }
}
