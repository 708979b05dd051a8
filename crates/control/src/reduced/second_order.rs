//! Second derivatives of the reduced cost.

use super::Reduced;
use crate::cost::Partials;
use crate::error::ControlError;
use crate::evaluated::Evaluated;
use crate::workspace::ReducedWorkspace;
use nastic_fem::{Controls, Increment, Instant, SecondOrder, SolveOptions};
use nastic_numeric::vector::axpy;
use nastic_opt::Hessian;
use std::borrow::Cow;

/// The second derivative along a direction, and the first one where it was asked for.
#[derive(Debug, Clone)]
pub(crate) struct SecondDerivative {
    /// `d2jhat/dm2 v`.
    pub product: Vec<f64>,
    /// `djhat/dm`; empty unless asked for.
    pub derivative: Vec<f64>,
}

impl Reduced {
    /// `d2jhat/dm2 v` at an evaluated point: one linear solve for the change `du` of the state, one for that of the adjoint, with
    /// the factor that the workspace keeps; a third one where the point has no adjoint yet (its derivative was not taken).
    ///
    /// With `K du = -r_m v` and `K dlambda = -(j_uu du + j_um v + (lambda . r)_uu du + (lambda . r)_um v)`,
    ///
    /// ```text
    /// d2jhat/dm2 v = j_mm v + j_mu du + r_m^T dlambda + (lambda . r)_mu du + (lambda . r)_mm v
    /// ```
    ///
    /// Source: docs/model.md section 6.
    ///
    /// # Errors
    /// A law, contribution or cost without second derivatives, by name; a singular tangent; a direction of the wrong length.
    pub fn hessian_vector(
        &self,
        point: &Evaluated,
        v: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        Ok(self.second_derivative(point, None, (v, Hessian::Exact, false), workspace)?.product)
    }

    /// The same with the state and the fields linearised, `du = -K^-1 r_m v` (Gauss-Newton's matrix, if the cost is a sum of squares):
    ///
    /// ```text
    /// j_mm v + j_mu du + r_m^T mu,   K mu = -(j_uu du + j_um v)
    /// ```
    ///
    /// Two linear solves too, as exact as an adjoint, and neither third derivatives of the energy nor an adjoint.
    ///
    /// # Errors
    /// A cost without second derivatives, by name; a singular tangent; a direction of the wrong length.
    pub fn gauss_newton_vector(
        &self,
        point: &Evaluated,
        v: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        Ok(self.second_derivative(point, None, (v, Hessian::GaussNewton, false), workspace)?.product)
    }

    /// The same of one term.
    ///
    /// # Errors
    /// As there.
    pub fn hessian_vector_of_term(
        &self,
        point: &Evaluated,
        term: usize,
        v: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        Ok(self.second_derivative(point, Some(term), (v, Hessian::Exact, false), workspace)?.product)
    }

    /// Of all terms, or of one, along v; with the first derivative if asked.
    pub(crate) fn second_derivative(
        &self,
        point: &Evaluated,
        term: Option<usize>,
        (v, which, first): (&[f64], Hessian, bool),
        workspace: &mut ReducedWorkspace,
    ) -> Result<SecondDerivative, ControlError> {
        let at_points = self.layout.change(&point.m, v)?;
        let exact = which == Hessian::Exact;
        let lambda = if exact || first { Some(self.adjoint_of(point, term, workspace)?) } else { None };
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let mut second = SecondOrder::new(self.solid.model(), &point.state, &how, &mut workspace.solve)?;
        if !exact {
            second = second.for_iterations();
        }
        let along = Partials { u: second.state_change(&at_points)?, m: v.to_vec() };
        let mut change = Partials::zero(along.u.len(), v.len());
        let costs = self.costs_of(point)?;
        for (_, cost) in costs.iter().enumerate().filter(|(k, _)| term.is_none_or(|term| term == *k)) {
            cost.add_second_partials(&along, &mut change)?;
        }
        let adjoint = match &lambda {
            Some(lambda) if exact => {
                let increment = Increment { u: &along.u, controls: &at_points };
                second.adjoint_change(lambda, &increment, &change.u)?
            }
            _ => second.through_state(&change.u)?,
        };
        self.forget(workspace);
        let mut product = change.m;
        axpy(1.0, &self.layout.control_vjp(&point.m, &adjoint.controls), &mut product);
        let mut derivative = Vec::new();
        let fixed_lengths = exact && self.layout.blocks().iter().any(|block| block.length.is_some());
        if let Some(lambda) = lambda.filter(|_| first || fixed_lengths) {
            let by_point = self.by_point(point, &lambda)?;
            if exact {
                axpy(1.0, &self.layout.second_vjp(&point.m, v, &by_point), &mut product);
            }
            if first {
                derivative = self.partials(point, term)?.m;
                axpy(1.0, &self.layout.control_vjp(&point.m, &by_point), &mut derivative);
            }
        }
        Ok(SecondDerivative { product, derivative })
    }

    /// The adjoint of all terms, which the point may hold, or of one.
    fn adjoint_of<'p>(
        &self,
        point: &'p Evaluated,
        term: Option<usize>,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Cow<'p, [f64]>, ControlError> {
        if let (None, Some(lambda)) = (term, point.adjoint()) {
            return Ok(Cow::Borrowed(lambda));
        }
        let (_, adjoint) = self.sensitivity(point, term, workspace)?;
        let none = || vec![0.0; point.state.u.len()];
        Ok(Cow::Owned(adjoint.map_or_else(none, |adjoint| adjoint.lambda)))
    }

    /// `lambda . dr/dm` by values at the points.
    fn by_point(&self, point: &Evaluated, lambda: &[f64]) -> Result<Controls, ControlError> {
        let state = &point.state;
        let mut at = Instant::new(&state.u, &state.controls, state.load);
        at.parallel = self.parallel;
        Ok(self.solid.model().vjp(&at, lambda)?.controls)
    }
}
