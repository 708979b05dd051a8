//! Viscous laws: energies of a time step with internal variables.

mod evolution;
mod kelvin_voigt;
mod maxwell;
mod spectrum;

pub use evolution::Evolution;
pub use kelvin_voigt::KelvinVoigt;
pub use maxwell::MaxwellBranch;

use crate::{EnergyError, Slots};

/// Second derivatives are there where a law contributes nothing.
fn only_at_rest<T: ?Sized>(m: Slots, step: usize, what: &'static str) -> Result<(), EnergyError> {
    let still = |q: usize| m.get(q, step) == 0.0;
    let points = if m.width == 0 { 0 } else { m.values.len() / m.width };
    if (0..points).all(still) { Ok(()) } else { Err(EnergyError::no_second_derivatives::<T>(what)) }
}
