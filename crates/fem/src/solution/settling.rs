//! Equilibria of what contact alone holds: it is let down to them.

use crate::model::Model;
use crate::nonlinear::anchor::Anchor;
use crate::nonlinear::equations::Equations;
use crate::nonlinear::iteration::{Limits, ROUNDING, Stop};
use crate::solution::options::SolveOptions;
use crate::solution::state::SolveReport;
use crate::solution::workspace::Workspace;
use nastic_linear::solver::Curvature;
use nastic_numeric::vector::sub;

/// Newton iterations of all steps.
const MOST: usize = 1000;
/// How far a free body goes in the first one, as a share of the body's diagonal.
const FIRST: f64 = 0.05;
/// How far nodes may go before nothing is expected to stop them, in diagonals.
const FAR: f64 = 20.0;
/// What the anchor becomes after a step: as much smaller as the residual, by these shares at most and at least, the latter after more than so many iterations another
/// one; and after a step that was not found.
const WEAKER: (f64, f64, f64) = (0.03, 0.25, 0.7);
const EASY: usize = 6;
const STRONGER: f64 = 8.0;
/// Newton iterations of a step, and what they leave of the residual.
const EACH: usize = 40;
const ROUGH: f64 = 1e-6;
const EXACT: f64 = 1e-3;
/// Newton iterations to the equilibrium once something holds every part.
const AT_LAST: usize = 20;

impl Model {
    /// Whether contact, or little more, holds a part of the body in an equilibrium that is the minimum of a potential.
    pub(crate) fn settles(&self) -> bool {
        let is_loose = || !self.supports.ties().is_empty() || !self.is_held_without_contact();
        self.touches_something() && self.has_potential() && !self.is_over_ranks() && is_loose()
    }

    /// From u to an equilibrium of less potential P, by steps each of which minimises
    ///
    /// ```text
    /// P(u) + (s/2) sum_a V_a |u_a - c_a|^2
    /// ```
    ///
    /// c the end of the step before: a body that nothing holds yet falls by its weight over s, lands, and tilts until it lies; what may roll or slide on rests where
    /// it came to, though the tangent of P is singular there. As P falls with every step, what is found is no saddle. s becomes smaller as the residual does, so that the last
    /// steps converge faster than linearly. Where it stops short, u is the last end.
    ///
    /// Source: Kelley and Keyes, Convergence Analysis of Pseudo-Transient Continuation, SIAM J. Numer. Anal. 35 (1998); Rockafellar, Monotone Operators and the Proximal
    /// Point Algorithm, SIAM J. Control Optim. 14 (1976).
    pub(super) fn settle(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        let (options, start, spent) = (newton.options, u.clone(), report.newton);
        let (mut relative, mut stiffness, least) = self.first_anchor(newton, u)?;
        let mut before = f64::INFINITY;
        while report.newton - spent < MOST {
            // as far as double precision goes
            let stagnates = relative <= ROUNDING && relative > 0.5 * before;
            if newton.jump(u).is_none() && (relative <= options.accuracy || stagnates) {
                return Ok(());
            }
            if newton.at(u, |at| self.free_motion(at)).is_none() && self.arrives(newton, u, workspace, report)? {
                return Ok(());
            }
            let at_step = report.newton;
            match self.anchored(newton, u, (stiffness, relative), workspace, report) {
                Ok(left) => {
                    let least_share = if report.newton - at_step <= EASY { WEAKER.1 } else { WEAKER.2 };
                    let share = (left / relative.max(f64::MIN_POSITIVE)).clamp(WEAKER.0, least_share);
                    stiffness = (share * stiffness).max(least);
                    (before, relative) = (relative, left);
                    let gone = self.unknowns().max_abs(&sub(self.nodal(u), self.nodal(&start)));
                    if gone > FAR * newton.diagonal() {
                        return Err(Stop::Slow { residual: relative });
                    }
                }
                Err(stop) if stop.is_final() => return Err(stop),
                Err(_) => {
                    workspace.forget();
                    stiffness *= STRONGER;
                }
            }
        }
        Err(Stop::Slow { residual: relative })
    }

    /// One step from u with an anchor there, and the residual that it leaves without; where it is not found, u stays.
    fn anchored(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        (stiffness, relative): (f64, f64),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<f64, Stop> {
        let accuracy = (EXACT * relative).clamp(0.5 * newton.options.accuracy, ROUGH);
        let options = SolveOptions { accuracy, ..newton.options.clone() };
        let anchor = Anchor::new(self, u, stiffness);
        let step = Equations { anchor: Some(&anchor), options: &options, ..*newton };
        let (mut end, limits) = (u.clone(), Limits::new(EACH.min(options.max_newton), accuracy));
        step.solve_within(limits, &mut end, self.linear_solver(newton.options, workspace), report)?;
        let now = newton.evaluate(&end)?;
        let left = newton.residual(&now.sums).1;
        (report.residual, report.energy) = (left, now.sums.energy);
        *u = end;
        Ok(left)
    }

    /// Newton's method from where something resists every motion; false where it does not arrive at a minimum.
    fn arrives(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<bool, Stop> {
        let (mut end, limits) = (u.clone(), Limits::new(AT_LAST, newton.options.accuracy));
        match newton.solve_within(limits, &mut end, self.linear_solver(newton.options, workspace), report) {
            Ok(Curvature::Positive) => {
                *u = end;
                Ok(true)
            }
            Err(stop) if stop.is_final() => Err(stop),
            _ => {
                workspace.forget();
                Ok(false)
            }
        }
    }

    /// The relative residual at u, and of anchors the stiffness of the first, as much as lets forces that nothing balances move the body by a share of its size, and the
    /// least one.
    fn first_anchor(&self, newton: &Equations, u: &[f64]) -> Result<(f64, f64, f64), Stop> {
        let now = newton.evaluate(u)?;
        let (residual, relative) = newton.residual(&now.sums);
        let volume: f64 = self.discretization().nodal_volumes().iter().sum();
        let (block, dim) = (self.unknowns().block(), self.discretization().dim());
        let total = |i: usize| residual[..newton.dofs()].iter().skip(i).step_by(block).map(|r| r.abs()).sum();
        let density = (0..dim).map(total).fold(0.0, f64::max) / volume;
        let mut tangent = self.matrix();
        newton.at(u, |at| now.point.add_tangent(at, &mut tangent))?;
        let least = Anchor::least(self, &tangent);
        Ok((relative, (density / (FIRST * newton.diagonal())).max(least), least))
    }
}
