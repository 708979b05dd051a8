//! Newton's method with strains and stresses of their own at the quadrature points, see [`PointStrains`].
//!
//! Downhill on the potential, thin and nearly incompressible bodies creep: every step that turns the body stretches it, every one that
//! shears it changes its volume, and the potential bears little of either. With strains of their own the iteration is
//! indifferent to what a step costs on the way (mixed integration points). There is no potential to search along; a step is
//! shortened only where it turns a point too far or inverts one. Only an end with less potential than the start counts, where the
//! last linear systems met no negative curvature.

use crate::contributions::Sums;
use crate::contributions::body_energy::point_strains::PointStrains;
use crate::solution::newton::{Newton, Stop, moved};
use crate::solution::state::SolveReport;
use crate::solution::tangent_systems::{TangentSystems, Wanted, eliminate};
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearSolver, SparseMatrix};

/// Iterations of an attempt.
const MOST: usize = 40;
/// Largest `|grad du|` of a step: what the linearised strains leave out is its square.
const LARGEST: f64 = 1.0;
/// Relative residual at u from which Newton's method on displacements takes over.
const NEAR: f64 = 1e-6;
/// Rounding of the potential, as a share of the sum of its absolute terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Relative residual wanted of the linear systems.
const LINEAR: f64 = 1e-10;
/// Times a step is halved before it leads nowhere.
const HALVINGS: usize = 30;

impl Newton<'_> {
    /// From u, whose prescribed components are in place, to an equilibrium of less potential; where it stops short, u is the last
    /// iterate.
    pub fn solve_with_point_strains(
        &self,
        u: &mut Vec<f64>,
        solver: &mut dyn LinearSolver,
        report: &mut SolveReport,
    ) -> Result<(), Stop> {
        let (body, parallel) = (&self.model.body, self.options.parallel);
        let start = self.evaluate(u)?;
        let mut relative = self.residual(&start).1;
        let mut strains = PointStrains::of(body, u, parallel)?;
        let (mut systems, mut matrix) = (TangentSystems::new(self.model, parallel, &mut *solver), self.model.matrix());
        for _ in 0..MOST.min(self.options.max_newton) {
            if self.options.cancelled() {
                return Err(Stop::Cancelled);
            }
            let (step, curvature) = self.point_strain_step(u, &strains, &mut matrix, &mut systems, report)?;
            let (next, largest) = strains.extrapolated(body, u, &step, parallel)?;
            let longest = self.model.max_step(&self.at(u), &step)?.min(LARGEST / largest);
            let shares = (0..HALVINGS).map(|k| longest * 0.5_f64.powi(k as i32));
            let found = shares.into_iter().find_map(|share| Some((share, strains.towards(&next, share)?)));
            let Some((share, found)) = found else { break };
            strains = found;
            *u = moved(u, &step, share);
            let now = self.evaluate(u)?;
            relative = self.residual(&now).1;
            self.record(&now, relative, report);
            self.tell(share, &now, report);
            if relative <= NEAR {
                let last = self.solve(u, solver, report)?;
                let sound = curvature == Curvature::Positive && last == Curvature::Positive;
                let rounding = ROUNDING * (start.energy_scale + start.energy.abs());
                return if sound && report.energy <= start.energy + rounding {
                    Ok(())
                } else {
                    Err(Stop::Slow { residual: relative })
                };
            }
        }
        Err(Stop::Slow { residual: relative })
    }

    /// The whole step, downhill where the tangent is indefinite.
    fn point_strain_step(
        &self,
        u: &[f64],
        strains: &PointStrains,
        matrix: &mut SparseMatrix,
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Curvature), Stop> {
        let mut sums = Sums::zero(u.len());
        matrix.clear();
        self.model.add_with_point_strains(&self.at(u), strains, &mut sums, matrix)?;
        self.model.supports.clear(&mut sums.force);
        let rhs: Vec<f64> = sums.force.iter().map(|r| -r).collect();
        eliminate(self.model, matrix);
        report.newton += 1;
        Ok(systems.step(matrix, u, &rhs, (LINEAR, Wanted::Downhill), report)?)
    }
}
