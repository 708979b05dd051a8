//! [`MultigridSolver`]: conjugate gradients with multigrid.

use super::{Accuracy, Curvature, Inertia, LinearError, LinearSolver, LinearWork, Step, System};
use crate::error::FactorError;
use crate::iterative::{CgEnd, CgReport, conjugate_gradient};
use crate::multigrid::{Geometry, Multigrid};
use crate::structure::Structure;
use std::sync::Arc;

/// Residual wanted of a Newton step near a solution, and of one far from it: the step is corrected by the next one anyway.
const STEP_TOLERANCE: f64 = 1e-4;
const COARSEST_STEP: f64 = 1e-2;
/// Residual at which the definiteness of a matrix counts as shown.
const EVIDENCE: f64 = 1e-8;
/// Cycles allowed per system. A nearly incompressible body (Poisson's ratio 0.4994) takes about 250 to full accuracy.
const MOST: usize = 600;
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
    /// Conjugate gradients to a relative residual, or to the limit of double precision.
    fn run(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Outcome, LinearError> {
        if !system.matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric);
        }
        let (mut x, mut reached) = (vec![0.0; b.len()], 1.0);
        let serves = self.serves && self.by_products == system.products.is_some();
        if let (Some(levels), true) = (&self.levels, serves) {
            let wanted = self.rate * decades(tolerance);
            let most = (wanted + RENEWAL - self.excess).ceil() as usize;
            let cg = iterate(system, levels, b, &mut x, (tolerance, most.min(MOST)), work);
            self.excess += (cg.iterations as f64 - wanted).max(0.0);
            self.serves = self.excess < RENEWAL;
            match cg.end {
                CgEnd::NegativeCurvature { .. } => {
                    self.serves = false;
                    return Ok(Outcome::Indefinite(moved(x)));
                }
                _ if arrived(system, levels, b, &x, &cg) => {
                    work.reused += 1;
                    return Ok(Outcome::Solved(x));
                }
                // the next levels go on from there
                CgEnd::Exhausted if cg.residual < 1.0 => reached = cg.residual,
                _ => x.fill(0.0),
            }
        }
        match self.renew(system, work) {
            Err(FactorError::NotPositive { .. }) => return Ok(Outcome::Indefinite(moved(x))),
            renewed => renewed?,
        }
        let Some(levels) = &self.levels else { return Ok(Outcome::Indefinite(None)) };
        let cg = iterate(system, levels, b, &mut x, (tolerance, MOST), work);
        if let CgEnd::NegativeCurvature { .. } = cg.end {
            self.serves = false;
            return Ok(Outcome::Indefinite(moved(x)));
        }
        if !arrived(system, levels, b, &x, &cg) {
            self.serves = false;
            return Err(LinearError::Multigrid { residual: cg.residual, cycles: cg.iterations, wanted: tolerance });
        }
        self.rate = cg.iterations.max(1) as f64 / decades(tolerance / reached);
        Ok(Outcome::Solved(x))
    }

    /// The levels of a matrix.
    fn renew(&mut self, system: &System, work: &mut LinearWork) -> Result<(), FactorError> {
        work.hierarchies += 1;
        let kept = self.levels.take().and_then(Arc::into_inner);
        let mut levels = kept.unwrap_or_else(|| Multigrid::empty(system.matrix.pattern()));
        let (points, corners) = (system.configuration.positions(), system.configuration.corners());
        let geometry = Geometry { points, fixed: system.fixed, corners, products: system.products };
        let renewed = levels.renew(system.matrix, &geometry, system.parallel);
        levels.release_products();
        (self.levels, self.serves) = (Some(Arc::new(levels)), renewed.is_ok());
        (self.rate, self.excess, self.by_products) = (MOST as f64, 0.0, system.products.is_some());
        renewed
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
        Ok(self.renew(system, work)?)
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        match self.run(system, b, tolerance.clamp(STEP_TOLERANCE, COARSEST_STEP), work)? {
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
            Outcome::Solved(x) => Some(x),
            Outcome::Indefinite(_) => None,
        })
    }

    /// 0 for a matrix that is positive definite as far as conjugate gradients with a right-hand side of fixed random numbers
    /// can show: they do not converge to 1e-8 where it is not, without meeting negative curvature.
    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        let golden = |i: usize| (1.0 + i as f64 * 0.618_033_988_75).fract() - 0.5;
        let n = system.matrix.pattern().dofs();
        let b: Vec<f64> = (0..n).map(|i| if system.fixed[i] { 0.0 } else { golden(i) }).collect();
        match self.run(system, &b, EVIDENCE, &mut LinearWork::default())? {
            Outcome::Solved(_) => Ok(Some(Inertia { negative: 0 })),
            Outcome::Indefinite(_) => Err(LinearError::Indefinite),
        }
    }

    /// None: it solves positive definite matrices alone.
    fn negative(&self) -> Option<usize> {
        self.serves.then_some(0)
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

fn iterate(
    system: &System,
    multigrid: &Multigrid,
    b: &[f64],
    x: &mut [f64],
    (tolerance, most): (f64, usize),
    work: &mut LinearWork,
) -> CgReport {
    let apply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
    let cg = match system.products {
        Some(products) => conjugate_gradient(&apply, &multigrid.below(products), b, x, tolerance, most),
        None => conjugate_gradient(&apply, multigrid, b, x, tolerance, most),
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

/// What conjugate gradients found before they met negative curvature, if they took a step.
fn moved(x: Vec<f64>) -> Option<Vec<f64>> {
    x.iter().any(|&x| x != 0.0).then_some(x)
}
