//! [`MultigridSolver`]: conjugate gradients with multigrid.

use super::{Accuracy, Curvature, Inertia, LinearError, LinearSolver, LinearWork, Step, System};
use crate::error::FactorError;
use crate::iterative::{CgEnd, CgReport, conjugate_gradient};
use crate::multigrid::{Geometry, Multigrid};
use crate::structure::Structure;
use std::sync::Arc;

/// Residual wanted of a Newton step: the step is corrected by the next one anyway.
const STEP_TOLERANCE: f64 = 1e-4;
/// Residual at which the definiteness of a matrix counts as shown.
const EVIDENCE: f64 = 1e-8;
/// Cycles allowed per system. A nearly incompressible body (Poisson's ratio 0.4994) takes about 250 to full accuracy.
const MOST: usize = 600;
/// A kept hierarchy may take this many times the cycles per decade of the residual that it took when it was new; a new one
/// costs about ten cycles.
const WORN: f64 = 2.0;
/// Backward error `|b - A x| / (|A| |x| + |b|)` that counts as rounding.
const ROUNDING: f64 = 1e-14;

/// Positive definite matrices by conjugate gradients with a multigrid hierarchy, which is kept while it serves.
#[derive(Clone, Debug, Default)]
pub struct MultigridSolver {
    kept: Option<Arc<Multigrid>>,
    /// Cycles per decade of the residual that the kept hierarchy took on its own matrix.
    rate: f64,
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
        if let Some(kept) = self.kept.take() {
            let most = (WORN * self.rate * decades(tolerance)).ceil() as usize;
            let (x, cg) = iterate(system, &kept, b, tolerance, most.min(MOST), work);
            match cg.end {
                CgEnd::NegativeCurvature { .. } => return Ok(Outcome::Indefinite(moved(x))),
                _ if arrived(system, b, &x, &cg) => {
                    work.reused += 1;
                    self.kept = Some(kept);
                    return Ok(Outcome::Solved(x));
                }
                _ => {}
            }
        }
        let fresh = match hierarchy(system, work) {
            Err(FactorError::NotPositive { .. }) => return Ok(Outcome::Indefinite(None)),
            built => Arc::new(built?),
        };
        let (x, cg) = iterate(system, &fresh, b, tolerance, MOST, work);
        if let CgEnd::NegativeCurvature { .. } = cg.end {
            return Ok(Outcome::Indefinite(moved(x)));
        }
        if !arrived(system, b, &x, &cg) {
            return Err(LinearError::Multigrid { residual: cg.residual, cycles: cg.iterations, wanted: tolerance });
        }
        (self.kept, self.rate) = (Some(fresh), cg.iterations.max(1) as f64 / decades(tolerance));
        Ok(Outcome::Solved(x))
    }
}

impl LinearSolver for MultigridSolver {
    fn name(&self) -> &'static str {
        "multigrid"
    }

    fn restart(&mut self) {}

    fn clear(&mut self) {
        self.kept = None;
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        let fresh = hierarchy(system, work)?;
        (self.kept, self.rate) = (Some(Arc::new(fresh)), MOST as f64);
        Ok(())
    }

    fn step(&mut self, system: &System, b: &[f64], _: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        match self.run(system, b, STEP_TOLERANCE, work)? {
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
        self.kept = None;
        let outcome = self.run(system, b, STEP_TOLERANCE, work);
        self.kept = None;
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
        self.kept.as_ref().map(|_| 0)
    }

    fn bytes(&self) -> usize {
        0
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

fn hierarchy(system: &System, work: &mut LinearWork) -> Result<Multigrid, FactorError> {
    work.hierarchies += 1;
    let (points, corners) = (system.configuration.positions(), system.configuration.corners());
    Multigrid::new(system.matrix, &Geometry { points, fixed: system.fixed, corners }, system.parallel)
}

fn iterate(
    system: &System,
    multigrid: &Multigrid,
    b: &[f64],
    tolerance: f64,
    most: usize,
    work: &mut LinearWork,
) -> (Vec<f64>, CgReport) {
    let mut x = vec![0.0; b.len()];
    let apply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
    let cg = conjugate_gradient(&apply, multigrid, b, &mut x, tolerance, most);
    work.cycles += cg.iterations;
    (x, cg)
}

/// Whether the tolerance is met, or double precision allows no more.
fn arrived(system: &System, b: &[f64], x: &[f64], cg: &CgReport) -> bool {
    let space = system.space();
    let rounding = || ROUNDING * (1.0 + system.matrix.norm() * space.norm(x) / space.norm(b));
    cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= rounding())
}

/// What conjugate gradients found before they met negative curvature, if they took a step.
fn moved(x: Vec<f64>) -> Option<Vec<f64>> {
    x.iter().any(|&x| x != 0.0).then_some(x)
}
