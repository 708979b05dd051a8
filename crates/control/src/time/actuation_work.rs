//! [`ActuationWork`]: the work that the actuations do in a motion.

use super::Timeline;
use super::trajectory_cost::{TrajectoryContext, TrajectoryCost, TrajectoryPartials};
use crate::cost::{CostForm, check_weight};
use nastic_fem::{Controls, Demand, Instant, State};
use nastic_fields::{ControlError, Layout};
use nastic_numeric::vector::{axpy, dot};

/// The energy that actuations spend: with `g(u; m) = r(u; m) - r(u; 0)` the internal force of the actuations
/// (viscous forces are in both),
///
/// ```text
/// j = -weight sum_n (g_n + g_{n+1})/2 . (u_{n+1} - u_n)
/// ```
///
/// the trapezoidal rule of `-int g . du`. Without dissipation it is what kinetic energy, stored energy and the potential of dead loads gain, up
/// to an error of second order in the step. It counts from the state at t = 0 on, and what flows back counts as negative.
///
/// The work of surfaces that are held and moved ([`MovingSupport`](nastic_fem::MovingSupport)) is not in it: it takes reactions with the accelerations
/// of held nodes, which not every scheme approximates. Beside given motions it is the work of the other actuations; beside controlled ones,
/// which would drive the body for nothing, it is refused.
///
/// Units: the weight's times N m.
#[derive(Debug, Clone)]
pub struct ActuationWork {
    weight: f64,
}

impl ActuationWork {
    /// Of all actuations.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn new(weight: f64) -> Result<Self, ControlError> {
        Ok(ActuationWork { weight: check_weight("actuation_work", weight)? })
    }
}

/// Refuses controls that move surfaces.
fn check_moved(layout: &Layout) -> Result<(), ControlError> {
    let Some(block) = layout.blocks().iter().find(|block| block.holds) else { return Ok(()) };
    let what = format!(
        "\"actuation_work\" does not count the work of a surface that is moved: the control \"{}\" would drive the body for nothing; let it \
         follow given values, or limit it by a \"control_rate\" instead",
        block.name
    );
    Err(ControlError::Cost { what })
}

/// Without actuation and with it; viscous laws hold the same in both, so that they cancel.
fn pair<'a>(state: &'a State, passive: &'a Controls) -> [Instant<'a>; 2] {
    [Instant::of(state).under(passive), Instant::of(state)]
}

/// g of every state.
fn forces(at: &TrajectoryContext) -> Result<Vec<Vec<f64>>, ControlError> {
    let model = at.solid.model();
    let demand = Demand { energy: false, force: true };
    let of = |state: &State| {
        let passive = model.unactuated(&state.controls);
        let [without, with] = pair(state, &passive);
        let mut force = model.evaluate(&with, demand)?.force;
        axpy(-1.0, &model.evaluate(&without, demand)?.force, &mut force);
        Ok(force)
    };
    at.trajectory.states().iter().map(of).collect()
}

/// `u_{n+1} - u_n`
fn moves(at: &TrajectoryContext) -> Vec<Vec<f64>> {
    let change = |pair: &[State]| pair[1].u.iter().zip(pair[0].u.iter()).map(|(b, a)| b - a).collect();
    at.trajectory.states().windows(2).map(change).collect()
}

/// How it stands in case files.
pub(crate) const FORM: CostForm = CostForm::of_motion(
    "actuation_work",
    "weight times the work that all actuations do from t = 0 to the end",
    &[],
    |on| Ok(Box::new(ActuationWork::new(on.weight)?)),
)
.words(|_| "work that the actuations do".to_owned());

impl TrajectoryCost for ActuationWork {
    fn name(&self) -> &str {
        "actuation_work"
    }

    fn check(&self, layout: &Layout, _: &Timeline) -> Result<(), ControlError> {
        check_moved(layout)
    }

    fn value(&self, at: &TrajectoryContext) -> Result<f64, ControlError> {
        check_moved(at.layout)?; // of controls that were added later
        if at.solid.body().grows() {
            let what = "\"actuation_work\" does not count the work of a growth; leave one of them out".to_owned();
            return Err(ControlError::Cost { what });
        }
        let forces = forces(at)?;
        let work = |(n, du): (usize, Vec<f64>)| -0.5 * (dot(&forces[n], &du) + dot(&forces[n + 1], &du));
        Ok(self.weight * moves(at).into_iter().enumerate().map(work).sum::<f64>())
    }

    fn add_partials(&self, at: &TrajectoryContext, out: &mut TrajectoryPartials) -> Result<(), ControlError> {
        let (forces, moves) = (forces(at)?, moves(at));
        let (model, of_instant) = (at.solid.model(), at.layout.of_instant());
        for (n, state) in at.trajectory.states().iter().enumerate() {
            let (t, len) = (at.timeline.instants()[n], state.u.len());
            let passive = model.unactuated(&state.controls);
            let mut by_u = vec![0.0; len];
            // what g_n is multiplied by
            let mut factor = vec![0.0; len];
            for (k, sign) in [(n.checked_sub(1), -0.5), (Some(n), 0.5)] {
                let Some((k, du)) = k.and_then(|k| Some((k, moves.get(k)?))) else { continue };
                axpy(-0.5 * self.weight, du, &mut factor);
                axpy(sign * self.weight, &forces[k], &mut by_u);
                axpy(sign * self.weight, &forces[k + 1], &mut by_u);
            }
            for (at, sign) in pair(state, &passive).iter().zip([-1.0, 1.0]) {
                let (mut tangent, mut image) = (model.tangents().matrix(), vec![0.0; len]);
                model.tangents().add_tangent(at, &mut tangent)?;
                tangent.multiply_transposed(&factor, &mut image, true);
                axpy(sign, &image, &mut by_u);
            }
            let own = &mut out.states[n].u;
            own.resize(len, 0.0);
            axpy(1.0, &by_u, own);
            let by_points = model.vjp(&pair(state, &passive)[1], &factor)?.controls;
            let by_instant = of_instant.control_vjp(&at.layout.at(at.m, t)?, &by_points);
            at.layout.add_at(t, &by_instant, &mut out.m);
        }
        Ok(())
    }
}
