//! How fast an equilibrium moves along the way of controls and loads: where obstacles move, what they touch goes with them.

use crate::contributions::controls::Controls;
use crate::contributions::instant::TimeStep;
use crate::model::Model;
use crate::solution::options::SolveOptions;
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent_systems::{TangentSystems, eliminate};
use crate::solution::workspace::Workspace;

/// Share of what contacts bear over which the change of the residual is taken.
const NUDGE: f64 = 1e-4;

impl Model {
    /// How fast the equilibrium moves along the way, per share of it: `K du/ds = -dr/ds`, the latter by a difference over a small part of what contacts
    /// bear; `None` where that cannot be had, or constraints have a part in it.
    pub(super) fn rate_along(
        &self,
        (here, from, to): (&State, &State, &Controls),
        (how, time_step): (&SolveOptions, Option<&TimeStep>),
        (done, bears): (f64, f64),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Option<Vec<f64>> {
        if self.unknowns().multipliers() > 0 || !self.unknowns().has_one_nodal_field() {
            return None;
        }
        let force = |controls: &Controls, load: f64, share: f64| {
            let newton = self.equations(controls, load, time_step, share, how);
            newton.evaluate(&here.u).map(|found| found.sums.force)
        };
        let length = NUDGE * bears * (1.0 - done);
        let next = done + length;
        let before = force(&here.controls, here.load, done).ok()?;
        let after = force(&from.controls.blend(to, next), from.load + next * (1.0 - from.load), next).ok()?;
        let mut rhs: Vec<f64> = before.iter().zip(&after).map(|(a, b)| (a - b) / length).collect();
        self.supports.clear(&mut rhs);
        let newton = self.equations(&here.controls, here.load, time_step, done, how);
        let mut matrix = self.matrix();
        newton.at(&here.u, |at| self.add_tangent(at, &mut matrix)).ok()?;
        eliminate(self, &mut matrix);
        let solver = self.linear_solver(how, workspace);
        TangentSystems::new(self, how.parallel, solver).solve(&matrix, &here.u, &rhs, report).ok()
    }
}
