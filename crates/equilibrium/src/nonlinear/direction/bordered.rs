//! [`Bordered`]: Newton's step under constraints, a saddle point of the potential with multipliers.
//!
//! With the potential `P(u)`, constraints `g(u) = 0` and their multipliers p, the step solves
//!
//! ```text
//! [K   -g_u^T] [du]     [P_u - p g_u]
//! [-g_u    0 ] [dp] = - [    -g     ],     K = P_uu - p g_uu
//! ```
//!
//! K may be indefinite, as behind the pressure maximum of a balloon. It must be positive definite on the null space of `g_u`, which
//! the inertia of the whole system shows, and is shifted until it is. For inequalities `g >= 0`, `p >= 0`, `p g = 0` the step
//! solves the linearised ones (sequential quadratic programming): inactive ones have `q = 0` and leave the system. Without a
//! potential K is not symmetric and the inertia is not used.

use super::active_set::{Trial, settle};
use super::{Direction, Step, Take};
use crate::linear_systems::saddle_point::{BorderedTangent, SaddlePoint};
use crate::linear_systems::tangent_systems::{Counted, FULL_STEP, TangentSystems, bordered_step};
use crate::nonlinear::equations::{Equations, Jump};
use crate::nonlinear::iterate::{Iterate, Stop};
use nastic_body::state::SolveReport;
use nastic_linear::solver::{Accuracy, Curvature};
use nastic_linear::{LinearError, LinearSolver};
use nastic_numeric::vector::axpy;

/// Smallest shift of K, as a share of its mean diagonal.
const MIN_SHIFT: f64 = 1e-8;
/// Ratio of one shift to the one before.
const SHIFT_GROWTH: f64 = 8.0;
/// Largest shift of K, as a share of its mean diagonal.
const MAX_SHIFT: f64 = 1e3;
/// Ratio of the last shift to the first that is tried at the next iterate.
const SHIFT_DECREASE: f64 = 64.0;
/// Error of the linear systems' solutions, as a share of the change of a constraint.
const LINEAR_ERROR_SHARE: f64 = 1e-6;
/// Rounding of a constraint, as a share of its scale.
const CONSTRAINT_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Largest value of a constraint that touches, over the sum of both: constraints that yield leave more than rounding.
const MAX_TOUCHING_RATIO: f64 = 10.0;

/// The linearised equations and inequalities at an iterate.
struct Linearised {
    system: SaddlePoint,
    /// Minus the residual; `g` for all inequalities, active or not.
    rhs: Vec<f64>,
    /// The scale of the rounding of each constraint, where there are inequalities.
    scales: Vec<f64>,
}

/// A step, the number of negative eigenvalues of the system beyond one for each active constraint, and which constraints are active or
/// touch.
type BorderedStep = (Vec<f64>, usize, Vec<bool>);

/// Steps of `(u, p)`.
pub(crate) struct Bordered<'a> {
    equations: &'a Equations<'a>,
    systems: TangentSystems<'a>,
    /// By constraint.
    inequalities: Vec<bool>,
    jump: Jump,
    linearised: Option<Linearised>,
    /// The last sufficient shift.
    shift: f64,
}

impl<'a> Bordered<'a> {
    /// Makes multipliers of inequalities at x admissible: in an extrapolated guess they may be negative.
    pub fn new(equations: &'a Equations<'a>, x: &mut [f64], solver: &'a mut dyn LinearSolver) -> Self {
        let systems = TangentSystems::new(equations.model, equations.controls(), equations.options.parallel, solver);
        let inequalities = equations.model.inequalities();
        equations.start_positive(x);
        Bordered { equations, systems, inequalities, jump: equations.jump(x), linearised: None, shift: 0.0 }
    }

    /// Newton's step, and the number of negative eigenvalues of the tangent on the null space of the active constraints; `None` where rounding
    /// determines it, or no active set was found.
    pub(super) fn newton(
        &mut self,
        here: &Iterate,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Option<usize>, f64), Stop> {
        let equations = self.equations;
        let tangent = equations.bordered_tangent(here.point, here.x)?;
        let mut residual = here.residual.to_vec();
        let scales = equations.put_slack(here.point, here.x, &self.inequalities, &mut residual)?;
        let rhs = equations.bordered_right_hand_side(&tangent, &residual, self.jump.as_deref());
        let scale = equations.energy_scale(&tangent.matrix, here.x, here.now);
        let system = SaddlePoint::new(equations.model, tangent);
        let mut linearised = Linearised { system, rhs, scales };
        let wanted = bordered_step(here.relative, equations.options.accuracy);
        let found = self.solve((here.x, wanted), &mut linearised, report);
        self.linearised = Some(linearised);
        let (dx, negative) = found.map_err(|error| failed(error, here))?;
        Ok((dx, negative, scale))
    }

    /// The step; with `kept` by a factor of the tangent before, if possible.
    fn solve(
        &mut self,
        (x, (accuracy, kept)): (&[f64], (Accuracy, bool)),
        problem: &mut Linearised,
        report: &mut SolveReport,
    ) -> Result<(Vec<f64>, Option<usize>), LinearError> {
        let u = self.equations.model.nodal(x);
        let (systems, inequalities) = (&mut self.systems, &self.inequalities);
        if !kept {
            problem.system.prepare(systems, u, report)?;
        }
        if !inequalities.contains(&true) {
            let Counted { solved: mut steps, negative } =
                problem.system.solve(systems, u, &[&problem.rhs], accuracy, report)?;
            return Ok((steps.pop().unwrap_or_default(), negative.ok()));
        }
        let mut last = Vec::new();
        let Linearised { system, rhs, scales } = problem;
        let (rhs, scales): (&[f64], &[f64]) = (rhs, scales);
        let symmetric = self.equations.model.properties().has_potential();
        let mut trial = |acting: &[bool], softened: bool| {
            system.set_acting(acting, softened);
            let given = ActiveSets { x, rhs, inequalities, scales, symmetric };
            let trial = given.step_with(acting, system, systems, report)?;
            last.clone_from(&trial.found.0);
            Ok(trial)
        };
        let (multipliers, g) = (&x[u.len()..], &rhs[u.len()..]);
        let acts = |k: usize| !inequalities[k] || multipliers[k] > 0.0 || g[k] < 0.0;
        let settled = match settle((0..inequalities.len()).map(acts).collect(), |acting| trial(acting, false)) {
            // Some of several dependent constraints may be inactive: compliant ones show which.
            Err(LinearError::Border { .. }) => {
                let equations = inequalities.iter().map(|inequality| !inequality).collect();
                let yielding = settle(equations, |acting| trial(acting, true))?;
                let settled = yielding.map(|(_, _, touching)| trial(&touching, false)).transpose()?;
                // multipliers of the wrong sign were cut: the set is not right
                settled.filter(|settled| settled.wrong.iter().all(|wrong| *wrong == 0.0)).map(|settled| settled.found)
            }
            settled => settled?,
        };
        Ok(settled.map_or((last, None), |(step, negative, _)| (step, Some(negative))))
    }
}

pub(super) fn failed(error: LinearError, here: &Iterate) -> Stop {
    match error {
        // Dependent constraints are dependent at any control.
        LinearError::Border { .. } | LinearError::NotCounted { .. } => Stop::Linear(error),
        _ if error.is_lack_of_memory() => Stop::Linear(error),
        _ => Stop::Slow { residual: here.relative },
    }
}

impl Direction for Bordered<'_> {
    fn is_pending(&self) -> bool {
        self.jump.is_some()
    }

    fn find(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Step, Stop> {
        let (mut dx, negative, scale) = self.newton(here, report)?;
        let definite = negative == Some(0) || !self.equations.model.properties().has_potential();
        let curvature = if definite { Curvature::Positive } else { Curvature::Negative };
        let dofs = self.equations.dofs();
        if let Some(jump) = self.jump.take() {
            self.equations.prescribe(&mut dx, &jump);
            return Ok(Step { scale, ..Step::whole(dx, curvature, self.equations.model.unknowns()) });
        }
        Ok(Step {
            size: self.equations.model.unknowns().max_abs(&dx[..dofs]),
            dx,
            curvature,
            scale,
            take: Take::Search,
        })
    }

    /// With K shifted until it is positive definite on the null space of the derivatives of the constraints that act.
    fn downhill(&mut self, here: &Iterate, report: &mut SolveReport) -> Result<Vec<f64>, Stop> {
        let Some(mut problem) = self.linearised.take() else { return Err(Stop::Slow { residual: here.relative }) };
        report.shifted += 1;
        let (mut shift, mut added) = ((self.shift / SHIFT_DECREASE).max(MIN_SHIFT), 0.0);
        while shift <= MAX_SHIFT {
            problem.system.shift(shift - added);
            added = shift;
            let found =
                self.solve((here.x, (FULL_STEP, false)), &mut problem, report).map_err(|error| failed(error, here))?;
            if let (step, Some(0)) = found {
                self.shift = shift;
                return Ok(step);
            }
            shift *= SHIFT_GROWTH;
        }
        Err(failed(LinearError::Shift, here))
    }
}

/// The arguments of all steps with different active sets.
struct ActiveSets<'a> {
    x: &'a [f64],
    rhs: &'a [f64],
    inequalities: &'a [bool],
    scales: &'a [f64],
    symmetric: bool,
}

impl ActiveSets<'_> {
    /// The step with an active set; the multipliers of other constraints become 0.
    fn step_with(
        &self,
        acting: &[bool],
        system: &SaddlePoint,
        systems: &mut TangentSystems,
        report: &mut SolveReport,
    ) -> Result<Trial<BorderedStep>, LinearError> {
        let ActiveSets { x, inequalities, scales, .. } = *self;
        let scalars = acting.len();
        let dofs = x.len() - scalars;
        let mut rhs = self.rhs.to_vec();
        let slack = || (0..scalars).filter(|&k| !acting[k]);
        slack().for_each(|k| system.add_column(k, x[dofs + k], &mut rhs[..dofs]));
        let Counted { solved: mut steps, negative } = system.solve(systems, &x[..dofs], &[&rhs], FULL_STEP, report)?;
        let negative = match negative {
            Err(why) if self.symmetric => return Err(why),
            known => known.unwrap_or(0),
        };
        let mut step = steps.pop().unwrap_or_default();
        let (mut wrong, mut touching) = (vec![0.0; scalars], acting.to_vec());
        for k in (0..scalars).filter(|&k| inequalities[k] && acting[k]) {
            wrong[k] = (-x[dofs + k] - step[dofs + k]).max(0.0);
            step[dofs + k] = step[dofs + k].max(-x[dofs + k]);
        }
        for k in slack() {
            step[dofs + k] = -x[dofs + k];
            let change = system.slope(k, &step[..dofs]);
            let beyond = change - rhs[dofs + k];
            let noise = CONSTRAINT_ROUNDING * scales[k] + LINEAR_ERROR_SHARE * change.abs();
            wrong[k] = if beyond > noise { beyond } else { 0.0 };
            touching[k] = beyond.abs() <= MAX_TOUCHING_RATIO * noise;
        }
        Ok(Trial { found: (step, negative, touching), wrong })
    }
}

impl Equations<'_> {
    /// `-r - K d`, on free unknowns where there is d, the jump of the prescribed ones.
    pub(super) fn bordered_right_hand_side(
        &self,
        tangent: &BorderedTangent,
        residual: &[f64],
        jump: Option<&[f64]>,
    ) -> Vec<f64> {
        let mut rhs: Vec<f64> = residual.iter().map(|r| -r).collect();
        if let Some(jump) = jump {
            let mut all = jump.to_vec();
            all.resize(rhs.len(), 0.0);
            axpy(-1.0, &tangent.multiply(&all, self.options.parallel), &mut rhs);
            self.model.supports.restrict(&mut rhs);
        }
        rhs
    }

    /// Makes multipliers of inequalities admissible.
    pub(super) fn start_positive(&self, x: &mut [f64]) {
        let inequalities = self.model.inequalities();
        let own = x[self.dofs()..].iter_mut().zip(&inequalities).filter(|(_, inequality)| **inequality);
        own.for_each(|(p, _)| *p = p.max(0.0));
    }
}
