//! Constraints of an ensemble: those of every member.

use super::Ensemble;
use crate::blocks::gather;
use crate::error::EnsembleError;
use crate::member::Member;
use crate::parcel::MemberValues;
use crate::point::{EnsemblePoint, EnsembleWorkspace, Sensitivity};
use nastic_control::{ControlError, Evaluated, Lagrangian, ReducedWorkspace};
use nastic_numeric::vector::axpy;
use nastic_opt::{Constrained, ConstraintGroup, Failed, Hessian};

impl Constrained for Ensemble {
    /// Every load case of every scenario keeps its own: groups `MEMBER/NAME`, member by member.
    fn constraints(&self) -> Vec<ConstraintGroup> {
        let of = |member: &Member| {
            let named = |group: ConstraintGroup| match member.name.as_str() {
                "" => group,
                member => ConstraintGroup { name: format!("{member}/{}", group.name), ..group },
            };
            member.problem.constraints().into_iter().map(named).collect::<Vec<_>>()
        };
        self.members.iter().flat_map(of).collect()
    }

    fn constraint_values(&self, point: &EnsemblePoint) -> Vec<f64> {
        point.values().into_iter().flat_map(|at| at.constraints).collect()
    }

    fn lagrangian_derivative(
        &self,
        point: &mut EnsemblePoint,
        y: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, Failed> {
        Ok(self.lagrangian_derivative_typed(point, y, workspace)?)
    }

    /// The work of their adjoints counts as that of the members' states.
    fn constraint_derivatives(
        &self,
        point: &mut EnsemblePoint,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<Vec<f64>>, Failed> {
        let count = self.constraint_values(point).len();
        let unit = |k: usize| (0..count).map(|i| if i == k { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        let rows = (0..count).map(|k| self.constraint_row(point, &unit(k), workspace));
        Ok(rows.collect::<Result<_, EnsembleError>>()?)
    }

    /// Costs and constraints of a member together, two linear solves; apart where the measure of risk is not linear.
    fn lagrangian_hessian_vector(
        &self,
        point: &EnsemblePoint,
        weights: [&[f64]; 2],
        along: (&[f64], Hessian),
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, Failed> {
        Ok(self.lagrangian_hessian_typed(point, weights, along.0, along.1, workspace)?)
    }
}

/// What of a member enters the sum `R(j) + y . c`: `factor * (costs * j + y . c)`.
struct Share {
    factor: f64,
    costs: bool,
    y: Vec<f64>,
    w: Vec<f64>,
}

impl Share {
    /// Of a cost of this weight; its adjoint is that of the cost itself where it can be.
    fn new(weight: f64, y: &[f64], w: &[f64]) -> Self {
        let factor = if weight != 0.0 { weight } else { 1.0 };
        let scaled = |x: &[f64]| x.iter().map(|x| x / factor).collect();
        Share { factor, costs: weight != 0.0, y: scaled(y), w: scaled(w) }
    }

    fn is_nothing(&self) -> bool {
        !self.costs && self.y.iter().chain(&self.w).all(|x| *x == 0.0)
    }
}

/// The derivative of a member's share with its adjoint state; none of a share of nothing.
fn sensitivity(
    share: Option<&Share>,
    at: Option<&Evaluated>,
    member: &Member,
    workspace: &mut ReducedWorkspace,
) -> Result<Sensitivity, ControlError> {
    let (Some(share), Some(at)) = (share.filter(|share| !share.is_nothing()), at) else { return Ok(None) };
    member.problem.lagrangian_sensitivity(at, Lagrangian { costs: share.costs, y: &share.y }, workspace).map(Some)
}

impl Ensemble {
    /// The shares of all members of this rank whose costs have these weights.
    fn shares(&self, point: &EnsemblePoint, [y, w]: [&[f64]; 2], weight: impl Fn(&Member) -> f64) -> Vec<Share> {
        let mut first = 0;
        let of = |(member, at): (&Member, MemberValues)| {
            let own = |x: &[f64]| x.get(first..first + at.constraints.len()).unwrap_or_default().to_vec();
            let share = Share::new(weight(member), &own(y), &own(w));
            first += at.constraints.len();
            share
        };
        let all: Vec<Share> = self.members.iter().zip(point.values()).map(of).collect();
        let own = self.ranks.own();
        all.into_iter().skip(own.start).take(own.len()).collect()
    }

    fn lagrangian_derivative_typed(
        &self,
        point: &mut EnsemblePoint,
        y: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let by_cost = self.risk.weights(&self.probabilities, &point.costs);
        let shares = self.shares(point, [y, &[]], |member| by_cost[member.scenario] * member.weight);
        let mut out = self.derivative_of(&shares, point, workspace)?;
        self.add_first_order(&mut out, point, workspace)?;
        Ok(out)
    }

    /// The derivative of `y . c`, of constraints alone: no digits are lost to a cost of another size.
    ///
    /// # Errors
    /// As [`derivative`](nastic_opt::Objective::derivative).
    pub fn constraint_derivative(
        &self,
        point: &EnsemblePoint,
        y: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let shares = self.shares(point, [y, &[]], |_| 0.0);
        self.derivative_of(&shares, &mut point.clone(), workspace)
    }

    fn derivative_of(
        &self,
        shares: &[Share],
        point: &mut EnsemblePoint,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let (known, first) = (&*point, self.ranks.own().start);
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let found = sensitivity(shares.get(index - first), known.member(index), member, workspace)?;
            // Without its costs it is no adjoint that a point is said to have.
            let costs = shares.get(index - first).is_some_and(|share| share.costs);
            Ok(found.map(|(derivative, adjoint)| (derivative, adjoint.filter(|_| costs))))
        };
        let (found, work) = self.side_by_side(workspace, of, |index, found| known.adjoint_work(index, found))?;
        let of = shares.iter().zip(&found);
        let out = self.sum(of.map(|(share, found)| Some((share.factor, found.as_ref()?.0.as_slice()))))?;
        point.take_adjoints(first, found, work);
        Ok(out)
    }

    /// The derivative of `y . c`, whose adjoints are not kept.
    fn constraint_row(
        &self,
        point: &mut EnsemblePoint,
        y: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let shares = self.shares(point, [y, &[]], |_| 0.0);
        let (known, first) = (&*point, self.ranks.own().start);
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            sensitivity(shares.get(index - first), known.member(index), member, workspace)
        };
        let work_of = |_: usize, found: &Sensitivity| Some(found.as_ref()?.1.as_ref()?.work);
        let (found, work) = self.side_by_side(workspace, of, work_of)?;
        let of = shares.iter().zip(&found);
        let out = self.sum(of.map(|(share, found)| Some((share.factor, found.as_ref()?.0.as_slice()))))?;
        point.add_work(&work);
        Ok(out)
    }

    fn lagrangian_hessian_typed(
        &self,
        point: &EnsemblePoint,
        weights: [&[f64]; 2],
        v: &[f64],
        which: Hessian,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        self.check_len(v)?;
        self.refuse_first_order()?;
        let bends = self.names.len() > 1 && !self.risk.is_linear();
        let by_cost = self.risk.weights(&self.probabilities, &point.costs);
        let weight = |member: &Member| if bends { 0.0 } else { by_cost[member.scenario] * member.weight };
        let shares = self.shares(point, weights, weight);
        let mut out = self.product_of(&shares, point, v, which, workspace)?;
        if bends {
            axpy(1.0, &self.second_derivative(point, v, which, workspace)?, &mut out);
        }
        Ok(out)
    }

    /// The product of the second derivative of `y . c`, of constraints alone, with a direction.
    ///
    /// # Errors
    /// As [`hessian_vector`](nastic_opt::Objective::hessian_vector).
    pub fn constraint_hessian_vector(
        &self,
        point: &EnsemblePoint,
        y: &[f64],
        v: &[f64],
        which: Hessian,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        self.check_len(v)?;
        let shares = self.shares(point, [y, &vec![0.0; y.len()]], |_| 0.0);
        self.product_of(&shares, point, v, which, workspace)
    }

    fn product_of(
        &self,
        shares: &[Share],
        point: &EnsemblePoint,
        v: &[f64],
        which: Hessian,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        let first = self.ranks.own().start;
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let share = shares.get(index - first).filter(|share| !share.is_nothing());
            let (Some(share), Some(at)) = (share, point.member(index)) else { return Ok(None) };
            let (of, along) = (Lagrangian { costs: share.costs, y: &share.y }, gather(&self.blocks, member, v));
            member.problem.lagrangian_second_derivative(at, of, &share.w, &along, which, workspace).map(Some)
        };
        let (found, _) = self.side_by_side(workspace, of, |_, _| ())?;
        self.sum(shares.iter().zip(&found).map(|(share, product)| Some((share.factor, product.as_deref()?))))
    }
}
