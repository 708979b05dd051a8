//! Newton's method for an equilibrium under constraints: a saddle point of the potential with multipliers.
//!
//! With the potential `P(u)`, constraints `g(u) = 0` and their multipliers p, the step solves
//!
//! ```text
//! [K   -g_u^T] [du]     [P_u - p g_u]
//! [-g_u    0 ] [dp] = - [    -g     ],     K = P_uu - p g_uu
//! ```
//!
//! K may be indefinite, as behind the pressure maximum of a balloon; what counts is that it is positive definite on the null space of
//! `g_u`, which the inertia of the whole tells. The step then goes downhill in the augmented Lagrangian at the new multiplier
//! `q = p + dp`, whose slope along it is `-du . K du - c |g|^2`:
//!
//! ```text
//! M(u) = P(u) - q g(u) + c/2 |g(u)|^2,    c |g|^2 = |a|, or 3 |a| where a < 0,    a = du . K du
//! ```
//!
//! Of inequalities `g >= 0`, `p >= 0`, `p g = 0` the step solves the linearised ones (sequential quadratic programming, `constrained_step`):
//! those that do not act get `q = 0` and leave the system. Multipliers stay positive along a step, since q is, and what counts of an
//! inequality with `q = 0` is its violation `min(0, g)`.
//!
//! Where the inertia is another, the step is taken as long as the residual falls (the equilibrium may be a saddle, which the state's
//! inertia tells), else K is shifted until the inertia is right. Source: Nocedal & Wright, "Numerical Optimization" (2006),
//! sections 18.1 to 18.5.

use crate::contributions::Sums;
use crate::error::Inadmissible;
use crate::solution::constrained_step::{Linearised, start_positive};
use crate::solution::newton::{ARMIJO, COLLAPSE, LOST, Newton, RESOLUTION, ROUNDING, Stop, moved};
use crate::solution::rotation_corrected_step::{GradientFit, StepLimits};
use crate::solution::saddle_point::SaddlePoint;
use crate::solution::state::SolveReport;
use crate::solution::tangent_systems::TangentSystems;
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearError, LinearSolver};
use nastic_numeric::vector::{axpy, dot, max_abs, norm};

/// A step that leaves less than this share of the residual is taken whatever the potential.
const FALLS: f64 = 0.5;

/// Where an iteration stands.
struct Iterate<'a> {
    u: &'a [f64],
    now: &'a Sums,
    relative: f64,
    /// What the rounding of the potential is measured against.
    scale: f64,
}

/// Unknowns with what was found there.
type Next = (Vec<f64>, Sums);

/// The augmented Lagrangian along a step.
struct Merit {
    start: f64,
    slope: f64,
    /// `c` over the square of the constraint's scale.
    weights: Vec<f64>,
    noise: f64,
}

impl Newton<'_> {
    /// As [`solve`](Newton::solve), u with the multipliers behind it.
    pub(super) fn solve_constrained(
        &self,
        u: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        let mut systems = TangentSystems::new(self.model, self.options.parallel, solver);
        let inequalities = self.model.inequalities();
        start_positive(&inequalities, &mut u[self.model.discretization().dofs()..]);
        let mut now = self.evaluate(u)?;
        let mut jump = self.jump(u);
        let mut before = f64::INFINITY;
        let mut fit = None;
        let shifted = report.shifted;
        let mut last = Curvature::Positive;
        for iteration in 0..self.options.max_newton {
            if self.options.cancelled() {
                return Err(Stop::Cancelled);
            }
            if iteration >= LOST.0 && report.shifted - shifted >= LOST.1 {
                break;
            }
            let (mut residual, relative) = self.residual(&now);
            self.record(&now, relative, report);
            let stagnates = relative <= ROUNDING && relative > 0.5 * before;
            if jump.is_none() && (relative <= self.options.accuracy || stagnates) {
                return Ok(last);
            }
            before = relative;
            let tangent = self.model.bordered_tangent(&self.at(u))?;
            let scales = self.put_slack(u, &inequalities, &mut residual)?;
            let mut rhs: Vec<f64> = residual.iter().map(|r| -r).collect();
            if let Some(jump) = &jump {
                let mut all = jump.clone();
                all.resize(u.len(), 0.0);
                axpy(-1.0, &tangent.multiply(&all, self.options.parallel), &mut rhs);
                self.model.supports.clear(&mut rhs);
            }
            let scale = self.energy_scale(&tangent.matrix, u, &now);
            let mut system = SaddlePoint::new(self.model, tangent);
            let failed = |error: LinearError| match error {
                // Constraints that depend on each other are so at any control.
                LinearError::Border { .. } | LinearError::NotCounted { .. } => Stop::Linear(error),
                _ if error.is_lack_of_memory() => Stop::Linear(error),
                _ => Stop::Slow { residual: relative },
            };
            let problem = Linearised { u, rhs: &rhs, inequalities: &inequalities, scales: &scales };
            let (mut step, negative) =
                self.constrained_step(&mut system, &mut systems, &problem, report).map_err(failed)?;
            report.newton += 1;
            let here = Iterate { u, now: &now, relative, scale };
            let (length, next) = if let Some(jump) = jump.take() {
                self.prescribe(&mut step, &jump);
                self.whole(&here, &step)?
            } else if let Some(next) = self.falls(&here, &step)? {
                (1.0, next)
            } else if negative == Some(0) {
                self.merit_search(&here, &step, &mut fit)?
            } else if let Some(found) = self.residual_falls(&here, &step)? {
                found
            } else {
                step = self.shifted_step(&mut system, &mut systems, &problem, report).map_err(failed)?;
                self.merit_search(&here, &step, &mut fit)?
            };
            last = if negative == Some(0) { Curvature::Positive } else { Curvature::Negative };
            let resolution = RESOLUTION * self.model.discretization().mesh().diagonal();
            let tiny = negative == Some(0) && max_abs(self.model.nodal(&step)) <= resolution;
            (*u, now) = next;
            self.tell(length, &now, report);
            let (_, relative) = self.residual(&now);
            if tiny && length == 1.0 && relative <= ROUNDING {
                self.record(&now, relative, report);
                return Ok(last);
            }
        }
        Err(Stop::Slow { residual: self.residual(&now).1 })
    }

    /// The prescribed components move at once or not at all.
    fn whole(&self, here: &Iterate, step: &[f64]) -> Result<(f64, Next), Stop> {
        if self.model.max_step(&self.at(here.u), step)? < 1.0 {
            return Err(Stop::Slow { residual: here.relative });
        }
        let u = moved(here.u, step, 1.0);
        let next = self.evaluate(&u)?;
        Ok((1.0, (u, next)))
    }

    /// The whole step, where it leaves little of the residual.
    fn falls(&self, here: &Iterate, step: &[f64]) -> Result<Option<Next>, Inadmissible> {
        if self.model.max_step(&self.at(here.u), step)? < 1.0 {
            return Ok(None);
        }
        let trial = moved(here.u, step, 1.0);
        let next = self.evaluate(&trial).ok().filter(|next| self.residual(next).1 <= FALLS * here.relative);
        Ok(next.map(|next| (trial, next)))
    }

    /// One of a few step lengths that lowers the residual.
    fn residual_falls(&self, here: &Iterate, step: &[f64]) -> Result<Option<(f64, Next)>, Inadmissible> {
        let mut length = self.model.max_step(&self.at(here.u), step)?;
        for _ in 0..4 {
            let trial = moved(here.u, step, length);
            if let Ok(next) = self.evaluate(&trial)
                && self.residual(&next).1 <= (1.0 - 0.1 * length) * here.relative
            {
                return Ok(Some((length, (trial, next))));
            }
            length *= 0.5;
        }
        Ok(None)
    }

    /// Downhill in the augmented Lagrangian: along the curve that turns with the body where the step turns it, else (or where that
    /// leads nowhere) straight on.
    fn merit_search(&self, here: &Iterate, step: &[f64], fit: &mut Option<GradientFit>) -> Result<(f64, Next), Stop> {
        let (model, parallel) = (self.model, self.options.parallel);
        let merit = self.merit(here, step)?;
        let reach = StepLimits::of(model.discretization(), here.u, step, parallel);
        let others = model.max_step_of_others(&self.at(here.u), step)?;
        if let Some(longest) = reach.curved {
            if fit.is_none() {
                *fit = GradientFit::new(model, parallel);
            }
            if let Some(fit) = fit {
                let curve = |s: f64| {
                    let bent = fit.correction(model, model.nodal(here.u), model.nodal(step), s, parallel);
                    let mut to = moved(here.u, step, s);
                    to.iter_mut().zip(&bent).for_each(|(u, bent)| *u += bent);
                    to
                };
                let found = self.search_along(here, step, &merit, &curve, longest.min(others));
                if !matches!(found, Err(Stop::Slow { .. })) {
                    return found;
                }
            }
        }
        let straight = |s: f64| moved(here.u, step, s);
        self.search_along(here, step, &merit, &straight, reach.straight.min(others))
    }

    /// At the multiplier `p + dp`, where the residual is `r + B dp`.
    fn merit(&self, here: &Iterate, step: &[f64]) -> Result<Merit, Inadmissible> {
        let dofs = self.model.discretization().dofs();
        let at_new = self.evaluate(&self.with_new_multipliers(here.u, here.u, step))?;
        let (mut force, _) = self.residual(&at_new);
        force.truncate(dofs);
        let slope = dot(&force, self.model.nodal(step));
        let relative: Vec<f64> = violations(&at_new, dofs).map(|(g, scale)| g / scale).collect();
        let size = norm(&relative).powi(2);
        let bent = if slope < 0.0 { slope.abs() } else { 3.0 * slope.abs() };
        let weight = bent / size;
        let weight = if weight.is_finite() { weight } else { 0.0 };
        let weights: Vec<f64> = violations(&at_new, dofs).map(|(_, scale)| weight / (scale * scale)).collect();
        let noise = 64.0 * f64::EPSILON * here.scale;
        let start = merit_at(&at_new, &weights, dofs);
        // of c/2 |g|^2 along a step on whose linear model g vanishes
        Ok(Merit { start, slope: slope - weight * size, weights, noise })
    }

    /// The longest of a few step lengths that lowers the merit enough and inverts nothing.
    fn search_along(
        &self,
        here: &Iterate,
        step: &[f64],
        merit: &Merit,
        path: &dyn Fn(f64) -> Vec<f64>,
        longest: f64,
    ) -> Result<(f64, Next), Stop> {
        let dofs = self.model.discretization().dofs();
        let mut length = longest;
        for _ in 0..30 {
            let trial = path(length);
            let at_new = self.with_new_multipliers(&trial, here.u, step);
            let sound = self.evaluate(&at_new).ok().filter(|next| next.min_j >= COLLAPSE * here.now.min_j);
            let Some(next) = sound else {
                length *= 0.5;
                continue;
            };
            let change = merit_at(&next, &merit.weights, dofs) - merit.start;
            if change <= ARMIJO * length * merit.slope + merit.noise {
                let next = if length == 1.0 { next } else { self.evaluate(&trial)? };
                return Ok((length, (trial, next)));
            }
            let vertex = -merit.slope * length * length / (2.0 * (change - merit.slope * length));
            length = if vertex.is_finite() { vertex.clamp(0.1 * length, 0.5 * length) } else { 0.5 * length };
        }
        Err(Stop::Slow { residual: here.relative })
    }

    /// A displacement with the multipliers of the whole step.
    fn with_new_multipliers(&self, u: &[f64], from: &[f64], step: &[f64]) -> Vec<f64> {
        let dofs = self.model.discretization().dofs();
        let mut out = self.model.nodal(u).to_vec();
        out.extend(moved(&from[dofs..], &step[dofs..], 1.0));
        out
    }
}

/// Values of the constraints, and what they are measured against.
fn violations(now: &Sums, dofs: usize) -> impl Iterator<Item = (f64, f64)> {
    let scale = |scale: &f64| if *scale > 0.0 { *scale } else { 1.0 };
    now.force[dofs..].iter().map(|r| -r).zip(now.force_scale[dofs..].iter().map(scale))
}

fn merit_at(at_new: &Sums, weights: &[f64], dofs: usize) -> f64 {
    let penalty = violations(at_new, dofs).zip(weights).map(|((g, _), weight)| 0.5 * weight * g * g).sum::<f64>();
    at_new.energy + penalty
}
