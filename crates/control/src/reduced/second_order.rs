//! Second derivatives of the reduced cost.

use super::{Lagrangian, Reduced};
use crate::cost::Partials;
use crate::evaluated::{AdjointState, Evaluated};
use crate::workspace::ReducedWorkspace;
use nastic_fem::{Controls, Increment, Instant, SecondOrder, SolveOptions};
use nastic_fields::ControlError;
use nastic_numeric::vector::axpy;
use nastic_opt::Hessian;
use std::borrow::Cow;

/// The second derivative along a direction, and the first one where it was asked for.
#[derive(Debug, Clone)]
pub struct SecondDerivative {
    /// `d2jhat/dm2 v`.
    pub product: Vec<f64>,
    /// `djhat/dm`; empty unless asked for.
    pub derivative: Vec<f64>,
}

/// A direction of second derivatives: a change of the control vector, and of all slots at the points.
pub(super) struct Direction {
    pub by_control: Vec<f64>,
    pub at_points: Controls,
}

/// What of second derivatives is wanted: of a term or of all, exact or not, and with the first one.
pub(super) struct Wanted {
    pub of: Option<usize>,
    pub which: Hessian,
    pub first: bool,
}

/// The partial derivative by the controls, for those who want it.
type ByControls<'a> = &'a dyn Fn() -> Result<Vec<f64>, ControlError>;

/// The adjoint of a functional, and its partial derivative by the state for those who want it.
type OfState<'a> = (Option<&'a [f64]>, &'a dyn Fn() -> Result<Vec<f64>, ControlError>);

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
    /// Source: docs/model/derivative.md.
    ///
    /// # Errors
    /// A law, contribution or cost without second derivatives, by name; a singular tangent; a direction of the wrong length.
    pub fn hessian_vector(
        &self,
        point: &Evaluated,
        v: &[f64],
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        Ok(self.second_derivative(point, None, v, Hessian::Exact, false, workspace)?.product)
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
        Ok(self.second_derivative(point, None, v, Hessian::GaussNewton, false, workspace)?.product)
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
        Ok(self.second_derivative(point, Some(term), v, Hessian::Exact, false, workspace)?.product)
    }

    /// [Exact](Self::hessian_vector) or [linearised](Self::gauss_newton_vector), of all terms or of one, along v; with the `first` derivative if asked.
    ///
    /// # Errors
    /// As there.
    pub fn second_derivative(
        &self,
        point: &Evaluated,
        term: Option<usize>,
        v: &[f64],
        which: Hessian,
        first: bool,
        workspace: &mut ReducedWorkspace,
    ) -> Result<SecondDerivative, ControlError> {
        self.solid().model().ranks().refuse_ranks("second derivatives")?;
        self.refuse_projection("second derivatives")?;
        let along = self.direction(point, v)?;
        self.second_derivative_along(point, Wanted { of: term, which, first }, &along, workspace)
    }

    /// The same along a direction that may have numbers beside the controls.
    pub(super) fn second_derivative_along(
        &self,
        point: &Evaluated,
        want: Wanted,
        along: &Direction,
        workspace: &mut ReducedWorkspace,
    ) -> Result<SecondDerivative, ControlError> {
        let Wanted { of: term, which, first } = want;
        let exact = which == Hessian::Exact;
        let lambda = if exact || first { Some(self.adjoint_of(point, term, workspace)?) } else { None };
        let costs = self.costs_of(point)?;
        let own = self.costs().iter().zip(costs.iter()).enumerate();
        let own = own.filter(|(k, _)| term.is_none_or(|term| term == *k));
        let own: Vec<_> = own.map(|(_, named)| named).collect();
        let add = |along: &Partials, change: &mut Partials| {
            let mut own = own.iter();
            own.try_for_each(|(of, at)| at.add_second_partials(along, change).map_err(|error| error.of(of.name())))
        };
        let by_m = || Ok(self.partials(point, term)?.m);
        let first: Option<ByControls<'_>> = if first { Some(&by_m) } else { None };
        let by_u = || Ok(self.partials(point, term)?.u);
        self.second_derivative_by(point, (lambda.as_deref(), &by_u), add, (along, which, first), workspace)
    }

    /// A change v of the control vector.
    fn direction(&self, point: &Evaluated, v: &[f64]) -> Result<Direction, ControlError> {
        self.refuse_motion("second derivatives")?;
        let at_points = self.layout_in_stage(point.stage).change(&point.m, v)?;
        Ok(Direction { by_control: v.to_vec(), at_points })
    }

    /// `(d2j + sum_k y_k d2c_k + sum_k w_k dc_k dc_k^T) v` of costs and constraints by the controls, as `of` weighs them.
    ///
    /// # Errors
    /// As [`hessian_vector`](Self::hessian_vector).
    pub fn lagrangian_second_derivative(
        &self,
        point: &Evaluated,
        of: Lagrangian<'_>,
        w: &[f64],
        v: &[f64],
        which: Hessian,
        workspace: &mut ReducedWorkspace,
    ) -> Result<Vec<f64>, ControlError> {
        let lambda = match &point.adjoint {
            _ if which == Hessian::GaussNewton => None,
            Some(adjoint) if of.costs && is_of(adjoint, of.y) => Some(Cow::Borrowed(adjoint.lambda.as_slice())),
            _ => Some(self.lambda(point, self.lagrangian_sensitivity(point, of, workspace)?.1)),
        };
        let costs = if of.costs { self.costs_of(point)? } else { Cow::default() };
        let constraints = self.constraints_of(point)?;
        let add = |along: &Partials, change: &mut Partials| {
            for (of, cost) in self.costs().iter().zip(costs.iter()) {
                cost.add_second_partials(along, change).map_err(|error| error.of(of.name()))?;
            }
            let weighted = Self::with_weights(&constraints, of.y).zip(Self::with_weights(&constraints, w));
            for (term, ((constraint, y), (_, w))) in self.constraint_terms().iter().zip(weighted) {
                let of_term = |error: ControlError| error.of(&term.group().name);
                constraint.add_second_partials(y, along, change).map_err(of_term)?;
                let slopes = constraint.change(along)?;
                let bent: Vec<f64> = w.iter().zip(&slopes).map(|(w, slope)| w * slope).collect();
                constraint.add_partials(&bent, change)?;
            }
            Ok(())
        };
        let by_u = || Ok(self.lagrangian_partials(point, of)?.u);
        let of_state: OfState<'_> = (lambda.as_deref(), &by_u);
        let along = self.direction(point, v)?;
        Ok(self.second_derivative_by(point, of_state, add, (&along, which, None), workspace)?.product)
    }

    /// The second derivative of what has the adjoint `lambda` (the exact one needs it) and whose second partials `add` adds; the
    /// first one too, where its partial derivative by the controls is given.
    fn second_derivative_by(
        &self,
        point: &Evaluated,
        (lambda, by_u): OfState<'_>,
        add: impl Fn(&Partials, &mut Partials) -> Result<(), ControlError>,
        (along, which, first): (&Direction, Hessian, Option<ByControls<'_>>),
        workspace: &mut ReducedWorkspace,
    ) -> Result<SecondDerivative, ControlError> {
        let layout = self.layout_in_stage(point.stage);
        let Direction { by_control: v, at_points } = along;
        let exact = which == Hessian::Exact;
        let how = SolveOptions { parallel: self.parallel, ..SolveOptions::default() };
        let mut second = SecondOrder::new(self.solid.model(), point.state(), &how, &mut workspace.solve)?;
        if !exact {
            second = second.for_iterations();
        }
        let along = Partials { u: second.state_change(at_points)?, m: v.clone() };
        let mut change = Partials::zero(along.u.len(), v.len());
        add(&along, &mut change)?;
        let adjoint = match lambda {
            Some(lambda) if exact => {
                let increment = Increment { u: &along.u, controls: at_points };
                second.adjoint_change(lambda, &increment, &change.u)?
            }
            _ => second.through_state(&change.u)?,
        };
        self.forget(workspace);
        let mut product = change.m;
        axpy(1.0, &layout.control_vjp(&point.m, &adjoint.controls), &mut product);
        let mut derivative = Vec::new();
        let bends = exact && layout.blocks().iter().any(|block| !block.is_affine());
        if let Some(lambda) = lambda.filter(|_| first.is_some() || bends) {
            let by_point = self.by_point(point, &by_u()?, lambda)?;
            if exact {
                axpy(1.0, &layout.second_vjp(&point.m, v, &by_point), &mut product);
            }
            if let Some(by_m) = first {
                derivative = by_m()?;
                axpy(1.0, &layout.control_vjp(&point.m, &by_point), &mut derivative);
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
        match (term, &point.adjoint) {
            (None, Some(adjoint)) if is_of(adjoint, &[]) => Ok(Cow::Borrowed(&adjoint.lambda)),
            _ => Ok(self.lambda(point, self.sensitivity(point, term, workspace)?.1)),
        }
    }

    /// The adjoint displacement, which is zero where nothing depends on the state.
    fn lambda<'p>(&self, point: &Evaluated, adjoint: Option<AdjointState>) -> Cow<'p, [f64]> {
        let none = || vec![0.0; point.state().u.len()];
        Cow::Owned(adjoint.map_or_else(none, |adjoint| adjoint.lambda))
    }

    /// The derivative of a functional with these partials by the state and this adjoint by the values at the points.
    pub(super) fn by_point(&self, point: &Evaluated, by_u: &[f64], lambda: &[f64]) -> Result<Controls, ControlError> {
        let state = point.state();
        let mut at = Instant::of(state);
        at.parallel = self.parallel;
        Ok(self.solid.model().prescribed_unknowns().sensitivities(&at, by_u, lambda)?.controls)
    }
}

/// Whether an adjoint state of the costs has these weights of the constraints.
fn is_of(adjoint: &AdjointState, y: &[f64]) -> bool {
    adjoint.multipliers == y || adjoint.multipliers.is_empty() && y.iter().all(|y| *y == 0.0)
}
