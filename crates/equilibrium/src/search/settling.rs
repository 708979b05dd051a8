//! Equilibria of what contact alone holds, by proximal steps.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::nonlinear::anchor::Anchor;
use crate::nonlinear::equations::Equations;
use crate::nonlinear::iterate::Stop;
use crate::nonlinear::iteration::{Limits, MIN_STEP_RATIO, STAGNATION_TOLERANCE};
use crate::search::options::SolveOptions;
use nastic_body::contribution::Sums;
use nastic_body::state::SolveReport;
use nastic_linear::solver::Curvature;
use nastic_numeric::vector::sub;

/// Newton iterations of all steps.
const MAX_ITERATIONS: usize = 1000;
/// The same where prescribed components move.
const MAX_ITERATIONS_WITH_JUMP: usize = 200;
/// Displacement of a free body in the first step, as a share of the body's diagonal.
const FIRST_DISPLACEMENT_RATIO: f64 = 0.05;
/// Displacement of a node, in diagonals of the body, beyond which no contact is expected to stop it.
const MAX_DISPLACEMENT_RATIO: f64 = 20.0;
/// Smallest ratio of the anchor's stiffness to that of the step before, which follows the ratio of the residuals.
const MIN_ANCHOR_RATIO: f64 = 0.03;
/// Largest ratio behind a fast step.
const MAX_ANCHOR_RATIO: f64 = 0.25;
/// Largest ratio behind a slow step.
const MAX_ANCHOR_RATIO_SLOW: f64 = 0.7;
/// Newton iterations up to which a step is fast.
const MAX_FAST_ITERATIONS: usize = 6;
/// Growth of the anchor's stiffness after a step that failed.
const ANCHOR_GROWTH: f64 = 8.0;
/// Consecutive steps that may fail.
const MAX_FAILURES: usize = 12;
/// Newton iterations of a step.
const MAX_STEP_ITERATIONS: usize = 40;
/// Relative residual of a step over the one at its start.
const STEP_RESIDUAL_RATIO: f64 = 1e-3;
/// Largest relative residual of a step.
const MAX_STEP_RESIDUAL: f64 = 1e-6;
/// Newton iterations without an anchor, once something holds every part.
const MAX_FINAL_ITERATIONS: usize = 20;
/// Residual over that of the last attempt without an anchor, below which the next one is made.
const RETRY_RESIDUAL_RATIO: f64 = 0.1;
/// Rounding of the potential, as a share of the sum of its absolute terms.
const ENERGY_ROUNDING: f64 = 1e-12;

impl Model {
    /// Whether contact, or little more, holds a part of the body in an equilibrium that is the minimum of a potential: nothing else, or of rigid bodies springs and a
    /// foundation.
    pub(crate) fn settles(&self) -> bool {
        let is_loose = || match self.supports.ties().is_empty() {
            true => !self.checks().is_held_without_contact(),
            false => !self.is_held_by_supports(),
        };
        let suited =
            self.properties().has_potential() && !self.ranks().is_over_ranks() && self.unknowns().has_one_nodal_field();
        self.touches_something() && suited && is_loose()
    }

    /// From u to an equilibrium of less potential P, by proximal steps, each of which minimises
    ///
    /// ```text
    /// P(u) + (s/2) sum_a V_a |u_a - c_a|^2
    /// ```
    ///
    /// c the end of the step before. A body that nothing holds yet moves by its weight over s until contact holds it; a body that may still roll or slide stops where
    /// the steps converge, though the tangent of P is singular there. P decreases with every step. s decreases with the residual, so that the last
    /// steps converge superlinearly. Where the steps fail, u is the end of the last one.
    ///
    /// Source: Kelley and Keyes, Convergence Analysis of Pseudo-Transient Continuation, SIAM J. Numer. Anal. 35 (1998); Rockafellar, Monotone Operators and the Proximal
    /// Point Algorithm, SIAM J. Control Optim. 14 (1976).
    pub(crate) fn settle(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        let (options, start, spent) = (newton.options, u.clone(), report.newton);
        let (mut here, mut stiffness, least, unresolved) = self.first_anchor(newton, u, report)?;
        let (mut before, mut tried) = (f64::INFINITY, f64::INFINITY);
        let (mut steps, mut failures, mut went) = (0, 0, f64::INFINITY);
        // shorter moves of supports may succeed where this one fails
        let most = if newton.jump(u).is_some() { MAX_ITERATIONS_WITH_JUMP } else { MAX_ITERATIONS };
        while report.newton - spent < most && steps < most {
            steps += 1;
            // as far as double precision goes
            let stagnates = here.relative <= STAGNATION_TOLERANCE && here.relative > 0.5 * before && stiffness <= least;
            // forces of a body without stress are rounding, however large they are relative to each other
            let rests = here.force <= unresolved && went <= MIN_STEP_RATIO * newton.diagonal();
            let moves = newton.jump(u).is_some();
            if !moves && (here.relative <= options.accuracy || stagnates || rests) {
                return Ok(());
            }
            if here.relative < RETRY_RESIDUAL_RATIO * tried && newton.at(u, |at| self.free_motion(at)).is_none() {
                if self.arrives(newton, u, workspace, report)? {
                    return Ok(());
                }
                tried = here.relative;
            }
            let (at_step, from) = (report.newton, u.clone());
            match self.proximal_step(newton, u, (stiffness, &here, moves), workspace, report) {
                Ok(left) => {
                    let fast = report.newton - at_step <= MAX_FAST_ITERATIONS;
                    let share = left.relative / here.relative.max(f64::MIN_POSITIVE);
                    let largest = if fast { MAX_ANCHOR_RATIO } else { MAX_ANCHOR_RATIO_SLOW };
                    stiffness = (share.clamp(MIN_ANCHOR_RATIO, largest) * stiffness).max(least);
                    (before, here, failures) = (here.relative, left, 0);
                    went = self.unknowns().max_abs(&sub(self.nodal(u), self.nodal(&from)));
                    let gone = self.unknowns().max_abs(&sub(self.nodal(u), self.nodal(&start)));
                    if gone > MAX_DISPLACEMENT_RATIO * newton.diagonal() {
                        return Err(Stop::Lost { residual: here.relative });
                    }
                }
                Err(stop) if stop.is_final() || matches!(stop, Stop::Linear(_)) || failures == MAX_FAILURES => {
                    return Err(stop);
                }
                Err(_) => {
                    workspace.forget();
                    (stiffness, failures) = (ANCHOR_GROWTH * stiffness, failures + 1);
                }
            }
        }
        let residual = here.relative;
        Err(if most == MAX_ITERATIONS { Stop::Lost { residual } } else { Stop::Slow { residual } })
    }

    /// One step from u with an anchor there: the iterate without the anchor. u stays where the step fails or leads to no minimum.
    fn proximal_step(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        (stiffness, here, moves): (f64, &Here, bool),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Here, Stop> {
        let accuracy = (STEP_RESIDUAL_RATIO * here.relative).min(MAX_STEP_RESIDUAL).max(0.5 * newton.options.accuracy);
        let options = SolveOptions { accuracy, ..newton.options.clone() };
        let anchor = Anchor::new(self, u, stiffness);
        let step = Equations { anchor: Some(&anchor), options: &options, ..*newton };
        let (mut end, limits) = (u.clone(), Limits::new(MAX_STEP_ITERATIONS.min(options.max_newton), accuracy));
        let curvature = step.solve_within(limits, &mut end, self.linear_solver(newton.options, workspace), report)?;
        let left = Here::at(newton, &end, report)?;
        let rises = !moves && left.energy > here.energy + left.rounding;
        if curvature != Curvature::Positive || rises {
            return Err(Stop::Slow { residual: left.relative });
        }
        *u = end;
        Ok(left)
    }

    /// Newton's method without an anchor, where something resists every motion; false where it does not converge to a minimum.
    fn arrives(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<bool, Stop> {
        let (mut end, limits) = (u.clone(), Limits::new(MAX_FINAL_ITERATIONS, newton.options.accuracy));
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

    /// The iterate at u; the stiffness of the first anchor, with which the unbalanced forces move the body by a share of its size; the least stiffness; and the
    /// forces of displacements that double precision does not resolve.
    fn first_anchor(
        &self,
        newton: &Equations,
        u: &[f64],
        report: &mut SolveReport,
    ) -> Result<(Here, f64, f64, f64), Stop> {
        let now = newton.evaluate(u)?;
        let (here, residual) = Here::of(newton, &now.sums, report);
        let volume: f64 = self.discretization().nodal_volumes().iter().sum();
        let (block, dim) = (self.unknowns().block(), self.discretization().dim());
        let total = |i: usize| residual[..newton.dofs()].iter().skip(i).step_by(block).map(|r| r.abs()).sum();
        let density = (0..dim).map(total).fold(0.0, f64::max) / volume;
        let mut tangent = self.tangents().matrix();
        newton.at(u, |at| now.point.add_tangent(at, &mut tangent))?;
        let least = Anchor::least(self, &tangent);
        let unresolved = MIN_STEP_RATIO * newton.diagonal() * self.unknowns().norm(&tangent.diagonal());
        Ok((here, (density / (FIRST_DISPLACEMENT_RATIO * newton.diagonal())).max(least), least, unresolved))
    }
}

/// The iterate between two steps.
struct Here {
    /// Residual, without an anchor, relative to forces, and that of the displacement itself.
    relative: f64,
    force: f64,
    /// The potential, and its rounding.
    energy: f64,
    rounding: f64,
}

impl Here {
    fn at(newton: &Equations, u: &[f64], report: &mut SolveReport) -> Result<Self, Stop> {
        Ok(Here::of(newton, &newton.evaluate(u)?.sums, report).0)
    }

    /// With the free residual.
    fn of(newton: &Equations, now: &Sums, report: &mut SolveReport) -> (Self, Vec<f64>) {
        let (residual, relative) = newton.residual(now);
        let force = newton.model.unknowns().norm(&residual[..newton.dofs()]);
        (report.residual, report.energy, report.min_j) = (relative, now.energy, now.min_j);
        (Here { relative, force, energy: now.energy, rounding: ENERGY_ROUNDING * now.energy_scale }, residual)
    }
}
