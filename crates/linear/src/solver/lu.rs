//! [`Lu`]: a sparse LU factorisation, for matrices that are not symmetric.

use super::{
    Accuracy, Curvature, Definite, LinearError, LinearSolver, LinearWork, Solution, SolverState, Step, System,
};
use crate::error::FactorError;
use crate::factor::lu_factor::{LuAnalysis, LuFactor};
use crate::factor::structure::Structure;
use crate::krylov::conjugate_gradients::CgReport;
use crate::krylov::gmres::gmres;
use std::sync::Arc;

/// Iterations with an earlier factorisation before a new one is made.
const MAX_REUSE_ITERATIONS: usize = 30;
/// Iterations with a factorisation of the matrix itself: two suffice unless it is nearly singular.
const MAX_ITERATIONS: usize = 100;

/// `A x = b` by GMRES with `P A Q = L U` as preconditioner, which is kept while it serves; the analysis of the columns is made
/// once. It takes matrices of any symmetry and signs, and counts none.
#[derive(Clone, Debug)]
pub struct Lu {
    structure: Arc<Structure>,
    analysis: Option<Arc<LuAnalysis>>,
    factor: Option<Arc<LuFactor>>,
}

impl Lu {
    /// For matrices of a structure.
    pub fn new(structure: Arc<Structure>) -> Self {
        Lu { structure, analysis: None, factor: None }
    }

    /// A factorisation of the matrix in the place of the kept one.
    fn factorise(&mut self, system: &System, work: &mut LinearWork) -> Result<&LuFactor, FactorError> {
        // Two factors at a time would be too many.
        self.factor = None;
        let analysis = match &self.analysis {
            Some(known) => known.clone(),
            None => Arc::new(LuAnalysis::new(&self.structure)?),
        };
        work.factorisations += 1;
        let fresh = Arc::new(LuFactor::new(analysis.clone(), system.matrix)?);
        self.analysis = Some(analysis);
        Ok(self.factor.insert(fresh))
    }

    /// The solution to a relative residual.
    pub(super) fn run(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        if let Some(kept) = &self.factor {
            let (x, report) = iterate(system, kept, b, tolerance, MAX_REUSE_ITERATIONS);
            work.back_substitutions += report.iterations;
            if report.converged() {
                work.reused += 1;
                return Ok(x);
            }
        }
        let fresh = self.factorise(system, work)?;
        let (x, report) = iterate(system, fresh, b, tolerance, MAX_ITERATIONS);
        work.back_substitutions += report.iterations;
        match system.is_solved(&x, &report, b, tolerance) {
            true => Ok(x),
            false => Err(LinearError::Singular { residual: report.residual, wanted: tolerance }),
        }
    }
}

impl LinearSolver for Lu {
    /// The memory is that of the entries that the elimination order of the structure would give: a lower bound.
    fn state(&self) -> SolverState {
        let bytes = self.factor.as_ref().map_or(0, |factor| factor.least_bytes());
        SolverState { name: "lu", takes_products: false, bytes }
    }

    fn restart(&mut self) {}

    fn clear(&mut self) {
        self.factor = None;
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        self.factorise(system, work)?;
        Ok(())
    }

    /// The curvature is not known and taken for positive.
    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        Ok(Step::new(self.run(system, b, tolerance, work)?, Curvature::Positive))
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

    /// Pivots of an LU factorisation do not show whether the matrix is positive definite.
    ///
    /// # Errors
    /// [`LinearError::NotCounted`].
    fn solve_definite(
        &mut self,
        _: &System,
        _: &[f64],
        _: Definite,
        _: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        Err(LinearError::NotCounted { solver: self.state().name })
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Lu::new(structure.clone()))
    }
}

fn iterate(system: &System, factor: &LuFactor, b: &[f64], tolerance: f64, most: usize) -> (Vec<f64>, CgReport) {
    let apply = system.product();
    match system.transposed {
        false => gmres(&apply, factor, b, tolerance, most),
        true => gmres(&apply, &factor.transposed(), b, tolerance, most),
    }
}
