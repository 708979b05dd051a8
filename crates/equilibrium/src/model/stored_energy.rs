//! [`StoredEnergy`]: what a state has stored.

use crate::model::views::Energies;
use nastic_body::contribution::energy_role::EnergyRole;
use nastic_body::contribution::point::Need;
use nastic_body::contribution::{Contribution, Demand, Sums};
use nastic_body::error::Inadmissible;
use nastic_body::instant::Instant;
use nastic_body::state::State;

/// Energies that a state has stored (J; in plane strain J/m): those of the same names in the `EnergyBalance` of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StoredEnergy {
    /// Without controls, by laws, springs, foundations.
    pub elastic: f64,
    /// In the layers of contacts.
    pub contact: f64,
}

fn energy(contribution: &dyn Contribution, at: &Instant) -> Result<f64, Inadmissible> {
    let mut sums = Sums::zero(at.u.len());
    contribution.at(at, Need::Residual)?.add_residual(at, Demand { energy: true, force: false }, &mut sums)?;
    Ok(sums.energy)
}

impl Energies<'_> {
    /// What a state by itself has stored, with relaxed viscous laws; loads, fluids and drives have no part in it.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn stored_energy(&self, state: &State) -> Result<StoredEnergy, Inadmissible> {
        let passive = self.model.unactuated(&state.controls);
        let at = Instant { parallel: true, ..Instant::of(state) };
        let u = self.model.displacement(at.u);
        let of_body = Instant { u: &u, space: self.model.unknowns(), ..at }.under(&passive);
        let mut stored = StoredEnergy { elastic: energy(&self.model.body, &of_body)?, contact: 0.0 };
        self.model.each_other(&at, |contribution, at| {
            if contribution.touches().is_some() {
                stored.contact += energy(contribution, at)?;
            } else if contribution.energy_role() == EnergyRole::Stored {
                stored.elastic += energy(contribution, &at.under(&passive))?;
            }
            Ok::<(), Inadmissible>(())
        })?;
        Ok(stored)
    }
}
