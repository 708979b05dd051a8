//! [`AlongRigidMotions`]: Newton's step of a body with rigid parts, by the unknowns that these leave free.

use super::bordered::failed;
use super::plain::{MAX_FLAT_STEP_RESIDUAL, MIN_JUMP_SHARE, forcing};
use super::{Direction, Step, Take};
use crate::linear_systems::saddle_point::SaddlePoint;
use crate::linear_systems::tangent_systems::TangentSystems;
use crate::nonlinear::equations::{Equations, Jump};
use crate::nonlinear::iterate::{Iterate, Stop};
use nastic_body::state::SolveReport;
use nastic_body::strategy::Strategy;
use nastic_linear::LinearSolver;
use nastic_linear::solver::Curvature;

/// `[K B; B^T 0] [du; dp] = -[r; g]` with all constraints [eliminated](SaddlePoint::step), in a step in time whose iterates
/// [stay on them](Equations::stays_rigid): the matrix that is left is that of the potential along rigid motions, without a border, and where it is not positive definite it is
/// shifted. As without constraints, tangents far from the end of the step leave out the curvature of contacts.
pub(crate) struct AlongRigidMotions<'a> {
    equations: &'a Equations<'a>,
    systems: TangentSystems<'a>,
    jump: Jump,
    /// Whether a step has taken a share of the jump alone.
    partly: bool,
    /// The last system with its right-hand side, and whether it is without the curvature of contacts.
    last: Option<(SaddlePoint, Vec<f64>, bool)>,
}

impl<'a> AlongRigidMotions<'a> {
    pub fn new(equations: &'a Equations<'a>, x: &[f64], solver: &'a mut dyn LinearSolver) -> Self {
        let systems = TangentSystems::new(equations.model, equations.controls(), equations.options.parallel, solver);
        AlongRigidMotions { equations, systems, jump: equations.jump(x), partly: false, last: None }
    }

    /// The system at an iterate, with its right-hand side and the energy that rounding is measured against.
    fn system(&self, here: &Iterate, flat: bool) -> Result<(SaddlePoint, Vec<f64>, f64), Stop> {
        let equations = Equations { flat_contacts: flat, ..*self.equations };
        let tangent = equations.bordered_tangent(here.point, here.x)?;
        let rhs = equations.bordered_right_hand_side(&tangent, here.residual, self.jump.as_deref());
        let scale = equations.energy_scale(&tangent.matrix, here.x, here.now);
        Ok((SaddlePoint::new(equations.model, tangent), rhs, scale))
    }
}

impl Direction for AlongRigidMotions<'_> {
    fn is_pending(&self) -> bool {
        self.jump.is_some() || self.partly
    }

    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let (equations, unknowns) = (self.equations, self.equations.model.unknowns());
        if self.partly {
            (self.jump, self.partly) = (equations.jump(here.x), false);
        }
        let flat = equations.flattens(here);
        if flat {
            report.strategies.count(Strategy::FlatContacts);
        }
        let (system, rhs, scale) = self.system(here, flat)?;
        let u = equations.model.nodal(here.x);
        let accuracy = forcing(here.relative, equations.options.accuracy);
        let solved = system.step(&mut self.systems, u, &rhs, accuracy, report);
        let (mut dx, curvature) = solved.map_err(|error| failed(error, here))?;
        self.last = Some((system, rhs, flat));
        if let Some(jump) = self.jump.take() {
            equations.prescribe(&mut dx, &jump);
            self.partly = true;
            let take = Take::Longest { least: MIN_JUMP_SHARE };
            return Ok(Step { scale, take, ..Step::whole(dx, curvature, unknowns) });
        }
        let size = unknowns.max_abs(&dx[..equations.dofs()]);
        Ok(Step { size, dx, curvature, scale, take: Take::Search })
    }

    /// With a tangent without the curvature of contacts, or with a shifted one.
    fn downhill(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Vec<f64>, Stop> {
        let slow = || Stop::Slow { residual: here.relative };
        let u = self.equations.model.nodal(here.x);
        let (_, rhs, flat) = self.last.as_ref().ok_or_else(slow)?;
        if !flat && self.equations.may_flatten() {
            report.strategies.count(Strategy::FlatContacts);
            let rhs = rhs.clone();
            let (system, ..) = self.system(here, true)?;
            self.systems.forget();
            let solved = system.step(&mut self.systems, u, &rhs, MAX_FLAT_STEP_RESIDUAL, report);
            self.last = Some((system, rhs, true));
            match solved.map_err(|error| failed(error, here))? {
                (dx, Curvature::Positive) => return Ok(dx),
                _ => self.systems.forget(),
            }
        }
        let (system, rhs, _) = self.last.as_ref().ok_or_else(slow)?;
        system.shifted_step(&mut self.systems, u, rhs, report).map_err(|error| failed(error, here))
    }

    fn took(&mut self, share: f64) {
        self.partly &= share < 1.0;
    }
}
