//! [`Prescribes`]: unknowns on nodes that a contribution moves by its controls.

use crate::contribution::sensitivities::Sensitivities;
use crate::controls::Controls;
use crate::instant::Instant;

/// Unknowns D that a contribution prescribes, `u_D = u_D(m)` with its controls m, of the displacement or of its [fields](super::Contribution::fields), in vectors of these; they
/// are held as by supports.
pub trait Prescribes {
    /// D
    fn unknowns(&self) -> Vec<u32>;

    /// Sets `u_D(m)`.
    fn prescribe(&self, at: &Instant, u: &mut [f64]);

    /// Adds `du_D/dm v`.
    fn add_change(&self, at: &Instant, v: &Controls, du: &mut [f64]);

    /// Adds `force . du_D/dm`.
    fn vjp(&self, at: &Instant, force: &[f64], into: &mut Sensitivities);

    /// Whether `u_D` has no second derivative along v and any other change of the controls.
    fn is_straight_along(&self, _at: &Instant, _v: &Controls) -> bool {
        true
    }
}
