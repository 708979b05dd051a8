//! [`General`]: matrices that are not symmetric.

use super::{Accuracy, Curvature, Inertia, LinearError, LinearSolver, LinearWork, Solver, Step, System};
use crate::error::FactorError;
use crate::factor::{Factor, Pivots};
use crate::gmres::gmres;
use crate::rotations::CorotatedPreconditioner;
use crate::symbolic::Symbolic;
use std::sync::Arc;

/// Iterations after which a new factor is due.
const WORN: usize = 30;
/// Iterations allowed with a factor of the matrix's own symmetric part.
const MOST: usize = 300;

/// `A = S + W` by GMRES with a factor of the symmetric part S as preconditioner: in double precision, of any signs. It is
/// kept while it serves. A general sparse LU factorisation of a body of 95,000 unknowns takes ten times the memory.
#[derive(Clone, Debug)]
pub struct General {
    symbolic: Arc<Symbolic>,
    factor: Option<Factor>,
}

/// Which system is solved.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Plain,
    Transposed,
}

impl General {
    /// For matrices of the pattern that was analysed.
    pub fn new(symbolic: Arc<Symbolic>) -> Self {
        General { symbolic, factor: None }
    }

    fn run(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        form: Form,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        work.solver = Solver::General;
        if let Some(kept) = &self.factor {
            let (x, report) = iterate(system, kept, b, tolerance, form, WORN);
            work.back_substitutions += report.iterations;
            if report.converged {
                work.reused += 1;
                return Ok(x);
            }
        }
        self.prepare(system, work)?;
        let Some(factor) = &self.factor else { return Err(LinearError::Indefinite) };
        let (x, report) = iterate(system, factor, b, tolerance, form, MOST);
        work.back_substitutions += report.iterations;
        if report.converged {
            return Ok(x);
        }
        let (residual, iterations) = (report.residual, report.iterations);
        Err(LinearError::Gmres { residual, iterations, wanted: tolerance })
    }
}

impl LinearSolver for General {
    fn restart(&mut self) {}

    fn clear(&mut self) {
        self.factor = None;
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        let symmetric = system.matrix.symmetric_part();
        work.factorisations += 1;
        let mut fresh = self.factor.take().unwrap_or_else(|| Factor::empty(&self.symbolic));
        match fresh.refactorize(&symmetric, Pivots::Positive, system.parallel) {
            Err(FactorError::NotPositive { .. }) => {
                work.factorisations += 1;
                fresh.refactorize(&symmetric, Pivots::AnySign, system.parallel)?;
            }
            done => done?,
        }
        fresh.set_rotations(system.configuration.rotations().clone());
        self.factor = Some(fresh);
        Ok(())
    }

    /// The curvature told is that of the symmetric part where a factor of it was made, else taken for positive.
    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        let x = self.run(system, b, tolerance, Form::Plain, work)?;
        let negative = self.factor.as_ref().is_some_and(|f| f.negative_pivots() > 0);
        Ok(Step { x, curvature: if negative { Curvature::Negative } else { Curvature::Positive } })
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        self.run(system, b, accuracy.residual, Form::Plain, work)
    }

    fn solve_transposed(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        self.run(system, b, accuracy.residual, Form::Transposed, work)
    }

    /// `A x = b` if the symmetric part is positive definite.
    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        self.prepare(system, work)?;
        if self.factor.as_ref().is_none_or(|f| f.negative_pivots() > 0) {
            self.factor = None;
            return Ok(None);
        }
        let x = self.run(system, b, 1e-4, Form::Plain, work);
        self.factor = None;
        x.map(Some)
    }

    fn inertia(&mut self, system: &System) -> Result<Inertia, LinearError> {
        if !system.matrix.is_symmetric() {
            return Err(LinearError::NoInertia);
        }
        let factor = self.symbolic.factorize(system.matrix, Pivots::AnySign, system.parallel)?;
        Ok(Inertia { negative: factor.negative_pivots() })
    }

    fn bytes(&self) -> usize {
        self.factor.as_ref().map_or(0, Factor::bytes)
    }

    fn factor(&self) -> Option<&Factor> {
        self.factor.as_ref()
    }

    fn boxed_clone(&self) -> Box<dyn LinearSolver> {
        Box::new(self.clone())
    }
}

fn iterate(
    system: &System,
    factor: &Factor,
    b: &[f64],
    tolerance: f64,
    form: Form,
    most: usize,
) -> (Vec<f64>, crate::gmres::GmresReport) {
    let preconditioner = CorotatedPreconditioner::new(factor, system.configuration.rotations(), system.fixed);
    let apply = |v: &[f64], out: &mut [f64]| match form {
        Form::Plain => system.matrix.multiply_on(v, out, system.parallel),
        Form::Transposed => system.matrix.multiply_transposed(v, out, system.parallel),
    };
    gmres(&apply, &preconditioner, b, tolerance, most)
}
