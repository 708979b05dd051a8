//! [`MultigridSolver`]: conjugate gradients with multigrid.

use super::{Accuracy, Curvature, Inertia, LinearError, LinearSolver, LinearWork, Step, System};
use crate::error::{FactorError, StructureError};
use crate::iterative::{CgEnd, CgReport, conjugate_gradient};
use crate::multigrid::{Geometry, Multigrid};
use crate::saddle_gmres::SaddleGmres;
use crate::structure::Structure;
use crate::volume_modes::VolumeModes;
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
    /// Whether the matrix of the last solution might be indefinite though it met no negative curvature.
    unsure: bool,
    /// Cycles per decade of the residual that they took on their own matrix.
    rate: f64,
    /// Cycles that they took beyond that on others. They are due when these cost as much as a renewal.
    excess: f64,
}

/// What became of a system.
enum Outcome {
    Solved(Vec<f64>),
    /// How far the iteration went before it met negative curvature, downhill on the quadratic model, if anywhere.
    Indefinite(Option<Vec<f64>>),
}

impl MultigridSolver {
    /// To a relative residual, or to the limit of double precision.
    fn run(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Outcome, LinearError> {
        if let Some(modes) = modes_of(system) {
            match self.run_by(system, Some(modes), b, tolerance, work) {
                // what is positive definite by its volume modes alone
                Err(LinearError::Multigrid { .. } | LinearError::Factor(FactorError::NotPositive { .. })) => {}
                done => return done,
            }
        }
        self.run_by(system, None, b, tolerance, work)
    }

    /// The same with levels of the matrix, or of what it has beside volume modes.
    fn run_by(
        &mut self,
        system: &System,
        modes: Option<&VolumeModes>,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Outcome, LinearError> {
        if !system.matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric);
        }
        self.unsure = false;
        let (mut x, mut reached) = (vec![0.0; b.len()], 1.0);
        let mut p = vec![0.0; modes.map_or(0, VolumeModes::len)];
        let same = (self.by_products, self.of_rest) == (system.products.is_some(), modes.is_some());
        if let (Some(levels), true) = (&self.levels, self.serves && same) {
            let wanted = self.rate * decades(tolerance);
            let most = (wanted + RENEWAL - self.excess).ceil() as usize;
            let (cg, positive) =
                iterate((system, modes), levels, b, (&mut x, &mut p), (tolerance, most.min(MOST)), work);
            self.unsure = !positive;
            self.excess += (cg.iterations as f64 - wanted).max(0.0);
            self.serves = self.excess < RENEWAL;
            match cg.end {
                CgEnd::NegativeCurvature { .. } => {
                    self.serves = false;
                    return Ok(Outcome::Indefinite(moved(system, x, b)));
                }
                _ if arrived(system, levels, b, &x, &cg) => {
                    work.reused += 1;
                    return Ok(Outcome::Solved(x));
                }
                // the next levels go on from there
                CgEnd::Exhausted if cg.residual < 1.0 => reached = cg.residual,
                // and from pressures too, though displacements alone leave more than nothing does
                CgEnd::Exhausted if modes.is_some() => {}
                _ => [&mut x, &mut p].into_iter().for_each(|start| start.fill(0.0)),
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
        let (cg, positive) = iterate((system, modes), levels, b, (&mut x, &mut p), (tolerance, most), work);
        self.unsure = !positive;
        if let CgEnd::NegativeCurvature { .. } = cg.end {
            self.serves = false;
            return Ok(Outcome::Indefinite(moved(system, x, b)));
        }
        if !arrived(system, levels, b, &x, &cg) {
            self.serves = false;
            return Err(LinearError::Multigrid { residual: cg.residual, cycles: cg.iterations, wanted: tolerance });
        }
        self.rate = cg.iterations.max(1) as f64 / decades(tolerance / reached);
        Ok(Outcome::Solved(x))
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
        (self.rate, self.excess, self.by_products) = (MOST as f64, 0.0, system.products.is_some());
        self.of_rest = modes.is_some();
        renewed
    }
}

impl MultigridSolver {
    /// Whether what the matrix has beside its volume modes, which are not negative, shows no negative curvature.
    fn rest_is_definite(&mut self, system: &System, b: &[f64]) -> Result<bool, LinearError> {
        let Some(modes) = modes_of(system).filter(|_| system.matrix.is_symmetric()) else { return Ok(false) };
        self.unsure = false;
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
        self.serves = cg.converged();
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
        match self.run(system, b, tolerance.clamp(STEP_TOLERANCE, COARSEST_STEP), work)? {
            // nothing showed that it leads downhill
            Outcome::Solved(x) if self.unsure && system.space().dot(&x, b) <= 0.0 => Err(LinearError::Indefinite),
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
        match self.run(system, b, accuracy.residual, work)? {
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
        let outcome = self.run(system, b, STEP_TOLERANCE, work);
        self.serves = false;
        Ok(match outcome? {
            Outcome::Solved(x) if !self.unsure => Some(x),
            _ => None,
        })
    }

    /// 0 for a matrix that is positive definite as far as conjugate gradients with a right-hand side of fixed random numbers
    /// can show: they do not converge to 1e-8 where it is not, without meeting negative curvature.
    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        let golden = |i: usize| (1.0 + i as f64 * 0.618_033_988_75).fract() - 0.5;
        let n = system.matrix.pattern().dofs();
        let b: Vec<f64> = (0..n).map(|i| if system.fixed[i] { 0.0 } else { golden(i) }).collect();
        if self.rest_is_definite(system, &b)? {
            return Ok(Some(Inertia { negative: 0 }));
        }
        match self.run_by(system, None, &b, EVIDENCE, &mut LinearWork::default())? {
            Outcome::Solved(_) => Ok(Some(Inertia { negative: 0 })),
            Outcome::Indefinite(_) => Err(LinearError::Indefinite),
        }
    }

    /// None: it solves positive definite matrices alone.
    fn negative(&self) -> Option<usize> {
        (self.serves && !self.unsure).then_some(0)
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
    (system, modes): (&System, Option<&VolumeModes>),
    multigrid: &Multigrid,
    b: &[f64],
    (x, p): (&mut [f64], &mut [f64]),
    (tolerance, most): (f64, usize),
    work: &mut LinearWork,
) -> (CgReport, bool) {
    let apply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
    let (cg, positive) = match (system.products, modes) {
        (Some(products), _) => (conjugate_gradient(&apply, &multigrid.below(products), b, x, tolerance, most), true),
        (None, None) => (conjugate_gradient(&apply, multigrid, b, x, tolerance, most), true),
        (None, Some(modes)) => {
            let saddle = SaddleGmres { apply: &apply, modes, preconditioner: multigrid };
            let found = saddle.solve(b, (x, p), (tolerance, most));
            (found.cg, found.positive)
        }
    };
    work.cycles += cg.iterations;
    (cg, positive)
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
