//! [`Shift`]: downhill steps where the matrix is not positive definite.

use super::{LinearError, LinearSolver, LinearWork, System};

/// Least shift tried, as a share of the mean diagonal: slender bodies bend with eigenvalues as small as this, and a larger
/// shift than needed shortens every step.
const LEAST: f64 = 1e-8;
/// Largest shift tried.
const MOST: f64 = 1e3;
/// From one shift to the next.
const GROWTH: f64 = 8.0;

/// `(A + s I) x = b` with s raised until the matrix is positive definite; remembers the last s.
#[derive(Clone, Debug)]
pub struct Shift {
    last: f64,
}

impl Default for Shift {
    fn default() -> Self {
        Shift { last: LEAST }
    }
}

impl Shift {
    /// The step.
    ///
    /// # Errors
    /// [`LinearError::Shift`] where no shift helps, and what the solver says.
    pub fn step(
        &mut self,
        solver: &mut dyn LinearSolver,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        work.shifted += 1;
        let mut matrix = system.matrix.clone();
        let diagonal = matrix.diagonal();
        let scale = diagonal.iter().map(|d| d.abs()).sum::<f64>() / diagonal.len() as f64;
        let (mut shift, mut added) = ((self.last / 64.0).max(LEAST), 0.0);
        while shift <= MOST {
            matrix.add_to_diagonal((shift - added) * scale);
            added = shift;
            if let Some(step) = solver.solve_definite(&System { matrix: &matrix, ..*system }, b, work)? {
                self.last = shift;
                return Ok(step);
            }
            shift *= GROWTH;
        }
        Err(LinearError::Shift)
    }
}
