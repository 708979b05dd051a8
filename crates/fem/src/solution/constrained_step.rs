//! The step of Newton's method under constraints: the linearised equations and inequalities.

use crate::error::Inadmissible;
use crate::solution::active_set::{Trial, settle};
use crate::solution::newton::Newton;
use crate::solution::saddle_point::SaddlePoint;
use crate::solution::state::SolveReport;
use crate::solution::tangent_systems::{FULL_STEP, TangentSystems};
use nastic_linear::LinearError;

/// Shifts of K, as shares of its mean diagonal: the least, from one to the next, the largest.
const SHIFTS: (f64, f64, f64) = (1e-8, 8.0, 1e3);
/// What the linear systems' solutions may be wrong by: of the change of a constraint this share, beside the rounding of the constraint itself.
const INEXACT: f64 = 1e-6;
const ROUNDED: f64 = 8.0 * f64::EPSILON;
/// Times that, what constraints that yield leave of one that touches.
const TOUCHING: f64 = 10.0;

/// What a step solves.
pub(super) struct Linearised<'a> {
    pub u: &'a [f64],
    /// Minus the residual; of inequalities `g`, whether they act or not.
    pub rhs: &'a [f64],
    /// By constraint.
    pub inequalities: &'a [bool],
    /// What the rounding of each is measured against, where there are inequalities.
    pub scales: &'a [f64],
}

/// What a step leads to: the step, the negative eigenvalues of the system beyond one for each constraint that acts, and which constraints
/// act or touch.
type Found = (Vec<f64>, usize, Vec<bool>);

/// Makes the multipliers of inequalities what they may be: in an extrapolated guess they may be negative.
pub(super) fn start_positive(inequalities: &[bool], multipliers: &mut [f64]) {
    let own = multipliers.iter_mut().zip(inequalities).filter(|(_, inequality)| **inequality);
    own.for_each(|(p, _)| *p = p.max(0.0));
}

impl Newton<'_> {
    /// Puts the residuals `-g` of all inequalities, of slack ones too, among the others, and gives what their rounding is measured against.
    pub(super) fn put_slack(
        &self,
        u: &[f64],
        inequalities: &[bool],
        residual: &mut [f64],
    ) -> Result<Vec<f64>, Inadmissible> {
        if !inequalities.contains(&true) {
            return Ok(Vec::new());
        }
        let dofs = self.model.discretization().dofs();
        let of_them = self.model.inequality_residuals(&self.at(u))?;
        for k in (dofs..u.len()).filter(|k| inequalities[k - dofs]) {
            residual[k] = of_them.force[k];
        }
        Ok(of_them.force_scale[dofs..].to_vec())
    }

    /// The step, and the negative eigenvalues of the system beyond one for each constraint that acts; `None` where rounding decides, or
    /// no set of acting inequalities is right.
    pub(super) fn constrained_step(
        &self,
        system: &mut SaddlePoint,
        systems: &mut TangentSystems,
        problem: &Linearised,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Option<usize>), LinearError> {
        let Linearised { u, rhs, inequalities, .. } = *problem;
        let u = self.model.nodal(u);
        system.prepare(systems, u, report)?;
        if !inequalities.contains(&true) {
            let (mut steps, negative) = system.solve(systems, u, &[rhs], FULL_STEP, report)?;
            return Ok((steps.pop().unwrap_or_default(), negative));
        }
        let mut last = Vec::new();
        let mut trial = |acting: &[bool], softened: bool| {
            system.set_acting(acting, softened);
            let trial = self.step_with(acting, system, systems, problem, report)?;
            last.clone_from(&trial.found.0);
            Ok(trial)
        };
        let (multipliers, g) = (&problem.u[u.len()..], &rhs[u.len()..]);
        let acts = |k: usize| !inequalities[k] || multipliers[k] > 0.0 || g[k] < 0.0;
        let settled = match settle((0..inequalities.len()).map(acts).collect(), |acting| trial(acting, false)) {
            // Of constraints that depend on each other some may be slack: yielding ones tell which.
            Err(LinearError::Border { .. }) => {
                let equations = inequalities.iter().map(|inequality| !inequality).collect();
                let yielding = settle(equations, |acting| trial(acting, true))?;
                let settled = yielding.map(|(_, _, touching)| trial(&touching, false)).transpose()?;
                // multipliers of the wrong sign were cut: the set is not right
                settled.filter(|settled| settled.wrong.iter().all(|wrong| *wrong == 0.0)).map(|settled| settled.found)
            }
            settled => settled?,
        };
        Ok(settled.map_or((last, None), |(step, negative, _)| (step, Some(negative))))
    }

    /// The step with a set of acting constraints; the multipliers of the others become 0.
    fn step_with(
        &self,
        acting: &[bool],
        system: &SaddlePoint,
        systems: &mut TangentSystems,
        problem: &Linearised,
        report: &mut SolveReport,
    ) -> Result<Trial<Found>, LinearError> {
        let Linearised { u, inequalities, scales, .. } = *problem;
        let (dofs, scalars) = (self.model.nodal(u).len(), acting.len());
        let mut rhs = problem.rhs.to_vec();
        let slack = || (0..scalars).filter(|&k| !acting[k]);
        slack().for_each(|k| system.add_column(k, u[dofs + k], &mut rhs[..dofs]));
        let (mut steps, negative) = system.solve(systems, &u[..dofs], &[&rhs], FULL_STEP, report)?;
        let negative = negative.ok_or_else(|| systems.uncounted(scalars))?;
        let mut step = steps.pop().unwrap_or_default();
        let (mut wrong, mut touching) = (vec![0.0; scalars], acting.to_vec());
        for k in (0..scalars).filter(|&k| inequalities[k] && acting[k]) {
            wrong[k] = (-u[dofs + k] - step[dofs + k]).max(0.0);
            step[dofs + k] = step[dofs + k].max(-u[dofs + k]);
        }
        for k in slack() {
            step[dofs + k] = -u[dofs + k];
            let change = system.slope(k, &step[..dofs]);
            let beyond = change - rhs[dofs + k];
            let noise = ROUNDED * scales[k] + INEXACT * change.abs();
            wrong[k] = if beyond > noise { beyond } else { 0.0 };
            touching[k] = beyond.abs() <= TOUCHING * noise;
        }
        Ok(Trial { found: (step, negative, touching), wrong })
    }

    /// With K shifted until it is positive definite on the null space of the derivatives of the constraints that act.
    pub(super) fn shifted_step(
        &self,
        system: &mut SaddlePoint,
        systems: &mut TangentSystems,
        problem: &Linearised,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        report.shifted += 1;
        let (mut shift, growth, most) = SHIFTS;
        let mut added = 0.0;
        while shift <= most {
            system.shift(shift - added);
            added = shift;
            if let (step, Some(0)) = self.constrained_step(system, systems, problem, report)? {
                return Ok(step);
            }
            shift *= growth;
        }
        Err(LinearError::Shift)
    }
}
