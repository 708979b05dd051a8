//! Second derivatives of the risk over an ensemble.

use super::Ensemble;
use crate::blocks::gather;
use crate::error::EnsembleError;
use crate::member::Member;
use crate::point::{EnsemblePoint, EnsembleWorkspace};
use nastic_control::{ReducedWorkspace, SecondDerivative};
use nastic_numeric::vector::{axpy, dot, scale};
use nastic_opt::Hessian;

impl Ensemble {
    /// `d2jhat/dm2 v` at an evaluated point, `jhat = R(j_1, .., j_n)`:
    ///
    /// ```text
    /// sum_s (dR/dj_s) d2j_s/dm2 v + sum_s (sum_t d2R/dj_s dj_t (dj_t/dm . v)) dj_s/dm
    /// ```
    ///
    /// two linear solves for every member; see [`Reduced::hessian_vector`](nastic_control::Reduced::hessian_vector).
    ///
    /// # Errors
    /// The first member, in order, without second derivatives; a measure of risk that has none there.
    pub fn hessian_vector(
        &self,
        point: &EnsemblePoint,
        v: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        self.second_derivative(point, v, Hessian::Exact, workspace)
    }

    /// The same with every member's state linearised; see [`Reduced::gauss_newton_vector`](nastic_control::Reduced::gauss_newton_vector).
    ///
    /// # Errors
    /// As there; a measure of risk that has no second derivatives there.
    pub fn gauss_newton_vector(
        &self,
        point: &EnsemblePoint,
        v: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        self.second_derivative(point, v, Hessian::GaussNewton, workspace)
    }

    pub(super) fn second_derivative(
        &self,
        point: &EnsemblePoint,
        v: &[f64],
        which: Hessian,
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        self.check_len(v)?;
        self.refuse_first_order()?;
        let bends = self.names.len() > 1 && !self.risk.is_linear();
        let by_cost = self.risk.weights(&self.probabilities, &point.costs);
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let along = gather(&self.blocks, member, v);
            match point.member(index) {
                Some(at) if bends || by_cost[member.scenario] != 0.0 => {
                    let found = member.problem.second_derivative(at, None, &along, which, bends, workspace)?;
                    let slope = if bends { dot(&found.derivative, &along) } else { 0.0 };
                    Ok(Some((found, slope)))
                }
                _ => Ok(None),
            }
        };
        let tell = |_: usize, found: &Option<(SecondDerivative, f64)>| found.as_ref().map_or(0.0, |found| found.1);
        let (found, slopes) = self.side_by_side(workspace, of, tell)?;
        let mut by_scenario = vec![0.0; self.names.len()];
        for (member, slope) in self.members.iter().zip(slopes) {
            by_scenario[member.scenario] += member.weight * slope;
        }
        let changes = match bends {
            true => self.risk.weights_change(&self.probabilities, &point.costs, &by_scenario)?,
            false => vec![0.0; self.names.len()],
        };
        let both: Vec<_> = self
            .own()
            .iter()
            .zip(found)
            .map(|(member, found)| {
                let (found, _) = found?;
                let mut out: Vec<f64> = found.product;
                scale(by_cost[member.scenario] * member.weight, &mut out);
                axpy(changes[member.scenario] * member.weight, &found.derivative, &mut out);
                Some(out)
            })
            .collect();
        self.sum(both.iter().map(|of| Some((1.0, of.as_deref()?))))
    }

    /// The second derivative of one term's expected value, as [`derivative_of_term`](Self::derivative_of_term).
    ///
    /// # Errors
    /// The first member, in order, without second derivatives.
    pub fn hessian_vector_of_term(
        &self,
        point: &EnsemblePoint,
        term: &str,
        v: &[f64],
        workspace: &mut EnsembleWorkspace,
    ) -> Result<Vec<f64>, EnsembleError> {
        self.check_len(v)?;
        let of = |index: usize, member: &Member, workspace: &mut ReducedWorkspace| {
            let own = member.problem.term_names().iter().position(|name| name == term);
            match (own, point.member(index)) {
                (Some(own), Some(at)) => {
                    let along = gather(&self.blocks, member, v);
                    member.problem.hessian_vector_of_term(at, own, &along, workspace).map(Some)
                }
                _ => Ok(None),
            }
        };
        self.expected(&self.side_by_side(workspace, of, |_, _| ())?.0)
    }
}
