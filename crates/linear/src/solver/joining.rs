//! [`Joining`]: a solver of matrices whose structure changes.

use super::{Accuracy, Definite, Inertia, LinearError, LinearSolver, LinearWork, Solution, SolverState, Step, System};
use crate::error::FactorError;
use crate::factor::joined_structure::JoinedStructure;
use crate::factor::structure::Structure;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Operator;
use std::sync::Arc;

/// Structures that are held: contact pairs alternate between a few sets.
const MAX_STRUCTURES: usize = 4;

/// A solver for matrices with blocks [beyond their pattern](SparseMatrix::add_beyond): every matrix is handed to a solver of the pattern
/// with these blocks [joined](JoinedStructure) to it. A structure serves while it has all pairs that are needed; a new one needs a new
/// factor. A matrix without such blocks goes as it is.
#[derive(Clone, Debug)]
pub struct Joining {
    first: Arc<Structure>,
    /// The last one first.
    joined: Vec<Arc<JoinedStructure>>,
    /// Whose matrices the solver takes: those of the first of `joined`, or of the first structure.
    is_joined: bool,
    solver: Box<dyn LinearSolver>,
}

impl Joining {
    /// One that begins with a solver for matrices of a structure.
    pub fn new(structure: &Arc<Structure>, solver: Box<dyn LinearSolver>) -> Self {
        Joining { first: structure.clone(), joined: Vec::new(), is_joined: false, solver }
    }

    /// Makes the solver one of the matrix, and gives the matrix that it takes where that is another one.
    fn ready(&mut self, matrix: &SparseMatrix) -> Result<Option<SparseMatrix>, FactorError> {
        if matrix.beyond().is_empty() {
            if std::mem::take(&mut self.is_joined) {
                self.solver = self.solver.anew(&self.first);
            }
            return Ok(None);
        }
        let found = self.joined.iter().enumerate().find_map(|(k, kept)| Some((k, kept.join(matrix)?)));
        let (at, joined) = match found {
            Some(found) => found,
            None => {
                let fresh = JoinedStructure::new(&self.first, matrix)?;
                let joined = fresh.join(matrix).ok_or(FactorError::ForeignPattern)?;
                self.joined.truncate(MAX_STRUCTURES - 1);
                self.joined.insert(0, fresh);
                self.is_joined = false;
                (0, joined)
            }
        };
        if at > 0 || !self.is_joined {
            self.joined[..=at].rotate_right(1);
            self.solver = self.solver.anew(self.joined[0].structure());
            self.is_joined = true;
        }
        Ok(Some(joined))
    }

    /// Calls with the solver of a system and the system that it takes.
    fn with<T>(
        &mut self,
        system: &System,
        call: impl FnOnce(&mut dyn LinearSolver, &System) -> Result<T, LinearError>,
    ) -> Result<T, LinearError> {
        match self.ready(system.matrix)? {
            None => call(self.solver.as_mut(), system),
            Some(joined) => call(self.solver.as_mut(), &System { matrix: &joined, ..*system }),
        }
    }
}

impl LinearSolver for Joining {
    fn state(&self) -> SolverState {
        self.solver.state()
    }

    fn restart(&mut self) {
        self.solver.restart();
    }

    fn clear(&mut self) {
        self.solver.clear();
    }

    fn prepare(&mut self, system: &System, work: &mut LinearWork) -> Result<(), LinearError> {
        self.with(system, |solver, system| solver.prepare(system, work))
    }

    fn step(&mut self, system: &System, b: &[f64], tolerance: f64, work: &mut LinearWork) -> Result<Step, LinearError> {
        self.with(system, |solver, system| solver.step(system, b, tolerance, work))
    }

    fn solve(
        &mut self,
        system: &System,
        b: &[f64],
        accuracy: Accuracy,
        work: &mut LinearWork,
    ) -> Result<Solution, LinearError> {
        self.with(system, |solver, system| solver.solve(system, b, accuracy, work))
    }

    /// The product has all blocks in it; what is kept is that of the last structure.
    fn solve_by_products(
        &mut self,
        product: &dyn Operator,
        at: &System,
        b: &[f64],
        accuracy: Accuracy,
        most: usize,
        work: &mut LinearWork,
    ) -> Option<Vec<f64>> {
        self.solver.solve_by_products(product, at, b, accuracy, most, work)
    }

    fn solve_definite(
        &mut self,
        system: &System,
        b: &[f64],
        which: Definite,
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        self.with(system, |solver, system| solver.solve_definite(system, b, which, work))
    }

    fn inertia(&mut self, system: &System) -> Result<Option<Inertia>, LinearError> {
        self.with(system, |solver, system| solver.inertia(system))
    }

    fn anew(&self, structure: &Arc<Structure>) -> Box<dyn LinearSolver> {
        Box::new(Joining::new(structure, self.solver.anew(structure)))
    }
}
