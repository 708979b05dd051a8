//! [`ArcStep`]: Newton's step of a path, with one unknown and one equation more.

use super::{Direction, Step};
use crate::linear_systems::saddle_point::{BorderedTangent, Extension, SaddlePoint};
use crate::linear_systems::tangent_systems::TangentSystems;
use crate::model::ModelPoint;
use crate::nonlinear::equations::{Drive, Equations};
use crate::nonlinear::iterate::{Iterate, Stop};
use nastic_body::error::Inadmissible;
use nastic_body::state::SolveReport;
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearSolver, Space};
use std::sync::Arc;

/// Difference of s for the derivative of the residual.
const DIFFERENCE_STEP: f64 = 1e-2;

/// The inner product of a path, `<(u, s), (v, t)> = sum_a w_a u_a . v_a + s t`; further fields and multipliers have no part in it.
pub(crate) struct PathMetric {
    /// w by unknown, zero on supports, which s determines, and of further fields.
    pub weights: Vec<f64>,
    /// A factor of all of them.
    pub scale: f64,
    /// What sums.
    pub space: Arc<Space>,
}

impl PathMetric {
    pub fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        let s = self.weights.len();
        self.space.dot(&a[..s], &self.weighted(b)) + a[s] * b[s]
    }

    fn weighted(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(&self.weights).map(|(x, w)| x * w * self.scale).collect()
    }
}

/// The plane of the points whose distance from `origin` along `normal` is `distance`.
#[derive(Clone, Copy)]
pub(crate) struct Plane<'a> {
    pub origin: &'a [f64],
    pub normal: &'a [f64],
    pub distance: f64,
}

/// Steps of `(u, p, s)` to an equilibrium in a plane.
pub(crate) struct ArcStep<'a> {
    pub equations: &'a Equations<'a>,
    pub metric: &'a PathMetric,
    pub plane: Plane<'a>,
    pub solver: &'a mut dyn LinearSolver,
}

impl Direction for ArcStep<'_> {
    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let Plane { origin, normal, distance } = self.plane;
        let away: Vec<f64> = here.x.iter().zip(origin).map(|(x, o)| x - o).collect();
        let short = distance - self.metric.product(&away, normal);
        let force: Vec<f64> = here.residual.iter().map(|r| -r).collect();
        let tangent = self.equations.bordered_tangent(here.point, here.x)?;
        let scale = self.equations.energy_scale(&tangent.matrix, self.equations.split(here.x).0, here.now);
        let mut dx = self.solve(here.point, here.x, tangent, &force, short, report)?;
        self.equations.keep_positive(here.x, &mut dx);
        Ok(Step { scale, ..Step::whole(dx, Curvature::Positive, self.equations.model.unknowns()) })
    }
}

impl ArcStep<'_> {
    /// The direction of the path at a point, with a product of 1 with the normal.
    pub fn tangent(&mut self, x: &[f64]) -> Result<Vec<f64>, Stop> {
        let none = vec![0.0; x.len() - 1];
        let point = self.equations.point(x)?;
        let tangent = self.equations.bordered_tangent(&point, x)?;
        self.solve(&point, x, tangent, &none, 1.0, &mut SolveReport::default())
    }

    /// `K y + B q + r_s t = f`, `B^T y + .. = g`, `<normal, (y, t)> = h`: y with the supports' motion, q and t.
    fn solve(
        &mut self,
        point: &ModelPoint,
        x: &[f64],
        tangent: BorderedTangent,
        f: &[f64],
        h: f64,
        report: &mut SolveReport,
    ) -> Result<Vec<f64>, Stop> {
        let equations = self.equations;
        let (model, parallel) = (equations.model, equations.options.parallel);
        let (u, s) = equations.split(x);
        let support = equations.support_motion(s);
        let mut column = equations.residual_by_s(point, u, s)?;
        let pulled = tangent.multiply(&support, parallel);
        column.iter_mut().zip(&pulled).for_each(|(c, p)| *c += p);
        model.supports.restrict(&mut column);
        // The equation in the units of the residual, so that both count alike in the residual of the whole system.
        let dofs = equations.dofs();
        let scale = Some(equations.model.unknowns().norm(&column[..dofs])).filter(|size| *size > 0.0).unwrap_or(1.0);
        let mut row: Vec<f64> = self.metric.weighted(self.plane.normal).iter().map(|r| scale * r).collect();
        row.truncate(dofs);
        model.supports.restrict(&mut row);
        let extension = Extension { column, row, corner: scale * self.plane.normal[u.len()] };
        let mut system = SaddlePoint::new(model, tangent);
        let acting = equations.acting(point, x)?;
        system.set_acting(&acting, false);
        let mut systems = TangentSystems::new(model, equations.controls(), parallel, &mut *self.solver);
        let given = (f, &u[dofs..], scale * h);
        let (mut y, t) = system.solve_extended(&mut systems, &u[..dofs], extension, given, report)?;
        y.iter_mut().zip(&support).for_each(|(y, w)| *y += t * w);
        y.push(t);
        Ok(y)
    }
}

impl Equations<'_> {
    /// Which constraints act at a point of a path: of inequalities those with `p > 0`, and those that are violated.
    fn acting(&self, point: &ModelPoint, x: &[f64]) -> Result<Vec<bool>, Inadmissible> {
        let (inequalities, dofs) = (self.model.inequalities(), self.dofs());
        if !inequalities.contains(&true) {
            return Ok(vec![true; inequalities.len()]);
        }
        let mut residual = vec![0.0; dofs + inequalities.len()];
        self.put_slack(point, x, &inequalities, &mut residual)?;
        let acts = |k: usize| !inequalities[k] || x[dofs + k] > 0.0 || residual[dofs + k] > 0.0;
        Ok((0..inequalities.len()).map(acts).collect())
    }

    /// Derivative of the residual by s, the displacement held: a central difference, exact for controls that enter linearly or in
    /// products of two.
    fn residual_by_s(&self, point: &ModelPoint, u: &[f64], s: f64) -> Result<Vec<f64>, Inadmissible> {
        let behind = self.force_at(point, u, s + DIFFERENCE_STEP)?;
        let before = self.force_at(point, u, s - DIFFERENCE_STEP)?;
        Ok(behind.iter().zip(&before).map(|(b, a)| (b - a) / (2.0 * DIFFERENCE_STEP)).collect())
    }

    /// Derivative of the supported components by s, over all unknowns but s.
    fn support_motion(&self, s: f64) -> Vec<f64> {
        let mut out = vec![0.0; self.model.unknowns().len()];
        let Drive::Path { from, to } = self.drive else { return out };
        let supports = &self.model.supports;
        let change = to.1 - from.load;
        for ((out, &fixed), value) in out.iter_mut().zip(supports.fixed()).zip(supports.values()) {
            *out = if fixed { change * value } else { 0.0 };
        }
        let along = to.0.minus(&from.controls);
        if let Some(driven) = self.model.prescribed_change(&self.prescribed_at(s).0, &along) {
            out.iter_mut().zip(driven).for_each(|(o, d)| *o += d);
        }
        out
    }
}
