use nastic_tensor::{Mat3, cross};

use crate::{Actuation, EnergyTerm, PointBatch, Response, Slot, Slots, Want};

/// Turgor: a pressure inside the material itself, as in plant cells or fluid-filled foams.
///
/// **Energy.** `-m (J - 1)`, added to the passive energy; `m > 0` inflates.
///
/// **Stress and tangent.** `P = -m H`, `dP/dF = -m X(F)` (the map `B -> -m F x B`), `dP/dm = -H`.
///
/// **Convexity.** Polyconvex for every `m`, since it is linear in `J`.
///
/// **Parameters.** None; control `pressure`, Pa.
///
/// **Source.** "Mathematical modeling, analysis and control in soft robotics", SeMA Journal 2023,
/// doi 10.1007/s40324-023-00334-4.
#[derive(Clone, Copy, Debug, Default)]
pub struct Turgor;

impl Turgor {
    /// Name in case files and messages.
    pub const NAME: &str = "turgor";
    const SLOTS: [Slot; 1] = [Slot::scalar("pressure", "Pa")];

    /// Turgor in the whole region it is attached to.
    pub const fn new() -> Self {
        Turgor
    }
}

impl EnergyTerm for Turgor {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let pressure = m.get(q, 0);
            if want.energy {
                out.energy[q] -= pressure * (k.j() - 1.0);
            }
            if want.stress {
                out.stress[q] -= k.h() * pressure;
            }
            if want.tangent {
                out.tangent[q].add_cross(k.f(), -pressure);
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for (q, (k, g)) in at.kinematics.iter().zip(change).enumerate() {
            out[q] -= cross(k.f(), g) * m.get(q, 0);
        }
    }
}

impl Actuation for Turgor {
    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn stress_by_control(&self, at: &PointBatch, _m: Slots, out: &mut [Mat3]) {
        for (out, k) in out.iter_mut().zip(at.kinematics) {
            *out = -k.h();
        }
    }
}
