//! [`SecondOrder`]: the linearised state and the linearised adjoint of an equilibrium.

use crate::adjoint::inverted;
use crate::linear_systems::tangent::Tangent;
use crate::linear_systems::tangent_systems::{EXACT, TangentSystems, Transposition};
use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::search::options::SolveOptions;
use nastic_body::contribution::sensitivities::{Increment, Sensitivities};
use nastic_body::controls::Controls;
use nastic_body::error::{SecondDerivativeError, StateError};
use nastic_body::instant::Instant;
use nastic_body::state::{SolveReport, State};
use nastic_linear::LinearError;
use nastic_linear::solver::Accuracy;
use nastic_numeric::vector::axpy;

/// Of products that iterations with them take.
const ITERATION_ACCURACY: Accuracy = Accuracy { error: 1e-9, residual: 1e-11 };

/// Directional derivatives of a state and its adjoint by the controls, in two linear solves with the factor that a workspace
/// keeps, as [`Model::adjoint_with`] uses it, and until double precision ends: with `r(u, m) = 0`, `K = r_u` and `K^T lambda = -j_u`,
///
/// ```text
/// K du          = -r_m v
/// K^T dlambda   = -(j_uu du + j_um v + (lambda . r)_uu du + (lambda . r)_um v)
/// through state = (r_m)^T dlambda + (lambda . r)_mu du + (lambda . r)_mm v
/// ```
///
/// so that the second derivative of `j(u(m), m)` along v is `j_mm v + j_mu du + through state`. Source: docs/model/derivative.md.
pub struct SecondOrder<'a> {
    model: &'a Model,
    state: &'a State,
    how: &'a SolveOptions<'a>,
    workspace: &'a mut Workspace,
    /// Whether the tangent is worth a matrix and a factor of its own: the workspace has met this state before.
    again: bool,
    accuracy: Accuracy,
    report: SolveReport,
}

/// The change of an adjoint, and of what it gives.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjointChange {
    /// `dlambda`, flat, zero on the supports.
    pub lambda: Vec<f64>,
    /// `(r_m)^T dlambda + (lambda . r)_mu du + (lambda . r)_mm v`: of every actuation by point, weights included.
    pub controls: Controls,
}

impl<'a> SecondOrder<'a> {
    /// At an equilibrium of a model.
    ///
    /// # Errors
    /// A state of another body, or with internal variables.
    pub fn new(
        model: &'a Model,
        state: &'a State,
        how: &'a SolveOptions<'a>,
        workspace: &'a mut Workspace,
    ) -> Result<Self, StateError> {
        model.ranks().refuse_ranks("second derivatives")?;
        model.checks().check_state(state)?;
        model.check_solver(how.solver)?;
        if !state.history.is_empty() {
            let what = "second derivatives of laws with internal variables are not there yet".to_owned();
            return Err(nastic_body::error::FemError::Meaningless { what }.into());
        }
        let again = workspace.comes_again(state, model);
        Ok(SecondOrder { model, state, how, workspace, again, accuracy: EXACT, report: SolveReport::default() })
    }

    /// The same with solutions as exact as iterations with the products need them; the products are symmetric to less.
    #[must_use]
    pub fn for_iterations(self) -> Self {
        SecondOrder { accuracy: ITERATION_ACCURACY, ..self }
    }

    /// `du` along v.
    ///
    /// # Errors
    /// A singular tangent; a contribution without second derivatives.
    pub fn state_change(&mut self, v: &Controls) -> Result<Vec<f64>, StateError> {
        self.model.check_control_change(v)?;
        let mut rhs = self.model.control_product(&self.instant(), v).map_err(|error| self.failed(error))?;
        rhs.iter_mut().for_each(|r| *r = -*r);
        let Some(held) = self.model.prescribed_change(&self.state.controls, v) else {
            return self.solve(rhs, Transposition::No);
        };
        // K_FF du_F = -(r_m v)_F - K_FD du_D
        let tangent = self.model.tangents().bordered_tangent(&self.instant()).map_err(|at| self.failed(at.into()))?;
        axpy(-1.0, &tangent.multiply(&held, self.how.parallel), &mut rhs);
        let mut du = self.solve(rhs, Transposition::No)?;
        axpy(1.0, &held, &mut du);
        Ok(du)
    }

    /// `dlambda` and what comes of it, for the adjoint `lambda`, along `(du, v)`; `by_state` is `j_uu du + j_um v`.
    ///
    /// # Errors
    /// A singular tangent; a term without second derivatives; vectors of the wrong length.
    pub fn adjoint_change(
        &mut self,
        lambda: &[f64],
        along: &Increment,
        by_state: &[f64],
    ) -> Result<AdjointChange, StateError> {
        let expected = self.model.unknowns().len();
        if let Some(found) = [lambda.len(), along.u.len(), by_state.len()].into_iter().find(|&n| n != expected) {
            let what = "a vector of the second-order adjoint".to_owned();
            return Err(nastic_body::error::FemError::Length { what, found, expected }.into());
        }
        if let Some(name) = self.model.turning(&self.instant(), along.controls) {
            return Err(SecondDerivativeError::Turning { name }.into());
        }
        let second = self.model.second_vjp(&self.instant(), lambda, along).map_err(|error| self.failed(error))?;
        let by_u: Vec<f64> = second.u.iter().zip(by_state).map(|(r, j)| r + j).collect();
        let d_lambda = self.solve(by_u.iter().map(|d| -d).collect(), Transposition::Yes)?;
        let first = self.sensitivities(&by_u, &d_lambda)?;
        let mut controls = second.controls;
        (0..controls.len()).for_each(|k| axpy(1.0, first.controls.values(k), controls.values_mut(k)));
        Ok(AdjointChange { lambda: d_lambda, controls })
    }

    /// What comes of a cost's derivative by the state alone: `(r_m)^T mu` with `K^T mu = -by_state`.
    ///
    /// # Errors
    /// A singular tangent; a vector of the wrong length.
    pub fn through_state(&mut self, by_state: &[f64]) -> Result<AdjointChange, StateError> {
        let expected = self.model.unknowns().len();
        if by_state.len() != expected {
            let what = "a derivative by the state".to_owned();
            return Err(nastic_body::error::FemError::Length { what, found: by_state.len(), expected }.into());
        }
        let lambda = self.solve(by_state.iter().map(|j| -j).collect(), Transposition::Yes)?;
        let controls = self.sensitivities(by_state, &lambda)?.controls;
        Ok(AdjointChange { lambda, controls })
    }

    /// `lambda . dr/dm`, and the part of held unknowns that controls move.
    fn sensitivities(&self, by_u: &[f64], lambda: &[f64]) -> Result<Sensitivities, StateError> {
        self.model
            .prescribed_unknowns()
            .sensitivities(&self.instant(), by_u, lambda)
            .map_err(|error| self.failed(error.into()))
    }

    /// Work done so far.
    pub fn report(&self) -> &SolveReport {
        &self.report
    }

    fn instant(&self) -> Instant<'a> {
        self.model.instant(self.state, None, self.how.parallel)
    }

    fn solve(&mut self, mut rhs: Vec<f64>, transposition: Transposition) -> Result<Vec<f64>, StateError> {
        self.model.supports.restrict(&mut rhs);
        if rhs.iter().all(|&b| b == 0.0) {
            return Ok(rhs);
        }
        let Self { model, state, how, again, accuracy, .. } = *self;
        let at = self.instant();
        if let Some(free) = model.loose(&at) {
            let mut systems =
                TangentSystems::new(model, &state.controls, how.parallel, model.linear_solver(how, self.workspace));
            let found = model.solve_neutral(&at, &free, &[&rhs], (state, accuracy), &mut systems, &mut self.report);
            return Ok(found?.pop().unwrap_or_default());
        }
        if model.unknowns().multipliers() > 0 {
            let mut system = model.saddle_point(state, how.parallel)?;
            if transposition == Transposition::Yes {
                system.transpose();
            }
            let mut systems =
                TangentSystems::new(model, &state.controls, how.parallel, model.linear_solver(how, self.workspace));
            let u = model.nodal(&state.u);
            system.prepare(&mut systems, u, &mut self.report)?;
            let mut solved = system.solve(&mut systems, u, &[&rhs], accuracy, &mut self.report)?.solved;
            return Ok(solved.pop().unwrap_or_default());
        }
        let kept = self.workspace.take_tangent();
        let mut systems =
            TangentSystems::new(model, &state.controls, how.parallel, model.linear_solver(how, self.workspace));
        if !again
            && kept.is_none()
            && let Some(x) = model.solve_by_products(state, &rhs, how, accuracy, &mut systems, &mut self.report)
        {
            return Ok(x);
        }
        let at = model.instant(state, None, how.parallel);
        let eliminated = |products: bool| model.eliminated(&at, products).map_err(|at| inverted(at, state));
        let usable = |kept: &(Tangent, bool)| systems.takes_products() || !kept.0.is_unassembled();
        let (mut tangent, mut factorised) = match kept.filter(usable) {
            Some(kept) => kept,
            None => (eliminated(systems.takes_products())?, false),
        };
        if tangent.is_unassembled() {
            let prepared =
                if again && !factorised { systems.prepare(&tangent, &state.u, &mut self.report) } else { Ok(()) };
            let solve = |()| model.solve_corrected(accuracy, &tangent, &at, &rhs, &mut systems, &mut self.report);
            match prepared.and_then(solve) {
                Err(LinearError::NoEntries | LinearError::Singular { .. }) => {
                    (tangent, factorised) = (eliminated(false)?, false);
                }
                solved => {
                    self.workspace.put_tangent(tangent, again);
                    return Ok(solved?);
                }
            }
        }
        if again && !factorised {
            systems.prepare(&tangent, &state.u, &mut self.report)?;
        }
        let solved = systems.solve_to(accuracy, &tangent, &state.u, &rhs, transposition, &mut self.report);
        self.workspace.put_tangent(tangent, again);
        Ok(solved?)
    }

    fn failed(&self, error: SecondDerivativeError) -> StateError {
        match error {
            SecondDerivativeError::Inadmissible(at) => {
                StateError::inadmissible(at, self.state.load, 0, Box::new(self.state.clone()))
            }
            refused => refused.into(),
        }
    }
}
