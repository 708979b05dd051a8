//! The adjoint of the state equation, and the inertia of an equilibrium.

mod neutral;
pub mod second_order;

use crate::linear_systems::saddle_point::{BorderedTangent, SaddlePoint};
use crate::linear_systems::tangent::Tangent;
use crate::linear_systems::tangent_systems::{EXACT, TangentSystems};
use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::model::views::Stability;
use crate::search::options::SolveOptions;
use nastic_body::error::{Inadmissible, StateError};
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::{SolveReport, State};
use nastic_linear::solver::{Accuracy, Inertia};
use nastic_linear::{LinearError, SparseMatrix, Symmetry};
use nastic_mesh::CellKind;

/// Adjoint displacements, and what they took.
#[derive(Debug, Clone)]
pub struct Adjoint {
    /// One solution per right-hand side, flat, zero on the supports; behind the displacement the adjoint multipliers of constraints.
    pub lambda: Vec<Vec<f64>>,
    /// Work done.
    pub report: SolveReport,
}

/// Iterations with matrix-free products, on hex27, where a product takes a seventh of an assembly. On hex20 and tet10 it takes
/// a quarter, which is too much.
const MAX_PRODUCT_ITERATIONS: usize = 6;

impl Model {
    /// Solves `K(u*, m) lambda = rhs`, `lambda = 0` on the supports, for every right-hand side (entries on supports are
    /// ignored). K is taken at the state itself: a factor kept in the workspace is a preconditioner, the residual of K(u*) decides.
    /// The error is `|lambda - exact| <= 1e-13 |exact|` in the energy norm `|v|^2 = v . K v`, as estimated from the steps of conjugate
    /// gradients; with multigrid, or where K(u*) is indefinite, the relative residual is 1e-11.
    ///
    /// Source: docs/model/derivative.md; the adjoint of a cost has `rhs = -dj/du`.
    ///
    /// # Errors
    /// [`StateError::Linear`] at a singular tangent, [`StateError::Problem`] for right-hand sides of the wrong length.
    pub fn adjoint(&self, state: &State, rhs: &[&[f64]], how: &SolveOptions) -> Result<Adjoint, StateError> {
        self.adjoint_with(state, rhs, how, &mut Workspace::default())
    }

    /// [`adjoint`](Self::adjoint) with what earlier solves left behind.
    ///
    /// # Errors
    /// As there.
    pub fn adjoint_with(
        &self,
        state: &State,
        rhs: &[&[f64]],
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Adjoint, StateError> {
        let clear = |b: &&[f64]| {
            let mut b = b.to_vec();
            self.supports.restrict(&mut b);
            b
        };
        self.ranks().all_accept(self.check_adjoint(state, rhs, how))?;
        let rhs: Vec<Vec<f64>> = rhs.iter().map(clear).collect();
        let columns: Vec<&[f64]> = rhs.iter().map(Vec::as_slice).collect();
        let mut report = SolveReport::default();
        let solver = self.linear_solver(how, workspace);
        let mut systems = TangentSystems::new(self, &state.controls, how.parallel, solver);
        if self.unknowns().multipliers() == 0
            && !self.touches_something()
            && let [b] = columns[..]
            && let Some(lambda) = self.solve_by_products(state, b, how, EXACT, &mut systems, &mut report)
        {
            return Ok(Adjoint { lambda: vec![lambda], report });
        }
        let at = self.instant(state, None, how.parallel);
        let lambda = self.solve_transposed_at(&at, &columns, state, &mut systems, &mut report);
        self.ranks().unless_parted(lambda).map(|lambda| Adjoint { lambda, report })
    }

    fn check_adjoint(&self, state: &State, rhs: &[&[f64]], how: &SolveOptions) -> Result<(), StateError> {
        let expected = self.unknowns().len();
        if let Some(b) = rhs.iter().find(|b| b.len() != expected) {
            let what = "right-hand side of the adjoint".to_owned();
            return Err(nastic_body::error::FemError::Length { what, found: b.len(), expected }.into());
        }
        self.checks().check_state(state)?;
        self.check_solver(how.solver)?;
        Ok(self.check_spans_ranks(how.solver)?)
    }

    /// `K(u*) x = b` with the factor held and K(u*) as a product, where that is faster than K(u*) as a matrix; `None`
    /// where it is not, or does not converge in time.
    fn solve_by_products(
        &self,
        state: &State,
        b: &[f64],
        how: &SolveOptions,
        accuracy: Accuracy,
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Option<Vec<f64>> {
        let quadratic = self.discretization().points().parts.iter().all(|part| part.kind == CellKind::Hex27);
        if !quadratic || self.properties().symmetry() != Symmetry::Symmetric || !self.supports.ties().is_empty() {
            return None;
        }
        let at = self.instant(state, None, how.parallel);
        let product = |v: &[f64], out: &mut [f64]| self.product_or_nan(&at, v, out);
        systems.solve_by_products(&product, &state.u, b, accuracy, MAX_PRODUCT_ITERATIONS, report)
    }

    /// Where a state was evaluated, at the end of a time step if there is one.
    pub fn instant<'s>(&self, state: &'s State, step: Option<&'s TimeStep>, parallel: bool) -> Instant<'s> {
        let at = Instant { parallel, ..Instant::of(state) };
        step.map_or(at, |step| at.in_step(step))
    }

    /// The same with the symbolic factor that a workspace holds.
    pub(crate) fn negative_pivots_with(
        &self,
        state: &State,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<usize, StateError> {
        Ok(self.inertia_with(state, how, workspace)?.negative)
    }

    fn inertia_with(
        &self,
        state: &State,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Inertia, StateError> {
        self.check_solver(how.solver)?;
        self.check_spans_ranks(how.solver)?;
        let at = self.instant(state, None, how.parallel);
        if self.loose(&at).is_some() {
            return self.count_anchored(&at, 1.0, state, how, workspace);
        }
        if self.unknowns().multipliers() > 0 {
            let system = self.saddle_point_at(&at).map_err(|at| inverted(at, state))?;
            let mut systems =
                TangentSystems::new(self, &state.controls, how.parallel, self.linear_solver(how, workspace));
            return Ok(system.inertia(&mut systems, self.nodal(&state.u), &mut SolveReport::default())?);
        }
        let mut systems = TangentSystems::new(self, &state.controls, how.parallel, self.linear_solver(how, workspace));
        let tangent = self.eliminated(&at, systems.takes_products()).map_err(|at| inverted(at, state))?;
        match systems.inertia(&tangent, &state.u) {
            Err(LinearError::NoEntries) => {
                let tangent = self.eliminated(&at, false).map_err(|at| inverted(at, state))?;
                Ok(systems.inertia(&tangent, &state.u)?)
            }
            counted => Ok(counted?),
        }
    }

    /// The bordered tangent at a state, with the constraints that act there.
    pub(crate) fn saddle_point(&self, state: &State, parallel: bool) -> Result<SaddlePoint, StateError> {
        self.saddle_point_at(&self.instant(state, None, parallel)).map_err(|at| inverted(at, state))
    }

    /// The same at an instant, at the end of a time step if there is one.
    pub(crate) fn saddle_point_at(&self, at: &Instant) -> Result<SaddlePoint, Inadmissible> {
        let tangent = self.tangents().bordered_tangent(at)?;
        let acting = self.acting(at)?;
        let mut system = SaddlePoint::new(self, tangent);
        system.set_acting(&acting, false);
        Ok(system)
    }

    /// The tangent at a state, supports not eliminated, and the derivatives of the constraints that act there.
    pub(crate) fn acting_tangent(
        &self,
        state: &State,
        parallel: bool,
    ) -> Result<(SparseMatrix, Vec<Vec<f64>>), StateError> {
        let at = self.instant(state, None, parallel);
        let found = self.tangents().bordered_tangent(&at).and_then(|tangent| Ok((tangent, self.acting(&at)?)));
        let (BorderedTangent { matrix, columns, .. }, acting) = found.map_err(|at| inverted(at, state))?;
        let own = columns.into_iter().zip(acting).filter(|(_, acting)| *acting);
        let clear = |(mut column, _): (Vec<f64>, bool)| {
            self.supports.restrict(&mut column);
            column
        };
        Ok((matrix, own.map(clear).collect()))
    }

    /// `[K B; B^T 0]^T x = b` at an instant with the constraints that act there, for right-hand sides that are zero on the supports.
    pub fn solve_transposed_at(
        &self,
        at: &Instant,
        rhs: &[&[f64]],
        state: &State,
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<Vec<Vec<f64>>, StateError> {
        if let Some(free) = self.loose(at) {
            return self.solve_neutral(at, &free, rhs, (state, EXACT), systems, report);
        }
        if self.unknowns().multipliers() == 0 {
            if let Some(solved) = self.solve_by_cells(at, rhs, state, systems, report)? {
                return Ok(solved);
            }
            return Ok(systems.solve_transposed(self.tangent_at(at, state)?, at.u, rhs, report)?);
        }
        let mut system = self.saddle_point_at(at).map_err(|at| inverted(at, state))?;
        let u = self.nodal(at.u);
        system.transpose();
        system.prepare(systems, u, report)?;
        Ok(system.solve(systems, u, rhs, EXACT, report)?.solved)
    }

    /// The same for a symmetric tangent by the products of its cells; nothing where the solver takes none or has to make a factor, or the model has none.
    fn solve_by_cells(
        &self,
        at: &Instant,
        rhs: &[&[f64]],
        state: &State,
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<Option<Vec<Vec<f64>>>, StateError> {
        if !systems.takes_products() {
            return Ok(None);
        }
        let tangent = self.eliminated(at, true).map_err(|at| inverted(at, state))?;
        if !tangent.is_unassembled() {
            return Ok(None);
        }
        let solve = |b: &&[f64]| self.solve_corrected(EXACT, &tangent, at, b, systems, report);
        match rhs.iter().map(solve).collect() {
            Err(LinearError::NoEntries | LinearError::Singular { .. }) => Ok(None),
            solved => Ok(Some(solved?)),
        }
    }

    /// `K x = b` at an instant with a tangent by products of cells.
    pub(crate) fn solve_corrected(
        &self,
        accuracy: Accuracy,
        tangent: &Tangent,
        at: &Instant,
        b: &[f64],
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, LinearError> {
        let exact = |v: &[f64], out: &mut [f64]| self.product_or_nan(at, v, out);
        systems.solve_corrected(accuracy, tangent, &exact, at.u, b, report)
    }

    /// `out = K v` of a displacement that has been evaluated, zero on the supports; NaN, which ends iterations, where a contribution needs a matrix.
    pub(crate) fn product_or_nan(&self, at: &Instant, v: &[f64], out: &mut [f64]) {
        if !self.tangents().tangent_product(at, v, out).unwrap_or(false) {
            out.fill(f64::NAN);
        }
        self.supports.clear(out);
    }

    /// The tangent at an instant, supports eliminated: by the products of its cells where these are wanted and there are some.
    pub(crate) fn eliminated(&self, at: &Instant, products: bool) -> Result<Tangent, Inadmissible> {
        if products && let Some(products) = self.tangents().cell_products(at)? {
            return Ok(Tangent::of_products(self, products));
        }
        let mut matrix = self.tangents().matrix();
        self.tangents().add_tangent(at, &mut matrix)?;
        let mut tangent = Tangent::of_entries(matrix);
        tangent.eliminate(self);
        Ok(tangent)
    }

    /// The tangent at the instant of a state.
    pub(crate) fn tangent_at(&self, at: &Instant, state: &State) -> Result<SparseMatrix, StateError> {
        let mut matrix = self.tangents().matrix();
        self.tangents().add_tangent(at, &mut matrix).map_err(|at| inverted(at, state))?;
        Ok(matrix)
    }
}

/// A state that cannot be derived.
pub fn inverted(at: Inadmissible, state: &State) -> StateError {
    StateError::inadmissible(at, state.load, 0, Box::new(state.clone()))
}

impl Stability<'_> {
    /// Number of negative eigenvalues of the tangent at a state: 0 for a stable equilibrium.
    ///
    /// Under constraints `g(u) = 0` that of the tangent on the null space of `dg/du`: the negative eigenvalues of `[K B; B^T 0]` less
    /// one for each constraint. 0 then means stable while the constraints hold, though the body may be unstable under the
    /// multipliers (pressures, tensions) as given loads. Inequalities that do not act (slack tendons) are left out; those at their onset count as
    /// acting.
    ///
    /// Of a [field by which the potential has a maximum](nastic_linear::Field::saddle) less one for each of its free unknowns, too: 0 means stable once that field is in balance.
    ///
    /// What contact alone holds and nothing resists to ([`neutral_motion`](Self::neutral_motion)) has eigenvalues that are zero: they do not count.
    ///
    /// On a body that is solved by multigrid, 0 means that conjugate gradients with a right-hand side of fixed random
    /// numbers converged to 1e-8 and met no negative curvature; only where they did meet it is a factor made to count
    /// ([`tangent_inertia`](Self::tangent_inertia) says which).
    ///
    /// # Errors
    /// [`StateError::Linear`] where the tangent is singular: the state sits on a bifurcation.
    pub fn negative_pivots(&self, state: &State) -> Result<usize, StateError> {
        self.negative_pivots_by(state, &SolveOptions::default())
    }

    /// [`negative_pivots`](Self::negative_pivots) by the solver and on the threads of a request.
    ///
    /// # Errors
    /// As there.
    pub fn negative_pivots_by(&self, state: &State, how: &SolveOptions) -> Result<usize, StateError> {
        self.model.negative_pivots_with(state, how, &mut Workspace::default())
    }

    /// [`negative_pivots_by`](Self::negative_pivots_by), and whether a factor shows them or conjugate gradients that met no negative curvature.
    ///
    /// # Errors
    /// As there.
    pub fn tangent_inertia(&self, state: &State, how: &SolveOptions) -> Result<Inertia, StateError> {
        self.model.inertia_with(state, how, &mut Workspace::default())
    }
}
