//! The part of an ensemble's risk that its [`FirstOrder`] adds.

use super::Ensemble;
use crate::blocks::scatter;
use crate::error::EnsembleError;
use crate::first_order::{FirstOrder, FirstOrderPoint, VarianceShare};
use crate::member::Member;
use crate::point::{EnsemblePoint, EnsembleWorkspace};
use nastic_control::{ControlError, Evaluated, ReducedWorkspace};
use nastic_numeric::vector::axpy;

/// A member's point with its adjoint, and the derivatives of its cost.
struct Sensitive {
    at: Evaluated,
    by_control: Vec<f64>,
    by_number: Vec<f64>,
}

impl Ensemble {
    /// The risk of first order, if that is what it has.
    pub fn first_order(&self) -> Option<&FirstOrder> {
        self.first_order.as_ref()
    }

    /// The uncertain numbers by their shares of the variance at a point, the largest first; none of another risk.
    pub fn variance_shares(&self, point: &EnsemblePoint) -> Vec<VarianceShare> {
        self.first_order.iter().zip(&point.first_order).flat_map(|(of, at)| of.shares(at)).collect()
    }

    /// Adds mean and deviation of first order to a point, with the adjoints of its members.
    pub(super) fn with_first_order(
        &self,
        mut point: EnsemblePoint,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<EnsemblePoint, EnsembleError> {
        let Some(of) = &self.first_order else { return Ok(point) };
        if !self.ranks.is_alone() {
            let what = "members on several ranks; take one".to_owned();
            return Err(EnsembleError::FirstOrder { who: String::new(), what });
        }
        let known = &point;
        let each = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let mut at = point_of(known, index)?.clone();
            let [by_control, by_number] = member.problem.derivative_by_uncertain(&mut at, workspace)?;
            Ok(Sensitive { at, by_control, by_number })
        };
        let (found, _) = self.side_by_side(workspace, each, |_, _| ())?;
        let mut by_control = vec![0.0; self.len];
        let mut by_number = vec![0.0; found.first().map_or(0, |one| one.by_number.len())];
        point.members.clear();
        for (member, own) in self.members.iter().zip(found) {
            scatter(&self.blocks, member, member.weight, &own.by_control, &mut by_control);
            axpy(member.weight, &own.by_number, &mut by_number);
            point.members.push(own.at);
        }
        let at = of.point(point.risk, by_number, by_control);
        self.taken(&mut point, at);
        Ok(point)
    }

    /// Makes this the first order of a point.
    pub(super) fn taken(&self, point: &mut EnsemblePoint, at: FirstOrderPoint) {
        if let Some(of) = &self.first_order {
            point.risk = of.value(&at);
            point.first_order = Some(at);
        }
    }

    /// Adds the derivative of the risk beyond that of the cost; two linear solves for every member.
    pub(super) fn add_first_order(
        &self,
        out: &mut [f64],
        point: &EnsemblePoint,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<(), EnsembleError> {
        let (Some(of), Some(at)) = (&self.first_order, &point.first_order) else { return Ok(()) };
        let [of_cost, of_deviation] = of.factors(at);
        axpy(of_cost, &at.by_control, out);
        let along = of.along(at);
        let each = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            member.problem.mixed_second_derivative(point_of(point, index)?, &along, workspace)
        };
        let (found, _) = self.side_by_side(workspace, each, |_, _| ())?;
        for (member, own) in self.members.iter().zip(&found) {
            scatter(&self.blocks, member, of_deviation * member.weight, own, out);
        }
        Ok(())
    }

    /// Refuses second derivatives of a risk of first order, which have third ones of the cost.
    pub(super) fn refuse_first_order(&self) -> Result<(), EnsembleError> {
        match &self.first_order {
            None => Ok(()),
            Some(_) => Err(EnsembleError::NoThirdDerivatives),
        }
    }
}

fn point_of(point: &EnsemblePoint, index: usize) -> Result<&Evaluated, ControlError> {
    point.member(index).ok_or(ControlError::Length { found: point.members.len(), expected: index + 1 })
}
