//! Tangent systems by conjugate gradients with multigrid.

use crate::solid::Solid;
use crate::solution::state::SolveReport;
use nastic_linear::{CgEnd, CgReport, FactorError, Geometry, Multigrid, SymmetricMatrix, conjugate_gradient};
use nastic_numeric::vector::norm;

/// Residual wanted of a Newton step: the step is corrected by the next one anyway.
const STEP_TOLERANCE: f64 = 1e-4;
/// Residual at which the definiteness of a tangent counts as shown.
const EVIDENCE: f64 = 1e-8;
/// Cycles allowed per system. A nearly incompressible body (Poisson's ratio 0.4994) takes about 250 to full accuracy.
const MOST: usize = 600;
/// A kept hierarchy may take this many times the cycles it took when it was new; a new one costs about ten cycles.
const WORN: usize = 2;
/// Backward error `|b - A x| / (|A| |x| + |b|)` that counts as rounding.
const ROUNDING: f64 = 1e-14;

/// What came of a system.
pub(crate) enum Outcome {
    /// A solution to the tolerance.
    Solved(Vec<f64>),
    /// The tangent is not positive definite; how far the iteration came, downhill on the quadratic model, if anywhere.
    Indefinite(Option<Vec<f64>>),
    /// The iteration does not get there.
    Failed(String),
}

/// The multigrid hierarchy of one Newton run, kept while it serves.
pub(crate) struct Levels<'a> {
    solid: &'a Solid,
    parallel: bool,
    /// Current positions of the nodes.
    points: Vec<[f64; 3]>,
    kept: Option<Multigrid>,
    /// Cycles that the kept hierarchy took on its own matrix.
    fresh: usize,
}

impl<'a> Levels<'a> {
    pub fn new(solid: &'a Solid, parallel: bool) -> Self {
        Levels { solid, parallel, points: solid.mesh().points().to_vec(), kept: None, fresh: 0 }
    }

    /// The displacement at which tangents are taken from now on.
    pub fn stand_at(&mut self, u: &[f64]) {
        let dim = self.solid.discretization().dim();
        for (point, (x, u)) in self.points.iter_mut().zip(self.solid.mesh().points().iter().zip(u.chunks_exact(dim))) {
            *point = *x;
            point.iter_mut().zip(u).for_each(|(x, u)| *x += u);
        }
    }

    /// A Newton step.
    pub fn step(
        &mut self,
        matrix: &SymmetricMatrix,
        rhs: &[f64],
        report: &mut SolveReport,
    ) -> Result<Outcome, FactorError> {
        self.solve(matrix, rhs, STEP_TOLERANCE, report)
    }

    /// The solution to a relative residual, or to the limit of double precision.
    pub fn solve(
        &mut self,
        matrix: &SymmetricMatrix,
        rhs: &[f64],
        tolerance: f64,
        report: &mut SolveReport,
    ) -> Result<Outcome, FactorError> {
        if let Some(kept) = self.kept.take() {
            let (x, cg) = self.iterate(matrix, &kept, rhs, tolerance, WORN * self.fresh, report);
            match cg.end {
                CgEnd::NegativeCurvature { .. } => return Ok(Outcome::Indefinite(moved(x))),
                _ if arrived(matrix, rhs, &x, &cg) => {
                    report.reused += 1;
                    self.kept = Some(kept);
                    return Ok(Outcome::Solved(x));
                }
                _ => {}
            }
        }
        let fresh = match self.hierarchy(matrix, report) {
            Err(FactorError::NotPositive { .. }) => return Ok(Outcome::Indefinite(None)),
            built => built?,
        };
        let (x, cg) = self.iterate(matrix, &fresh, rhs, tolerance, MOST, report);
        if let CgEnd::NegativeCurvature { .. } = cg.end {
            return Ok(Outcome::Indefinite(moved(x)));
        }
        if !arrived(matrix, rhs, &x, &cg) {
            return Ok(Outcome::Failed(format!(
                "multigrid reached a relative residual of {:.1e} in {} cycles where {tolerance:.1e} is wanted; \
                 the material may be too nearly incompressible for it",
                cg.residual, cg.iterations
            )));
        }
        (self.kept, self.fresh) = (Some(fresh), cg.iterations.max(1));
        Ok(Outcome::Solved(x))
    }

    /// Whether a tangent is positive definite: conjugate gradients from a right-hand side without a pattern cannot
    /// converge where it is not, without meeting negative curvature.
    pub fn definite(&mut self, matrix: &SymmetricMatrix) -> Result<Option<bool>, FactorError> {
        let mut rhs: Vec<f64> =
            (0..matrix.pattern().dofs()).map(|i| (1.0 + i as f64 * 0.618_033_988_75).fract()).collect();
        rhs.iter_mut().for_each(|b| *b -= 0.5);
        self.solid.supports().clear(&mut rhs);
        Ok(match self.solve(matrix, &rhs, EVIDENCE, &mut SolveReport::default())? {
            Outcome::Solved(_) => Some(true),
            Outcome::Indefinite(_) => Some(false),
            Outcome::Failed(_) => None,
        })
    }

    /// Drops the hierarchy: the next matrix is another one.
    pub fn forget(&mut self) {
        self.kept = None;
    }

    fn hierarchy(&self, matrix: &SymmetricMatrix, report: &mut SolveReport) -> Result<Multigrid, FactorError> {
        report.hierarchies += 1;
        let fixed = self.solid.supports().fixed();
        let geometry = Geometry { points: &self.points, fixed, corners: self.solid.discretization().corners() };
        Multigrid::new(matrix, &geometry, self.parallel)
    }

    fn iterate(
        &self,
        matrix: &SymmetricMatrix,
        multigrid: &Multigrid,
        b: &[f64],
        tolerance: f64,
        most: usize,
        report: &mut SolveReport,
    ) -> (Vec<f64>, CgReport) {
        let mut x = vec![0.0; b.len()];
        let apply = |v: &[f64], out: &mut [f64]| matrix.multiply_on(v, out, self.parallel);
        let cg = conjugate_gradient(&apply, multigrid, b, &mut x, tolerance, most);
        report.cycles += cg.iterations;
        (x, cg)
    }
}

/// Whether the tolerance is met, or double precision allows no more.
fn arrived(matrix: &SymmetricMatrix, b: &[f64], x: &[f64], cg: &CgReport) -> bool {
    let rounding = || ROUNDING * (1.0 + matrix.norm() * norm(x) / norm(b));
    cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= rounding())
}

/// What conjugate gradients found before they met negative curvature, if they took a step.
fn moved(x: Vec<f64>) -> Option<Vec<f64>> {
    x.iter().any(|&x| x != 0.0).then_some(x)
}
