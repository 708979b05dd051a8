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

/// Below this relative residual a step that does not halve it has met the limit of double precision.
pub(crate) const ROUNDING: f64 = 1e-10;
/// Below this one too, if it is rounding of the stiffness: of nearly incompressible bodies that bear little, that of `kappa (J - 1)` is more than the former share
/// of their forces.
const NOISY: f64 = 1e-8;
/// Rounding of a force, as a share of that which a strain of order 1 takes.
const NOISE: f64 = 16.0 * f64::EPSILON;
/// Rounding of the residual of a body without stress, as a share of the forces that its moduli make.
const NOISE_OF_MODULI: f64 = 64.0 * f64::EPSILON;
/// Share of the forces that moduli make, by which residuals are divided where the forces at hand are smaller.
const LEAST_FORCE: f64 = 1e-6;
/// A full step shorter than this share of the body's size is below what double precision resolves.
pub(crate) const RESOLUTION: f64 = 1e-12;
/// Largest relative residual that such a step may leave of an equilibrium, by the largest forces met on the way; where more is left, the
/// tangent grows without bound as the step shrinks (that of a tendon whose guides meet), and nothing balances.
const RESOLVED: f64 = 1e-6;

/// The next iterate, and how it was reached.
type Moved<'m> = (Vec<f64>, Evaluated<'m>, Reached);

/// What the last step was.
#[derive(Clone, Copy)]
struct Reached {
    curvature: Curvature,
    /// The energy that a strain of order 1 takes.
    energy: f64,
    /// Its pressures are apart from its changes of volume.
    apart: bool,
    /// Rounding may be more than [`ROUNDING`] of the forces.
    noisy: bool,
    /// One that double precision does not resolve.
    tiny: bool,
}

/// What is left of a residual.
struct Left {
    /// Relative to the forces at hand, whose norm is `scale`.
    relative: f64,
    scale: f64,
    /// The largest on the way.
    forces: f64,
    /// Whether an equilibrium with it would be none, by any measure of forces but those on the way.
    meaningless: bool,
    /// Whether forces are below what rounding makes of moduli, and constraints are held to rounding.
    below_moduli: bool,
    /// Relative residual before the last step.
    before: f64,
    accuracy: f64,
}

impl Left {
    /// Whether it is small enough, or as small as double precision lets it become. Asked of a norm: whether that of the forces is below so much of what a strain of
    /// order 1 takes.
    fn is_equilibrium(&self, last: &Reached, is_below: impl Fn(f64) -> bool) -> bool {
        // at rest no force is left to measure it by but those of the way there; pressures of their own may be wrong where the displacement is not
        let resolved = || self.relative * self.scale <= if last.apart { ROUNDING } else { RESOLVED } * self.forces;
        let noisy = || last.noisy && self.relative <= NOISY && is_below(NOISE);
        let is_rounding = || self.relative <= ROUNDING || self.below_moduli && !last.apart || noisy();
        self.relative <= self.accuracy
            || self.relative > 0.5 * self.before && is_rounding()
            || last.tiny && !self.meaningless && (resolved() || is_below(RESOLUTION))
    }
}

/// When an iteration ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Steps.
    pub most: usize,
    /// Relative residual of a solution.
    pub accuracy: f64,
    /// Iterations after which it is given up where the tangent was shifted so many times: it goes downhill far from any equilibrium,
    /// which shorter load steps do not. Attempts that converge shift it once or twice.
    pub lost: (usize, usize),
    /// Growth of the residual beyond its least value at which it is given up.
    pub diverged: f64,
    /// Steps in a row that are shorter than a length at which it is given up.
    pub creeps: (usize, f64),
}

impl Limits {
    /// So many steps to an accuracy.
    pub fn new(most: usize, accuracy: f64) -> Self {
        Limits { most, accuracy, lost: (30, 3), diverged: f64::INFINITY, creeps: (usize::MAX, 0.0) }
    }
}

/// Newton's method for some equations.
pub(crate) struct Iteration<'a> {
    equations: &'a Equations<'a>,
    limits: Limits,
    search: LineSearch<'a>,
    /// Short steps in a row.
    short: usize,
    /// How much of the last step was taken.
    length: f64,
}

impl<'a> Iteration<'a> {
    pub fn new(equations: &'a Equations<'a>, limits: Limits) -> Self {
        Iteration { equations, limits, search: LineSearch::new(equations), short: 0, length: 0.0 }
    }

    /// From x to a solution, and what the last tangent was (positive where none was needed); where it stops short, x is the last
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
            let stalls = relative > ROUNDING && relative > 0.5 * before;
            let below_moduli = stalls && self.is_below_moduli(&now.sums, &residual, moduli());
            let beside_moduli = || relative * (scale / (LEAST_FORCE * moduli())).min(1.0);
            let odd = last.tiny && equations.is_static() && relative > RESOLVED && beside_moduli() > RESOLVED;
            let meaningless = odd && self.leaves(relative * scale, moduli(), &last) > RESOLVED;
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
                // no step lowers what is rounding alone
                Err(Stop::Slow { .. }) if relative <= ROUNDING && !is_pending => return Ok(last.curvature),
                taken => taken?,
            };
            (residual, relative) = equations.residual(&now.sums);
            self.watched(load, relative, &now.sums, report);
        }
        Err(Stop::Slow { residual: report.residual })
    }

    /// One step from a start, whatever residual it leaves.
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
        self.short = if taken.length < self.limits.creeps.1 { self.short + 1 } else { 0 };
        let resolved = step.size > RESOLUTION * self.equations.diagonal();
        // of the displacement alone it says nothing of further fields
        let alone = self.equations.model.unknowns().has_one_nodal_field();
        let apart = direction.pressures().is_some_and(PredictedPressures::is_apart);
        let tiny = alone && step.curvature == Curvature::Positive && taken.length == 1.0 && !resolved;
        self.length = taken.length;
        let noisy = self.is_noisy(&step, taken.length, apart);
        Ok((taken.x, taken.now, Reached { curvature: step.curvature, energy: step.scale, apart, noisy, tiny }))
    }

    /// Whether an iteration that tangents were shifted in so many times leads nowhere.
    fn gives_up(&self, iteration: usize, shifts: usize, relative: f64, least: f64, last: &Reached) -> bool {
        let limits = &self.limits;
        // multipliers may still move where the body does not
        let unresolved = last.tiny && !last.apart && self.equations.model.unknowns().multipliers() == 0;
        let lost = iteration >= limits.lost.0 && shifts >= limits.lost.1;
        let diverged = limits.diverged.is_finite() && (relative > limits.diverged * least || !relative.is_finite());
        let creeps = self.short >= limits.creeps.0;
        iteration == limits.most || unresolved || lost || diverged || creeps
    }

    /// Whether forces are below what rounding makes of moduli, and constraints are held to rounding; not over ranks, where nobody asks for it.
    fn is_below_moduli(&self, now: &Sums, residual: &[f64], moduli: f64) -> bool {
        let (equations, space) = (self.equations, self.equations.model.unknowns());
        moduli > 0.0
            && space.norm(&residual[..equations.dofs()]) <= NOISE_OF_MODULI * moduli
            && equations.constraint_residual(residual, now) <= ROUNDING
    }

    /// A residual by a small share of what a strain of 1 takes; where something touches, whose stiffness says nothing of the body, by that of moduli.
    fn leaves(&self, residual: f64, moduli: f64, last: &Reached) -> f64 {
        let touches = self.equations.model.touches_something();
        let force = if touches { moduli } else { moduli.max(last.energy / self.equations.diagonal()) };
        residual / (LEAST_FORCE * force)
    }

    /// Whether the forces left are below so much of those that a strain of order 1 takes.
    fn is_below(&self, share: f64, residual: &[f64], last: &Reached) -> bool {
        let equations = self.equations;
        let norm = equations.model.unknowns().norm(&residual[..equations.dofs()]);
        norm <= share * last.energy / equations.diagonal()
    }

    /// Whether rounding of the stiffness may be all that a step has left: a full one, of forces in statics alone, without what pushes only where it is met.
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

    /// Reports the step just taken to a watch; without messages between ranks, of which some may have none.
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
