//! [`Deflated`]: Newton's step for the deflated residual.

use super::bordered::Bordered;
use super::{Direction, Step, Take};
use crate::linear_systems::tangent_systems::{TangentSystems, eliminate};
use crate::nonlinear::equations::Equations;
use crate::nonlinear::iterate::{Iterate, Stop};
use nastic_body::state::{SolveReport, State};
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearSolver, Space};
use std::sync::Arc;

/// Largest component of one step, as a share of the body's diagonal.
const MAX_STEP_RATIO: f64 = 0.1;
/// The distance at which deflation is as strong as the shift, as a share of the body's diagonal.
const DEFLATION_DISTANCE: f64 = 0.1;
/// Distance below which two equilibria are the same, as a share of the body's diagonal (root mean square).
const SAME_STATE_DISTANCE: f64 = 1e-6;

/// Equilibria that are known, and the distance of others from them: `|v|^2 = sum_a V_a v_a . v_a / (V l^2)`.
pub(crate) struct Known<'a> {
    states: Vec<&'a State>,
    /// `V_a / (V l^2)` by displacement component.
    weights: Vec<f64>,
    space: Arc<Space>,
}

impl<'a> Known<'a> {
    pub fn new(equations: &Equations, states: Vec<&'a State>) -> Self {
        let disc = equations.model.discretization();
        let mut weights = disc.volumes_by_unknown();
        let scale =
            weights.iter().sum::<f64>() / disc.dim() as f64 * (DEFLATION_DISTANCE * equations.diagonal()).powi(2);
        weights.iter_mut().for_each(|w| *w /= scale);
        Known { states, weights, space: equations.model.unknowns().clone() }
    }

    /// `1 / (1 - (grad log m) . d)` for Newton's step d.
    fn factor(&self, u: &[f64], step: &[f64]) -> f64 {
        let slope = |known: &&State| {
            let away: Vec<f64> = u.iter().zip(known.u.iter()).map(|(u, v)| u - v).collect();
            let weighted: Vec<f64> = away.iter().zip(&self.weights).map(|(v, w)| v * w).collect();
            let square = self.space.dot(&away, &weighted);
            -2.0 * self.space.dot(&weighted, step) / (square * (1.0 + square))
        };
        let factor = 1.0 / (1.0 - self.states.iter().map(slope).sum::<f64>());
        if factor.is_finite() { factor } else { f64::MAX }
    }

    /// Whether a displacement is that of one of them.
    pub fn contains(&self, u: &[f64]) -> bool {
        let least = (SAME_STATE_DISTANCE / DEFLATION_DISTANCE).powi(2);
        self.states.iter().any(|known| {
            let squares = u.iter().zip(known.u.iter()).zip(&self.weights).map(|((u, v), w)| (u - v).powi(2) * w);
            squares.sum::<f64>() < least
        })
    }
}

/// Newton's step, of unknowns without or with multipliers, times the factor of the deflation.
pub(crate) struct Deflated<'a> {
    equations: &'a Equations<'a>,
    known: &'a Known<'a>,
    newton: Newton<'a>,
}

enum Newton<'a> {
    Plain(&'a mut dyn LinearSolver),
    Bordered(Box<Bordered<'a>>),
}

impl<'a> Deflated<'a> {
    pub fn new(
        equations: &'a Equations<'a>,
        x: &mut [f64],
        known: &'a Known<'a>,
        solver: &'a mut dyn LinearSolver,
    ) -> Self {
        let newton = match equations.model.unknowns().multipliers() {
            0 => Newton::Plain(solver),
            _ => Newton::Bordered(Box::new(Bordered::new(equations, x, solver))),
        };
        Deflated { equations, known, newton }
    }
}

impl Direction for Deflated<'_> {
    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let equations = self.equations;
        let (newton, scale) = match &mut self.newton {
            Newton::Plain(solver) => {
                let mut systems = TangentSystems::new(
                    equations.model,
                    equations.controls(),
                    equations.options.parallel,
                    &mut **solver,
                );
                let mut memory = None;
                let matrix = equations.tangent(here, &mut memory)?;
                let scale = equations.energy_scale(&*matrix, here.x, here.now);
                eliminate(equations.model, matrix);
                let rhs: Vec<f64> = here.residual.iter().map(|r| -r).collect();
                (systems.solve(matrix, here.x, &rhs, report)?, scale)
            }
            Newton::Bordered(bordered) => {
                let (step, _, scale) = bordered.newton(here, report)?;
                (step, scale)
            }
        };
        let (u, du) = (equations.model.nodal(here.x), equations.model.nodal(&newton));
        let (factor, size) = (self.known.factor(u, du), equations.model.unknowns().max_abs(du));
        let longest = MAX_STEP_RATIO * equations.diagonal() / size.max(f64::MIN_POSITIVE);
        let mut dx: Vec<f64> = newton.iter().map(|d| factor.clamp(-longest, longest) * d).collect();
        equations.keep_positive(here.x, &mut dx);
        Ok(Step { dx, curvature: Curvature::Positive, size, scale, take: Take::Longest { least: 0.0 } })
    }
}

impl Equations<'_> {
    /// Shortens the steps of multipliers that would become negative.
    pub(super) fn keep_positive(&self, x: &[f64], dx: &mut [f64]) {
        let dofs = self.dofs();
        for (k, _) in self.model.inequalities().iter().enumerate().filter(|(_, inequality)| **inequality) {
            dx[dofs + k] = dx[dofs + k].max(-x[dofs + k]);
        }
    }
}
