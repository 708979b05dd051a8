//! [`Ensemble`] as an optimiser sees it.

use super::Ensemble;
use crate::error::EnsembleError;
use crate::first_order::FirstOrderPoint;
use crate::member::Member;
use crate::parcel::ReportedFailure;
use crate::point::{EnsemblePoint, EnsembleWorkspace};
use crate::saved::SavedMembers;
use nastic_control::{ControlError, Layout, ReducedWorkspace};
use nastic_opt::{Failed, Hessian, InnerProduct, Objective, Problem, Request, Saved, SavedError, Summary};
use std::sync::Arc;

impl Objective for Ensemble {
    type Point = EnsemblePoint;
    type Workspace = EnsembleWorkspace;

    fn evaluate(
        &self,
        m: &[f64],
        how: &Request<'_, EnsemblePoint>,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<EnsemblePoint, Failed> {
        Ok(self.evaluate_typed(m, how, workspace)?)
    }

    fn value(&self, point: &EnsemblePoint) -> f64 {
        point.risk
    }

    /// Leaves the adjoint states in the members' points.
    fn derivative(&self, point: &mut EnsemblePoint, workspace: &mut EnsembleWorkspace) -> Result<Vec<f64>, Failed> {
        Ok(self.derivative_typed(point, workspace)?)
    }

    fn hessian_vector(
        &self,
        point: &EnsemblePoint,
        v: &[f64],
        which: Hessian,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, Failed> {
        Ok(match which {
            Hessian::Exact => Ensemble::hessian_vector(self, point, v, workspace)?,
            Hessian::GaussNewton => self.gauss_newton_vector(point, v, workspace)?,
        })
    }

    /// The failure of the member with the first limit point on the way, else the first one in order; failures that stop a run take precedence.
    fn jump(&self, from: &EnsemblePoint, to: &EnsemblePoint, workspace: &mut EnsembleWorkspace) -> Option<Failed> {
        let of = |index: usize, member: &Member, _: &mut ReducedWorkspace| {
            let points = from.member(index).zip(to.member(index));
            Ok(points.and_then(|(from, to)| member.problem.other_branch(from, to)))
        };
        // the rank of the member has the original error
        let rank = self.ranks.team().rank();
        let tell = |_: usize, found: &Option<ControlError>| found.as_ref().map(|why| ReportedFailure::of(rank, why));
        let (own, found) = match self.side_by_side(workspace, of, tell) {
            Ok(found) => found,
            Err(error @ EnsembleError::Team(_)) => return Some(error.into()),
            Err(_) => return None,
        };
        let mut found: Vec<Option<ControlError>> = found.into_iter().map(|why| why.map(ControlError::from)).collect();
        self.ranks.own().zip(own).for_each(|(index, own)| found[index] = own);
        let named = self.members.iter().zip(found);
        let all = named.filter_map(|(member, why)| Some(Failed::from(EnsembleError::member(&member.name, why?))));
        let order = |failed: &Failed| if failed.is_fatal() { -1.0 } else { failed.limit().unwrap_or(f64::INFINITY) };
        all.min_by(|a, b| order(a).total_cmp(&order(b)))
    }

    /// The most of any member; one with fewer stays at its last.
    fn stages(&self) -> usize {
        self.members.iter().map(|member| member.problem.stages()).max().unwrap_or(1)
    }

    fn restage(&self, stage: usize, point: &EnsemblePoint) -> Result<EnsemblePoint, Failed> {
        Ok(self.restage_typed(stage, point)?)
    }

    fn summary(&self, point: &EnsemblePoint) -> Summary {
        self.summary_of(point)
    }

    /// Those of the members, of each the largest.
    fn figures(&self, point: &EnsemblePoint) -> Summary {
        let mut out = Summary::default();
        let all = self.gathered(point, |index, at| self.members[index].problem.figures(at)).unwrap_or_default();
        for (name, value) in all.into_iter().flat_map(|own| own.0) {
            match out.0.iter_mut().find(|(known, _)| *known == name) {
                Some((_, most)) => *most = most.max(value),
                None => out.0.push((name, value)),
            }
        }
        out
    }

    /// On a team every rank has its own members alone: [`SavedMembers`].
    fn save(&self, point: &EnsemblePoint) -> Vec<u8> {
        let mut saved = SavedMembers::none(self.members.len());
        point.held().for_each(|(index, at)| saved.0[index] = self.members[index].problem.save(at));
        saved.0.extend(point.first_order.iter().map(FirstOrderPoint::to_bytes));
        saved.to_bytes()
    }

    /// Solves nothing; of a motion see [`Reduced`](nastic_control::Reduced). On a team a rank is sent those of its own members that it lacks by one that has them.
    fn load(&self, m: &[f64], bytes: &[u8], how: &Request<'_, EnsemblePoint>) -> Result<EnsemblePoint, Failed> {
        self.check_len(m)?;
        let SavedMembers(mut saved) = SavedMembers::from_bytes(bytes).map_err(Failed::new)?;
        let unfit = || Failed::new(SavedError::Unfit("it has another number of members, or another risk"));
        let behind =
            self.first_order().map(|_| saved.pop().and_then(|own| FirstOrderPoint::from_bytes(&own, self.len)));
        if saved.len() != self.members.len() {
            return Err(unfit());
        }
        let mut point = self.loaded(m, saved, how)?;
        if let Some(at) = behind {
            self.taken(&mut point, at.ok_or_else(unfit)?);
        }
        Ok(point)
    }
}

impl Problem for Ensemble {
    /// Every block once, in the product of the first member that uses it.
    fn inner_product(&self) -> Result<Arc<dyn InnerProduct>, Failed> {
        if self.len == 0 {
            let known = self.members.first().map(|member| Layout::names(member.problem.solid()).join(", "));
            return Err(ControlError::NoControls { known: known.unwrap_or_default() }.into());
        }
        Ok(self.product.clone())
    }
}

/// As the failure of the member.
impl From<EnsembleError> for Failed {
    fn from(error: EnsembleError) -> Self {
        match &error {
            EnsembleError::Member { source, .. } => {
                let failed = Failed::from(ControlError::clone(source));
                failed.told_by(error)
            }
            // nothing is said of the control
            EnsembleError::Team(_) => Failed::new(error).fatal(),
            _ => Failed::new(error),
        }
    }
}
