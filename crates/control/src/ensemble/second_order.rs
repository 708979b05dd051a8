//! Second derivatives of the risk over an ensemble.

use super::blocks::gather;
use super::{Ensemble, EnsembleError, EnsemblePoint, EnsembleWorkspace};
use nastic_numeric::vector::{axpy, dot};
use nastic_opt::Hessian;

impl Ensemble {
    /// `d2jhat/dm2 v` at an evaluated point, `jhat = R(j_1, .., j_n)`:
    ///
    /// ```text
    /// sum_s (dR/dj_s) d2j_s/dm2 v + sum_s (sum_t d2R/dj_s dj_t (dj_t/dm . v)) dj_s/dm
    /// ```
    ///
    /// two linear solves for every member; see [`Reduced::hessian_vector`](crate::Reduced::hessian_vector).
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

    /// The same with every member's state linearised; see [`Reduced::gauss_newton_vector`](crate::Reduced::gauss_newton_vector).
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
        let bends = self.names.len() > 1 && !self.risk.is_linear();
        let by_cost = self.risk.weights(&self.probabilities, &point.costs);
        let members = self.side_by_side(workspace, |index, member, workspace| {
            let along = gather(&self.blocks, member, v);
            match point.members.get(index) {
                Some(at) if bends || by_cost[member.scenario] != 0.0 => {
                    member.problem.second_derivative(at, None, (&along, which, bends), workspace).map(Some)
                }
                _ => Ok(None),
            }
        })?;
        let found = || self.members.iter().zip(&members);
        let mut out = self.sum(found().map(|(member, found)| {
            Some((by_cost[member.scenario] * member.weight, found.as_ref()?.product.as_slice()))
        }));
        if bends {
            let of = |scenario: usize| {
                self.sum(found().map(|(member, found)| {
                    let found = found.as_ref().filter(|_| member.scenario == scenario)?;
                    Some((member.weight, found.derivative.as_slice()))
                }))
            };
            let derivatives: Vec<Vec<f64>> = (0..self.names.len()).map(of).collect();
            let slopes: Vec<f64> = derivatives.iter().map(|derivative| dot(derivative, v)).collect();
            let changes = self.risk.weights_change(&self.probabilities, &point.costs, &slopes)?;
            derivatives.iter().zip(changes).for_each(|(derivative, change)| axpy(change, derivative, &mut out));
        }
        Ok(out)
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
        let products = self.side_by_side(workspace, |index, member, workspace| {
            let own = member.problem.term_names().iter().position(|name| name == term);
            match (own, point.members.get(index)) {
                (Some(own), Some(at)) => {
                    let along = gather(&self.blocks, member, v);
                    member.problem.hessian_vector_of_term(at, own, &along, workspace).map(Some)
                }
                _ => Ok(None),
            }
        })?;
        Ok(self.expected(&products))
    }
}
