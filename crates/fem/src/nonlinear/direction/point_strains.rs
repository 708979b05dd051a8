//! [`WithPointStrains`]: Newton's step with strains and stresses of their own at the quadrature points, see [`PointStrains`].
//!
//! Downhill on the potential, thin and nearly incompressible bodies creep: every step that turns the body stretches it, every one that
//! shears it changes its volume, and the potential bears little of either. With strains of their own the iteration is
//! indifferent to what a step costs on the way (mixed integration points). There is no potential to search along; a step is
//! shortened only where it turns a point too far or inverts one. Only an end with less potential than the start counts, where the
//! last linear systems met no negative curvature.

use super::{Direction, Step, Take};
use crate::contributions::Sums;
use crate::contributions::body_energy::point_strains::PointStrains;
use crate::error::Inadmissible;
use crate::nonlinear::equations::{Equations, moved};
use crate::nonlinear::iteration::{Iterate, Stop};
use crate::solution::state::SolveReport;
use crate::solution::tangent_systems::{TangentSystems, Wanted, eliminate};
use nastic_linear::{LinearSolver, SparseMatrix};

/// Largest `|grad du|` of a step: what the linearised strains leave out is its square.
const LARGEST: f64 = 1.0;
/// Relative residual wanted of the linear systems.
const LINEAR: f64 = 1e-10;
/// Times a step is halved before it leads nowhere.
const HALVINGS: usize = 30;

/// Steps of u and of the strains.
pub(crate) struct WithPointStrains<'a> {
    equations: &'a Equations<'a>,
    systems: TangentSystems<'a>,
    strains: PointStrains,
    matrix: SparseMatrix,
    begun: bool,
}

impl<'a> WithPointStrains<'a> {
    /// With those of a displacement.
    pub fn new(
        equations: &'a Equations<'a>,
        u: &[f64],
        solver: &'a mut dyn LinearSolver,
    ) -> Result<Self, Inadmissible> {
        let (model, parallel) = (equations.model, equations.options.parallel);
        let strains = PointStrains::of(&model.body, u, parallel)?;
        let systems = TangentSystems::new(model, parallel, solver);
        Ok(WithPointStrains { equations, systems, strains, matrix: model.matrix(), begun: false })
    }
}

impl Direction for WithPointStrains<'_> {
    fn is_pending(&self) -> bool {
        !self.begun
    }

    /// The whole step, downhill where the tangent is indefinite, as far as strains can follow.
    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let Equations { model, options, .. } = *self.equations;
        self.begun = true;
        let mut sums = Sums::zero(here.x.len());
        self.matrix.clear();
        let (strains, matrix) = (&self.strains, &mut self.matrix);
        self.equations.at(here.x, |at| model.add_with_point_strains(at, strains, &mut sums, matrix))?;
        model.supports.clear(&mut sums.force);
        let rhs: Vec<f64> = sums.force.iter().map(|r| -r).collect();
        eliminate(model, &mut self.matrix);
        let (mut dx, curvature) = self.systems.step(&self.matrix, here.x, &rhs, (LINEAR, Wanted::Downhill), report)?;
        let (next, largest) = self.strains.extrapolated(&model.body, here.x, &dx, options.parallel)?;
        let longest = self.equations.admissible_move(here, &moved(here.x, &dx, 1.0))?.min(LARGEST / largest);
        let shares = (0..HALVINGS).map(|k| longest * 0.5_f64.powi(k as i32));
        let found = shares.into_iter().find_map(|share| Some((share, self.strains.towards(&next, share)?)));
        let Some((length, strains)) = found else { return Err(Stop::Slow { residual: here.relative }) };
        self.strains = strains;
        dx.iter_mut().for_each(|d| *d *= length);
        Ok(Step { size: model.unknowns().max_abs(&dx), dx, curvature, scale: 0.0, take: Take::Checked { length } })
    }
}
