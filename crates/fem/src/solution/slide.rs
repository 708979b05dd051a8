//! Steps in time with friction that are not found at once.

use crate::contributions::controls::Controls;
use crate::contributions::instant::TimeStep;
use crate::error::StateError;
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::state::{SolveReport, State};
use crate::solution::workspace::Workspace;

/// Multiples of the slip speed, one after the other: without friction, whose potential is searched; then friction that is nearly viscous, to
/// that asked for.
const SMOOTHING: [f64; 10] = [f64::INFINITY, 100.0, 30.0, 10.0, 5.0, 3.0, 2.0, 1.5, 1.2, 1.0];
/// Newton iterations for a step at once.
const ITERATIONS: usize = 20;

impl Model {
    /// The end of a step with friction: from its beginning at once, else by continuation in the slip speed, a load step each; `None` without
    /// friction, and where neither leads there.
    pub(super) fn slide(
        &self,
        near: &State,
        controls: &Controls,
        (how, step): (&SolveOptions, &TimeStep),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Option<State>, StateError> {
        if !self.depends_on_path() || !self.bears(near, controls, (how, step)) {
            return Ok(None);
        }
        let ways: [&[f64]; 2] = [&[1.0], &SMOOTHING];
        for factors in ways {
            let mut u = near.u.to_vec();
            let mut reached = true;
            for &smoothing in factors {
                let most = if factors.len() == 1 { ITERATIONS } else { how.max_newton };
                let brief = SolveOptions { max_newton: how.max_newton.min(most), ..how.clone() };
                let smoothed = TimeStep { smoothing, ..step.clone() };
                let newton = self.equations(controls, 1.0, Some(&smoothed), 1.0, &brief);
                if let Err(stop) = newton.solve(&mut u, self.linear_solver(how, workspace), report) {
                    stop.final_error().map_or(Ok(()), Err)?;
                    reached = false;
                    break;
                }
            }
            if reached {
                report.load_steps += factors.len();
                return Ok(Some(State::equilibrium(u, controls.clone(), 1.0, *report)));
            }
            workspace.forget();
        }
        Ok(None)
    }

    /// Whether the controls may change at once: no obstacle moves by more than a few layers. Else it goes in load steps.
    pub(super) fn bears(&self, near: &State, controls: &Controls, (how, step): (&SolveOptions, &TimeStep)) -> bool {
        let at = self.instant(near, Some(step), how.parallel);
        self.admissible_change(&at, controls).is_ok_and(|share| share >= 1.0)
    }
}
