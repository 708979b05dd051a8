//! [`Modes`]: the smallest eigenvalues of the tangent at an equilibrium, and their modes.

use crate::error::StateError;
use crate::model::{Feature, Model};
use crate::solution::options::SolveOptions;
use crate::solution::state::State;
use crate::solution::tangent_systems::eliminate;
use nastic_linear::{
    Eigenpairs, Eigenproblem, FactorError, JoinedStructure, LinearError, MassMatrix, smallest_eigenpairs,
};

/// Eigenvalues and modes of `K phi = lambda M phi`: K the tangent at a state, M the diagonal matrix of the nodes'
/// reference volumes ([`Discretization::nodal_volumes`](crate::Discretization::nodal_volumes)).
///
/// lambda is a force per length^4 (N/m^4: a stiffness per volume), in plane strain too, and converges as the mesh is
/// refined. A negative one is a direction in which the potential falls: `1/2 lambda phi . M phi` per square of the
/// amplitude. A homogeneous body of density rho vibrates about a stable state with angular frequencies `sqrt(lambda /
/// rho)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Eigenvalues, ascending.
    pub eigenvalues: Vec<f64>,
    /// Their modes, flat like displacements, zero on the supports, with a largest component of exactly 1.
    pub shapes: Vec<Vec<f64>>,
    /// Negative eigenvalues of the tangent, counted by the pivots of a factor; all of them are among the eigenvalues.
    pub negative: usize,
}

impl Model {
    /// The `count` algebraically smallest eigenvalues of the tangent at a state, all negative ones in any case, with
    /// their modes.
    ///
    /// Shift-invert Lanczos ([`smallest_eigenpairs`]) with a factor, whatever solves other systems. Multiple
    /// eigenvalues are found with all their modes; which basis of their span is returned has no meaning.
    ///
    /// # Errors
    /// [`StateError::Linear`] for a tangent that is not symmetric, a count of zero or beyond the free unknowns, or a
    /// factor that would be too large; [`StateError::Problem`] for a state of another body.
    pub fn modes(&self, state: &State, count: usize, how: &SolveOptions) -> Result<Modes, StateError> {
        let found =
            self.lowest_modes(state, MassMatrix::Diagonal(&self.discretization().volumes_by_unknown()), count, how)?;
        let shapes = found.vectors.into_iter().map(normalized).collect();
        Ok(Modes { eigenvalues: found.values, shapes, negative: found.negative })
    }

    /// The smallest eigenpairs of the tangent by a mass without fixed unknowns.
    pub(crate) fn lowest_modes(
        &self,
        state: &State,
        mass: MassMatrix,
        count: usize,
        how: &SolveOptions,
    ) -> Result<Eigenpairs, StateError> {
        self.check_state(state)?;
        self.supports(Feature::Modes)?;
        let (mut matrix, constraints) = self.acting_tangent(state, how.parallel)?;
        eliminate(self, &mut matrix);
        let mut structure = self.tangent_structure().equations().clone();
        if !matrix.beyond().is_empty() {
            let joined =
                JoinedStructure::new(&structure, &matrix).map_err(FactorError::from).map_err(LinearError::from)?;
            matrix = joined.join(&matrix).ok_or(LinearError::from(FactorError::ForeignPattern))?;
            structure = joined.structure().clone();
        }
        let problem = Eigenproblem {
            matrix: &matrix,
            mass,
            fixed: self.supports.fixed(),
            constraints: &constraints,
            symbolic: structure.symbolic(),
            parallel: how.parallel,
        };
        Ok(smallest_eigenpairs(&problem, count)?)
    }
}

/// Scaled to a largest component of 1; of components that differ by rounding the first.
pub(super) fn normalized(mut shape: Vec<f64>) -> Vec<f64> {
    let largest = shape.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let at = shape.iter().position(|x| x.abs() >= (1.0 - 1e-6) * largest);
    let scale = at.map_or(1.0, |at| largest * shape[at].signum());
    shape.iter_mut().for_each(|x| *x /= scale);
    shape
}
