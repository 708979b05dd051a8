//! Steps of a [`SaddlePoint`] of which all constraints are local.

use super::saddle_point::SaddlePoint;
use super::tangent_systems::{StepWanted, TangentSystems};
use nastic_body::state::SolveReport;
use nastic_linear::LinearError;
use nastic_linear::solver::Curvature;

impl SaddlePoint {
    /// The step of a system of which all constraints are local, by the unknowns that these leave free, to a relative residual, and the curvature there.
    ///
    /// # Errors
    /// [`LinearError::Border`] where one is not local or they depend on each other; those of the solver.
    pub fn step(
        &self,
        systems: &mut TangentSystems,
        u: &[f64],
        rhs: &[f64],
        tolerance: f64,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Curvature), LinearError> {
        let mut curvature = Curvature::Positive;
        let step = self.without_border(rhs, |f| {
            let (x, found) = systems.step(&self.matrix, u, f, tolerance, StepWanted::Newton, report)?;
            curvature = found;
            Ok(x)
        })?;
        Ok((step, curvature))
    }

    /// The same with the matrix shifted until it is positive definite.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn shifted_step(
        &self,
        systems: &mut TangentSystems,
        u: &[f64],
        rhs: &[f64],
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        self.without_border(rhs, |f| {
            report.shifted += 1;
            systems.shifted_step(&self.matrix, u, f, report)
        })
    }
}
