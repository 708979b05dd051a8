//! [`MultigridSolver`]: conjugate gradients with multigrid.

use super::{
    Accuracy, Curvature, Definite, Inertia, LinearError, LinearSolver, LinearWork, Solution, SolverState, Step, System,
};
use crate::error::{FactorError, StructureError};
use crate::factor::structure::Structure;
use crate::krylov::conjugate_gradients::{CgEnd, CgReport, StoppingTest, conjugate_gradient, conjugate_gradient_while};
use crate::krylov::saddle_gmres::{self, Counts, SaddleGmres, Start, residual_of_pressures};
use crate::krylov::volume_modes::VolumeModes;
use crate::multigrid::{Geometry, Multigrid};
use crate::pattern::entries::Pattern;
use std::sync::Arc;

/// Relative residual of a Newton step near a solution.
const STEP_TOLERANCE: f64 = 1e-4;
/// Relative residual of a Newton step far from a solution: the next step corrects it.
const MAX_STEP_TOLERANCE: f64 = 1e-2;
/// Relative residual at which the definiteness of a matrix counts as shown.
const DEFINITENESS_TOLERANCE: f64 = 1e-8;
/// Cycles per system. A nearly incompressible body (Poisson's ratio 0.4994) takes about 250 to full accuracy.
const MAX_CYCLES: usize = 600;
/// The same where the volume modes of such a body are separate unknowns: about 30 for a step, 120 to full accuracy.
const MAX_CYCLES_WITH_MODES: usize = 300;
/// Cost of a new hierarchy, in cycles: its products, and the bound of the smoother.
const RENEWAL_CYCLES: f64 = 8.0;
/// Cycles beyond those expected, after which the convergence rate of the levels held counts as known.
const MAX_EXCESS_CYCLES: f64 = 2.0;
/// Backward error `|b - A x| / (|A| |x| + |b|)` that counts as rounding.
const ROUNDING: f64 = 1e-14;

/// Positive definite matrices by conjugate gradients with a multigrid hierarchy, which is reused while it is effective.
#[derive(Clone, Debug, Default)]
pub struct MultigridSolver {
    /// The levels of a recent matrix; while `serves` is false they are no preconditioner, and the next ones take their memory.
    levels: Option<Arc<Multigrid>>,
    serves: bool,
    /// Whether they were made for products of cells, which they serve alone.
    by_products: bool,
    /// Whether they were made for the part of a matrix without its volume modes, which they serve alone.
    of_rest: bool,
    /// Cycles per decade of the residual on the matrix that they were made of.
    rate: Option<f64>,
    /// Further cycles on other matrices. The levels are renewed when these cost as much as a renewal.
    excess: f64,
}

impl MultigridSolver {
    /// Memory of a system with this number of volume modes beside the levels: the vectors of its iteration, and the matrix without the modes.
    pub fn bytes_of_modes(pattern: &Pattern, modes: usize) -> usize {
        SaddleGmres::bytes(pattern.dofs() + modes) + size_of::<f64>() * pattern.values()
    }
}

/// The outcome of a solution.
enum Outcome {
    Solved(Solved),
    Indefinite(NotDefinite),
}

/// A solution.
struct Solved {
    x: Vec<f64>,
    /// Whether all curvature met was positive.
    positive: bool,
    /// Differences between pressures and changes of volume after a step.
    changes_left: Option<Vec<f64>>,
}

/// The result for an indefinite matrix.
struct NotDefinite {
    /// The iterate before negative curvature, if it decreases the quadratic model.
    x: Option<Vec<f64>>,
    /// The Rayleigh quotient of the direction of negative curvature.
    quotient: Option<f64>,
}

impl MultigridSolver {
    /// Solves to an aim, or to the limit of double precision.
    fn run(&mut self, system: &System, b: &[f64], aim: Aim, work: &mut LinearWork) -> Result<Outcome, LinearError> {
        if let Some(modes) = modes_of(system) {
            match self.run_by(system, Some(modes), b, aim, work) {
                // a matrix that is positive definite by its volume modes alone
                Err(LinearError::Multigrid { .. } | LinearError::Factor(FactorError::NotPositive { .. })) => {}
                done => return done,
            }
        }
        self.run_by(system, None, b, aim, work)
    }

    /// The same with levels of the matrix, or of its part without volume modes.
    fn run_by(
        &mut self,
        system: &System,
        modes: Option<&VolumeModes>,
        b: &[f64],
        aim: Aim,
        work: &mut LinearWork,
    ) -> Result<Outcome, LinearError> {
        if !system.matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric);
        }
        let (mut x, mut p) = (vec![0.0; b.len()], modes.map_or(Vec::new(), VolumeModes::first_pressures));
        let same = (self.by_products, self.of_rest) == (system.products.is_some(), modes.is_some());
        let expects = modes.filter(|modes| aim.is_step && modes.expects());
        let (counts, aim) = match expects {
            None => (Counts::Matrix, aim),
            Some(modes) => {
                let scale = residual_of_pressures(modes, b, &p, system.parallel);
                let share = scale / system.space().norm(b);
                (Counts::System(scale), Aim::of_step(aim.asked / share))
            }
        };
        let solved = |x: Vec<f64>, p: &[f64], positive| {
            let changes_left = expects.map(|modes| modes.left(&x, p, system.parallel));
            Ok(Outcome::Solved(Solved { x, positive, changes_left }))
        };
        let indefinite = |x, quotient| Ok(Outcome::Indefinite(NotDefinite { x: moved(system, x, b), quotient }));
        let mut reached = 1.0;
        if self.serves && same {
            match self.run_by_kept((system, modes, counts), b, &mut x, &mut p, aim, work) {
                WithKept::Solved { positive } => return solved(x, &p, positive),
                WithKept::Indefinite { curvature } => return indefinite(x, Some(curvature)),
                WithKept::Left(left) => reached = left,
            }
        }
        match self.renew(system, modes, work) {
            Err(FactorError::NotPositive { .. }) if modes.is_none() => return indefinite(x, None),
            renewed => renewed?,
        }
        let Some(levels) = &self.levels else { return indefinite(Vec::new(), None) };
        let most = if modes.is_some() { MAX_CYCLES_WITH_MODES } else { MAX_CYCLES };
        let (cg, positive) = iterate((system, modes, counts), levels, b, &mut x, &mut p, (aim, most), work);
        if let CgEnd::NegativeCurvature { curvature } = cg.end {
            return indefinite(x, Some(curvature));
        }
        if !arrived(system, levels, b, &x, &cg) {
            self.serves = false;
            return Err(LinearError::Multigrid { residual: cg.residual, cycles: cg.iterations, wanted: aim.residual });
        }
        self.rate = Some(cg.iterations.max(1) as f64 / decades(cg.residual.max(aim.residual) / reached));
        solved(x, &p, positive)
    }

    /// The same with the levels held, as long as new ones are not expected to be less expensive.
    fn run_by_kept(
        &mut self,
        (system, modes, counts): (&System, Option<&VolumeModes>, Counts),
        b: &[f64],
        x: &mut [f64],
        p: &mut [f64],
        aim: Aim,
        work: &mut LinearWork,
    ) -> WithKept {
        let Some(levels) = &self.levels else { return WithKept::Left(1.0) };
        // GMRES iterates until the residual is met
        let expected = if modes.is_some() { aim.residual } else { aim.expected() };
        let (rate, excess) = (self.rate, self.excess);
        let wanted = rate.map_or(MAX_CYCLES as f64, |rate| rate * decades(expected));
        let go_on = |cycles: usize, reached: f64| {
            let (cycles, left) = (cycles as f64, decades(expected / reached));
            // remaining cycles at the present rate, and with new levels, if their rate is known
            let (here, anew) = (cycles / decades(reached) * left, rate.map(|rate| RENEWAL_CYCLES + rate * left));
            let pays = cycles + excess < wanted + MAX_EXCESS_CYCLES || anew.is_some_and(|anew| here <= anew);
            cycles < MAX_CYCLES as f64 && pays
        };
        let (cg, positive) = match modes {
            None => (by_cg(system, levels, b, x, aim, &go_on, work), true),
            Some(_) => {
                let most = (wanted + RENEWAL_CYCLES - excess).ceil() as usize;
                iterate((system, modes, counts), levels, b, x, p, (aim, most.min(MAX_CYCLES)), work)
            }
        };
        self.excess += (cg.iterations as f64 - wanted).max(0.0);
        self.serves = self.excess < RENEWAL_CYCLES;
        match cg.end {
            // the levels may still be effective for definite matrices
            CgEnd::NegativeCurvature { curvature } => return WithKept::Indefinite { curvature },
            _ if arrived(system, levels, b, x, &cg) => {
                work.reused += 1;
                return WithKept::Solved { positive };
            }
            // the next levels continue from this iterate
            CgEnd::Exhausted if cg.residual < 1.0 => {}
            // with volume modes too, though the residual of the displacements alone exceeds that of zero
            CgEnd::Exhausted if modes.is_some() => {}
            _ => {
                x.fill(0.0);
                p.copy_from_slice(&modes.map_or(Vec::new(), VolumeModes::first_pressures));
            }
        }
        self.serves = false;
        WithKept::Left(if cg.end == CgEnd::Exhausted { cg.residual.min(1.0) } else { 1.0 })
    }

    /// The levels of a matrix, or of its part without volume modes.
    fn renew(
        &mut self,
        system: &System,
        modes: Option<&VolumeModes>,
        work: &mut LinearWork,
    ) -> Result<(), FactorError> {
        work.hierarchies += 1;
        let kept = self.levels.take().and_then(Arc::into_inner);
        let mut levels = kept.unwrap_or_else(|| Multigrid::empty(system.matrix.pattern()));
        let (points, corners) = (system.configuration.positions(), system.configuration.corners());
        let geometry = Geometry { points, fixed: system.fixed, corners, products: system.products };
        let renewed = match modes {
            None => levels.renew(system.matrix, &geometry, system.parallel),
            Some(modes) => {
                let rest = modes.rest(system.matrix).map_err(|why| FactorError::from(StructureError::from(why)));
                rest.and_then(|rest| levels.renew(&rest, &geometry, system.parallel))
            }
        };
        levels.release_products();
        (self.levels, self.serves) = (Some(Arc::new(levels)), renewed.is_ok());
        let same = (self.by_products, self.of_rest) == (system.products.is_some(), modes.is_some());
        (self.by_products, self.of_rest) = (system.products.is_some(), modes.is_some());
        // the rate of the levels before, until these have solved a system
        self.rate = self.rate.filter(|_| same);
        self.excess = 0.0;
        renewed
    }
}

impl MultigridSolver {
    /// Whether the matrix without its volume modes, which are not negative, shows no negative curvature.
    fn rest_is_definite(&mut self, system: &System, b: &[f64]) -> Result<bool, LinearError> {
        let Some(modes) = modes_of(system).filter(|_| system.matrix.is_symmetric()) else { return Ok(false) };
        match self.renew(system, Some(modes), &mut LinearWork::default()) {
            Err(FactorError::NotPositive { .. }) => return Ok(false),
            renewed => renewed?,
        }
        let Some(levels) = &self.levels else { return Ok(false) };
        let apply = |v: &[f64], out: &mut [f64]| {
            system.multiply(v, out);
            let mut p = vec![0.0; modes.len()];
            modes.of(v, &mut p, system.parallel);
            p.iter_mut().zip(modes.stiffness()).for_each(|(p, [c, _])| *p *= -c);
            modes.add(&p, out, system.parallel);
        };
        let preconditioner: &Multigrid = levels;
        let cg =
            conjugate_gradient(&apply, preconditioner, b, &mut vec![0.0; b.len()], DEFINITENESS_TOLERANCE, MAX_CYCLES);
        self.serves = cg.converged();
        Ok(cg.converged())
    }
}

impl LinearSolver for MultigridSolver {
    fn state(&self) -> SolverState {
        let bytes = self.levels.as_ref().map_or(0, |levels| levels.bytes());
        SolverState { name: "multigrid", takes_products: true, bytes }
    }

    fn restart(&mut self) {}

    fn clear(&mut self) {
        *self = Self::default();
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        match modes_of(system).map(|modes| self.renew(system, Some(modes), work)) {
            None | Some(Err(FactorError::NotPositive { .. })) => Ok(self.renew(system, None, work)?),
            Some(renewed) => Ok(renewed?),
        }
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        match self.run(system, b, Aim::of_step(tolerance), work)? {
            // nothing shows that it is a descent direction
            Outcome::Solved(Solved { x, changes_left: None, .. }) if system.space().dot(&x, b) <= 0.0 => {
                Err(LinearError::Indefinite { quotient: None })
            }
            Outcome::Solved(Solved { x, changes_left, .. }) => {
                Ok(Step { changes_left, ..Step::new(x, Curvature::Positive) })
            }
            Outcome::Indefinite(NotDefinite { x: Some(x), quotient }) => {
                Ok(Step { quotient, ..Step::new(x, Curvature::Negative) })
            }
            Outcome::Indefinite(NotDefinite { x: None, quotient }) => Err(LinearError::Indefinite { quotient }),
        }
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        match self.run(system, b, Aim::exact(accuracy), work)? {
            Outcome::Solved(Solved { x, positive, .. }) => Ok(Solution { x, negative: positive.then_some(0) }),
            Outcome::Indefinite(NotDefinite { quotient, .. }) => Err(LinearError::Indefinite { quotient }),
        }
    }

    /// Levels of a matrix nearby show negative curvature as well as those of the matrix itself.
    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        which: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        let once = which == Definite::Once;
        self.serves &= !once;
        let found = self.run(system, b, Aim::residual(if once { STEP_TOLERANCE } else { MAX_STEP_TOLERANCE }), work);
        self.serves &= !once;
        match found? {
            Outcome::Solved(Solved { x, positive: true, .. }) if system.space().dot(&x, b) > 0.0 => Ok(x),
            Outcome::Solved(_) => Err(LinearError::Indefinite { quotient: None }),
            Outcome::Indefinite(NotDefinite { quotient, .. }) => Err(LinearError::Indefinite { quotient }),
        }
    }

    /// 0 for a matrix that is positive definite as far as conjugate gradients with a right-hand side of fixed random numbers
    /// can show: they do not converge to 1e-8 where it is not, without meeting negative curvature.
    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        let golden = |i: usize| (1.0 + i as f64 * 0.618_033_988_75).fract() - 0.5;
        let n = system.matrix.pattern().dofs();
        let b: Vec<f64> = (0..n).map(|i| if system.fixed[i] { 0.0 } else { golden(i) }).collect();
        if self.rest_is_definite(system, &b)? {
            return Ok(Some(Inertia { negative: 0, by_factor: false }));
        }
        match self.run_by(system, None, &b, Aim::residual(DEFINITENESS_TOLERANCE), &mut LinearWork::default())? {
            Outcome::Solved(_) => Ok(Some(Inertia { negative: 0, by_factor: false })),
            Outcome::Indefinite(NotDefinite { quotient, .. }) => Err(LinearError::Indefinite { quotient }),
        }
    }

    fn anew(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(MultigridSolver::default())
    }
}

/// The outcome of a solution with the levels held.
enum WithKept {
    Solved {
        positive: bool,
    },
    Indefinite {
        curvature: f64,
    },
    /// Not solved; the share of the residual at which new levels begin.
    Left(f64),
}

/// When a solution is accurate enough.
#[derive(Clone, Copy)]
struct Aim {
    test: StoppingTest,
    /// Relative residual that is always accurate enough.
    residual: f64,
    /// The residual asked for, and whether a step is computed, whose pressures may differ from those of its changes of volume.
    asked: f64,
    is_step: bool,
}

impl Aim {
    fn residual(residual: f64) -> Self {
        Aim { test: residual.into(), residual, asked: residual, is_step: false }
    }

    /// Of a Newton step.
    fn of_step(asked: f64) -> Self {
        Aim { asked, is_step: true, ..Aim::residual(asked.clamp(STEP_TOLERANCE, MAX_STEP_TOLERANCE)) }
    }

    fn exact(Accuracy { error, residual }: Accuracy) -> Self {
        Aim { test: StoppingTest::Either { error, residual }, residual, asked: residual, is_step: false }
    }

    /// The relative residual at which the aim is expected to be met.
    fn expected(&self) -> f64 {
        match self.test {
            StoppingTest::Either { error, residual } => error.max(residual),
            _ => self.residual,
        }
    }
}

/// Orders of magnitude between a right-hand side and its residual.
fn decades(tolerance: f64) -> f64 {
    -tolerance.log10().min(-1.0)
}

/// The volume modes of a system by its entries.
fn modes_of<'a>(system: &System<'a>) -> Option<&'a VolumeModes> {
    if system.products.is_some() { None } else { system.configuration.volume_modes() }
}

/// The report of the iteration, and whether all curvature met was positive.
fn iterate(
    (system, modes, counts): (&System, Option<&VolumeModes>, Counts),
    multigrid: &Multigrid,
    b: &[f64],
    x: &mut [f64],
    p: &mut [f64],
    (aim, most): (Aim, usize),
    work: &mut LinearWork,
) -> (CgReport, bool) {
    let Some(modes) = modes else {
        return (by_cg(system, multigrid, b, x, aim, &|cycles, _| cycles < most, work), true);
    };
    let apply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
    let saddle = SaddleGmres { apply: &apply, modes, preconditioner: multigrid, counts };
    let found = saddle.solve(b, Start { u: x, p }, saddle_gmres::Aim { tolerance: aim.residual, most });
    work.cycles += found.cg.iterations;
    (found.cg, found.positive)
}

/// The same by conjugate gradients.
fn by_cg(
    system: &System,
    multigrid: &Multigrid,
    b: &[f64],
    x: &mut [f64],
    aim: Aim,
    go_on: &dyn Fn(usize, f64) -> bool,
    work: &mut LinearWork,
) -> CgReport {
    let apply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
    let cg = match system.products {
        Some(products) => conjugate_gradient_while(&apply, &multigrid.below(products), b, x, aim.test, go_on),
        None => conjugate_gradient_while(&apply, multigrid, b, x, aim.test, go_on),
    };
    work.cycles += cg.iterations;
    cg
}

/// Whether the tolerance is met, or double precision allows no more.
fn arrived(system: &System, levels: &Multigrid, b: &[f64], x: &[f64], cg: &CgReport) -> bool {
    let space = system.space();
    let norm = || if system.products.is_some() { levels.norm() } else { system.matrix.norm() };
    let rounding = || ROUNDING * (1.0 + norm() * space.norm(x) / space.norm(b));
    cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= rounding())
}

/// The iterate before negative curvature, if it is a descent direction.
fn moved(system: &System, x: Vec<f64>, b: &[f64]) -> Option<Vec<f64>> {
    (system.space().dot(&x, b) > 0.0).then_some(x)
}
