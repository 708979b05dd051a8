//! Equilibria of what contact alone holds, by proximal steps.

use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::nonlinear::anchor::Anchor;
use crate::nonlinear::equations::Equations;
use crate::nonlinear::iterate::Stop;
use crate::nonlinear::iteration::{Limits, RESOLUTION, ROUNDING};
use crate::search::options::SolveOptions;
use nastic_body::contribution::Sums;
use nastic_body::state::SolveReport;
use nastic_linear::solver::Curvature;
use nastic_numeric::vector::sub;

/// Newton iterations of all steps.
const MOST: usize = 1000;
const MOST_MOVED: usize = 200;
/// How far a free body goes in the first one, as a share of the body's diagonal.
const FIRST: f64 = 0.05;
/// How far nodes may go before nothing is expected to stop them, in diagonals.
const FAR: f64 = 20.0;
/// What the anchor becomes after a step: as much smaller as the residual, within these shares, after one of more than so many iterations within the second ones.
const WEAKER: (f64, f64) = (0.03, 0.25);
const LITTLE_WEAKER: (f64, f64) = (0.03, 0.7);
const EASY: usize = 6;
/// Its growth after a step that was not found, and how many of these in a row are tried.
const STRONGER: f64 = 8.0;
const FAILURES: usize = 12;
/// Newton iterations of a step; what they leave, as a share of the residual and at most.
const EACH: usize = 40;
const STEP: f64 = 1e-3;
const ROUGH: f64 = 1e-6;
/// Newton iterations to the equilibrium once something holds every part, and the share to which the residual has to fall before they are tried again.
const AT_LAST: usize = 20;
const AGAIN: f64 = 0.1;
/// Rounding of the potential, as a share of the sum of its absolute terms.
const ENERGY: f64 = 1e-12;

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
    /// c the end of the step before: a body that nothing holds yet falls by its weight over s, lands, and tilts until it lies; what may roll or slide on rests where
    /// it came to, though the tangent of P is singular there. P falls with every step. s becomes smaller as the residual does, so that the last
    /// steps converge faster than linearly. Where it stops short, u is the last end.
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
        // shorter moves of supports may be found where this one is not
        let most = if newton.jump(u).is_some() { MOST_MOVED } else { MOST };
        while report.newton - spent < most && steps < most {
            steps += 1;
            // as far as double precision goes
            let stagnates = here.relative <= ROUNDING && here.relative > 0.5 * before && stiffness <= least;
            // forces of a body without stress are rounding, however large beside each other
            let rests = here.force <= unresolved && went <= RESOLUTION * newton.diagonal();
            let moves = newton.jump(u).is_some();
            if !moves && (here.relative <= options.accuracy || stagnates || rests) {
                return Ok(());
            }
            if here.relative < AGAIN * tried && newton.at(u, |at| self.free_motion(at)).is_none() {
                if self.arrives(newton, u, workspace, report)? {
                    return Ok(());
                }
                tried = here.relative;
            }
            let (at_step, from) = (report.newton, u.clone());
            match self.proximal_step(newton, u, (stiffness, &here, moves), workspace, report) {
                Ok(left) => {
                    let easy = report.newton - at_step <= EASY;
                    let share = left.relative / here.relative.max(f64::MIN_POSITIVE);
                    let shares = if easy { WEAKER } else { LITTLE_WEAKER };
                    stiffness = (share.clamp(shares.0, shares.1) * stiffness).max(least);
                    (before, here, failures) = (here.relative, left, 0);
                    went = self.unknowns().max_abs(&sub(self.nodal(u), self.nodal(&from)));
                    let gone = self.unknowns().max_abs(&sub(self.nodal(u), self.nodal(&start)));
                    if gone > FAR * newton.diagonal() {
                        return Err(Stop::Lost { residual: here.relative });
                    }
                }
                Err(stop) if stop.is_final() || matches!(stop, Stop::Linear(_)) || failures == FAILURES => {
                    return Err(stop);
                }
                Err(_) => {
                    workspace.forget();
                    (stiffness, failures) = (STRONGER * stiffness, failures + 1);
                }
            }
        }
        let residual = here.relative;
        Err(if most == MOST { Stop::Lost { residual } } else { Stop::Slow { residual } })
    }

    /// One step from u with an anchor there, and what it leaves without; where it is not found, or leads to no minimum, u stays.
    fn proximal_step(
        &self,
        newton: &Equations,
        u: &mut Vec<f64>,
        (stiffness, here, moves): (f64, &Here, bool),
        workspace: &mut Workspace,
        report: &mut SolveReport,
    ) -> Result<Here, Stop> {
        let accuracy = (STEP * here.relative).min(ROUGH).max(0.5 * newton.options.accuracy);
        let options = SolveOptions { accuracy, ..newton.options.clone() };
        let anchor = Anchor::new(self, u, stiffness);
        let step = Equations { anchor: Some(&anchor), options: &options, ..*newton };
        let (mut end, limits) = (u.clone(), Limits::new(EACH.min(options.max_newton), accuracy));
        let curvature = step.solve_within(limits, &mut end, self.linear_solver(newton.options, workspace), report)?;
        let left = Here::at(newton, &end, report)?;
        let rises = !moves && left.energy > here.energy + left.rounding;
        if curvature != Curvature::Positive || rises {
            return Err(Stop::Slow { residual: left.relative });
        }
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

    /// What is at u; of anchors the stiffness of the first, as much as lets forces that nothing balances move the body by a share of its size, and the least one; and the
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
        let unresolved = RESOLUTION * newton.diagonal() * self.unknowns().norm(&tangent.diagonal());
        Ok((here, (density / (FIRST * newton.diagonal())).max(least), least, unresolved))
    }
}

/// A place on the way.
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
        (Here { relative, force, energy: now.energy, rounding: ENERGY * now.energy_scale }, residual)
    }
}
