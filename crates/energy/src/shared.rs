//! [`Shared`]: a law whose slots have one value for the whole body.

use crate::term::{forward_law, forward_statements};
use crate::{EnergyError, EnergyTerm, Slot};

/// A law with its slots in [global scope](crate::Scope): one value of each for all points, and one derivative, the sum over the points. So
/// weights of a network, which are many and the same everywhere, take no array over the points.
#[derive(Clone, Debug)]
pub struct Shared<L> {
    law: L,
    slots: Vec<Slot>,
}

impl<L: EnergyTerm> Shared<L> {
    /// Of a law with slots.
    ///
    /// # Errors
    /// [`EnergyError::NoParameters`] of a law whose slots are internal variables, which differ from point to point, and of a growth.
    pub fn new(law: L) -> Result<Self, EnergyError> {
        if law.strain_map().is_some() || law.slots().iter().any(Slot::is_internal) {
            return Err(EnergyError::NoParameters { owner: std::any::type_name::<L>() });
        }
        let slots = law.slots().iter().map(|slot| slot.global()).collect();
        Ok(Shared { law, slots })
    }
}

impl<L: EnergyTerm> EnergyTerm for Shared<L> {
    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    forward_law!(self, self.law);
}
