//! Viscous laws: energies of a time step with internal variables.

mod evolution;
mod kelvin_voigt;
mod maxwell;
mod neo_hooke_spring;
mod spectrum;

pub use evolution::Evolution;
pub use kelvin_voigt::KelvinVoigt;
pub use maxwell::{MaxwellBranch, SpringMeasure};

use crate::{EnergyError, Slots};

/// Second derivatives are there where a law contributes nothing.
fn only_at_rest<T: ?Sized>(m: Slots, step: usize, what: &'static str) -> Result<(), EnergyError> {
    let still = m.values.chunks_exact(m.width.max(1)).all(|slots| slots[step] == 0.0);
    if still { Ok(()) } else { Err(EnergyError::no_second_derivatives::<T>(what)) }
}
