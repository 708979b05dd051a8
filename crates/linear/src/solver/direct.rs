//! [`Direct`]: a sparse factor, reused as preconditioner while it is effective.

use super::factor_reuse::FactorReuse;
use super::settled::settled;
use super::{
    Accuracy, Curvature, Definite, Inertia, LinearError, LinearSolver, LinearWork, Solution, SolverState, Step, System,
};
use crate::error::FactorError;
use crate::factor::rotations::CorotatedPreconditioner;
use crate::factor::structure::Structure;
use crate::factor::symbolic::Symbolic;
use crate::factor::symmetric::{Factor, Pivots, Precision};
use crate::krylov::conjugate_gradients::{CgEnd, CgReport, StoppingTest, conjugate_gradient};
use crate::krylov::gmres::gmres;
use crate::krylov::refinement::refine;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Operator;
use nastic_numeric::Random;
use std::sync::Arc;

/// Relative residual up to which a step is taken when the iterations worth a factorisation are used up: the next matrix gets a
/// factor of its own.
const MAX_STEP_RESIDUAL: f64 = 0.1;
/// Iterations with a new factor in single precision, beyond which it is too inaccurate; otherwise two or three suffice.
const MAX_FRESH_ITERATIONS: usize = 12;
/// Iterations with a factor whose pivots have grown.
const MAX_GROWN_ITERATIONS: usize = 60;
/// Relative residual at which the definiteness of a matrix counts as shown.
const DEFINITENESS_TOLERANCE: f64 = 1e-8;
/// Relative residual of the inverse iterations before the last, which only turn a vector towards the softest mode.
const MODE_TOLERANCE: f64 = 1e-3;
/// Least ratio of the smallest eigenvalue to the rounding of its Rayleigh quotient with which definiteness is shown.
const MIN_ROUNDING_RATIO: f64 = 1e4;
/// Rounding of a Rayleigh quotient, in units of the rounding of the terms that cancel in it.
const QUOTIENT_ROUNDING: f64 = 4.0;

/// Multifrontal factors of positive definite matrices in single precision, as preconditioner of conjugate gradients on the
/// exact matrix; in double precision where single is too inaccurate; `L D L^T` where the matrix is indefinite.
#[derive(Clone, Debug)]
pub struct Direct {
    structure: Arc<Structure>,
    factor: Option<Factor>,
    /// Fingerprint of the matrix that the factor was made of.
    of: Option<u64>,
    reuse: FactorReuse,
    /// Precision of the next factor: single, unless that was too inaccurate for these matrices.
    precision: Precision,
}

impl Direct {
    /// For matrices of a structure.
    pub fn new(structure: Arc<Structure>) -> Self {
        Direct { structure, factor: None, of: None, reuse: FactorReuse::default(), precision: Precision::Single }
    }

    /// One that begins with a factor of a matrix near the expected ones.
    pub fn with_factor(factor: Factor) -> Self {
        let precision = factor.precision();
        let structure = Structure::analysed(factor.symbolic().clone());
        Direct { structure, factor: Some(factor), of: None, reuse: FactorReuse::default(), precision }
    }

    fn symbolic(&self) -> &Arc<Symbolic> {
        self.structure.symbolic()
    }

    /// In which the next factor of a system is made.
    fn precision_of(&self, system: &System) -> Precision {
        if system.maxima() > 0 { Precision::Double } else { self.precision }
    }

    /// The factor held in the workspace, if it serves as a preconditioner.
    fn kept(&self) -> Option<&Factor> {
        self.factor.as_ref().filter(|f| f.pivots() == Pivots::Positive)
    }

    /// Whether the factor is of this very matrix.
    fn is_of(&self, system: &System) -> bool {
        self.factor.is_some() && self.of == Some(fingerprint(system.matrix))
    }

    /// Whether it is of this matrix in double precision.
    fn is_exact(&self, system: &System) -> bool {
        self.factor.as_ref().is_some_and(|f| f.is_usable() && f.precision() == Precision::Double) && self.is_of(system)
    }

    /// A new factor in single precision in the memory of the old one.
    fn refactorize_single(&mut self, system: &System, work: &mut LinearWork) -> Result<&Factor, FactorError> {
        work.factorisations += 1;
        let mut fresh = match self.factor.take() {
            Some(mut own) => own.approximate(system.matrix, system.parallel).map(|()| own)?,
            None => self.symbolic().approximate(system.matrix, system.parallel)?,
        };
        fresh.set_rotations(system.configuration.rotations().clone());
        self.of = Some(fingerprint(system.matrix));
        Ok(self.factor.insert(fresh))
    }

    /// A new factor in single precision, and what conjugate gradients make of it.
    fn approximate(
        &mut self,
        system: &System,
        b: &[f64],
        test: StoppingTest,
        work: &mut LinearWork,
    ) -> Result<(Vec<f64>, CgReport), FactorError> {
        let fresh = self.refactorize_single(system, work)?;
        let (x, cg) = precondition(system, fresh, system, b, test, MAX_FRESH_ITERATIONS);
        work.back_substitutions += cg.iterations;
        Ok((x, cg))
    }

    /// A new factor in double precision in the memory of the old one.
    fn refactorize(&mut self, system: &System, pivots: Pivots, work: &mut LinearWork) -> Result<(), FactorError> {
        work.factorisations += 1;
        let mut fresh = match self.factor.take() {
            Some(mut own) => own.refactorize(system.matrix, pivots, system.parallel).map(|()| own)?,
            None => self.symbolic().factorize(system.matrix, pivots, system.parallel)?,
        };
        fresh.set_rotations(system.configuration.rotations().clone());
        self.of = Some(fingerprint(system.matrix));
        self.factor = Some(fresh);
        Ok(())
    }

    /// The same of a matrix that may be indefinite.
    fn refactorize_any(&mut self, system: &System, work: &mut LinearWork) -> Result<(), FactorError> {
        if system.maxima() > 0 {
            return self.refactorize(system, Pivots::AnySign, work);
        }
        match self.refactorize(system, Pivots::Positive, work) {
            Err(FactorError::NotPositive { .. }) => self.refactorize(system, Pivots::AnySign, work),
            done => done,
        }
    }

    /// With the factor of an indefinite matrix, if that matrix is this one or one very near.
    fn solve_by_any_sign(
        &self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Option<Vec<f64>> {
        let factor = self.factor.as_ref().filter(|f| f.is_usable() && f.pivots() == Pivots::AnySign)?;
        let mut x = self.back_substitute(b, work);
        let multiply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
        let refined = refine(&multiply, factor, b, &mut x, accuracy.residual, 3);
        work.back_substitutions += refined.iterations;
        refined.converged().then_some(x)
    }

    fn back_substitute(&self, b: &[f64], work: &mut LinearWork) -> Vec<f64> {
        let mut x = b.to_vec();
        if let Some(factor) = &self.factor {
            factor.solve(&mut x, 1);
            work.back_substitutions += 1;
        }
        x
    }

    /// With the factor held: a step, or whether the matrix showed to be indefinite.
    fn step_by_kept(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Kept {
        let Some(kept) = self.kept().filter(|_| self.reuse.serves(self.symbolic(), tolerance)) else {
            return Kept::Nothing { indefinite: false };
        };
        let most = FactorReuse::worth(self.symbolic());
        let (x, cg) = precondition(system, kept, system, b, tolerance.into(), most);
        work.back_substitutions += cg.iterations;
        self.reuse.spent += cg.iterations;
        if cg.converged() || (matches!(cg.end, CgEnd::Exhausted | CgEnd::Stagnated) && cg.residual <= MAX_STEP_RESIDUAL)
        {
            work.reused += 1;
            return Kept::Step(Step::new(x, Curvature::Positive));
        }
        let indefinite = matches!(cg.end, CgEnd::NegativeCurvature { .. });
        if indefinite && cg.iterations > 1 && !self.reuse.cut_short {
            self.reuse.cut_short = true;
            return Kept::Step(Step::new(x, Curvature::CutShort));
        }
        Kept::Nothing { indefinite }
    }

    /// With a new factor in single precision, where that is enough.
    fn step_by_single(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Kept, LinearError> {
        if self.precision_of(system) != Precision::Single {
            return Ok(Kept::Nothing { indefinite: false });
        }
        let indefinite = match self.approximate(system, b, tolerance.into(), work) {
            Ok((x, cg)) if cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= MAX_STEP_RESIDUAL) => {
                return Ok(Kept::Step(Step::new(x, Curvature::Positive)));
            }
            Ok((_, cg)) => matches!(cg.end, CgEnd::NegativeCurvature { .. }),
            Err(FactorError::NotPositive { .. }) => true,
            Err(other) => return Err(other.into()),
        };
        if !indefinite {
            self.precision = Precision::Double;
        }
        Ok(Kept::Nothing { indefinite })
    }

    /// `A x = b`, by what is kept or a new factor.
    fn solution(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        symmetric(system)?;
        let test = StoppingTest::Error(accuracy.error);
        if let Some(x) = self.solve_by_any_sign(system, b, accuracy, work) {
            return Ok(x);
        }
        let own = self.is_of(system);
        if let Some(kept) = self.kept() {
            let worth = FactorReuse::worth(self.symbolic());
            let (x, cg) =
                precondition(system, kept, system, b, test, if own { worth.max(MAX_FRESH_ITERATIONS) } else { worth });
            work.back_substitutions += cg.iterations;
            if exact(&cg, accuracy.residual) {
                return Ok(x);
            }
        }
        if self.precision_of(system) == Precision::Single && !own {
            match self.approximate(system, b, test, work) {
                Ok((x, cg)) if exact(&cg, accuracy.residual) => return Ok(x),
                // Else memory that is free again by now would decide between the factors.
                Err(lacking @ (FactorError::Memory { .. } | FactorError::Limit(_))) => return Err(lacking.into()),
                _ => (),
            }
        }
        if self.kept().is_some_and(|factor| self.is_of(system) && factor.precision() == Precision::Single) {
            // of a positive definite matrix: too coarse
            self.precision = Precision::Double;
        }
        if !self.is_exact(system) {
            self.refactorize_any(system, work)?;
        }
        let mut x = self.back_substitute(b, work);
        let Some(fresh) = &self.factor else { return Err(LinearError::Indefinite { quotient: None }) };
        let multiply = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
        let refined = refine(&multiply, fresh, b, &mut x, accuracy.residual, 10);
        work.back_substitutions += refined.iterations;
        // Refinement stalls where double precision ends: in thin bodies at residuals far above the tolerance, because large
        // terms cancel in A x. A solution that one more correction leaves alone is still an answer, another is not.
        if refined.converged() || refined.residual <= 1e3 * accuracy.residual || settled(system, fresh, b, &x) {
            return Ok(x);
        }
        let failed = |residual: f64| LinearError::Singular { residual, wanted: accuracy.residual };
        if system.maxima() == 0 {
            return Err(failed(refined.residual));
        }
        // pivots are chosen within fronts: where one of a field with a maximum grew, the factor is no more than a preconditioner
        let (x, found) = gmres(&multiply, fresh, b, accuracy.residual, MAX_GROWN_ITERATIONS);
        work.back_substitutions += found.iterations;
        let solved = found.converged() || settled(system, fresh, b, &x);
        if solved { Ok(x) } else { Err(failed(refined.residual.min(found.residual))) }
    }

    /// Negative eigenvalues of the matrix that the factor held was made of, beyond those of the maxima of a system.
    fn negative(&self, system: &System) -> Result<Option<usize>, LinearError> {
        let usable = self.factor.as_ref().filter(|factor| factor.is_usable());
        usable.map(|factor| system.beyond_maxima(factor.negative_pivots())).transpose()
    }
}

/// What a factor made of a step.
enum Kept {
    Step(Step),
    Nothing { indefinite: bool },
}

impl LinearSolver for Direct {
    fn state(&self) -> SolverState {
        SolverState { name: "direct", takes_products: false, bytes: self.factor.as_ref().map_or(0, Factor::bytes) }
    }

    fn restart(&mut self) {
        self.reuse = FactorReuse::default();
        self.precision = self.factor.as_ref().map_or(Precision::Single, Factor::precision);
    }

    fn clear(&mut self) {
        self.factor = None;
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        symmetric(system)?;
        if self.precision_of(system) == Precision::Single {
            match self.refactorize_single(system, work) {
                Ok(_) => return Ok(()),
                Err(FactorError::NotPositive { .. }) => {
                    self.refactorize(system, Pivots::AnySign, work)?;
                    if self.negative(system)? == Some(0) {
                        // single precision is too coarse to show that it is positive definite
                        self.precision = Precision::Double;
                    }
                    return Ok(());
                }
                Err(other) => return Err(other.into()),
            }
        }
        Ok(self.refactorize_any(system, work)?)
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        symmetric(system)?;
        let mut indefinite = match self.step_by_kept(system, b, tolerance, work) {
            Kept::Step(step) => return Ok(step),
            Kept::Nothing { indefinite } => indefinite,
        };
        self.reuse.spent = 0;
        if !indefinite {
            indefinite = match self.step_by_single(system, b, tolerance, work)? {
                Kept::Step(step) => return Ok(step),
                Kept::Nothing { indefinite } => indefinite,
            };
        }
        if !indefinite && system.maxima() == 0 {
            match self.refactorize(system, Pivots::Positive, work) {
                Ok(()) => return Ok(Step::new(self.back_substitute(b, work), Curvature::Positive)),
                Err(FactorError::NotPositive { .. }) => (),
                Err(other) => return Err(other.into()),
            }
        }
        self.refactorize(system, Pivots::AnySign, work)?;
        let x = self.back_substitute(b, work);
        let definite = self.negative(system)? == Some(0);
        // Of no use as a preconditioner.
        self.factor = None;
        if definite {
            self.precision = Precision::Double;
        }
        Ok(Step::new(x, if definite { Curvature::Positive } else { Curvature::Negative }))
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        Ok(Solution { x: self.solution(system, b, accuracy, work)?, negative: self.negative(system)? })
    }

    fn solve_by_products(
        &mut self,
        product: &dyn Operator,
        at: &System,
        b: &[f64],
        accuracy: Accuracy,
        most: usize,
        work: &mut LinearWork,
    ) -> Option<Vec<f64>> {
        let kept = self.kept()?;
        let (x, cg) = precondition(product, kept, at, b, StoppingTest::Error(accuracy.error), most);
        work.back_substitutions += cg.iterations;
        cg.converged().then_some(x)
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        _: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        let pivots = if system.maxima() > 0 { Pivots::AnySign } else { Pivots::Positive };
        match self.refactorize(system, pivots, work) {
            Ok(()) => {
                let (x, definite) = (self.back_substitute(b, work), self.negative(system)? == Some(0));
                self.factor = None;
                if definite { Ok(x) } else { Err(LinearError::Indefinite { quotient: None }) }
            }
            Err(FactorError::NotPositive { .. }) => Err(LinearError::Indefinite { quotient: None }),
            Err(other) => Err(other.into()),
        }
    }

    /// First by a factor in single precision: whether conjugate gradients with it show no negative curvature, in a matrix well away from singular (see
    /// `definite`). Pivots of a factor in double precision are counted where they do, or where single precision is known to be too coarse.
    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        symmetric(system)?;
        let symbolic = self.symbolic();
        let rounding = |x: &[f64]| QUOTIENT_ROUNDING * f64::EPSILON * mean_diagonal(system, x);
        let single = || symbolic.approximate(system.matrix, system.parallel).ok();
        let evidence =
            (self.precision_of(system) == Precision::Single).then(single).flatten().and_then(|f| definite(&f, system));
        if evidence.is_some_and(|(smallest, x)| smallest > MIN_ROUNDING_RATIO * rounding(&x)) {
            return Ok(Some(Inertia { negative: 0, by_factor: true }));
        }
        let factor = match symbolic.factorize(system.matrix, Pivots::Positive, system.parallel) {
            Err(FactorError::NotPositive { .. }) => {
                symbolic.factorize(system.matrix, Pivots::AnySign, system.parallel)?
            }
            done => done?,
        };
        let negative = if factor.pivots() == Pivots::Positive { 0 } else { factor.negative_pivots() };
        let negative = system.beyond_maxima(negative)?;
        // fields of other units than the displacement: eigenvalues relative to the diagonal
        let scales: Option<Vec<f64>> =
            (system.maxima() > 0).then(|| system.matrix.diagonal().iter().map(|d| d.abs()).collect());
        let solve = |x: &mut Vec<f64>| {
            scales.iter().for_each(|scales| x.iter_mut().zip(scales).for_each(|(x, scale)| *x *= scale));
            factor.solve(x, 1);
            true
        };
        let counted = Ok(Some(Inertia { negative, by_factor: true }));
        let Some((smallest, x)) = smallest_eigenvalue(solve, system) else { return counted };
        let rounding = if scales.is_some() { QUOTIENT_ROUNDING * f64::EPSILON } else { rounding(&x) };
        if smallest < rounding {
            return Err(LinearError::NearlySingular { smallest, rounding });
        }
        counted
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Direct::new(structure.clone()))
    }
}

/// A number by which matrices are distinguished (FNV-1a on the bits of the values): what it decides is which factor is tried, not what a
/// solution is worth.
fn fingerprint(matrix: &SparseMatrix) -> u64 {
    let mix = |hash: u64, value: &f64| (hash ^ value.to_bits()).wrapping_mul(0x0100_0000_01b3);
    matrix.values.iter().fold(0xcbf2_9ce4_8422_2325, mix)
}

fn symmetric(system: &System) -> Result<(), LinearError> {
    if system.matrix.is_symmetric() { Ok(()) } else { Err(LinearError::NotSymmetric) }
}

/// `|A x| / |x|`, and x, after three steps of inverse iteration from a seeded vector: the smallest absolute value of an eigenvalue
/// from above, and to a few per cent where it is far below the others. Infinite where every unknown is fixed; nothing where a solution fails.
fn smallest_eigenvalue(mut solve: impl FnMut(&mut Vec<f64>) -> bool, system: &System) -> Option<(f64, Vec<f64>)> {
    let mut random = Random::new(1);
    let mut x: Vec<f64> = system.fixed.iter().map(|fixed| if *fixed { 0.0 } else { random.symmetric() }).collect();
    let mut growth = 0.0;
    for _ in 0..3 {
        let size = system.space().norm(&x);
        x.iter_mut().for_each(|x| *x /= size);
        if !solve(&mut x) {
            return None;
        }
        growth = system.space().norm(&x);
    }
    Some((if growth > 0.0 { 1.0 / growth } else { f64::INFINITY }, x))
}

/// The smallest eigenvalue and its vector, if the matrix is positive definite as far as conjugate gradients show: they solve three systems of inverse
/// iteration, whose right-hand sides turn into the softest mode, the last one to [`DEFINITENESS_TOLERANCE`], with a factor in single precision. In that
/// preconditioner all eigenvalues but those of the softest modes are 1 up to rounding; a negative one stands apart and shows as negative curvature.
fn definite(factor: &Factor, system: &System) -> Option<(f64, Vec<f64>)> {
    let mut tolerances = [MODE_TOLERANCE, MODE_TOLERANCE, DEFINITENESS_TOLERANCE].into_iter();
    let solve = |x: &mut Vec<f64>| {
        let b = std::mem::take(x);
        *x = vec![0.0; b.len()];
        let product = |v: &[f64], out: &mut [f64]| system.multiply(v, out);
        let tolerance = tolerances.next().unwrap_or(DEFINITENESS_TOLERANCE);
        conjugate_gradient(&product, factor, &b, x, tolerance, MAX_FRESH_ITERATIONS).converged()
    };
    smallest_eigenvalue(solve, system)
}

/// `sum_i |A_ii| x_i^2 / |x|^2`: the size of the terms that cancel in the Rayleigh quotient of x.
fn mean_diagonal(system: &System, x: &[f64]) -> f64 {
    let size = system.space().norm(x);
    system.matrix.diagonal().into_iter().zip(x).map(|(d, x)| d.abs() * (x / size).powi(2)).sum()
}

/// Conjugate gradients with a factor for a number of iterations.
fn precondition(
    product: &dyn Operator,
    factor: &Factor,
    at: &System,
    b: &[f64],
    test: StoppingTest,
    most: usize,
) -> (Vec<f64>, CgReport) {
    let mut x = vec![0.0; b.len()];
    let corotated = CorotatedPreconditioner::new(factor, at.configuration.rotations(), at.fixed);
    let report = conjugate_gradient(&|v, out| product.apply(v, out), &corotated, b, &mut x, test, most);
    (x, report)
}

/// Whether the tolerance is met, or double precision allows no more not far from it.
fn exact(cg: &CgReport, tolerance: f64) -> bool {
    cg.converged() || (cg.end == CgEnd::Stagnated && cg.residual <= 1e2 * tolerance)
}
