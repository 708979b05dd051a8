//! [`Plain`]: Newton's step by the displacement.

use super::{Direction, Step, Take};
use crate::linear_systems::tangent::{Tangent, TangentRef};
use crate::linear_systems::tangent_systems::{StepWanted, TangentSystems};
use crate::nonlinear::equations::{Equations, Jump};
use crate::nonlinear::iterate::{Iterate, Stop};
use crate::nonlinear::iteration::STAGNATION_TOLERANCE;
use crate::nonlinear::predicted_pressures::PredictedPressures;
use nastic_body::error::Inadmissible;
use nastic_body::state::SolveReport;
use nastic_body::strategy::Strategy;
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearError, LinearSolver};

/// Largest relative residual of a step that moves prescribed components, which is taken whole; at rest there is no residual yet to compare
/// with. Steps shorter than this share of the body are solved to a residual equal to their length, since they may reach the accuracy asked
/// for at once.
const MAX_JUMP_TOLERANCE: f64 = 1e-2;

/// Share of a step of prescribed components in time below which it fails.
pub(super) const MIN_JUMP_SHARE: f64 = 0.05;
/// Relative residual of a step without the curvature of contacts, which is not Newton's.
pub(super) const MAX_FLAT_STEP_RESIDUAL: f64 = 1e-3;
/// Largest residual of a step with the factor of an earlier tangent over the one asked for: with predicted pressures the next step does not correct it.
const MAX_REUSED_RESIDUAL_RATIO: f64 = 10.0;
/// Smallest relative residual that such a step is compared with, above that of multigrid.
const MIN_REUSED_TOLERANCE: f64 = 2e-5;
/// Share of the residual with predicted pressures that a step may leave.
const PRESSURE_RESIDUAL_SHARE: f64 = 0.1;

/// `K du = -r`, to an accuracy that follows the residual, or with the tangent of predicted pressures; prescribed components move in the first step, at once or not at all.
pub(crate) struct Plain<'a> {
    equations: &'a Equations<'a>,
    systems: TangentSystems<'a>,
    tangent: Option<Tangent>,
    rhs: Vec<f64>,
    jump: Jump,
    /// Whether a step has taken a share of the jump alone.
    partly: bool,
    /// Whether the tangent is without the curvature of contacts.
    flat: bool,
    pressures: Option<PredictedPressures<'a>>,
}

impl<'a> Plain<'a> {
    pub fn new(equations: &'a Equations<'a>, u: &[f64], solver: &'a mut dyn LinearSolver) -> Self {
        let systems = TangentSystems::new(equations.model, equations.controls(), equations.options.parallel, solver);
        let jump = equations.jump(u);
        let (tangent, rhs, pressures) = (None, Vec::new(), None);
        Plain { equations, systems, tangent, rhs, jump, partly: false, flat: false, pressures }
    }

    /// With pressures that every step predicts.
    pub fn with_pressures(self, pressures: PredictedPressures<'a>) -> Self {
        Plain { pressures: Some(pressures), ..self }
    }
}

impl Direction for Plain<'_> {
    fn is_pending(&self) -> bool {
        self.jump.is_some() || self.partly
    }

    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let products = self.systems.takes_products() && self.pressures.is_none();
        match self.step(here, products, report) {
            Err(Stop::Linear(LinearError::NoEntries)) => self.step(here, false, report),
            found => found,
        }
    }

    /// With a tangent without the curvature of contacts, or with a shifted one.
    fn downhill(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Vec<f64>, Stop> {
        if !self.flat && self.pressures.is_none() && self.equations.may_flatten() {
            let (dx, curvature) = self.flat_step(here, report)?;
            if curvature == Curvature::Positive {
                return Ok(dx);
            }
        }
        let Some(tangent) = &self.tangent else { return Err(Stop::Slow { residual: here.relative }) };
        let dx = match self.systems.shifted_step(tangent, here.x, &self.rhs, report) {
            Err(LinearError::NoEntries) => {
                let tangent = self.equations.tangent_or_products(here, false, &mut self.tangent)?;
                tangent.eliminate(self.equations.model);
                self.systems.shifted_step(&*tangent, here.x, &self.rhs, report)?
            }
            found => found?,
        };
        self.begin(here, &dx)?;
        Ok(dx)
    }

    fn pressures(&self) -> Option<&PredictedPressures<'_>> {
        self.pressures.as_ref()
    }

    fn took(&mut self, share: f64) {
        self.partly &= share < 1.0;
        if let Some(pressures) = &mut self.pressures {
            pressures.end(share);
        }
    }
}

impl Plain<'_> {
    /// With products of cells instead of entries, if asked for and the model has them.
    fn step(&mut self, here: &Iterate, products: bool, report: &mut SolveReport) -> Result<Step, Stop> {
        if self.partly {
            (self.jump, self.partly) = (self.equations.jump(here.x), false);
        }
        self.flat = self.pressures.is_none() && self.equations.flattens(here);
        if self.flat {
            report.strategies.count(Strategy::FlatContacts);
        }
        let equations = &Equations { flat_contacts: self.flat, ..*self.equations };
        let tangent = equations.tangent_or_products(here, products, &mut self.tangent)?;
        let mut soft = 1.0;
        if let (Some(pressures), Some(matrix)) = (&mut self.pressures, tangent.entries_mut()) {
            let share = pressures.add(here, matrix)?;
            // a whole step has the pressures of its changes of volume
            self.systems.expect_changes(self.jump.is_none().then(|| pressures.expected_changes()));
            soft = PRESSURE_RESIDUAL_SHARE * share;
        }
        self.rhs = equations.right_hand_side(&*tangent, here.residual, self.jump.as_deref());
        let scale = equations.energy_scale(&*tangent, here.x, here.now);
        tangent.eliminate(equations.model);
        let accuracy = match &self.jump {
            Some(jump) => (equations.model.unknowns().max_abs(jump) / equations.diagonal())
                .clamp(STAGNATION_TOLERANCE, MAX_JUMP_TOLERANCE),
            None => forcing(here.relative, equations.options.accuracy).min(soft),
        };
        let wanted = (accuracy, StepWanted::Newton);
        let kept = report.reused;
        let (mut dx, mut curvature) = self.systems.step(&*tangent, here.x, &self.rhs, wanted.0, wanted.1, report)?;
        if self.pressures.is_some() && self.systems.changes_left().is_none() {
            let left = || left_by(&*tangent, &dx, &self.rhs, equations);
            let poor = curvature == Curvature::CutShort
                || report.reused > kept
                    && curvature == Curvature::Positive
                    && left() > MAX_REUSED_RESIDUAL_RATIO * accuracy.max(MIN_REUSED_TOLERANCE);
            if poor {
                self.systems.forget();
                (dx, curvature) = self.systems.step(&*tangent, here.x, &self.rhs, wanted.0, wanted.1, report)?;
            }
        }
        let jump = self.jump.take();
        if let Some(jump) = &jump {
            equations.prescribe(&mut dx, jump);
        }
        self.begin(here, &dx)?;
        if jump.is_some() {
            let whole = Step::whole(dx, curvature, equations.model.unknowns());
            // what a step in time passes through is cleared by the next iteration
            self.partly = equations.is_step();
            let take = if self.partly { Take::Longest { least: MIN_JUMP_SHARE } } else { whole.take };
            return Ok(Step { scale, take, ..whole });
        }
        Ok(Step { size: equations.model.unknowns().max_abs(&dx), dx, curvature, scale, take: Take::Search })
    }

    /// With the tangent without the curvature of contacts, to which the present one changes.
    fn flat_step(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<(Vec<f64>, Curvature), Stop> {
        report.strategies.count(Strategy::FlatContacts);
        let flat = Equations { flat_contacts: true, ..*self.equations };
        let tangent = flat.tangent_or_products(here, false, &mut self.tangent)?;
        tangent.eliminate(flat.model);
        self.systems.forget();
        let wanted = StepWanted::Newton;
        Ok(self.systems.step(&*tangent, here.x, &self.rhs, MAX_FLAT_STEP_RESIDUAL, wanted, report)?)
    }

    fn begin(&mut self, here: &Iterate, dx: &[f64]) -> Result<(), Inadmissible> {
        self.pressures.as_mut().map_or(Ok(()), |pressures| pressures.begin(here, dx, self.systems.changes_left()))
    }
}

impl Equations<'_> {
    /// `-r - K d` on free unknowns, d the jump of the prescribed ones.
    pub(super) fn right_hand_side<'m>(
        &self,
        tangent: impl Into<TangentRef<'m>>,
        residual: &[f64],
        jump: Option<&[f64]>,
    ) -> Vec<f64> {
        let mut rhs: Vec<f64> = residual.iter().map(|r| -r).collect();
        if let Some(jump) = jump {
            let mut pulled = vec![0.0; jump.len()];
            tangent.into().multiply(jump, &mut pulled, self.options.parallel);
            self.model.unknowns().add_up(&mut pulled);
            rhs.iter_mut().zip(&pulled).for_each(|(r, p)| *r -= p);
            self.model.supports.restrict(&mut rhs);
        }
        rhs
    }

    /// Puts the jump of the prescribed components into a step.
    pub(super) fn prescribe(&self, step: &mut [f64], jump: &[f64]) {
        for ((s, &d), &fixed) in step.iter_mut().zip(jump).zip(self.model.supports.fixed()) {
            if fixed {
                *s = d;
            }
        }
    }
}

/// Relative residual of a step.
fn left_by<'m>(tangent: impl Into<TangentRef<'m>>, dx: &[f64], rhs: &[f64], equations: &Equations) -> f64 {
    let (space, mut left) = (equations.model.unknowns(), vec![0.0; dx.len()]);
    tangent.into().multiply(dx, &mut left, equations.options.parallel);
    left.iter_mut().zip(rhs).for_each(|(left, rhs)| *left -= rhs);
    space.norm(&left) / space.norm(rhs)
}

/// Forcing term, the relative residual of a Newton step: ten times the residual itself, which keeps convergence quadratic, at
/// most a tenth, and at least a thousandth of the final residual. Dembo, Eisenstat, Steihaug, SIAM J. Numer. Anal. 19 (1982).
pub(super) fn forcing(relative: f64, accuracy: f64) -> f64 {
    (10.0 * relative).clamp(1e-10, 0.1).max(1e-3 * accuracy / relative)
}
