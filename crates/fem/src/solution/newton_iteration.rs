//! [`Model::iterate_once`]: one iteration of Newton's method as a step of its own.

use crate::contributions::controls::Controls;
use crate::contributions::instant::TimeStep;
use crate::error::StateError;
use crate::model::Model;
use crate::solution::newton::{Newton, Stop, moved};
use crate::solution::options::SolveOptions;
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent_systems::{TangentSystems, eliminate};
use crate::solution::workspace::Workspace;
use crate::time::modal_step::ModalStep;
use nastic_linear::LinearSolver;

impl Model {
    /// The solution of the equations of a time step, linearised at a state: `u - K^-1 r`, taken whole, but for the part in modes that move otherwise. The report tells the residual that
    /// is left.
    ///
    /// # Errors
    /// [`StateError::Inadmissible`] where J <= 0 there, [`StateError::Linear`] where K is not positive definite.
    pub(crate) fn iterate_once(
        &self,
        controls: &Controls,
        from: &State,
        (how, time_step): (&SolveOptions, &TimeStep),
        modes: Option<&ModalStep>,
        workspace: &mut Workspace,
    ) -> Result<State, StateError> {
        self.check_controls(controls)?;
        if how.cancelled() {
            return Err(StateError::Cancelled);
        }
        let newton = self.newton(controls, 1.0, Some(time_step), 1.0, how);
        let mut report = SolveReport { load_steps: 1, ..SolveReport::default() };
        let found = newton.iterate(&from.u, modes, self.linear_solver(how, workspace), &mut report);
        match found {
            Ok(u) => Ok(State::equilibrium(u, controls.clone(), 1.0, report)),
            Err(stop) => {
                workspace.forget();
                Err(match stop {
                    Stop::Inadmissible(at) => StateError::inadmissible(at, 1.0, 0, Box::new(from.clone())),
                    Stop::Linear(error) => error.into(),
                    Stop::Slow { .. } | Stop::Cancelled => StateError::Cancelled,
                })
            }
        }
    }
}

impl Newton<'_> {
    fn iterate(
        &self,
        u: &[f64],
        modes: Option<&ModalStep>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, Stop> {
        let mut systems = TangentSystems::new(self.model, self.options.parallel, solver);
        let (residual, _) = self.residual(&self.evaluate(u)?);
        let jump = self.jump(u);
        let mut matrix = self.model.matrix();
        self.model.add_tangent(&self.at(u), &mut matrix)?;
        let rhs = self.right_hand_side(&matrix, &residual, jump.as_deref());
        eliminate(self.model, &mut matrix);
        let mut step = systems.solve_definite(&matrix, u, &rhs, report)?;
        if let Some(jump) = &jump {
            self.prescribe(&mut step, jump);
        }
        if let Some(modes) = modes {
            modes.replace(&mut step);
        }
        let end = moved(u, &step, 1.0);
        let next = self.evaluate(&end)?;
        let (_, relative) = self.residual(&next);
        report.newton = 1;
        self.record(&next, relative, report);
        self.tell(1.0, &next, report);
        Ok(end)
    }
}
