//! [`Evolution`]: how internal variables follow the deformation.

use crate::MaterialPoint;
use nastic_tensor::{Kinematics, Mat3};

/// The internal variables of a viscous law. They are the slots of an [`EnergyTerm`](crate::EnergyTerm) whose energy is that of a time
/// step, condensed: stored energy plus `h` times the dissipation potential, minimised over the internal variables at the end of the
/// step (Ortiz and Stainier, CMAME 171, 1999). Among the slots is one that says how long the step is; where all slots are
/// zero the law is as after an infinitely long step: it contributes nothing.
///
/// A point carries the slots of the last step; [`advance`](Self::advance) makes those of the next one.
pub trait Evolution: Send + Sync {
    /// Sets the slot that depends on the length of the step (s, 0 for an instant) in the slots of a point.
    fn set_step(&self, at: MaterialPoint, dt: f64, slots: &mut [f64]);

    /// Whether the energy at an instant is that of a step without length whatever the velocity: not so where it depends on that.
    fn is_known_at_instants(&self) -> bool {
        true
    }

    /// The internal variables at the end of the step that the slots belong to, at the deformation there: sets `next`, but for the
    /// slot of [`set_step`](Self::set_step), which stays.
    fn advance(&self, at: MaterialPoint, k: &Kinematics, slots: &[f64], next: &mut [f64]);

    /// The transpose of the derivative of [`advance`](Self::advance): adds the derivatives by `F` and the slots that follow from `by_next`.
    fn advance_vjp(
        &self,
        at: MaterialPoint,
        k: &Kinematics,
        slots: &[f64],
        by_next: &[f64],
        by_f: &mut Mat3,
        by_slots: &mut [f64],
    );
}
