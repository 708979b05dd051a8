//! Linear systems with tangents: the factor at hand as preconditioner while that is cheaper than a new one.

use crate::solid::Solid;
use crate::solution::levels::{Levels, Outcome};
use crate::solution::nodal_rotations;
use crate::solution::options::SolveOptions;
use crate::solution::solver::{self, Solver};
use crate::solution::state::SolveReport;
use nastic_linear::{
    Aim, CgEnd, CgReport, CorotatedPreconditioner, Factor, FactorError, Pivots, Precision, Rotations, SymmetricMatrix,
    conjugate_gradient, refine,
};
use std::cell::OnceCell;
use std::sync::Arc;

/// Of a solution that counts as exact: strains, and with them a gradient, are known to `1e-8`, with a margin of ten.
const EXACT: Aim = Aim::Error(1e-9);
/// Relative error of a solution that rounding alone may leave.
const SETTLED: f64 = 1e-7;
/// Relative residual with which a step is taken when the iterations that are worth it are used up: the work is done, and the
/// next tangent gets a factor of its own.
const ENOUGH: f64 = 0.1;
/// Iterations after which a new factor in single precision is too coarse: where it is not, two or three are enough.
const FRESH: usize = 12;
/// Iterations that cost as much as factorising, per square root of the flops per entry of the factor: an iteration is bound by
/// memory, a factorisation by arithmetic, which is the faster the larger the fronts are (measured on hex8 in single precision with
/// the product that goes with it: 7 at 10k unknowns, 11 at 31k, 15 at 98k).
const FACTORISING: f64 = 0.4;

/// Accuracy of a step from which the equilibrium is in sight.
const IN_SIGHT: f64 = 1e-3;

/// Solves the tangent systems of one Newton run and decides, from counts alone, when to factorise.
pub(crate) struct Tangents<'a> {
    solid: &'a Solid,
    parallel: bool,
    /// Iterations with the kept factor so far: when they have cost as much as a factorisation, one is due. Whatever
    /// comes, that is at most twice the least possible work, and the last factor is one from near the end.
    spent: usize,
    /// Displacement at which the tangents are taken, and how far the body has turned there, once somebody asked.
    u: Vec<f64>,
    rotations: OnceCell<Arc<Rotations>>,
    /// In which the next factor is made: single, until that turns out too coarse for the body.
    precision: Precision,
    /// Whether a step has been cut short where the curvature turned negative. Once in a run that is cheaper than knowing
    /// the whole tangent, which is positive again at most next iterates; where it is not, a factor tells.
    cut_short: bool,
    /// The shift that made the last indefinite tangent definite, as a share of the mean diagonal.
    shift: f64,
    /// There on a body that is solved by multigrid.
    levels: Option<Levels<'a>>,
}

/// What a tangent turned out to be along the way to a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    /// Positive wherever it was looked at: the step is Newton's, downhill.
    Positive,
    /// Negative somewhere; the step is the part of Newton's found before that, downhill. Dembo, Steihaug, "Truncated-Newton
    /// algorithms for large-scale unconstrained optimization", Math. Programming 26 (1983).
    CutShort,
    /// Negative somewhere; the step is Newton's and may lead to a saddle, uphill.
    Negative,
}

/// Least shift tried, as a share of the mean diagonal: slender bodies bend with eigenvalues as small as this, and a larger
/// shift than needed shortens every step.
const LEAST_SHIFT: f64 = 1e-8;

impl<'a> Tangents<'a> {
    pub fn new(solid: &'a Solid, how: &SolveOptions, kept: Option<&Factor>) -> Self {
        let solver = how.solver.unwrap_or_else(|| solid.discretization().solver());
        let levels = (solver == Solver::Multigrid).then(|| Levels::new(solid, how.parallel));
        let (u, rotations) = (Vec::new(), OnceCell::new());
        let precision = kept.map_or(Precision::Single, Factor::precision);
        Tangents {
            solid,
            parallel: how.parallel,
            spent: 0,
            u,
            rotations,
            precision,
            cut_short: false,
            shift: LEAST_SHIFT,
            levels,
        }
    }

    /// Says at which displacement the tangents to come are taken.
    pub fn stand_at(&mut self, u: &[f64]) {
        self.u = u.to_vec();
        self.rotations = OnceCell::new();
        if let Some(levels) = &mut self.levels {
            levels.stand_at(u);
        }
    }

    /// [`stand_at`](Self::stand_at), chained.
    pub fn standing_at(mut self, u: &[f64]) -> Self {
        self.stand_at(u);
        self
    }

    fn rotations(&self) -> &Arc<Rotations> {
        self.rotations.get_or_init(|| Arc::new(nodal_rotations::rotations(self.solid.body(), &self.u, self.parallel)))
    }

    /// The Newton step of a tangent whose supports are eliminated, to a relative residual of `tolerance`, and what the
    /// tangent turned out to be.
    pub fn solve(
        &mut self,
        matrix: &SymmetricMatrix,
        rhs: &[f64],
        tolerance: f64,
        factor: &mut Option<Factor>,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Curvature), String> {
        if let Some(levels) = &mut self.levels {
            report.solver = Solver::Multigrid;
            match levels.step(matrix, rhs, report).map_err(|e| e.to_string())? {
                Outcome::Solved(step) => return Ok((step, Curvature::Positive)),
                Outcome::Indefinite(Some(step)) => return Ok((step, Curvature::Negative)),
                Outcome::Indefinite(None) => {
                    let step = self.solve_shifted(matrix.clone(), rhs, factor, report)?;
                    return Ok((step, Curvature::Negative));
                }
                Outcome::Failed(why) => self.fall_back(why)?,
            }
        }
        report.solver = Solver::Direct;
        let mut indefinite = false;
        if let Some(kept) =
            factor.as_ref().filter(|f| self.spent < self.patience(tolerance) && f.pivots() == Pivots::Positive)
        {
            let (step, cg) = self.precondition(&self.product(matrix), kept, rhs, tolerance.into(), self.worth());
            report.back_substitutions += cg.iterations;
            self.spent += cg.iterations;
            if cg.converged() || (matches!(cg.end, CgEnd::Exhausted | CgEnd::Stagnated) && cg.residual <= ENOUGH) {
                report.reused += 1;
                return Ok((step, Curvature::Positive));
            }
            if matches!(cg.end, CgEnd::NegativeCurvature { .. }) && cg.iterations > 1 && !self.cut_short {
                self.cut_short = true;
                return Ok((step, Curvature::CutShort));
            }
            indefinite = matches!(cg.end, CgEnd::NegativeCurvature { .. });
        }
        self.spent = 0;
        if !indefinite && self.precision == Precision::Single {
            match self.approximate(matrix, rhs, tolerance.into(), factor, report) {
                Ok((step, cg)) if cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= ENOUGH) => {
                    return Ok((step, Curvature::Positive));
                }
                Ok((_, cg)) => indefinite = matches!(cg.end, CgEnd::NegativeCurvature { .. }),
                Err(FactorError::NotPositive { .. }) => indefinite = true,
                Err(other) => return Err(other.to_string()),
            }
            if !indefinite {
                self.precision = Precision::Double;
            }
        }
        if !indefinite {
            match self.refactorize(matrix, Pivots::Positive, factor, report) {
                Ok(()) => return Ok((self.back_substitute(rhs, factor, report), Curvature::Positive)),
                Err(FactorError::NotPositive { .. }) => (),
                Err(other) => return Err(other.to_string()),
            }
        }
        self.refactorize(matrix, Pivots::AnySign, factor, report).map_err(|e| e.to_string())?;
        let step = self.back_substitute(rhs, factor, report);
        // Of no use as a preconditioner.
        let definite = factor.take().is_some_and(|f| f.negative_pivots() == 0);
        if definite {
            self.precision = Precision::Double;
        }
        Ok((step, if definite { Curvature::Positive } else { Curvature::Negative }))
    }

    /// Solves with the tangent as it stands until the relative residual is below `tolerance`, for several right-hand
    /// sides; the tangent may be indefinite.
    pub fn solve_exactly(
        &mut self,
        mut matrix: SymmetricMatrix,
        rhs: &[&[f64]],
        tolerance: f64,
        factor: &mut Option<Factor>,
        report: &mut SolveReport,
    ) -> Result<Vec<Vec<f64>>, String> {
        self.eliminate(&mut matrix);
        report.solver = if self.levels.is_some() { Solver::Multigrid } else { Solver::Direct };
        let mut solutions = Vec::with_capacity(rhs.len());
        for b in rhs {
            solutions.push(self.solve_one_exactly(&matrix, b, tolerance, factor, report)?);
        }
        Ok(solutions)
    }

    /// [`solve_exactly`](Self::solve_exactly) with the tangent as a product, zero on the supports, and a factor that is good
    /// enough for so many iterations; `None` where it is not.
    pub fn solve_by_products(
        &self,
        product: &dyn Fn(&[f64], &mut [f64]),
        b: &[f64],
        factor: &Factor,
        most: usize,
        report: &mut SolveReport,
    ) -> Option<Vec<f64>> {
        if self.levels.is_some() || factor.pivots() != Pivots::Positive {
            return None;
        }
        let (x, cg) = self.precondition(product, factor, b, EXACT, most);
        report.back_substitutions += cg.iterations;
        cg.converged().then_some(x)
    }

    fn solve_one_exactly(
        &mut self,
        matrix: &SymmetricMatrix,
        b: &[f64],
        tolerance: f64,
        factor: &mut Option<Factor>,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, String> {
        if let Some(levels) = &mut self.levels {
            match levels.solve(matrix, b, tolerance, report).map_err(|e| e.to_string())? {
                Outcome::Solved(x) => return Ok(x),
                Outcome::Indefinite(_) => self.fall_back("the tangent is not positive definite".to_owned())?,
                Outcome::Failed(why) => self.fall_back(why)?,
            }
            report.solver = Solver::Direct;
        }
        if let Some(kept) = factor.as_ref().filter(|f| f.pivots() == Pivots::Positive) {
            let (x, cg) = self.precondition(&self.product(matrix), kept, b, EXACT, self.worth());
            report.back_substitutions += cg.iterations;
            if exact(&cg, tolerance) {
                return Ok(x);
            }
        }
        if self.precision == Precision::Single
            && let Ok((x, cg)) = self.approximate(matrix, b, EXACT, factor, report)
            && exact(&cg, tolerance)
        {
            return Ok(x);
        }
        match self.refactorize(matrix, Pivots::Positive, factor, report) {
            Err(FactorError::NotPositive { .. }) => self.refactorize(matrix, Pivots::AnySign, factor, report),
            done => done,
        }
        .map_err(|e| e.to_string())?;
        let mut x = self.back_substitute(b, factor, report);
        let Some(fresh) = factor.as_ref() else { return Err("no factor".to_owned()) };
        let refined = refine(&|v, out| matrix.multiply(v, out), fresh, b, &mut x, tolerance, 10);
        report.back_substitutions += refined.iterations;
        // Refinement stalls where double precision ends: in thin bodies at residuals far above the tolerance, because large
        // terms cancel in K x. A solution that one more correction leaves alone is still an answer, another is not.
        if refined.converged() || refined.residual <= 1e3 * tolerance || settled(matrix, fresh, b, &x) {
            return Ok(x);
        }
        Err(format!(
            "relative residual {:.1e} where {tolerance:.1e} is wanted: the tangent is numerically singular \
             (a bifurcation, or a body held too loosely)",
            refined.residual
        ))
    }

    /// Number of negative eigenvalues of a tangent.
    pub fn negative_pivots(mut self, mut matrix: SymmetricMatrix) -> Result<usize, FactorError> {
        self.eliminate(&mut matrix);
        if let Some(levels) = &mut self.levels
            && levels.definite(&matrix)? == Some(true)
        {
            return Ok(0);
        }
        let symbolic = self.solid.discretization().symbolic();
        match symbolic.factorize(&matrix, Pivots::Positive, self.parallel) {
            Err(FactorError::NotPositive { .. }) => {
                Ok(symbolic.factorize(&matrix, Pivots::AnySign, self.parallel)?.negative_pivots())
            }
            done => done.map(|_| 0),
        }
    }

    /// From multigrid to a factor, where that fits: for good, whatever made multigrid fail stays true nearby.
    fn fall_back(&mut self, why: String) -> Result<(), String> {
        let symbolic = self.solid.discretization().symbolic();
        if !solver::fits(symbolic) {
            let gib = symbolic.factor_bytes() as f64 / f64::from(1 << 30);
            return Err(format!("{why}, and a factor of the tangent takes {gib:.0} GiB; try a coarser mesh"));
        }
        self.levels = None;
        Ok(())
    }

    /// Rows and columns of supported unknowns become those of a multiple of the identity.
    pub fn eliminate(&self, matrix: &mut SymmetricMatrix) {
        let diagonal = matrix.diagonal().iter().fold(0.0, |m: f64, d| m.max(d.abs()));
        let diagonal = if diagonal > 0.0 && diagonal.is_finite() { diagonal } else { 1.0 };
        matrix.eliminate(self.solid.supports().fixed(), diagonal);
    }

    fn product<'m>(&self, matrix: &'m SymmetricMatrix) -> impl Fn(&[f64], &mut [f64]) + use<'m> {
        let parallel = self.parallel;
        move |v, out| matrix.multiply_on(v, out, parallel)
    }

    /// As far as conjugate gradients with a factor come in so many iterations.
    fn precondition(
        &self,
        product: &dyn Fn(&[f64], &mut [f64]),
        factor: &Factor,
        b: &[f64],
        aim: Aim,
        most: usize,
    ) -> (Vec<f64>, CgReport) {
        let mut x = vec![0.0; b.len()];
        let turned = CorotatedPreconditioner::new(factor, self.rotations(), self.solid.supports().fixed());
        let report = conjugate_gradient(product, &turned, b, &mut x, aim, most);
        (x, report)
    }

    /// Iterations with a kept factor that are worth it instead of a factorisation.
    fn worth(&self) -> usize {
        let symbolic = self.solid.discretization().symbolic();
        let ratio = FACTORISING * (symbolic.flops() / (symbolic.nonzeros() as f64).max(1.0)).sqrt();
        ratio.round().clamp(5.0, 40.0) as usize
    }

    /// Iterations so far from which a new factor is due. Made with the equilibrium in sight it serves the adjoint and the next
    /// solve nearby as well, which take some six iterations more with an old one: it is due earlier.
    fn patience(&self, tolerance: f64) -> usize {
        if tolerance <= IN_SIGHT { 2 * self.worth() / 5 } else { self.worth() }
    }

    /// A new factor in single precision, and what conjugate gradients make of it.
    fn approximate(
        &self,
        matrix: &SymmetricMatrix,
        rhs: &[f64],
        aim: Aim,
        factor: &mut Option<Factor>,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, CgReport), FactorError> {
        report.factorisations += 1;
        let mut fresh = match factor.take() {
            Some(mut own) => own.approximate(matrix, self.parallel).map(|()| own)?,
            None => self.solid.discretization().symbolic().approximate(matrix, self.parallel)?,
        };
        fresh.stand_in(self.rotations().clone());
        let (x, cg) = self.precondition(&self.product(matrix), &fresh, rhs, aim, FRESH);
        report.back_substitutions += cg.iterations;
        *factor = Some(fresh);
        Ok((x, cg))
    }

    /// A new factor in the memory of the old one where nobody else holds that.
    fn refactorize(
        &self,
        matrix: &SymmetricMatrix,
        pivots: Pivots,
        factor: &mut Option<Factor>,
        report: &mut SolveReport,
    ) -> Result<(), FactorError> {
        report.factorisations += 1;
        let mut fresh = match factor.take() {
            Some(mut own) => own.refactorize(matrix, pivots, self.parallel).map(|()| own)?,
            None => self.solid.discretization().symbolic().factorize(matrix, pivots, self.parallel)?,
        };
        fresh.stand_in(self.rotations().clone());
        *factor = Some(fresh);
        Ok(())
    }

    fn back_substitute(&self, rhs: &[f64], factor: &Option<Factor>, report: &mut SolveReport) -> Vec<f64> {
        let mut x = rhs.to_vec();
        if let Some(factor) = factor {
            factor.solve(&mut x, 1);
            report.back_substitutions += 1;
        }
        x
    }

    /// A downhill step where the tangent is not positive definite: the diagonal is raised until it is.
    pub fn solve_shifted(
        &mut self,
        mut matrix: SymmetricMatrix,
        rhs: &[f64],
        factor: &mut Option<Factor>,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, String> {
        report.shifted += 1;
        let diagonal = matrix.diagonal();
        let scale = diagonal.iter().map(|d| d.abs()).sum::<f64>() / diagonal.len() as f64;
        let (mut shift, mut added) = ((self.shift / 64.0).max(LEAST_SHIFT), 0.0);
        while shift <= 1e3 {
            add_to_diagonal(&mut matrix, (shift - added) * scale);
            added = shift;
            if let Some(levels) = &mut self.levels {
                levels.forget();
                match levels.step(&matrix, rhs, report).map_err(|e| e.to_string())? {
                    Outcome::Solved(step) => {
                        levels.forget();
                        self.shift = shift;
                        return Ok(step);
                    }
                    Outcome::Indefinite(_) => {
                        shift *= 8.0;
                        continue;
                    }
                    Outcome::Failed(why) => self.fall_back(why)?,
                }
            }
            match self.refactorize(&matrix, Pivots::Positive, factor, report) {
                Ok(()) => {
                    self.shift = shift;
                    let step = self.back_substitute(rhs, factor, report);
                    // of no use as a preconditioner: it belongs to another matrix
                    *factor = None;
                    return Ok(step);
                }
                Err(FactorError::NotPositive { .. }) => shift *= 8.0,
                Err(other) => return Err(other.to_string()),
            }
        }
        Err("the tangent stays indefinite under any shift".to_owned())
    }
}

/// Whether the tolerance is met, or double precision allows no more not far from it.
fn exact(cg: &CgReport, tolerance: f64) -> bool {
    cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= 1e2 * tolerance)
}

/// Whether the factor's correction of x is below [`SETTLED`] of it: an estimate of the error, not of the residual.
fn settled(matrix: &SymmetricMatrix, factor: &Factor, b: &[f64], x: &[f64]) -> bool {
    let mut correction = vec![0.0; b.len()];
    matrix.multiply(x, &mut correction);
    correction.iter_mut().zip(b).for_each(|(r, b)| *r = b - *r);
    factor.solve(&mut correction, 1);
    let size = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
    let (correction, x) = (size(&correction), size(x));
    x.is_finite() && correction <= SETTLED * SETTLED * x
}

fn add_to_diagonal(matrix: &mut SymmetricMatrix, shift: f64) {
    let pattern = matrix.pattern().clone();
    for dof in 0..pattern.dofs() {
        if let Some(at) = pattern.value_index(dof, dof) {
            matrix.values[at] += shift;
        }
    }
}
