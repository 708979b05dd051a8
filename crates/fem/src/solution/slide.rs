//! Steps in time with friction that are not found at once.

use crate::contributions::controls::Controls;
use crate::contributions::instant::TimeStep;
use crate::error::StateError;
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::state::{SolveReport, State};
use crate::solution::workspace::Workspace;

/// Multiples of the slip speed, one after the other: what slides at a speed is nearly viscous friction at a hundred times that.
const SMOOTHING: [f64; 9] = [100.0, 30.0, 10.0, 5.0, 3.0, 2.0, 1.5, 1.2, 1.0];
/// Newton iterations for a step at once, and for each of those.
const ITERATIONS: usize = 30;

impl Model {
    /// The end of a step with friction: from its beginning at once, else by continuation in the slip speed; `None` without friction, and
    /// where neither leads there.
    pub(super) fn slide(
        &self,
        near: &State,
        controls: &Controls,
        (how, step): (&SolveOptions, &TimeStep),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Option<State>, StateError> {
        if !self.depends_on_path() {
            return Ok(None);
        }
        let brief = SolveOptions { max_newton: how.max_newton.min(ITERATIONS), ..how.clone() };
        let ways: [&[f64]; 2] = [&[1.0], &SMOOTHING];
        for (way, factors) in ways.into_iter().enumerate() {
            let mut u = near.u.to_vec();
            let mut reached = true;
            for &smoothing in factors {
                let smoothed = TimeStep { smoothing, ..step.clone() };
                let newton = self.equations(controls, 1.0, Some(&smoothed), 1.0, &brief);
                if let Err(stop) = newton.solve(&mut u, self.linear_solver(how, workspace), report) {
                    stop.final_error().map_or(Ok(()), Err)?;
                    reached = false;
                    break;
                }
            }
            if reached {
                report.load_steps += 1;
                report.restarts += way;
                return Ok(Some(State::equilibrium(u, controls.clone(), 1.0, *report)));
            }
            workspace.forget();
        }
        Ok(None)
    }
}
