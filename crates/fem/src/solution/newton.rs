//! Newton's method with a line search on the potential energy, or on the residual where there is no potential.

use crate::contributions::controls::Controls;
use crate::contributions::instant::{Instant, TimeStep};
use crate::contributions::{Demand, Sums};
use crate::error::{Inadmissible, StateError};
use crate::model::Model;
use crate::solution::options::{Progress, SolveOptions};
use crate::solution::rotation_corrected_step::{GradientFit, StepLimits};
use crate::solution::state::SolveReport;
use crate::solution::tangent_systems::{TangentSystems, Wanted, eliminate};
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearError, LinearSolver, SparseMatrix};
use nastic_numeric::vector::{max_abs, norm};

/// One equilibrium to be found: controls and load are held, the displacement is not.
pub(crate) struct Newton<'a> {
    pub model: &'a Model,
    pub controls: &'a Controls,
    pub load: f64,
    /// The time step that ends at this equilibrium, if it is one.
    pub time_step: Option<&'a TimeStep>,
    /// Where on the path this is.
    pub path: f64,
    pub options: &'a SolveOptions<'a>,
}

/// Why it stopped short.
pub(crate) enum Stop {
    Inadmissible(Inadmissible),
    Slow { residual: f64 },
    Linear(LinearError),
    Cancelled,
}

impl Stop {
    /// Whether no other way would mend it.
    pub fn is_final(&self) -> bool {
        match self {
            Stop::Cancelled => true,
            Stop::Linear(error) => error.is_lack_of_memory(),
            Stop::Inadmissible(at) => at.problem().is_some(),
            Stop::Slow { .. } => false,
        }
    }

    /// The error of what no other way would mend.
    pub fn final_error(self) -> Option<StateError> {
        match self {
            Stop::Linear(error) if error.is_lack_of_memory() => Some(error.into()),
            Stop::Cancelled => Some(StateError::Cancelled),
            Stop::Inadmissible(at) => at.problem().map(StateError::from),
            _ => None,
        }
    }
}

impl From<Inadmissible> for Stop {
    fn from(at: Inadmissible) -> Self {
        Stop::Inadmissible(at)
    }
}

impl From<LinearError> for Stop {
    fn from(error: LinearError) -> Self {
        Stop::Linear(error)
    }
}

/// Where an iteration stands.
struct Iterate<'a> {
    u: &'a [f64],
    now: &'a Sums,
    residual: &'a [f64],
    /// What the rounding of the potential is measured against.
    scale: f64,
}

/// A displacement with what was found there.
type Next = (Vec<f64>, Sums);

/// Steps that leave less than this share of the smallest J are too long.
pub(super) const COLLAPSE: f64 = 0.09;
/// Sufficient decrease wanted of a step, as a share of what the slope promises.
pub(super) const ARMIJO: f64 = 1e-4;
/// Below this relative residual a step that does not halve it has met the limit of double precision.
pub(super) const ROUNDING: f64 = 1e-10;
/// Iterations after which an attempt is given up that had to shift the tangent so many times: it goes downhill far from any
/// equilibrium, which shorter load steps do not. Attempts that converge shift it once or twice.
pub(super) const LOST: (usize, usize) = (30, 3);
/// A full step shorter than this share of the body's size is below what double precision resolves.
pub(super) const RESOLUTION: f64 = 1e-12;
/// Largest relative residual that such a step may leave of an equilibrium whose forces are larger than rounding; where more is left, the
/// tangent grows without bound as the step shrinks (that of a tendon whose guides meet), and nothing balances.
const RESOLVED: f64 = 1e-6;
/// Absolute row sums of a tangent over its diagonal entries, at most.
const NEIGHBOURS: f64 = 100.0;

/// Relative residual of a step that moves prescribed components: it is taken whole, and from rest there is no residual yet to
/// measure it by. The largest; steps shorter than that share of the body are solved as exactly as they are short, since what they leave may
/// be within the accuracy asked for at once.
const JUMP: f64 = 1e-2;

impl Newton<'_> {
    /// From u (with the multipliers of constraints behind it, see `constrained_newton`) to equilibrium, and what the last tangent was (positive where none was needed); where it stops short, u is the
    /// last iterate.
    pub fn solve(
        &self,
        u: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<Curvature, Stop> {
        if self.model.unknowns().scalars > 0 {
            return self.solve_constrained(u, solver, report);
        }
        let mut systems = TangentSystems::new(self.model, self.options.parallel, solver);
        let mut matrix = None;
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
            let (residual, relative) = self.residual(&now);
            self.record(&now, relative, report);
            let stagnates = relative <= ROUNDING && relative > 0.5 * before;
            if jump.is_none() && (relative <= self.options.accuracy || stagnates) {
                return Ok(last);
            }
            before = relative;
            let matrix = self.tangent(u, &mut matrix)?;
            let rhs = self.right_hand_side(matrix, &residual, jump.as_deref());
            let scale = self.energy_scale(matrix, u, &now);
            eliminate(self.model, matrix);
            let accuracy = match &jump {
                Some(jump) => (max_abs(jump) / self.model.discretization().mesh().diagonal()).clamp(ROUNDING, JUMP),
                None => forcing(relative, self.options.accuracy),
            };
            let (mut step, curvature) = systems.step(matrix, u, &rhs, (accuracy, Wanted::Newton), report)?;
            report.newton += 1;
            let here = Iterate { u, now: &now, residual: &residual, scale };
            let (length, next) = if let Some(jump) = jump.take() {
                self.prescribe(&mut step, &jump);
                self.jump_step(&here, &step)?
            } else if !self.model.has_potential() {
                self.residual_descent(&here, &step)?
            } else if curvature != Curvature::Negative {
                self.downhill(&here, &step, &mut fit)?
            } else if let Some(found) = self.residual_search(&here, &step)? {
                found
            } else {
                step = systems.shifted_step(matrix, u, &rhs, report)?;
                self.downhill(&here, &step, &mut fit)?
            };
            let resolution = RESOLUTION * self.model.discretization().mesh().diagonal();
            last = curvature;
            let tiny = curvature == Curvature::Positive && max_abs(&step) <= resolution;
            (*u, now) = next;
            self.tell(length, &now, report);
            if tiny && length == 1.0 {
                let (_, relative) = self.residual(&now);
                self.record(&now, relative, report);
                let balanced = relative <= RESOLVED || self.is_below_resolution(&now, matrix);
                return if balanced { Ok(last) } else { Err(Stop::Slow { residual: relative }) };
            }
        }
        Err(Stop::Slow { residual: self.residual(&now).1 })
    }

    /// Whether a residual is what a displacement below the resolution takes of a typical stiffness: near rest it may be large beside the forces.
    fn is_below_resolution(&self, now: &Sums, matrix: &SparseMatrix) -> bool {
        let (residual, _) = self.residual(now);
        let mut diagonal: Vec<f64> = matrix.diagonal().iter().map(|d| d.abs()).collect();
        diagonal.sort_unstable_by(f64::total_cmp);
        let stiffness = diagonal.get(diagonal.len() / 2).copied().unwrap_or(0.0);
        let resolution = RESOLUTION * self.model.discretization().mesh().diagonal();
        max_abs(&residual) <= NEIGHBOURS * stiffness * resolution
    }

    pub(super) fn at<'u>(&'u self, u: &'u [f64]) -> Instant<'u> {
        let (controls, load, parallel) = (self.controls, self.load, self.options.parallel);
        Instant { step: self.time_step, parallel, ..Instant::new(u, controls, load) }
    }

    /// Energy and residual, without those of inequalities that are slack.
    pub(super) fn evaluate(&self, u: &[f64]) -> Result<Sums, Inadmissible> {
        let mut sums = self.model.evaluate(&self.at(u), Demand { energy: true, force: true })?;
        self.model.leave_out_slack(u, &mut sums);
        Ok(sums)
    }

    /// The tangent at u in the memory of the one before.
    fn tangent<'m>(
        &self,
        u: &[f64],
        memory: &'m mut Option<SparseMatrix>,
    ) -> Result<&'m mut SparseMatrix, Inadmissible> {
        let matrix = memory.get_or_insert_with(|| self.model.matrix());
        matrix.clear();
        self.model.add_tangent(&self.at(u), matrix)?;
        Ok(matrix)
    }

    /// What the prescribed components still have to move; `None` when they are in place.
    pub(super) fn jump(&self, u: &[f64]) -> Option<Vec<f64>> {
        let supports = &self.model.supports;
        let prescribed = self.prescribed();
        let wanted = supports.fixed().iter().zip(&prescribed).zip(u);
        let jump: Vec<f64> = wanted.map(|((&f, &v), &u)| if f { v - u } else { 0.0 }).collect();
        jump.iter().any(|&d| d != 0.0).then_some(jump)
    }

    /// Where the prescribed components are wanted: those of an extrapolated end are on the way from the state before to that end.
    fn prescribed(&self) -> Vec<f64> {
        let Some((step, end)) = self.time_step.and_then(|step| Some((step, step.end.as_ref()?))) else {
            return self.model.prescribed(self.controls, self.load);
        };
        let controls = step.before.controls.blend(&end.controls, self.path);
        let mut w = self.model.prescribed(&controls, self.load);
        w.iter_mut().zip(&end.rest).for_each(|(w, b)| *w = (*w - b) / end.alpha);
        w
    }

    /// Free residual, and its norm relative to the norm of the sums of absolute forces; of constraints each relative to its own scale.
    pub(super) fn residual(&self, now: &Sums) -> (Vec<f64>, f64) {
        let mut residual = now.force.clone();
        self.model.supports.clear(&mut residual);
        let share = |r: &[f64], scale: &[f64]| {
            let size = norm(r);
            if size == 0.0 { 0.0 } else { size / norm(scale) }
        };
        let dofs = self.model.discretization().dofs();
        let of_forces = share(self.model.nodal(&residual), self.model.nodal(&now.force_scale));
        let of_constraint = |r: (&f64, &f64)| share(&[*r.0], &[*r.1]);
        let constraints = residual.iter().zip(&now.force_scale).skip(dofs).map(of_constraint);
        let relative = constraints.fold(of_forces, f64::max);
        (residual, relative)
    }

    /// Energies are small differences of large terms, the smaller the nearer to rest: W vanishes there, while what it is
    /// the difference of is of the size of `F : dP/dF : F`, or `x . K x` with the current positions x.
    pub(super) fn energy_scale(&self, matrix: &SparseMatrix, u: &[f64], now: &Sums) -> f64 {
        let disc = self.model.discretization();
        let dim = disc.dim();
        let reference = disc.mesh().points().iter().flat_map(|x| &x[..dim]);
        let x: Vec<f64> = reference.zip(u).map(|(x, u)| x + u).collect();
        let mut stretched = vec![0.0; x.len()];
        matrix.multiply_on(&x, &mut stretched, self.options.parallel);
        let terms: f64 = x.iter().zip(&stretched).map(|(x, f)| x * f).sum();
        now.energy_scale + terms.abs()
    }

    pub(super) fn right_hand_side(&self, matrix: &SparseMatrix, residual: &[f64], jump: Option<&[f64]>) -> Vec<f64> {
        let mut rhs: Vec<f64> = residual.iter().map(|r| -r).collect();
        if let Some(jump) = jump {
            let mut pulled = vec![0.0; jump.len()];
            matrix.multiply(jump, &mut pulled);
            rhs.iter_mut().zip(&pulled).for_each(|(r, p)| *r -= p);
            self.model.supports.clear(&mut rhs);
        }
        rhs
    }

    pub(super) fn prescribe(&self, step: &mut [f64], jump: &[f64]) {
        for ((s, &d), &fixed) in step.iter_mut().zip(jump).zip(self.model.supports.fixed()) {
            if fixed {
                *s = d;
            }
        }
    }

    /// The prescribed components move at once or not at all.
    fn jump_step(&self, here: &Iterate, step: &[f64]) -> Result<(f64, Next), Stop> {
        if self.longest(here, step)? < 1.0 {
            return Err(Stop::Slow { residual: self.residual(here.now).1 });
        }
        let u = moved(here.u, step, 1.0);
        let next = self.evaluate(&u)?;
        Ok((1.0, (u, next)))
    }

    fn longest(&self, here: &Iterate, step: &[f64]) -> Result<f64, Inadmissible> {
        self.model.max_step(&self.at(here.u), step)
    }

    /// Along the curve that turns with the body where the step turns it, else (or where that leads nowhere) straight on.
    fn downhill(&self, here: &Iterate, step: &[f64], fit: &mut Option<GradientFit>) -> Result<(f64, Next), Stop> {
        let parallel = self.options.parallel;
        let reach = StepLimits::of(self.model.discretization(), here.u, step, parallel);
        let others = self.model.max_step_of_others(&self.at(here.u), step)?;
        if let Some(longest) = reach.curved {
            if fit.is_none() {
                *fit = GradientFit::new(self.model, parallel);
            }
            if let Some(fit) = fit {
                let curve = |s: f64| {
                    let bent = fit.correction(self.model, here.u, step, s, parallel);
                    moved(&moved(here.u, step, s), &bent, 1.0)
                };
                let found = self.energy_search(here, step, &curve, longest.min(others));
                if !matches!(found, Err(Stop::Slow { .. })) {
                    return found;
                }
            }
        }
        self.energy_search(here, step, &|s| moved(here.u, step, s), reach.straight.min(others))
    }

    /// The longest of a few step lengths along a path that starts in the direction of `step` which lowers the potential
    /// enough and inverts nothing.
    fn energy_search(
        &self,
        here: &Iterate,
        step: &[f64],
        path: &dyn Fn(f64) -> Vec<f64>,
        longest: f64,
    ) -> Result<(f64, Next), Stop> {
        let slope: f64 = here.residual.iter().zip(step).map(|(r, s)| r * s).sum();
        let start = here.now.energy;
        let noise = 64.0 * f64::EPSILON * here.scale;
        let mut length = longest;
        for _ in 0..30 {
            let trial = path(length);
            let sound = self.evaluate(&trial).ok().filter(|next| next.min_j >= COLLAPSE * here.now.min_j);
            let Some(next) = sound else {
                length *= 0.5;
                continue;
            };
            let change = next.energy - start;
            if change <= ARMIJO * length * slope + noise {
                return Ok((length, (trial, next)));
            }
            // the vertex of the parabola through the start, its slope and this value
            let vertex = -slope * length * length / (2.0 * (change - slope * length));
            length = if vertex.is_finite() { vertex.clamp(0.1 * length, 0.5 * length) } else { 0.5 * length };
        }
        Err(Stop::Slow { residual: self.residual(here.now).1 })
    }

    /// Where the tangent has negative eigenvalues an equilibrium nearby may be a saddle of the potential: the branch is
    /// followed as long as the residual falls, and the state's inertia tells what was found.
    fn residual_search(&self, here: &Iterate, step: &[f64]) -> Result<Option<(f64, Next)>, Stop> {
        let before = norm(here.residual);
        let mut length = self.longest(here, step)?;
        for _ in 0..4 {
            let trial = moved(here.u, step, length);
            if let Ok(next) = self.evaluate(&trial)
                && norm(&self.residual(&next).0) <= (1.0 - 0.1 * length) * before
            {
                return Ok(Some((length, (trial, next))));
            }
            length *= 0.5;
        }
        Ok(None)
    }

    /// Without a potential: the longest of a few step lengths that lowers the residual enough and inverts nothing.
    fn residual_descent(&self, here: &Iterate, step: &[f64]) -> Result<(f64, Next), Stop> {
        let before = norm(here.residual);
        let mut length = self.longest(here, step)?;
        for _ in 0..30 {
            let trial = moved(here.u, step, length);
            if let Ok(next) = self.evaluate(&trial)
                && norm(&self.residual(&next).0) <= (1.0 - ARMIJO * length) * before
            {
                return Ok((length, (trial, next)));
            }
            length *= 0.5;
        }
        Err(Stop::Slow { residual: self.residual(here.now).1 })
    }

    pub(super) fn record(&self, now: &Sums, relative: f64, report: &mut SolveReport) {
        report.residual = relative;
        report.min_j = now.min_j;
        report.energy = now.energy;
    }

    pub(super) fn tell(&self, step: f64, now: &Sums, report: &SolveReport) {
        if let Some(watch) = self.options.watch {
            let (_, residual) = self.residual(now);
            let energy = now.energy;
            watch(&Progress { load: self.path, newton: report.newton, residual, step, energy });
        }
    }
}

/// Relative residual wanted of a Newton step: a tenth at most and ten times the residual itself, for that keeps convergence
/// quadratic, and no smaller than a thousandth of what the end asks for. Dembo, Eisenstat, Steihaug, SIAM J. Numer. Anal. 19 (1982).
fn forcing(relative: f64, accuracy: f64) -> f64 {
    (10.0 * relative).clamp(1e-10, 0.1).max(1e-3 * accuracy / relative)
}

pub(super) fn moved(u: &[f64], step: &[f64], length: f64) -> Vec<f64> {
    u.iter().zip(step).map(|(u, s)| u + length * s).collect()
}
