//! [`TimeStepping::check_velocity`](crate::TimeStepping::check_velocity): whether a motion may begin with a velocity.

use nalgebra::DVector;
use nastic_body::error::FemError;
use nastic_body::instant::Instant;
use nastic_body::state::State;
use nastic_equilibrium::model::Model;

/// Largest part of a velocity that violates the constraints, as a share of the whole: rounding.
const MAX_VIOLATION_SHARE: f64 = 1e-6;

/// [`TimeStepping::check_velocity`](crate::TimeStepping::check_velocity).
pub(crate) fn check_velocity(model: &Model, begin: &State) -> Result<(), FemError> {
    let Some(velocity) = &begin.velocity else { return Ok(()) };
    if begin.time > 0.0 {
        return Ok(());
    }
    model.supports.check_tied("the velocity", velocity)?;
    let dim = model.discretization().dim();
    model.each_other(&Instant::of(begin), |contribution, at| {
        let local = contribution.constrains().and_then(|constraints| constraints.local(at));
        let Some((nodes, allowed)) = local else { return Ok(()) };
        let entries = nodes.iter().flat_map(|&node| &velocity[dim * node as usize..][..dim]);
        let own = DVector::from_iterator(allowed.nrows(), entries.copied());
        let basis = allowed.qr().q();
        let off = (&own - &basis * basis.tr_mul(&own)).norm() / own.norm();
        if off.is_nan() || off <= MAX_VIOLATION_SHARE {
            return Ok(());
        }
        let what = format!(
            "the velocity at the beginning changes the shape of \"{}\": {:.3} of it is no rigid motion; give a translation and a rotation, v + w x (X - c)",
            contribution.name(),
            off
        );
        Err(FemError::Meaningless { what })
    })
}
