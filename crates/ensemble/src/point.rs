//! [`EnsemblePoint`] and [`EnsembleWorkspace`]: an evaluated control of an ensemble, and what it leaves for the next.

use crate::first_order::FirstOrderPoint;
use crate::parcel::MemberValues;
use nastic_control::{AdjointState, Evaluated, ReducedWorkspace};
use nastic_fem::SolveReport;
use nastic_opt::{EvaluatedStart, Start};

/// An evaluated control of an ensemble. A value.
#[derive(Debug, Clone)]
pub struct EnsemblePoint {
    /// The control vector.
    pub m: Vec<f64>,
    /// State and terms of every member that this rank has, in the order of [`Ensemble::members`](crate::Ensemble::members): of all, unless the
    /// ensemble is on a team; [`held`](Self::held) has their numbers.
    pub members: Vec<Evaluated>,
    /// Cost `j_s` of every scenario.
    pub costs: Vec<f64>,
    /// R of these.
    pub risk: f64,
    /// Of a risk of first order: mean and deviation.
    pub first_order: Option<FirstOrderPoint>,
    pub(crate) held: Held,
}

/// Which members a point has.
#[derive(Debug, Clone)]
pub(crate) enum Held {
    All,
    /// Those of this rank, from a number on, and the reports of all.
    Own {
        first: usize,
        reports: Vec<MemberValues>,
    },
}

impl EnsemblePoint {
    fn first(&self) -> usize {
        if let Held::Own { first, .. } = self.held { first } else { 0 }
    }

    /// Whether it has all members.
    pub fn is_whole(&self) -> bool {
        matches!(self.held, Held::All)
    }

    /// A member, by its number, if it is here.
    pub fn member(&self, index: usize) -> Option<&Evaluated> {
        self.members.get(index.checked_sub(self.first())?)
    }

    /// The members that are here, with their numbers.
    pub fn held(&self) -> impl ExactSizeIterator<Item = (usize, &Evaluated)> {
        let first = self.first();
        self.members.iter().enumerate().map(move |(k, at)| (first + k, at))
    }

    /// What is known of every member, here or not.
    pub fn values(&self) -> Vec<MemberValues> {
        match &self.held {
            Held::All => self.members.iter().map(MemberValues::of).collect(),
            Held::Own { reports, .. } => reports.clone(),
        }
    }

    /// Work of the state solve and of the adjoint of every member.
    pub fn work(&self) -> Vec<SolveReport> {
        match &self.held {
            Held::All => self.members.iter().map(Evaluated::total_work).collect(),
            Held::Own { reports, .. } => reports.iter().map(MemberValues::total_work).collect(),
        }
    }

    /// The work of the adjoint of a member, behind a derivative that gave it a new one or none.
    pub(crate) fn adjoint_work(&self, index: usize, new: &Sensitivity) -> Option<SolveReport> {
        let adjoint = match new {
            Some((_, adjoint)) => adjoint.as_ref(),
            None => self.member(index).and_then(|at| at.adjoint.as_ref()),
        };
        adjoint.map(|adjoint| adjoint.work)
    }

    /// Counts further work of every member as that of its state.
    pub(crate) fn add_work(&mut self, work: &[Option<SolveReport>]) {
        let own: Vec<&mut SolveReport> = match &mut self.held {
            Held::All => self.members.iter_mut().map(|at| &mut at.work).collect(),
            Held::Own { reports, .. } => reports.iter_mut().map(|report| &mut report.work).collect(),
        };
        own.into_iter().zip(work).for_each(|(own, work)| work.iter().for_each(|work| own.add_work(work)));
    }

    /// Takes over the adjoint states of the members from a number on, and their work of all.
    pub(crate) fn take_adjoints(&mut self, from: usize, found: Vec<Sensitivity>, work: Vec<Option<SolveReport>>) {
        let first = self.first();
        let own = self.members.iter_mut().skip(from - first);
        for (at, (_, adjoint)) in own.zip(found).filter_map(|(at, found)| Some((at, found?))) {
            at.adjoint = adjoint;
        }
        if let Held::Own { reports, .. } = &mut self.held {
            reports.iter_mut().zip(work).for_each(|(report, work)| report.adjoint = work);
        }
    }
}

/// The derivative of a member and its adjoint state; none of a member that has no weight.
pub(crate) type Sensitivity = Option<(Vec<f64>, Option<AdjointState>)>;

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

/// A workspace for every member of this rank.
#[derive(Debug, Default)]
pub struct EnsembleWorkspace {
    pub(crate) members: Vec<ReducedWorkspace>,
}

impl EnsembleWorkspace {
    /// Memory of the factors kept for the next solves, in bytes: at most one per member.
    pub fn factor_bytes(&self) -> usize {
        self.members.iter().map(ReducedWorkspace::factor_bytes).sum()
    }

    /// One for each member.
    pub(crate) fn of(&mut self, members: usize) -> &mut [ReducedWorkspace] {
        self.members.resize_with(members, ReducedWorkspace::default);
        &mut self.members
    }
}
