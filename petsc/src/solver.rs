//! [`PETSC`]: tangent systems of a body over ranks by PETSc.

use crate::numbering::Numbering;
use crate::rows::Rows;
use crate::session::PetscError;
use crate::system::{Distributed, End};
use nastic_fem::SolverFactory;
use nastic_linear::solver::{Accuracy, Curvature, Definite, Inertia, Solution, SolverState, Step, System};
use nastic_linear::{LinearError, LinearSolver, LinearWork, Structure, Symmetry};
use std::sync::Arc;

/// The name in reports.
const NAME: &str = "petsc";
/// Relative residual by which a matrix is taken for positive definite.
const DEFINITE: f64 = 1e-12;

/// Conjugate gradients and algebraic multigrid (GAMG) of PETSc with the rigid motions at the displaced nodes; options with the prefix `-nastic_` choose
/// another preconditioner: `-nastic_pc_type hypre`, or `-nastic_pc_type cholesky -nastic_pc_factor_mat_solver_type mumps`.
pub const PETSC: &dyn SolverFactory = &Petsc;

#[derive(Debug)]
struct Petsc;

impl SolverFactory for Petsc {
    fn name(&self) -> &'static str {
        NAME
    }

    fn about(&self) -> &'static str {
        "conjugate gradients with algebraic multigrid of PETSc, over the ranks of MPI"
    }

    fn takes(&self) -> Symmetry {
        Symmetry::Symmetric
    }

    fn spans_ranks(&self) -> bool {
        true
    }

    fn make(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(PetscSolver::default())
    }
}

/// Keeps the numbers of nodes alone: a matrix and its multigrid levels live as long as the call that solves with them.
#[derive(Clone, Debug, Default)]
struct PetscSolver {
    numbering: Option<Numbering>,
}

fn failed(error: PetscError) -> LinearError {
    LinearError::External { solver: NAME, what: error.to_string() }
}

impl PetscSolver {
    fn distributed(&mut self, system: &System) -> Result<(Distributed, usize), LinearError> {
        let space = system.space();
        let rows = match system.matrix.is_symmetric() && system.matrix.beyond().is_empty() {
            true => Rows::of(system.matrix).map_err(failed),
            false => Err(LinearError::NotSymmetric),
        };
        // calls of PETSC would wait for a rank that refuses its own
        let refused = space.any(rows.is_err());
        let rows = rows?;
        if refused {
            let what = "another rank refuses its share of the matrix, and says why".to_owned();
            return Err(LinearError::External { solver: NAME, what });
        }
        let block = system.matrix.pattern().dim();
        let numbering = match self.numbering.take().filter(|known| known.fits(space)) {
            Some(known) => known,
            None => Numbering::of(space).map_err(failed)?,
        };
        let numbering = self.numbering.insert(numbering);
        let places = (block, system.configuration.positions());
        let distributed = Distributed::new(rows, numbering, places, space.share().is_some());
        Ok((distributed.map_err(failed)?, block * numbering.owned))
    }

    /// `A x = b` to a relative residual.
    fn run(
        &mut self,
        system: &System,
        b: &[f64],
        tolerance: f64,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        let (distributed, owned) = self.distributed(system)?;
        let mut x = vec![0.0; b.len()];
        let report = distributed.solve(&b[..owned], &mut x[..owned], tolerance).map_err(failed)?;
        work.hierarchies += 1;
        work.cycles += report.iterations;
        match report.end {
            // only owners have values yet
            End::Converged => {
                system.space().add_up(&mut x);
                on_supports(system, b, &mut x);
            }
            End::Indefinite => return Err(LinearError::Indefinite { quotient: None }),
            End::Spent => {
                let residual = report.residual / system.space().norm(b);
                return Err(LinearError::Singular { residual, wanted: tolerance });
            }
            End::Other(reason) => {
                let what = format!("it gave up after {} iterations (KSPConvergedReason {reason})", report.iterations);
                return Err(LinearError::External { solver: NAME, what });
            }
        }
        // a solution along which the curvature is not positive, where the iteration has met none of it
        let space = system.space();
        match space.dot(&x, b) > 0.0 || space.norm(b) == 0.0 {
            true => Ok(x),
            false => Err(LinearError::Indefinite { quotient: None }),
        }
    }
}

/// Rows of supports have a diagonal alone, and are solved by that: levels mix them with others, and what an iteration leaves there would move the supports.
fn on_supports(system: &System, b: &[f64], x: &mut [f64]) {
    let mut diagonal = system.matrix.diagonal();
    system.space().add_up(&mut diagonal);
    for (i, x) in x.iter_mut().enumerate().filter(|(i, _)| system.fixed[*i]) {
        *x = b[i] / diagonal[i];
    }
}

impl LinearSolver for PetscSolver {
    fn state(&self) -> SolverState {
        let bytes = self.numbering.as_ref().map_or(0, |numbering| 4 * numbering.global.len());
        SolverState { name: NAME, takes_products: false, bytes }
    }

    fn restart(&mut self) {}

    fn clear(&mut self) {}

    /// Nothing is kept from one system to the next.
    fn prepare(&mut self, _: &System, _: &mut LinearWork) -> Result<(), LinearError> {
        Ok(())
    }

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

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        _: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        self.run(system, b, DEFINITE, work)
    }

    /// By a factor of MUMPS.
    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        let (negative, zero) = self.distributed(system)?.0.inertia().map_err(failed)?;
        match zero {
            0 => Ok(Some(Inertia { negative, by_factor: true })),
            _ => Err(LinearError::External {
                solver: NAME,
                what: format!("{zero} pivots of MUMPS are zero: the tangent is singular"),
            }),
        }
    }

    fn anew(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(PetscSolver::default())
    }
}
