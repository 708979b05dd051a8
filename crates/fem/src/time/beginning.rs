//! [`Model::check_velocity`]: whether a motion may begin with a velocity.

use crate::contributions::instant::Instant;
use crate::error::FemError;
use crate::model::Model;
use crate::solution::state::State;
use nalgebra::DVector;

/// Largest part of a velocity that constraints do not allow, as a share of the whole: what rounding leaves.
const OFF: f64 = 1e-6;

impl Model {
    /// Whether a motion may begin with the velocity of a state: nodes that follow others have that of these, and constraints on a few nodes are kept to
    /// first order, by which the velocity of a rigid body is a translation and a rotation. A state that a motion led to, t > 0, has the velocity that
    /// its scheme gave it, which keeps constraints as far as the scheme is accurate, and of a body at rest is rounding: it is not looked at.
    ///
    /// # Errors
    /// [`FemError::Meaningless`]: of which body, and how far off it is.
    pub fn check_velocity(&self, begin: &State) -> Result<(), FemError> {
        let Some(velocity) = &begin.velocity else { return Ok(()) };
        if begin.time > 0.0 {
            return Ok(());
        }
        self.supports.check_tied("the velocity", velocity)?;
        let dim = self.discretization().dim();
        self.each_other(&Instant::of(begin), |contribution, at| {
            let local = contribution.constrains().and_then(|constraints| constraints.local(at));
            let Some((nodes, allowed)) = local else { return Ok(()) };
            let entries = nodes.iter().flat_map(|&node| &velocity[dim * node as usize..][..dim]);
            let own = DVector::from_iterator(allowed.nrows(), entries.copied());
            let basis = allowed.qr().q();
            let off = (&own - &basis * basis.tr_mul(&own)).norm() / own.norm();
            if off.is_nan() || off <= OFF {
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
}
