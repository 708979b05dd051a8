use nastic_tensor::{HyperDual, Mat3, Vec3};

use crate::slot::DIRECTION;
use crate::{EnergyError, Field, MaterialPoint, Role, Slot, Slots};

/// Unit vectors a of the reference body as `a (x) a`: written with a law, or its slots behind another one, a vector d of any length, `a = d / |d|`.
#[derive(Clone, Debug)]
pub(crate) struct Director {
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
                std::array::from_fn(|i| std::array::from_fn(|k| d[i] * d[k] / square))
            }
            _ => {
                let dyad = self.written.at(at) * self.written.at(at).transpose();
                std::array::from_fn(|i| std::array::from_fn(|k| HyperDual::constant(dyad[(i, k)])))
            }
        }
    }

    /// The unit vector a at a point of a batch; a zero vector in the slots leaves no number.
    pub fn unit(&self, at: MaterialPoint, slots: Slots, q: usize) -> Vec3 {
        if self.is_slot { vector(slots, q).normalize() } else { self.written.at(at) }
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

/// The vector d in the slots behind the first.
pub(crate) fn vector(slots: Slots, q: usize) -> Vec3 {
    Vec3::new(slots.get(q, 1), slots.get(q, 2), slots.get(q, 3))
}

/// The derivative of `d (x) d / |d|^2` along v: `(v (x) d + d (x) v) / s - 2 (d.v) d (x) d / s^2`, `s = |d|^2`.
pub(crate) fn dyad_change(d: &Vec3, v: &Vec3) -> Mat3 {
    let s = d.norm_squared();
    symmetric(d, v) / s - d * d.transpose() * (2.0 * d.dot(v) / (s * s))
}

/// The second derivative of `d (x) d / |d|^2` along v and w.
pub(crate) fn second_dyad_change(d: &Vec3, v: &Vec3, w: &Vec3) -> Mat3 {
    let s = d.norm_squared();
    let (dv, dw) = (d.dot(v), d.dot(w));
    let mixed = symmetric(d, v) * dw + symmetric(d, w) * dv + d * d.transpose() * v.dot(w);
    symmetric(v, w) / s - mixed * (2.0 / (s * s)) + d * d.transpose() * (8.0 * dv * dw / (s * s * s))
}

/// `v (x) w + w (x) v`.
fn symmetric(v: &Vec3, w: &Vec3) -> Mat3 {
    v * w.transpose() + w * v.transpose()
}

/// A load and a direction behind it, a vector of the body itself.
pub(crate) const fn with_direction(load: Slot) -> [Slot; 4] {
    let role = Role::Design { rest: 0.0 };
    let [x, y, z] = Slot::vector(DIRECTION, "1");
    [load, Slot { role, ..x }, Slot { role, ..y }, Slot { role, ..z }]
}
