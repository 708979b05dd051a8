//! [`Linearised`]: the one step of a linearly implicit time scheme.

use super::{Direction, Step, Take};
use crate::linear_systems::tangent_systems::{TangentSystems, eliminate};
use crate::nonlinear::equations::Equations;
use crate::nonlinear::iterate::{Iterate, Stop};
use nastic_body::state::SolveReport;
use nastic_linear::LinearSolver;
use nastic_linear::solver::Curvature;

/// Puts the part of a step that moves otherwise in its place.
pub type StepCorrection<'a> = &'a dyn Fn(&mut [f64]);

/// `K du = -r` with a positive definite tangent, taken whole, but for the part in modes that move otherwise.
pub(crate) struct Linearised<'a> {
    pub equations: &'a Equations<'a>,
    /// What moves a part of the step otherwise.
    pub replace: Option<StepCorrection<'a>>,
    pub solver: &'a mut dyn LinearSolver,
}

impl Direction for Linearised<'_> {
    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let equations = self.equations;
        let mut systems =
            TangentSystems::new(equations.model, equations.controls(), equations.options.parallel, &mut *self.solver);
        let (jump, mut memory) = (equations.jump(here.x), None);
        let matrix = equations.tangent(here, &mut memory)?;
        let rhs = equations.right_hand_side(&*matrix, here.residual, jump.as_deref());
        eliminate(equations.model, matrix);
        let mut dx = systems.solve_definite(matrix, here.x, &rhs, report)?;
        if let Some(jump) = &jump {
            equations.prescribe(&mut dx, jump);
        }
        if let Some(replace) = self.replace {
            replace(&mut dx);
        }
        let whole = Step::whole(dx, Curvature::Positive, equations.model.unknowns());
        Ok(Step { take: Take::Once, ..whole })
    }
}
