use nastic_tensor::{Mat3, cross};

use crate::{EnergyError, EnergyTerm, PointBatch, Response, Slot, Slots, Want};

/// Turgor: a pressure inside the material itself, as in plant cells or fluid-filled foams.
///
/// **Energy.** `-m (J - 1)`, added to the passive energy; `m > 0` inflates.
///
/// **Stress and tangent.** `P = -m H`, `dP/dF = -m X(F)` (the map `B -> -m F x B`), `dP/dm = -H`;
/// `d2P/dF2 : (A, B) = -m A x B`, `d2P/dm dF : A = -F x A`.
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

    fn second_stress_change(
        &self,
        _at: &PointBatch,
        m: Slots,
        [a, b]: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        for (q, ((a, b), out)) in a.iter().zip(b).zip(out).enumerate() {
            *out -= cross(a, b) * m.get(q, 0);
        }
        Ok(())
    }

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn stress_by_control(&self, at: &PointBatch, _m: Slots, out: &mut [Mat3]) {
        for (out, k) in out.iter_mut().zip(at.kinematics) {
            *out = -k.h();
        }
    }

    fn control_stress_change(
        &self,
        at: &PointBatch,
        _m: Slots,
        change: &[Mat3],
        _v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        for ((out, k), change) in out.iter_mut().zip(at.kinematics).zip(change) {
            *out = -cross(k.f(), change);
        }
        Ok(())
    }
}
