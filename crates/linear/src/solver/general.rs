//! [`General`]: matrices that are not symmetric.

use super::{
    Accuracy, Curvature, Definite, Inertia, LinearError, LinearSolver, LinearWork, Lu, Solution, SolverState, Step,
    System,
};
use crate::error::FactorError;
use crate::factor::rotations::CorotatedPreconditioner;
use crate::factor::structure::Structure;
use crate::factor::symmetric::{Factor, Pivots};
use crate::krylov::conjugate_gradients::CgReport;
use crate::krylov::gmres::gmres;
use crate::pattern::matrix::SparseMatrix;
use std::sync::Arc;

/// Iterations with an earlier factor before a new one is made.
const MAX_REUSE_ITERATIONS: usize = 30;
/// Iterations with a factor of the symmetric part of the matrix itself.
const MAX_ITERATIONS: usize = 300;

/// `A = S + W` by GMRES with a factor of the [stand-in](SparseMatrix::stand_in) as preconditioner, the symmetric part S with what was set aside: in
/// double precision, of any signs, kept while it serves. Where that does not converge, or the stand-in has no factor, an LU factorisation of A takes its place from then on: whatever
/// made it fail stays true nearby. LU comes second because it takes several times the memory and time (docs/development/performance.md).
#[derive(Clone, Debug)]
pub struct General {
    structure: Arc<Structure>,
    factor: Option<Factor>,
    /// What it fell back on.
    lu: Option<Lu>,
}

impl General {
    /// For matrices of a structure.
    pub fn new(structure: Arc<Structure>) -> Self {
        General { structure, factor: None, lu: None }
    }

    fn run(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        if let Some(lu) = &mut self.lu {
            return lu.run(system, b, tolerance, work);
        }
        if let Some(kept) = &self.factor {
            let (x, report) = iterate(system, kept, b, tolerance, MAX_REUSE_ITERATIONS);
            work.back_substitutions += report.iterations;
            if report.converged() {
                work.reused += 1;
                return Ok(x);
            }
        }
        let why = match self.factorise(system, system.matrix.stand_in(), work) {
            Ok(factor) => {
                let (x, report) = iterate(system, factor, b, tolerance, MAX_ITERATIONS);
                work.back_substitutions += report.iterations;
                if system.is_solved(&x, &report, b, tolerance) {
                    return Ok(x);
                }
                let (residual, iterations) = (report.residual, report.iterations);
                LinearError::Gmres { residual, iterations, wanted: tolerance }
            }
            Err(singular @ FactorError::Singular { .. }) => singular.into(),
            Err(other) => return Err(other.into()),
        };
        self.factor = None;
        let mut lu = Lu::new(self.structure.clone());
        match lu.run(system, b, tolerance, work) {
            Ok(x) => {
                self.lu = Some(lu);
                Ok(x)
            }
            Err(lacking) if lacking.is_lack_of_memory() => Err(lacking),
            Err(_) => Err(why),
        }
    }

    /// A factor of a symmetric matrix in the place of the system's, in the memory of the kept one.
    fn factorise(
        &mut self,
        system: &System,
        symmetric: SparseMatrix,
        work: &mut LinearWork,
    ) -> Result<&Factor, FactorError> {
        work.factorisations += 1;
        let mut fresh = self.factor.take().unwrap_or_else(|| Factor::empty(self.structure.symbolic()));
        match fresh.refactorize(&symmetric, Pivots::Positive, system.parallel) {
            Err(FactorError::NotPositive { .. }) => {
                work.factorisations += 1;
                fresh.refactorize(&symmetric, Pivots::AnySign, system.parallel)?;
            }
            done => done?,
        }
        fresh.set_rotations(system.configuration.rotations().clone());
        Ok(self.factor.insert(fresh))
    }
}

impl LinearSolver for General {
    fn state(&self) -> SolverState {
        let bytes = self.factor.as_ref().map_or(0, Factor::bytes);
        match &self.lu {
            Some(lu) => SolverState { bytes: bytes + lu.state().bytes, ..lu.state() },
            None => SolverState { name: "general", takes_products: false, bytes },
        }
    }

    fn restart(&mut self) {}

    /// What it fell back on stays.
    fn clear(&mut self) {
        self.factor = None;
        if let Some(lu) = &mut self.lu {
            lu.clear();
        }
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        if let Some(lu) = &mut self.lu {
            return lu.prepare(system, work);
        }
        match self.factorise(system, system.matrix.stand_in(), work) {
            Ok(_) => Ok(()),
            Err(FactorError::Singular { .. }) => {
                self.factor = None;
                self.lu.insert(Lu::new(self.structure.clone())).prepare(system, work)
            }
            Err(other) => Err(other.into()),
        }
    }

    /// The curvature reported is that of the stand-in where a factor of it was made, else taken for positive.
    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        let x = self.run(system, b, tolerance, work)?;
        let negative = self.factor.as_ref().is_some_and(|f| f.negative_pivots() > 0);
        Ok(Step::new(x, if negative { Curvature::Negative } else { Curvature::Positive }))
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        Ok(Solution { x: self.run(system, b, accuracy.residual, work)?, negative: None })
    }

    /// `A x = b` if the symmetric part is positive definite.
    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        _: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        let definite = match self.factorise(system, system.matrix.symmetric_part(), work) {
            Ok(factor) => factor.negative_pivots() == 0,
            Err(FactorError::Singular { .. }) => false,
            Err(other) => return Err(other.into()),
        };
        let indefinite = Err(LinearError::Indefinite { quotient: None });
        let x = if definite { self.run(system, b, 1e-4, work) } else { indefinite };
        self.clear();
        x
    }

    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        if !system.matrix.is_symmetric() {
            return Err(LinearError::NoInertia);
        }
        let factor = self.structure.symbolic().factorize(system.matrix, Pivots::AnySign, system.parallel)?;
        Ok(Some(Inertia { negative: factor.negative_pivots(), by_factor: true }))
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        let lu = self.lu.as_ref().map(|_| Lu::new(structure.clone()));
        Box::new(General { lu, ..General::new(structure.clone()) })
    }
}

fn iterate(system: &System, factor: &Factor, b: &[f64], tolerance: f64, most: usize) -> (Vec<f64>, CgReport) {
    let preconditioner = CorotatedPreconditioner::new(factor, system.configuration.rotations(), system.fixed);
    gmres(&system.product(), &preconditioner, b, tolerance, most)
}
