use nastic_tensor::{HyperDual, Vec3};

use super::strain_map::entries;
use crate::{EnergyError, Field, MaterialPoint, Role, Slot};

/// Unit vectors a of the reference body as `a (x) a`: written with a law, or its slots behind another one, a vector d of any length, `a = d / |d|`.
#[derive(Clone, Debug)]
pub(super) struct Director {
    written: Field<Vec3>,
    owner: &'static str,
    pub is_slot: bool,
}

impl Director {
    /// Of a field that must have unit length.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] with the first vector that is not a unit vector, and where it is.
    pub fn new(written: impl Into<Field<Vec3>>, owner: &'static str) -> Result<Self, EnergyError> {
        Ok(Director { written: written.into().unit_directions(owner, "direction")?, owner, is_slot: false })
    }

    /// The same as slots.
    pub fn as_slots(&self) -> Self {
        Director { is_slot: true, ..self.clone() }
    }

    /// `a (x) a` with all slots of the law; those of the direction stand behind the first.
    pub fn dyad(&self, at: MaterialPoint, slots: &[HyperDual]) -> [[HyperDual; 3]; 3] {
        match slots {
            [_, d @ ..] if self.is_slot && d.len() == 3 => {
                let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                entries(|i, k| d[i] * d[k] / square)
            }
            _ => {
                let dyad = self.written.at(at) * self.written.at(at).transpose();
                entries(|i, k| HyperDual::constant(dyad[(i, k)]))
            }
        }
    }

    /// What is written, unless slots say otherwise.
    pub fn fixed(&self, at: MaterialPoint) -> Option<Vec3> {
        (!self.is_slot).then(|| self.written.at(at))
    }

    /// At rest the slots have what is written.
    pub fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        slot.checked_sub(1).map_or(0.0, |component| self.written.at(at)[component])
    }

    /// # Errors
    /// [`EnergyError::Length`] of a field that does not fit.
    pub fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.written.check_len(self.owner, "direction", cells, points)
    }
}

/// A load and a direction behind it, a vector of the body itself.
pub(super) const fn with_direction(load: Slot) -> [Slot; 4] {
    let role = Role::Design { rest: 0.0 };
    let [x, y, z] = Slot::vector("direction", "1");
    [load, Slot { role, ..x }, Slot { role, ..y }, Slot { role, ..z }]
}
