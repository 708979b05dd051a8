//! [`Modes`]: the smallest eigenvalues of the tangent at an equilibrium, and their modes.

use crate::adjoint::inverted;
use crate::linear_systems::tangent::TangentRef;
use crate::linear_systems::tangent_systems::{Deformed, eliminate};
use crate::model::views::Stability;
use crate::model::{Feature, Model};
use crate::search::options::SolveOptions;
use nastic_body::error::StateError;
use nastic_body::state::State;
use nastic_linear::{
    ByProducts, Eigenpairs, Eigenproblem, FactorError, Inversion, JoinedStructure, LinearError, MassMatrix, Operator,
    Solver, smallest_eigenpairs,
};

/// Eigenvalues and modes of `K phi = lambda M phi`: K the tangent at a state, M the diagonal matrix of the nodes'
/// reference volumes ([`Discretization::nodal_volumes`](nastic_body::discretization::Discretization::nodal_volumes)).
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
    /// Negative eigenvalues of the tangent; all of them are among the eigenvalues.
    pub negative: usize,
    /// Whether the pivots of a factor show that none is missing; without a factor these are the ones that were found.
    pub counted: bool,
    /// Of modes without a factor: iterations and errors.
    pub by_products: Option<ByProducts>,
}

impl Model {
    fn factor_fits(&self) -> bool {
        self.tangent_structure().equations().factor_fits()
    }

    /// Whether multigrid solves the tangent systems of a body, without constraints, and no other solver.
    fn multigrid_serves_modes(&self, how: &SolveOptions) -> bool {
        let factory = how.solver.unwrap_or_else(|| self.solver());
        let plain = self.unknowns().has_one_nodal_field() && self.unknowns().multipliers() == 0;
        plain && self.supports.ties().is_empty() && factory == Solver::MULTIGRID
    }

    /// The same by products of the tangent, without a factor; nothing where it couples nodes beyond those of the cells, or where these are not found and a factor fits.
    fn modes_by_products(
        &self,
        state: &State,
        mass: MassMatrix,
        count: usize,
        how: &SolveOptions,
    ) -> Result<Option<Eigenpairs>, StateError> {
        let at = self.instant(state, None, how.parallel);
        let tangent = self.eliminated(&at, true).map_err(|at| inverted(at, state))?;
        let TangentRef { matrix, .. } = TangentRef::from(&tangent);
        if !matrix.is_symmetric() {
            return Err(LinearError::NotSymmetric.into());
        }
        if !matrix.beyond().is_empty() {
            return Ok(None);
        }
        // moduli of products are rounded
        let exact = |v: &[f64], out: &mut [f64]| self.product_or_nan(&at, v, out);
        let configuration = Deformed::new(self, at.u, at.controls, how.parallel);
        let system = configuration.system((&tangent).into());
        let product: &dyn Operator = if tangent.is_unassembled() { &exact } else { &system };
        // of one body; several free ones may need a factor for few modes
        let rigid = if self.discretization().dim() == 3 { 6 } else { 3 };
        let zeros = if self.checks().is_held_without_contact() { 0 } else { rigid };
        let problem = Eigenproblem {
            mass,
            fixed: system.fixed,
            inversion: Inversion::Cycles { product, system },
            zeros,
            cancel: how.cancel,
            parallel: system.parallel,
        };
        match smallest_eigenpairs(&problem, count) {
            Err(LinearError::Cancelled) => Err(StateError::Cancelled),
            Err(error) if !matches!(error, LinearError::EigenpairCount { .. }) && self.factor_fits() => Ok(None),
            found => Ok(Some(found?)),
        }
    }
}

/// Scaled to a largest component of 1; of components that differ by rounding the first.
pub fn normalized(mut shape: Vec<f64>) -> Vec<f64> {
    let largest = shape.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let at = shape.iter().position(|x| x.abs() >= (1.0 - 1e-6) * largest);
    let scale = at.map_or(1.0, |at| largest * shape[at].signum());
    shape.iter_mut().for_each(|x| *x /= scale);
    shape
}

impl Stability<'_> {
    /// The `count` algebraically smallest eigenvalues of the tangent at a state, all negative ones in any case, with
    /// their modes.
    ///
    /// By [`smallest_eigenpairs`] with factors, or with cycles of multigrid where that solves the systems of the body: then nothing proves that none is missing
    /// ([`Modes::counted`]). Multiple eigenvalues are found with all their modes; which basis of their span is returned has no meaning.
    ///
    /// # Errors
    /// [`StateError::Linear`] for a tangent that is not symmetric, a count of zero or beyond the free unknowns, or a
    /// factor that would be too large; [`StateError::Problem`] for a state of another body; [`StateError::Cancelled`].
    pub fn modes(&self, state: &State, count: usize, how: &SolveOptions) -> Result<Modes, StateError> {
        let found = self.lowest_modes(
            state,
            MassMatrix::Diagonal(&self.model.discretization().volumes_by_unknown()),
            count,
            how,
        )?;
        let Eigenpairs { values: eigenvalues, vectors, negative, counted, by_products, .. } = found;
        let shapes = vectors.into_iter().map(normalized).collect();
        Ok(Modes { eigenvalues, shapes, negative, counted, by_products })
    }

    /// The smallest eigenpairs of the tangent by a mass without fixed unknowns.
    pub fn lowest_modes(
        &self,
        state: &State,
        mass: MassMatrix,
        count: usize,
        how: &SolveOptions,
    ) -> Result<Eigenpairs, StateError> {
        self.model.checks().check_state(state)?;
        self.model.properties().supports(Feature::Modes)?;
        if self.model.multigrid_serves_modes(how)
            && let Some(found) = self.model.modes_by_products(state, mass, count, how)?
        {
            return Ok(found);
        }
        let (mut matrix, constraints) = self.model.acting_tangent(state, how.parallel)?;
        eliminate(self.model, &mut matrix);
        let mut structure = self.model.tangent_structure().equations().clone();
        if !matrix.beyond().is_empty() {
            let joined =
                JoinedStructure::new(&structure, &matrix).map_err(FactorError::from).map_err(LinearError::from)?;
            matrix = joined.join(&matrix).ok_or(LinearError::from(FactorError::ForeignPattern))?;
            structure = joined.structure().clone();
        }
        let symbolic = structure.symbolic();
        let problem = Eigenproblem {
            mass,
            fixed: self.model.supports.fixed(),
            inversion: Inversion::Factors { matrix: &matrix, constraints: &constraints, symbolic },
            zeros: 0,
            cancel: how.cancel,
            parallel: how.parallel,
        };
        match smallest_eigenpairs(&problem, count) {
            Err(LinearError::Cancelled) => Err(StateError::Cancelled),
            found => Ok(found?),
        }
    }

    /// The same request, for modes whose number decides something: with a factor where one fits, which counts them.
    pub fn counting<'h>(&self, how: &SolveOptions<'h>) -> SolveOptions<'h> {
        let plain = how.clone();
        if self.model.factor_fits() { SolveOptions { solver: Some(Solver::DIRECT), ..plain } } else { plain }
    }
}
