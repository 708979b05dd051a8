//! [`WithPointStrains`]: Newton's step with independent strains and stresses at the quadrature points, see [`PointStrains`].
//!
//! Descent on the potential is slow in thin and nearly incompressible bodies: every step that turns the body stretches it, every one that
//! shears it changes its volume, and both increase the potential steeply. With independent strains the iteration does not depend
//! on the energy of intermediate iterates (mixed integration points). There is no line search on a potential; a step is
//! shortened only where it rotates a point too far or inverts one. A result counts only with less potential than the start (any, if the step
//! moves prescribed components or a constraint), and if the last linear systems met no negative curvature.
//!
//! Under constraints the system is bordered. It is not shifted if the inertia of an intermediate iterate is wrong: a shift would change the
//! step in the constraints and in the pressures of nearly incompressible points, and the next tangent has the right inertia at most iterates.

use super::bordered::failed;
use super::{Direction, Step, Take};
use crate::linear_systems::saddle_point::{BorderedTangent, SaddlePoint};
use crate::linear_systems::tangent_systems::{Counted, StepWanted, TangentSystems, bordered_step, eliminate};
use crate::nonlinear::equations::{Equations, Jump, moved};
use crate::nonlinear::iterate::{Iterate, Stop};
use nastic_body::body_energy::driving::Driving;
use nastic_body::body_energy::point_strains::PointStrains;
use nastic_body::contribution::Sums;
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_body::state::SolveReport;
use nastic_linear::solver::Curvature;
use nastic_linear::{LinearError, LinearSolver};

/// Largest `|grad du|` of a step: the error of the linearised strains is its square.
const MAX_STEP_GRADIENT: f64 = 1.0;
/// Relative residual of the linear systems.
const LINEAR_TOLERANCE: f64 = 1e-10;
/// Halvings of a step before it has failed.
const MAX_HALVINGS: usize = 30;

/// Steps of u and of the strains.
pub(crate) struct WithPointStrains<'a> {
    equations: &'a Equations<'a>,
    systems: TangentSystems<'a>,
    strains: PointStrains,
    tangent: BorderedTangent,
    jump: Jump,
    begun: bool,
}

impl<'a> WithPointStrains<'a> {
    /// With the strains of a displacement.
    pub fn new(
        equations: &'a Equations<'a>,
        x: &[f64],
        solver: &'a mut dyn LinearSolver,
    ) -> Result<Self, Inadmissible> {
        let (model, parallel) = (equations.model, equations.options.parallel);
        let of = |at: &Instant| PointStrains::of(&model.body, model.nodal(at.u), Driving::of(at), parallel);
        let strains = equations.at(x, of)?;
        let systems = TangentSystems::new(model, equations.controls(), parallel, solver);
        let (tangent, jump) = (BorderedTangent::zero(model), equations.jump(x));
        Ok(WithPointStrains { equations, systems, strains, tangent, jump, begun: false })
    }

    fn solve(
        &mut self,
        here: &Iterate,
        rhs: &[f64],
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Curvature), LinearError> {
        let model = self.equations.model;
        if model.unknowns().multipliers() == 0 {
            eliminate(model, &mut self.tangent.matrix);
            return self.systems.step(
                &self.tangent.matrix,
                here.x,
                rhs,
                LINEAR_TOLERANCE,
                StepWanted::Downhill,
                report,
            );
        }
        let (system, u) = (SaddlePoint::new(model, self.tangent.clone()), model.nodal(here.x));
        let (accuracy, kept) = bordered_step(here.relative, self.equations.options.accuracy);
        if !kept {
            system.prepare(&mut self.systems, u, report)?;
        }
        let Counted { solved: mut steps, negative } = system.solve(&mut self.systems, u, &[rhs], accuracy, report)?;
        let definite = negative == Ok(0) || !self.equations.has_potential();
        let curvature = if definite { Curvature::Positive } else { Curvature::Negative };
        Ok((steps.pop().unwrap_or_default(), curvature))
    }
}

impl Direction for WithPointStrains<'_> {
    fn is_pending(&self) -> bool {
        !self.begun
    }

    /// The whole step, a descent direction where the tangent is indefinite, limited by the strains.
    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let Equations { model, options, .. } = *self.equations;
        self.begun = true;
        let mut sums = Sums::zero(here.x.len());
        self.tangent.clear();
        let (strains, tangent) = (&self.strains, &mut self.tangent);
        self.equations.at(here.x, |at| model.add_with_point_strains(at, strains, &mut sums, tangent))?;
        let mut rhs = self.equations.bordered_right_hand_side(&self.tangent, &sums.force, self.jump.as_deref());
        model.supports.restrict(&mut rhs);
        let solved = self.solve(here, &rhs, report);
        let (mut dx, curvature) = solved.map_err(|error| failed(error, here))?;
        let jump = self.jump.take();
        if let Some(jump) = &jump {
            self.equations.prescribe(&mut dx, jump);
        }
        let (next, largest) = self.equations.at(here.x, |at| {
            let (u, du) = (model.nodal(at.u), model.nodal(&dx));
            self.strains.extrapolated(&model.body, u, Driving::of(at), du, options.parallel)
        })?;
        let longest = self.equations.admissible_move(here, &moved(here.x, &dx, 1.0))?;
        // prescribed components move at once or not at all
        let longest = if jump.is_some() { longest } else { longest.min(MAX_STEP_GRADIENT / largest) };
        let shares = (0..MAX_HALVINGS).map(|k| longest * 0.5_f64.powi(k as i32));
        let found = shares.into_iter().find_map(|share| Some((share, self.strains.towards(&next, share)?)));
        let slow = Stop::Slow { residual: here.relative };
        let Some((length, strains)) = found else { return Err(slow) };
        if jump.is_some() && length < 1.0 {
            return Err(slow);
        }
        self.strains = strains;
        dx.iter_mut().for_each(|d| *d *= length);
        let size = model.unknowns().max_abs(&dx[..self.equations.dofs()]);
        Ok(Step { size, dx, curvature, scale: 0.0, take: Take::Checked { length } })
    }
}
