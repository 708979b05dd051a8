//! The discrete adjoint of a trajectory, from its end to its beginning.

use crate::contributions::controls::Controls;
use crate::error::StateError;
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::state::SolveReport;
use crate::solution::tangent_systems::TangentSystems;
use crate::solution::trajectory::{Begin, Trajectory};
use crate::solution::workspace::Workspace;
use nastic_numeric::vector::axpy;

/// Partial derivatives of a functional at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StatePartials {
    /// `dj/du`, flat; empty for zero.
    pub u: Vec<f64>,
    /// `dj/dv`, flat; empty for zero.
    pub velocity: Vec<f64>,
}

impl StatePartials {
    /// Of a functional that depends on the displacement alone.
    pub fn by_displacement(u: Vec<f64>) -> Self {
        StatePartials { u, velocity: Vec::new() }
    }
}

/// What a reverse sweep finds.
#[derive(Debug, Clone)]
pub struct Swept {
    /// Adjoint displacement of every instant, flat, zero on the supports; empty where the state was given.
    pub lambda: Vec<Vec<f64>>,
    /// Derivative of the functional by the controls of every instant, through the states.
    pub controls: Vec<Controls>,
    /// Work done.
    pub report: SolveReport,
}

/// What later instants owe to one: `dj/du_n` and `dj/dv_n` through them.
#[derive(Default)]
struct Carried {
    u: Vec<f64>,
    velocity: Vec<f64>,
}

impl Model {
    /// The derivative of `j(y_0, .., y_N)` by the controls of every instant, given its partial derivatives: with the
    /// residuals `r_n(u_n, v_n, a_n; m_n) = 0` and backward Euler's `v_n = (u_n - u_{n-1})/h`, `a_n = (v_n - v_{n-1})/h`,
    ///
    /// ```text
    /// K_n^T l_n = -(dj/du_n + V_n / h_n + what later steps owe),   V_n = dj/dv_n - A_{n+1} / h_{n+1}
    /// dj/dm_n = l_n . dr_n/dm_n,    A_n = l_n . dr_n/da_n
    /// ```
    ///
    /// K_n the tangent of the step. A static problem is a trajectory of one instant, and this its adjoint. Source:
    /// docs/model.md section 6.
    ///
    /// # Errors
    /// A tangent that is singular, partial derivatives of the wrong length, states of another body or with internal variables.
    pub fn reverse_sweep(
        &self,
        trajectory: &Trajectory,
        partials: &[StatePartials],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Swept, StateError> {
        let states = trajectory.states();
        self.check_partials(partials, states.len())?;
        if states.iter().any(|state| !state.internal.is_empty()) {
            let what = "the adjoint of laws with internal variables is not there yet".to_owned();
            return Err(crate::FemError::Meaningless { what }.into());
        }
        states.iter().try_for_each(|state| self.check_state(state))?;
        let mut swept = Swept {
            lambda: vec![Vec::new(); states.len()],
            controls: vec![self.controls(); states.len()],
            report: SolveReport::default(),
        };
        let mut carried = Carried::default();
        for n in (0..states.len()).rev() {
            if n == 0 && trajectory.begin() == Begin::Given {
                break;
            }
            let step = trajectory.step(n);
            let mut by_u = sum(&partials[n].u, &carried.u, self.unknowns().len());
            let by_v = sum(&partials[n].velocity, &carried.velocity, self.unknowns().len());
            if let Some(step) = &step {
                axpy(1.0 / step.dt, &by_v, &mut by_u);
            }
            carried = Carried::default();
            if by_u.iter().all(|&d| d == 0.0) && by_v.iter().all(|&d| d == 0.0) {
                swept.lambda[n] = by_u;
                continue;
            }
            let rhs: Vec<f64> = by_u.iter().map(|d| -d).collect();
            let lambda = match &step {
                None => {
                    let adjoint = self.adjoint_with(&states[n], &[&rhs], how, workspace)?;
                    swept.report.add_work(&adjoint.report);
                    swept.report.solver = adjoint.report.solver;
                    adjoint.lambda.into_iter().next().unwrap_or_default()
                }
                Some(step) => {
                    let at = self.instant(&states[n], Some(step), how.parallel);
                    let mut rhs = rhs;
                    self.supports.clear(&mut rhs);
                    let matrix = self.tangent_at(&at, &states[n])?;
                    let mut systems = TangentSystems::new(self, how.parallel, self.linear_solver(how, workspace));
                    let mut solved = systems.solve_transposed(matrix, at.u, &[&rhs], &mut swept.report)?;
                    solved.swap_remove(0)
                }
            };
            let at = self.instant(&states[n], step.as_ref(), how.parallel);
            let found = self.vjp(&at, &lambda).and_then(|mut found| {
                self.add_held_sensitivity(&at, &by_u, &lambda, &mut found)?;
                Ok(found)
            });
            let sensitivities = found.map_err(|at| {
                let last = Box::new(states[n].clone());
                StateError::Inverted { at, load: states[n].load, cuts: 0, last }
            })?;
            if let Some(step) = &step {
                let h = step.dt;
                // v_n and a_n depend on u_{n-1}, a_n on v_{n-1}
                let mut u = vec![0.0; by_u.len()];
                axpy(-1.0 / h, &sensitivities.velocity, &mut u);
                axpy(-1.0 / (h * h), &sensitivities.acceleration, &mut u);
                axpy(-1.0 / h, &by_v, &mut u);
                let velocity = sensitivities.acceleration.iter().map(|a| -a / h).collect();
                carried = Carried { u, velocity };
            }
            swept.controls[n] = sensitivities.controls;
            swept.lambda[n] = lambda;
        }
        Ok(swept)
    }

    fn check_partials(&self, partials: &[StatePartials], expected: usize) -> Result<(), StateError> {
        let refuse = |what: &str, found, expected| {
            Err(crate::FemError::Length { what: what.to_owned(), found, expected }.into())
        };
        if partials.len() != expected {
            return refuse("partial derivatives by instant", partials.len(), expected);
        }
        let dofs = self.unknowns().len();
        let lengths = partials.iter().flat_map(|p| [p.u.len(), p.velocity.len()]);
        match lengths.filter(|&found| found != 0).find(|&found| found != dofs) {
            Some(found) => refuse("partial derivatives of a state", found, dofs),
            None => Ok(()),
        }
    }
}

/// The sum of two vectors of which either may be empty for zero.
fn sum(a: &[f64], b: &[f64], len: usize) -> Vec<f64> {
    let mut sum = vec![0.0; len];
    [a, b].into_iter().filter(|v| !v.is_empty()).for_each(|v| axpy(1.0, v, &mut sum));
    sum
}
