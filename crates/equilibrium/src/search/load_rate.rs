//! How fast an equilibrium moves along the way of controls and loads: where obstacles move, what they touch goes with them.

use crate::linear_systems::tangent_systems::{StepWanted, TangentSystems};
use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::search::options::SolveOptions;
use nastic_body::controls::Controls;
use nastic_body::state::{SolveReport, State};
use nastic_linear::solver::Curvature;

/// Length of the difference that gives the change of the residual, as a share of the change that contacts admit.
const DIFFERENCE_RATIO: f64 = 1e-4;
/// Relative residual of the linear system.
const LINEAR_TOLERANCE: f64 = 1e-3;

impl Model {
    /// How fast the equilibrium moves along the way, per share of it: `K du/ds = -dr/ds`, the latter by a difference over a small part of what contacts
    /// bear; a first guess, solved roughly. `None` where constraints or prescribed components that move have a part in it, and where K is not
    /// positive definite or may be singular, as contact alone holds the body.
    pub(crate) fn rate_along(
        &self,
        (here, from, to): (&State, &State, &Controls),
        how: &SolveOptions,
        done: f64,
        bears: f64,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Option<Vec<f64>> {
        let free = self.unknowns().multipliers() == 0 && self.unknowns().has_one_nodal_field();
        if !free || !self.checks().is_held_without_contact() {
            return None;
        }
        let length = DIFFERENCE_RATIO * bears * (1.0 - done);
        let next = done + length;
        let (controls, load) = (from.controls.blend(to, next), from.load + next * (1.0 - from.load));
        if self.unknowns().any(self.prescribed(&controls, load) != self.prescribed(&here.controls, here.load)) {
            return None;
        }
        let [now, nudged] = [(&*here.controls, here.load, done), (&controls, load, next)]
            .map(|(controls, load, share)| self.equations(controls, load, None, share, how));
        let [before, after] = [&now, &nudged].map(|newton| newton.evaluate(&here.u).map(|found| found.sums.force));
        let mut rhs: Vec<f64> = before.ok()?.iter().zip(&after.ok()?).map(|(a, b)| (a - b) / length).collect();
        self.supports.restrict(&mut rhs);
        let mut systems = TangentSystems::new(self, &here.controls, how.parallel, self.linear_solver(how, workspace));
        let tangent = now.at(&here.u, |at| self.eliminated(at, false)).ok()?;
        let (rate, curvature) =
            systems.step(&tangent, &here.u, &rhs, LINEAR_TOLERANCE, StepWanted::Newton, report).ok()?;
        (curvature != Curvature::Negative).then_some(rate)
    }
}
