//! [`MultigridSolver`]: conjugate gradients with multigrid.

use super::{Accuracy, Curvature, Inertia, LinearError, LinearSolver, LinearWork, Step, System};
use crate::error::{FactorError, StructureError};
use crate::factor::structure::Structure;
use crate::krylov::conjugate_gradients::{CgEnd, CgReport, StoppingTest, conjugate_gradient, conjugate_gradient_while};
use crate::krylov::saddle_gmres::{self, Counts, SaddleGmres, Start, residual_of_pressures};
use crate::krylov::volume_modes::VolumeModes;
use crate::multigrid::{Geometry, Multigrid};
use crate::pattern::entries::Pattern;
use std::sync::Arc;

/// Residual wanted of a Newton step near a solution, and of one far from it: the step is corrected by the next one anyway.
const STEP_TOLERANCE: f64 = 1e-4;
const COARSEST_STEP: f64 = 1e-2;
/// Residual at which the definiteness of a matrix counts as shown.
const EVIDENCE: f64 = 1e-8;
/// Cycles allowed per system. A nearly incompressible body (Poisson's ratio 0.4994) takes about 250 to full accuracy.
const MOST: usize = 600;
/// The same where the volume modes of such a body are unknowns of their own: some 30 to a step, 120 to full accuracy.
const MOST_OF_REST: usize = 300;
/// What a new hierarchy costs, in cycles: its products, and the bound of the smoother.
const RENEWAL: f64 = 8.0;
/// Cycles beyond those wanted after which the pace of levels that are kept is believed.
const GRACE: f64 = 2.0;
/// Backward error `|b - A x| / (|A| |x| + |b|)` that counts as rounding.
const ROUNDING: f64 = 1e-14;

/// Positive definite matrices by conjugate gradients with a multigrid hierarchy, which is kept while it serves.
#[derive(Clone, Debug, Default)]
pub struct MultigridSolver {
    /// The levels of a recent matrix; of no use as a preconditioner, but in the memory of the next ones, while they do not serve.
    levels: Option<Arc<Multigrid>>,
    serves: bool,
    /// Whether they are of products of cells, and serve below such alone.
    by_products: bool,
    /// Whether they are of what a matrix has beside its volume modes, and serve such alone.
    of_rest: bool,
    /// Whether the last matrix showed positive curvature, and that alone.
    positive: bool,
    /// A quotient of it that is not positive.
    quotient: Option<f64>,
    /// What its step left between pressures and changes of volume.
    left: Option<Vec<f64>>,
    /// Cycles per decade of the residual that they took on their own matrix.
    rate: Option<f64>,
    /// Cycles that they took beyond that on others. They are due when these cost as much as a renewal.
    excess: f64,
}

impl MultigridSolver {
    /// Memory that a system with so many volume modes takes beside the levels: the vectors of its iteration, and what the matrix has beside the modes.
    pub fn bytes_of_modes(pattern: &Pattern, modes: usize) -> usize {
        SaddleGmres::bytes(pattern.dofs() + modes) + size_of::<f64>() * pattern.values()
    }
}

impl MultigridSolver {
    /// A solution that leads downhill, of a matrix that showed positive curvature alone.
    fn downhill(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        Ok(match self.run(system, b, Aim::residual(tolerance), work)? {
            Outcome::Solved(x) if self.positive && system.space().dot(&x, b) > 0.0 => Some(x),
            _ => None,
        })
    }
}

/// What became of a system.
enum Outcome {
    Solved(Vec<f64>),
    /// How far the iteration went before it met negative curvature, downhill on the quadratic model, if anywhere.
    Indefinite(Option<Vec<f64>>),
}

impl MultigridSolver {
    /// To an aim, or to the limit of double precision.
    fn run(&mut self, system: &System, b: &[f64], aim: Aim, work: &mut LinearWork) -> Result<Outcome, LinearError> {
        self.left = None;
        if let Some(modes) = modes_of(system) {
            match self.run_by(system, Some(modes), b, aim, work) {
                // what is positive definite by its volume modes alone
                Err(LinearError::Multigrid { .. } | LinearError::Factor(FactorError::NotPositive { .. })) => {}
                done => return done,
            }
        }
        self.run_by(system, None, b, aim, work)
    }

    /// The same with levels of the matrix, or of what it has beside volume modes.
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
        (self.positive, self.quotient) = (false, None);
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
        let mut reached = 1.0;
        if self.serves && same {
            match self.run_by_kept((system, modes, counts), b, (&mut x, &mut p), aim, work) {
                WithKept::Solved => {
                    self.left = expects.map(|modes| modes.left(&x, &p, system.parallel));
                    return Ok(Outcome::Solved(x));
                }
                WithKept::Indefinite => return Ok(Outcome::Indefinite(moved(system, x, b))),
                WithKept::Left(left) => reached = left,
            }
        }
        match self.renew(system, modes, work) {
            Err(FactorError::NotPositive { .. }) if modes.is_none() => {
                return Ok(Outcome::Indefinite(moved(system, x, b)));
            }
            renewed => renewed?,
        }
        let Some(levels) = &self.levels else { return Ok(Outcome::Indefinite(None)) };
        let most = if modes.is_some() { MOST_OF_REST } else { MOST };
        let (cg, positive) = iterate((system, modes, counts), levels, b, (&mut x, &mut p), (aim, most), work);
        if let CgEnd::NegativeCurvature { curvature } = cg.end {
            self.quotient = Some(curvature);
            return Ok(Outcome::Indefinite(moved(system, x, b)));
        }
        if !arrived(system, levels, b, &x, &cg) {
            self.serves = false;
            return Err(LinearError::Multigrid { residual: cg.residual, cycles: cg.iterations, wanted: aim.residual });
        }
        self.positive = positive;
        self.rate = Some(cg.iterations.max(1) as f64 / decades(cg.residual.max(aim.residual) / reached));
        self.left = expects.map(|modes| modes.left(&x, &p, system.parallel));
        Ok(Outcome::Solved(x))
    }

    /// The same with the levels that are kept, as long as new ones are not expected to be cheaper.
    fn run_by_kept(
        &mut self,
        (system, modes, counts): (&System, Option<&VolumeModes>, Counts),
        b: &[f64],
        (x, p): (&mut [f64], &mut [f64]),
        aim: Aim,
        work: &mut LinearWork,
    ) -> WithKept {
        let Some(levels) = &self.levels else { return WithKept::Left(1.0) };
        // GMRES goes on to the residual
        let expected = if modes.is_some() { aim.residual } else { aim.expected() };
        let (rate, excess) = (self.rate, self.excess);
        let wanted = rate.map_or(MOST as f64, |rate| rate * decades(expected));
        let go_on = |cycles: usize, reached: f64| {
            let (cycles, left) = (cycles as f64, decades(expected / reached));
            // what is left at the pace so far, and by new levels, if that is known
            let (here, anew) = (cycles / decades(reached) * left, rate.map(|rate| RENEWAL + rate * left));
            let pays = cycles + excess < wanted + GRACE || anew.is_some_and(|anew| here <= anew);
            cycles < MOST as f64 && pays
        };
        let (cg, positive) = match modes {
            None => (by_cg(system, levels, (b, x), (aim, &go_on), work), true),
            Some(_) => {
                let most = (wanted + RENEWAL - excess).ceil() as usize;
                iterate((system, modes, counts), levels, b, (x, p), (aim, most.min(MOST)), work)
            }
        };
        self.excess += (cg.iterations as f64 - wanted).max(0.0);
        self.serves = self.excess < RENEWAL;
        match cg.end {
            // they may be as good for what is definite as they were
            CgEnd::NegativeCurvature { curvature } => {
                self.quotient = Some(curvature);
                return WithKept::Indefinite;
            }
            _ if arrived(system, levels, b, x, &cg) => {
                self.positive = positive;
                work.reused += 1;
                return WithKept::Solved;
            }
            // the next levels go on from there
            CgEnd::Exhausted if cg.residual < 1.0 => {}
            // and from pressures too, though displacements alone leave more than nothing does
            CgEnd::Exhausted if modes.is_some() => {}
            _ => {
                x.fill(0.0);
                p.copy_from_slice(&modes.map_or(Vec::new(), VolumeModes::first_pressures));
            }
        }
        self.serves = false;
        WithKept::Left(if cg.end == CgEnd::Exhausted { cg.residual.min(1.0) } else { 1.0 })
    }

    /// The levels of a matrix, or of what it has beside volume modes.
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
        // that of levels before, until these have solved a system
        self.rate = self.rate.filter(|_| same);
        (self.excess, self.positive, self.quotient) = (0.0, false, None);
        renewed
    }
}

impl MultigridSolver {
    /// Whether what the matrix has beside its volume modes, which are not negative, shows no negative curvature.
    fn rest_is_definite(&mut self, system: &System, b: &[f64]) -> Result<bool, LinearError> {
        let Some(modes) = modes_of(system).filter(|_| system.matrix.is_symmetric()) else { return Ok(false) };
        self.positive = false;
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
        let cg = conjugate_gradient(&apply, preconditioner, b, &mut vec![0.0; b.len()], EVIDENCE, MOST);
        (self.serves, self.positive) = (cg.converged(), cg.converged());
        Ok(cg.converged())
    }
}

impl LinearSolver for MultigridSolver {
    fn name(&self) -> &'static str {
        "multigrid"
    }

    fn takes_products(&self) -> bool {
        true
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
            // nothing showed that it leads downhill
            Outcome::Solved(x) if self.left.is_none() && system.space().dot(&x, b) <= 0.0 => {
                Err(LinearError::Indefinite)
            }
            Outcome::Solved(x) => Ok(Step { x, curvature: Curvature::Positive }),
            Outcome::Indefinite(Some(x)) => Ok(Step { x, curvature: Curvature::Negative }),
            Outcome::Indefinite(None) => Err(LinearError::Indefinite),
        }
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        match self.run(system, b, Aim::exact(accuracy), work)? {
            Outcome::Solved(x) => Ok(x),
            Outcome::Indefinite(_) => Err(LinearError::Indefinite),
        }
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        self.serves = false;
        let solved = self.downhill(system, b, STEP_TOLERANCE, work);
        self.serves = false;
        solved
    }

    fn negative_quotient(&self) -> Option<f64> {
        self.quotient
    }

    fn changes_left(&self) -> Option<&[f64]> {
        self.left.as_deref()
    }

    /// Levels of a matrix nearby show negative curvature as well as its own do.
    fn solve_shifted(
        &mut self,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        self.downhill(system, b, COARSEST_STEP, work)
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
        match self.run_by(system, None, &b, Aim::residual(EVIDENCE), &mut LinearWork::default())? {
            Outcome::Solved(_) => Ok(Some(Inertia { negative: 0, by_factor: false })),
            Outcome::Indefinite(_) => Err(LinearError::Indefinite),
        }
    }

    /// None: it solves positive definite matrices alone.
    fn negative(&self) -> Option<usize> {
        self.positive.then_some(0)
    }

    fn bytes(&self) -> usize {
        self.levels.as_ref().map_or(0, |levels| levels.bytes())
    }

    fn anew(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(MultigridSolver::default())
    }

    fn boxed_clone(&self) -> Box<dyn LinearSolver> {
        Box::new(self.clone())
    }
}

/// What became of a system with levels that were kept.
enum WithKept {
    Solved,
    Indefinite,
    /// Not solved, with the share of the residual that new levels begin from.
    Left(f64),
}

/// When a solution is good enough.
#[derive(Clone, Copy)]
struct Aim {
    test: StoppingTest,
    /// Relative residual that is good enough in any case.
    residual: f64,
    /// The one that was asked for, and whether a step is, which may leave pressures apart from changes of volume.
    asked: f64,
    is_step: bool,
}

impl Aim {
    fn residual(residual: f64) -> Self {
        Aim { test: residual.into(), residual, asked: residual, is_step: false }
    }

    /// Of a Newton step.
    fn of_step(asked: f64) -> Self {
        Aim { asked, is_step: true, ..Aim::residual(asked.clamp(STEP_TOLERANCE, COARSEST_STEP)) }
    }

    fn exact(Accuracy { error, residual }: Accuracy) -> Self {
        Aim { test: StoppingTest::Either { error, residual }, residual, asked: residual, is_step: false }
    }

    /// The relative residual that it is expected to be met at.
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

/// What was found, and whether all curvature that was looked at is positive.
fn iterate(
    (system, modes, counts): (&System, Option<&VolumeModes>, Counts),
    multigrid: &Multigrid,
    b: &[f64],
    (x, p): (&mut [f64], &mut [f64]),
    (aim, most): (Aim, usize),
    work: &mut LinearWork,
) -> (CgReport, bool) {
    let Some(modes) = modes else {
        return (by_cg(system, multigrid, (b, x), (aim, &|cycles, _| cycles < most), work), true);
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
    (b, x): (&[f64], &mut [f64]),
    (aim, go_on): (Aim, &dyn Fn(usize, f64) -> bool),
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

/// What was found before negative curvature was met, if it leads downhill.
fn moved(system: &System, x: Vec<f64>, b: &[f64]) -> Option<Vec<f64>> {
    (system.space().dot(&x, b) > 0.0).then_some(x)
}
