//! [`Shift`]: descent steps where the matrix is not positive definite.

use super::{Definite, LinearError, LinearSolver, LinearWork, System};
use crate::multigrid::CellProducts;
use std::sync::Arc;

/// Smallest shift, as a share of the mean diagonal: slender bodies bend with eigenvalues as small as this, and a larger
/// shift than needed shortens every step.
const MIN_SHIFT: f64 = 1e-8;
/// Largest shift, likewise.
const MAX_SHIFT: f64 = 1e3;
/// Ratio of one shift to the one before.
const SHIFT_GROWTH: f64 = 8.0;
/// Least shift over a negative Rayleigh quotient: no shift below the quotient makes the matrix positive definite.
const QUOTIENT_RATIO: f64 = 2.0;

/// `(A + s I) x = b` with s raised until the matrix is positive definite; remembers the last s.
#[derive(Clone, Debug)]
pub struct Shift {
    last: f64,
    /// A quotient `p . A p / p . p` of the last matrix that is not positive, where one was met.
    quotient: Option<f64>,
}

impl Default for Shift {
    fn default() -> Self {
        Shift { last: MIN_SHIFT, quotient: None }
    }
}

impl Shift {
    /// Notes a quotient of the matrix that is to be shifted which is not positive.
    pub fn note(&mut self, quotient: Option<f64>) {
        self.quotient = quotient;
    }

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
        if let Some(products) = system.products {
            return self.step_by_products(solver, system, products, b, work);
        }
        let mut matrix = system.matrix.clone();
        let space = system.space();
        let mut diagonal = matrix.diagonal();
        space.add_up(&mut diagonal);
        // unknowns by which the potential has a maximum stay as they are
        let maxima = system.configuration.maxima();
        let is_shifted = |dof: usize| !maxima.get(dof).is_some_and(|is| *is);
        let own: Vec<usize> = (0..space.own(&diagonal).len()).filter(|dof| is_shifted(*dof)).collect();
        let scale = space.total(own.iter().map(|dof| diagonal[*dof].abs()).sum()) / space.total(own.len() as f64);
        let mut entries = vec![0.0; diagonal.len()];
        let (mut shift, mut added) = (self.first(scale), 0.0);
        while shift <= MAX_SHIFT {
            // matrices of ranks add up: each unknown is shifted by its owner alone
            own.iter().for_each(|dof| entries[*dof] = (shift - added) * scale);
            matrix.add_diagonal(&entries);
            added = shift;
            if let Some(step) = self.attempt(shift, solver, &System { matrix: &matrix, ..*system }, b, work)? {
                return Ok(step);
            }
            shift = self.next(shift, scale);
        }
        Err(LinearError::Shift)
    }

    /// The first one to be tried, as a share of the mean diagonal.
    fn first(&self, scale: f64) -> f64 {
        (self.last / 64.0).max(MIN_SHIFT).max(self.needed(scale))
    }

    /// The next one.
    fn next(&self, shift: f64, scale: f64) -> f64 {
        (SHIFT_GROWTH * shift).max(shift + self.needed(scale))
    }

    fn needed(&self, scale: f64) -> f64 {
        let needed = self.quotient.map_or(0.0, |quotient| -QUOTIENT_RATIO * quotient / scale);
        if needed.is_finite() { needed } else { 0.0 }
    }

    /// The step of a shifted system, if that is definite.
    fn attempt(
        &mut self,
        shift: f64,
        solver: &mut dyn LinearSolver,
        system: &System,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Option<Vec<f64>>, LinearError> {
        self.quotient = None;
        match solver.solve_definite(system, b, Definite::Shifted, work) {
            Ok(step) => {
                self.last = shift;
                Ok(Some(step))
            }
            Err(LinearError::Indefinite { quotient }) => {
                self.quotient = quotient;
                Ok(None)
            }
            Err(other) => Err(other),
        }
    }

    fn step_by_products(
        &mut self,
        solver: &mut dyn LinearSolver,
        system: &System,
        products: &Arc<dyn CellProducts>,
        b: &[f64],
        work: &mut LinearWork,
    ) -> Result<Vec<f64>, LinearError> {
        let blocks = products.diagonal_blocks(system.parallel);
        // supported unknowns have a row of the identity, whatever the units
        let fixed = system.fixed;
        let diagonal = blocks.as_flattened().iter().enumerate().map(|(at, row)| (at, row[at % 3].abs()));
        let own = diagonal.filter(|(at, _)| !fixed[*at]);
        let (scale, count) = own.fold((0.0, 0), |(sum, count), (_, entry)| (sum + entry, count + 1));
        let scale = scale / count.max(1) as f64;
        let mut shift = self.first(scale);
        while shift <= MAX_SHIFT {
            let shifted = products.shifted(shift * scale);
            let system = System { products: Some(&shifted), ..*system };
            if let Some(step) = self.attempt(shift, solver, &system, b, work)? {
                return Ok(step);
            }
            shift = self.next(shift, scale);
        }
        Err(LinearError::Shift)
    }
}

#[cfg(test)]
mod tests {
    use super::Shift;
    use crate::multigrid::Corners;
    use crate::solver::{
        Accuracy, Configuration, Definite, LinearError, LinearSolver, LinearWork, Solution, SolverState, Step, System,
    };
    use crate::{Field, Pattern, Rotations, Share, Space, SparseMatrix, Structure};
    use nastic_team::Team;
    use nastic_team::threads::{self, Faults};
    use std::sync::Arc;

    /// Gives the diagonal of what it is to solve with.
    #[derive(Clone, Debug)]
    struct Diagonal;

    impl LinearSolver for Diagonal {
        fn state(&self) -> SolverState {
            SolverState { name: "diagonal", takes_products: false, bytes: 0 }
        }
        fn restart(&mut self) {}
        fn clear(&mut self) {}
        fn prepare(&mut self, _: &System, _: &mut LinearWork) -> Result<(), LinearError> {
            Ok(())
        }
        fn step(&mut self, _: &System, _: &[f64], _: f64, _: &mut LinearWork) -> Result<Step, LinearError> {
            Err(LinearError::Indefinite { quotient: None })
        }
        fn solve(&mut self, _: &System, _: &[f64], _: Accuracy, _: &mut LinearWork) -> Result<Solution, LinearError> {
            Err(LinearError::Indefinite { quotient: None })
        }
        fn solve_definite(
            &mut self,
            system: &System,
            _: &[f64],
            _: Definite,
            _: &mut LinearWork,
        ) -> Result<Vec<f64>, LinearError> {
            let mut diagonal = system.matrix.diagonal();
            system.space().add_up(&mut diagonal);
            Ok(diagonal)
        }
        fn anew(&self, _: &Arc<Structure>) -> Box<dyn LinearSolver> {
            Box::new(Diagonal)
        }
    }

    struct At(Space, Arc<Rotations>);

    impl Configuration for At {
        fn positions(&self) -> &[[f64; 3]] {
            &[]
        }
        fn rotations(&self) -> &Arc<Rotations> {
            &self.1
        }
        fn corners(&self) -> Option<&Corners> {
            None
        }
        fn space(&self) -> &Space {
            &self.0
        }
    }

    #[test]
    fn every_unknown_of_several_ranks_is_shifted_once() -> Result<(), Box<dyn std::error::Error>> {
        // two ranks with two nodes each, of which they share the second; 1 and 3 on their diagonals
        let found = threads::run(2, &Faults::default(), |rank| {
            let own = rank.rank();
            let share = Share::new(Arc::new(rank), 2 - own, vec![(1 - own, vec![1])]);
            let pattern = Pattern::of_elements(&[[0.0; 3], [1.0, 0.0, 0.0]], 2, [[0, 1].as_slice()])?;
            let mut matrix = SparseMatrix::zeros(Arc::new(pattern));
            matrix.add_to_diagonal([1.0, 3.0][own]);
            let space = Space::new(2, 1).with(Field::nodal("displacement", 2)).shared(Some(share));
            let at = At(space, Arc::new(Rotations(Vec::new())));
            let fixed = &[false; 4];
            let system = System {
                matrix: &matrix,
                products: None,
                fixed,
                configuration: &at,
                transposed: false,
                parallel: false,
            };
            let mut shift = Shift { last: 64.0, ..Shift::default() };
            let solved = shift.step(&mut Diagonal, &system, &[0.0; 4], &mut LinearWork::default());
            Ok::<_, Box<dyn std::error::Error + Send + Sync>>(solved?)
        });
        // the mean of 1, 4 and 3, once
        let scale = 2.0 * (1.0 + 4.0 + 3.0) / 6.0;
        for (found, own) in found.into_iter().zip([1.0, 3.0]) {
            let expected = [own, own, 4.0, 4.0].map(|d| d + scale);
            let found = found.map_err(|error| error.to_string())?;
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
        }
        Ok(())
    }
}
