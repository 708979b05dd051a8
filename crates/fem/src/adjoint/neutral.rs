//! Adjoints of equilibria that may roll or slide on.

use super::inverted;
use crate::contributions::instant::Instant;
use crate::discretization::rigid_motions::FreeMotion;
use crate::error::{FemError, StateError};
use crate::model::Model;
use crate::nonlinear::anchor::Anchor;
use crate::solution::saddle_point::SaddlePoint;
use crate::solution::state::{SolveReport, State};
use crate::solution::tangent_systems::{EXACT, TangentSystems};

/// Times that what the anchor took is given back.
const CORRECTIONS: usize = 2;
/// Share of a right-hand side along free motions that is rounding and anchor.
const ALONG: f64 = 1e-3;

impl Model {
    /// `[K B; B^T 0] x = b` at an equilibrium of which nothing resists to some motions, so that K is singular. The derivative is that of the equilibrium nearest to
    /// this one: with D the weakest anchor, `(K + D) x_0 = b` and `(K + D) x_k = b + D x_(k-1)`, which is wrong by `(D / (K + D))^3` where K is regular, and is not
    /// determined where `D x_0`, the part of b along the free motions, does not vanish.
    pub(super) fn solve_neutral(
        &self,
        (at, free): (&Instant, &FreeMotion),
        rhs: &[&[f64]],
        state: &State,
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<Vec<Vec<f64>>, StateError> {
        let mut tangent = self.bordered_tangent(at).map_err(|at| inverted(at, state))?;
        let anchor = Anchor::weakest(self, &tangent.matrix);
        tangent.matrix.add_diagonal(anchor.diagonal());
        let mut system = SaddlePoint::new(self, tangent);
        system.set_acting(&self.acting(at).map_err(|at| inverted(at, state))?, false);
        let u = self.nodal(at.u);
        system.prepare(systems, u, report)?;
        let mut found = system.solve(systems, u, rhs, EXACT, report)?.0;
        let space = self.unknowns();
        for (x, b) in found.iter().zip(rhs) {
            let share = space.norm(&self.held_by(&anchor, x)) / space.norm(b).max(f64::MIN_POSITIVE);
            if share > ALONG {
                let FreeMotion { count, what, example } = free.clone();
                return Err(FemError::FreeDerivative { share, count, what, example }.into());
            }
        }
        for _ in 0..CORRECTIONS {
            let add = |(x, b): (&Vec<f64>, &&[f64])| {
                let mut with = self.held_by(&anchor, x);
                with.iter_mut().zip(*b).for_each(|(with, b)| *with += b);
                with
            };
            let corrected: Vec<Vec<f64>> = found.iter().zip(rhs).map(add).collect();
            let columns: Vec<&[f64]> = corrected.iter().map(Vec::as_slice).collect();
            found = system.solve(systems, u, &columns, EXACT, report)?.0;
        }
        Ok(found)
    }

    /// D x, of nodes that follow others on these.
    fn held_by(&self, anchor: &Anchor, x: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; x.len()];
        force.iter_mut().zip(anchor.diagonal()).zip(x).for_each(|((force, s), x)| *force = s * x);
        self.supports.restrict(&mut force);
        force
    }
}
