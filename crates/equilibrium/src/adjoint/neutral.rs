//! Adjoints of equilibria that may roll or slide on.

use super::inverted;
use crate::linear_systems::saddle_point::SaddlePoint;
use crate::linear_systems::tangent_systems::TangentSystems;
use crate::linear_systems::workspace::Workspace;
use crate::model::Model;
use crate::model::views::Stability;
use crate::nonlinear::anchor::Anchor;
use crate::search::options::SolveOptions;
use nastic_body::discretization::rigid_motions::FreeMotion;
use nastic_body::error::{FemError, Inadmissible, StateError};
use nastic_body::instant::Instant;
use nastic_body::state::{SolveReport, State};
use nastic_linear::solver::{Accuracy, Inertia};
use nastic_numeric::vector::{axpy, sub};

/// Corrections by the force of the anchor.
const CORRECTIONS: usize = 2;
/// Largest share of a right-hand side along free motions that is rounding.
const MAX_FREE_MOTION_SHARE: f64 = 1e-6;
/// Stiffness over that of the weakest anchor, below which it is rounding.
const MAX_NEUTRAL_RATIO: f64 = 10.0;

impl Model {
    /// Free motions of an equilibrium that may be held by contact alone.
    pub(super) fn loose(&self, at: &Instant) -> Option<FreeMotion> {
        if at.step.is_some() || !self.settles() { None } else { self.free_motion(at) }
    }

    /// Number of negative eigenvalues with a multiple of the weakest anchor.
    pub(super) fn count_anchored(
        &self,
        at: &Instant,
        factor: f64,
        state: &State,
        how: &SolveOptions,
        workspace: &mut Workspace,
    ) -> Result<Inertia, StateError> {
        let (system, _) = self.anchored(at, factor).map_err(|at| inverted(at, state))?;
        let mut systems = TangentSystems::new(self, at.controls, how.parallel, self.linear_solver(how, workspace));
        Ok(system.inertia(&mut systems, self.nodal(at.u), &mut SolveReport::default())?)
    }

    /// The system with a multiple of the weakest anchor, and the anchor by unknowns on nodes.
    fn anchored(&self, at: &Instant, factor: f64) -> Result<(SaddlePoint, Vec<f64>), Inadmissible> {
        let mut tangent = self.tangents().bordered_tangent(at)?;
        let anchor = Anchor::new(self, &[], factor * Anchor::least(self, &tangent.matrix)).diagonal().to_vec();
        tangent.matrix.add_diagonal(&anchor);
        let mut system = SaddlePoint::new(self, tangent);
        system.set_acting(&self.acting(at)?, false);
        Ok((system, anchor))
    }

    /// `[K B; B^T 0] x = b` at an equilibrium with free motions, so that K is singular (and symmetric, as it has a potential). With D the weakest anchor,
    ///
    /// ```text
    /// (K + D) x_0 = b,    (K + D) x_k = b + D x_(k-1)
    /// ```
    ///
    /// has the error `(D / (K + D))^(k+1)` where K is regular, and grows by the same `y = x_k - x_(k-1)` along free motions: D y is the part of b along them. Where D y
    /// exceeds rounding the derivative is not determined; rounding is removed. The derivative is that of the equilibrium nearest to this one.
    pub(super) fn solve_neutral(
        &self,
        at: &Instant,
        free: &FreeMotion,
        rhs: &[&[f64]],
        (state, accuracy): (&State, Accuracy),
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<Vec<Vec<f64>>, StateError> {
        let (system, anchor) = self.anchored(at, 1.0).map_err(|at| inverted(at, state))?;
        let u = self.nodal(at.u);
        system.prepare(systems, u, report)?;
        let mut found = system.solve(systems, u, rhs, accuracy, report)?.solved;
        let mut before = found.clone();
        for _ in 0..CORRECTIONS {
            let add = |(x, b): (&Vec<f64>, &&[f64])| {
                let mut with = self.held_by(&anchor, x);
                with.iter_mut().zip(*b).for_each(|(with, b)| *with += b);
                with
            };
            let corrected: Vec<Vec<f64>> = found.iter().zip(rhs).map(add).collect();
            let columns: Vec<&[f64]> = corrected.iter().map(Vec::as_slice).collect();
            before = std::mem::replace(&mut found, system.solve(systems, u, &columns, accuracy, report)?.solved);
        }
        let (space, dofs) = (self.unknowns(), u.len());
        for ((x, before), b) in found.iter_mut().zip(&before).zip(rhs) {
            let growth = sub(x, before);
            let along = space.norm(&self.held_by(&anchor, &growth)[..dofs]);
            let share = along / space.norm(&b[..dofs]).max(f64::MIN_POSITIVE);
            if share.is_nan() || share > MAX_FREE_MOTION_SHARE {
                let FreeMotion { count, what, example } = free.clone();
                return Err(FemError::FreeDerivative { share, count, what, example }.into());
            }
            axpy(-((CORRECTIONS + 1) as f64), &growth, x);
        }
        Ok(found)
    }

    /// D x, on the independent nodes.
    fn held_by(&self, anchor: &[f64], x: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; x.len()];
        force.iter_mut().zip(anchor).zip(x).for_each(|((force, s), x)| *force = s * x);
        self.supports.restrict(&mut force);
        force
    }
}

impl Stability<'_> {
    /// Rigid motions of an equilibrium under full loads without resistance, by contact normals and by the tangent: a body held by contact alone may roll or slide along them,
    /// and its position among them is arbitrary.
    ///
    /// # Errors
    /// As of [`negative_pivots`](Self::negative_pivots).
    pub fn neutral_motion(&self, state: &State, how: &SolveOptions) -> Result<Option<FreeMotion>, StateError> {
        let at = self.model.instant(state, None, how.parallel);
        let Some(free) = self.model.loose(&at) else { return Ok(None) };
        let mut workspace = Workspace::default();
        let mut count = |factor: f64| {
            self.model.count_anchored(&at, factor, state, how, &mut workspace).map(|counted| counted.negative)
        };
        Ok((count(-MAX_NEUTRAL_RATIO)? > count(1.0)?).then_some(free))
    }
}
