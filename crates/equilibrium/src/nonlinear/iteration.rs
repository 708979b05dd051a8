//! `Iteration`: evaluate, test, find a step, take it.

use crate::nonlinear::direction::{Direction, Step, Take};
use crate::nonlinear::equations::{Drive, Equations, Evaluated};
use crate::nonlinear::iterate::{Iterate, Stop};
use crate::nonlinear::line_search::LineSearch;
use crate::nonlinear::predicted_pressures::PredictedPressures;
use crate::search::options::Progress;
use nastic_body::contribution::Sums;
use nastic_body::state::SolveReport;
use nastic_body::strategy::Strategy;
use nastic_linear::solver::Curvature;
use std::cell::OnceCell;

/// Relative residual below which a step that does not halve it has met the limit of double precision.
pub(crate) const STAGNATION_TOLERANCE: f64 = 1e-10;
/// The same where the residual is rounding of the stiffness: in nearly incompressible bodies under small loads the rounding of `kappa (J - 1)` exceeds the former
/// share of the forces.
const STIFF_STAGNATION_TOLERANCE: f64 = 1e-8;
/// Rounding of a force, as a share of the force of a strain of order 1.
const FORCE_ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Rounding of the residual of a body without stress, as a share of the forces of its moduli.
const MODULI_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Smallest force that residuals are divided by, as a share of the forces of the moduli.
const MIN_FORCE_RATIO: f64 = 1e-6;
/// Shortest full step that double precision resolves, as a share of the body's size.
pub(crate) const MIN_STEP_RATIO: f64 = 1e-12;
/// Largest residual behind an unresolved step that is an equilibrium, relative to the largest forces of the iteration. Where more is left, the
/// tangent grows without bound as the step shrinks (the tangent of a tendon whose guides meet), and there is no equilibrium.
const MAX_TINY_STEP_RESIDUAL: f64 = 1e-6;

/// The next iterate, and how it was reached.
type Moved<'m> = (Vec<f64>, Evaluated<'m>, Reached);

/// What the last step was.
#[derive(Clone, Copy)]
struct Reached {
    curvature: Curvature,
    /// The energy of a strain of order 1.
    energy: f64,
    /// Its pressures do not belong to its changes of volume.
    apart: bool,
    /// Rounding may be more than [`STAGNATION_TOLERANCE`] of the forces.
    noisy: bool,
    /// Double precision does not resolve it.
    tiny: bool,
}

/// The residual of an iterate.
struct Left {
    /// Relative to the present forces, whose norm is `scale`.
    relative: f64,
    scale: f64,
    /// The largest forces of the iteration.
    forces: f64,
    /// Whether it is too large for an equilibrium by every measure of forces other than the largest of the iteration.
    meaningless: bool,
    /// Whether forces are below the rounding of those of the moduli, and constraints are fulfilled to rounding.
    below_moduli: bool,
    /// Relative residual before the last step.
    before: f64,
    accuracy: f64,
}

impl Left {
    /// Whether it is small enough, or as small as double precision allows. `is_below(share)` says whether the norm of the forces is below this share of the force of
    /// a strain of order 1.
    fn is_equilibrium(&self, last: &Reached, is_below: impl Fn(f64) -> bool) -> bool {
        // at rest there are no forces to compare with but the largest of the iteration; independent pressures may be wrong where the displacement is right
        let resolved = || {
            self.relative * self.scale
                <= if last.apart { STAGNATION_TOLERANCE } else { MAX_TINY_STEP_RESIDUAL } * self.forces
        };
        let noisy = || last.noisy && self.relative <= STIFF_STAGNATION_TOLERANCE && is_below(FORCE_ROUNDING);
        let is_rounding = || self.relative <= STAGNATION_TOLERANCE || self.below_moduli && !last.apart || noisy();
        self.relative <= self.accuracy
            || self.relative > 0.5 * self.before && is_rounding()
            || last.tiny && !self.meaningless && (resolved() || is_below(MIN_STEP_RATIO))
    }
}

/// When an iteration stops.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Steps.
    pub most: usize,
    /// Relative residual of a solution.
    pub accuracy: f64,
    /// Iterations after which it is given up if the tangent was shifted `max_shifts` times: it descends far from any
    /// equilibrium, which shorter load steps avoid. Attempts that converge shift the tangent once or twice.
    pub max_shifted_iterations: usize,
    /// Shifts of the tangent.
    pub max_shifts: usize,
    /// Ratio of the residual to its least value at which it is given up.
    pub diverged: f64,
    /// Short steps at which it is given up.
    pub short_steps: ShortSteps,
}

/// Consecutive steps that are shorter than a length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShortSteps {
    pub most: usize,
    pub length: f64,
}

impl ShortSteps {
    /// No step is short.
    pub const ALLOWED: Self = ShortSteps { most: usize::MAX, length: 0.0 };
}

impl Limits {
    /// At most `most` steps to an accuracy.
    pub fn new(most: usize, accuracy: f64) -> Self {
        let (diverged, short_steps) = (f64::INFINITY, ShortSteps::ALLOWED);
        Limits { most, accuracy, max_shifted_iterations: 30, max_shifts: 3, diverged, short_steps }
    }
}

/// Newton's method for some equations.
pub(crate) struct Iteration<'a> {
    equations: &'a Equations<'a>,
    limits: Limits,
    search: LineSearch<'a>,
    /// Consecutive short steps.
    short: usize,
    /// Length of the last step, of the whole one.
    length: f64,
}

impl<'a> Iteration<'a> {
    pub fn new(equations: &'a Equations<'a>, limits: Limits) -> Self {
        Iteration { equations, limits, search: LineSearch::new(equations), short: 0, length: 0.0 }
    }

    /// From x to a solution, with the curvature of the last tangent (positive where none was needed); on failure x is the last
    /// iterate.
    pub fn run(
        &mut self,
        x: &mut Vec<f64>,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        let (equations, limits) = (self.equations, self.limits);
        equations.place(x);
        equations.model.supports.extend(x);
        if equations.stays_rigid() {
            *x = equations.restored(std::mem::take(x));
        }
        let mut now = equations.evaluate(x)?;
        let (mut residual, mut relative) = equations.residual(&now.sums);
        let (mut before, mut least) = (f64::INFINITY, f64::INFINITY);
        let none = Reached { curvature: Curvature::Positive, energy: 0.0, apart: false, noisy: false, tiny: false };
        let (mut last, mut forces) = (none, 0.0_f64);
        // a pass over the cells, which few iterations ask for
        let (shifted, of_moduli) = (report.shifted, OnceCell::new());
        let moduli = || *of_moduli.get_or_init(|| equations.force_of_moduli());
        for iteration in 0..=limits.most {
            if equations.model.unknowns().any(equations.options.cancelled()) {
                return Err(Stop::Cancelled);
            }
            let space = equations.model.unknowns();
            let scale = space.norm(&now.sums.force_scale[..equations.dofs()]);
            record(&now.sums, relative, report);
            forces = forces.max(scale);
            let stalls = relative > STAGNATION_TOLERANCE && relative > 0.5 * before;
            let below_moduli = stalls && self.is_below_moduli(&now.sums, &residual, moduli());
            let beside_moduli = || relative * (scale / (MIN_FORCE_RATIO * moduli())).min(1.0);
            let odd = last.tiny
                && equations.is_static()
                && relative > MAX_TINY_STEP_RESIDUAL
                && beside_moduli() > MAX_TINY_STEP_RESIDUAL;
            let meaningless = odd && self.leaves(relative * scale, moduli(), &last) > MAX_TINY_STEP_RESIDUAL;
            let left = Left { relative, scale, forces, meaningless, below_moduli, before, accuracy: limits.accuracy };
            if !direction.is_pending() && left.is_equilibrium(&last, |share| self.is_below(share, &residual, &last)) {
                if relative > limits.accuracy {
                    report.residual = beside_moduli();
                }
                return Ok(last.curvature);
            }
            if self.gives_up(iteration, report.shifted - shifted, relative, least, &last) {
                return Err(Stop::Slow { residual: relative });
            }
            (before, least) = (relative, relative.min(least));
            if equations.options.is_spent(report.newton) {
                return Err(Stop::Spent { residual: relative });
            }
            let here = Iterate { x, now: &now.sums, point: &now.point, residual: &residual, relative };
            let (is_pending, load) = (direction.is_pending(), equations.split(x).1);
            (*x, now, last) = match self.step(&here, direction, report) {
                // no step reduces rounding
                Err(Stop::Slow { .. }) if relative <= STAGNATION_TOLERANCE && !is_pending => return Ok(last.curvature),
                taken => taken?,
            };
            (residual, relative) = equations.residual(&now.sums);
            self.watched(load, relative, &now.sums, report);
        }
        Err(Stop::Slow { residual: report.residual })
    }

    /// One step from a start, whatever its residual.
    pub fn once(
        &mut self,
        x: &mut Vec<f64>,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        let now = self.equations.evaluate(x)?;
        let (residual, relative) = self.equations.residual(&now.sums);
        let here = Iterate { x, now: &now.sums, point: &now.point, residual: &residual, relative };
        let (next, now, ..) = self.step(&here, direction, report)?;
        let relative = self.equations.residual(&now.sums).1;
        self.watched(self.equations.split(x).1, relative, &now.sums, report);
        record(&now.sums, relative, report);
        *x = next;
        Ok(())
    }

    /// One step.
    fn step(
        &mut self,
        here: &Iterate,
        direction: &mut dyn Direction,
        report: &mut SolveReport,
    ) -> Result<Moved<'a>, Stop> {
        let step = direction.find(here, report)?;
        report.newton += 1;
        let taken = self.search.take(here, &step, direction, report)?;
        direction.took(taken.length);
        if taken.curved {
            report.strategies.count(Strategy::CurvedStep);
        }
        self.short = if taken.length < self.limits.short_steps.length { self.short + 1 } else { 0 };
        let resolved = step.size > MIN_STEP_RATIO * self.equations.diagonal();
        // the size of the displacement step says nothing about further fields
        let alone = self.equations.model.unknowns().has_one_nodal_field();
        let apart = direction.pressures().is_some_and(PredictedPressures::is_apart);
        let tiny = alone && step.curvature == Curvature::Positive && taken.length == 1.0 && !resolved;
        self.length = taken.length;
        let noisy = self.is_noisy(&step, taken.length, apart);
        Ok((taken.x, taken.now, Reached { curvature: step.curvature, energy: step.scale, apart, noisy, tiny }))
    }

    /// Whether the iteration is given up, after this number of shifts.
    fn gives_up(&self, iteration: usize, shifts: usize, relative: f64, least: f64, last: &Reached) -> bool {
        let limits = &self.limits;
        // multipliers may still move where the body does not
        let unresolved = last.tiny && !last.apart && self.equations.model.unknowns().multipliers() == 0;
        let lost = iteration >= limits.max_shifted_iterations && shifts >= limits.max_shifts;
        let diverged = limits.diverged.is_finite() && (relative > limits.diverged * least || !relative.is_finite());
        let is_slow = self.short >= limits.short_steps.most;
        iteration == limits.most || unresolved || lost || diverged || is_slow
    }

    /// Whether forces are below the rounding of those of the moduli, and constraints are fulfilled to rounding; not over ranks, where it is not used.
    fn is_below_moduli(&self, now: &Sums, residual: &[f64], moduli: f64) -> bool {
        let (equations, space) = (self.equations, self.equations.model.unknowns());
        moduli > 0.0
            && space.norm(&residual[..equations.dofs()]) <= MODULI_ROUNDING * moduli
            && equations.constraint_residual(residual, now) <= STAGNATION_TOLERANCE
    }

    /// A residual relative to a small share of the force of a strain of 1; where something touches, whose stiffness says nothing about the body, of the force of the moduli.
    fn leaves(&self, residual: f64, moduli: f64, last: &Reached) -> f64 {
        let touches = self.equations.model.touches_something();
        let force = if touches { moduli } else { moduli.max(last.energy / self.equations.diagonal()) };
        residual / (MIN_FORCE_RATIO * force)
    }

    /// Whether the residual is below this share of the force of a strain of order 1.
    fn is_below(&self, share: f64, residual: &[f64], last: &Reached) -> bool {
        let equations = self.equations;
        let norm = equations.model.unknowns().norm(&residual[..equations.dofs()]);
        norm <= share * last.energy / equations.diagonal()
    }

    /// Whether the residual behind a step may be rounding of the stiffness alone: a full step in statics, without constraints and contact.
    fn is_noisy(&self, step: &Step, length: f64, apart: bool) -> bool {
        let Equations { model, drive, .. } = self.equations;
        let space = model.unknowns();
        let is_static = matches!(drive, Drive::Held { time_step: None, .. });
        is_static
            && matches!(step.take, Take::Search)
            && length == 1.0
            && !apart
            && space.has_one_nodal_field()
            && space.multipliers() == 0
            && !model.touches_something()
    }

    /// Reports the step just taken to a watch; without messages between ranks, some of which may have no watch.
    fn watched(&self, load: f64, residual: f64, now: &Sums, report: &SolveReport) {
        if let Some(watch) = self.equations.options.watch {
            watch(&Progress { load, newton: report.newton, residual, step: self.length, energy: now.energy });
        }
    }
}

fn record(now: &Sums, relative: f64, report: &mut SolveReport) {
    report.residual = relative;
    report.min_j = now.min_j;
    report.energy = now.energy;
}
