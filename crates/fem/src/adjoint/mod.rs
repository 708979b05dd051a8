//! The adjoint of the state equation, and the inertia of an equilibrium.

use crate::error::StateError;
use crate::solid::Solid;
use crate::solution::options::SolveOptions;
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent::Tangents;
use crate::solution::workspace::Workspace;
use nastic_linear::{Factor, SymmetricMatrix};
use nastic_mesh::CellKind;

/// Adjoint displacements, and what they took.
#[derive(Debug, Clone)]
pub struct Adjoint {
    /// One solution per right-hand side, flat, zero on the supports.
    pub lambda: Vec<Vec<f64>>,
    /// Work done.
    pub report: SolveReport,
}

/// Residual of the adjoint equation relative to its right-hand side, where no conjugate gradients with a factor estimate the
/// error itself (see `EXACT` in `tangent.rs`).
const TOLERANCE: f64 = 1e-11;

/// Iterations with products that assemble nothing, on hex27: there one takes a seventh of an assembly. On hex20 and tet10 it
/// takes a quarter and does not pay.
const PRODUCTS: usize = 6;

impl Solid {
    /// Solves `K(u*, m) lambda = rhs`, `lambda = 0` on the supports, for every right-hand side (entries on supports are
    /// ignored). K is taken at the state itself: a factor handed in is a tool, the residual of K(u*) decides.
    /// The error is `|lambda - exact| <= 1e-9 |exact|` in the energy norm `|v|^2 = v . K v`, as estimated from the steps of conjugate
    /// gradients; with multigrid, or where K(u*) is indefinite, the relative residual is 1e-11.
    ///
    /// Source: docs/model.md section 6; the adjoint of a cost has `rhs = -dj/du`.
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
            self.supports().clear(&mut b);
            b
        };
        let expected = self.discretization().dofs();
        if let Some(b) = rhs.iter().find(|b| b.len() != expected) {
            let what = "right-hand side of the adjoint".to_owned();
            return Err(crate::FemError::Length { what, found: b.len(), expected }.into());
        }
        let rhs: Vec<Vec<f64>> = rhs.iter().map(clear).collect();
        let columns: Vec<&[f64]> = rhs.iter().map(Vec::as_slice).collect();
        let mut report = SolveReport::default();
        let factor = &mut workspace.factor;
        if let [b] = columns[..]
            && let Some(lambda) = self.adjoint_by_products(state, b, how, factor.as_ref(), &mut report)
        {
            return Ok(Adjoint { lambda: vec![lambda], report });
        }
        let matrix = self.tangent(state, how.parallel)?;
        let lambda = Tangents::new(self, how, factor.as_ref())
            .standing_at(&state.u)
            .solve_exactly(matrix, &columns, TOLERANCE, factor, &mut report)
            .map_err(|why| StateError::Linear { why })?;
        Ok(Adjoint { lambda, report })
    }

    /// The adjoint for one right-hand side with the factor at hand and K(u*) as a product, where that is cheaper than K(u*)
    /// as a matrix; `None` where it is not, or does not get there.
    fn adjoint_by_products(
        &self,
        state: &State,
        b: &[f64],
        how: &SolveOptions,
        factor: Option<&Factor>,
        report: &mut SolveReport,
    ) -> Option<Vec<f64>> {
        let pays = self.discretization().body().parts.iter().all(|part| part.kind == CellKind::Hex27);
        let factor = factor.filter(|_| pays)?;
        let product = |v: &[f64], out: &mut [f64]| {
            // a number that is none ends the iterations
            if self.body().tangent_product(&state.u, &state.controls, v, out, how.parallel).is_err() {
                out.fill(f64::NAN);
            }
            self.supports().clear(out);
        };
        Tangents::new(self, how, Some(factor))
            .standing_at(&state.u)
            .solve_by_products(&product, b, factor, PRODUCTS, report)
    }

    /// Number of negative eigenvalues of the tangent at a state: 0 for a stable equilibrium.
    ///
    /// On a body that is solved by multigrid, 0 means that conjugate gradients with a right-hand side of fixed random
    /// numbers converged to 1e-8 and met no negative curvature; only where they did meet it is a factor made to count.
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
        let matrix = self.tangent(state, how.parallel)?;
        let tangents = Tangents::new(self, how, None).standing_at(&state.u);
        tangents.negative_pivots(matrix).map_err(|e| StateError::Linear { why: e.to_string() })
    }

    /// The tangent K(u, m) at a state, supports not eliminated.
    fn tangent(&self, state: &State, parallel: bool) -> Result<SymmetricMatrix, StateError> {
        let mut matrix = self.discretization().matrix();
        let evaluated = self.body().add_tangent(&state.u, &state.controls, &mut matrix, parallel);
        evaluated.map_err(|at| StateError::Inverted {
            at,
            load: state.load,
            cuts: 0,
            last: Box::new(state.clone()),
        })?;
        Ok(matrix)
    }
}
