use nastic_tensor::{Kinematics, Mat3, Tangent};

use super::evolution::Evolution;
use super::only_at_rest;
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// Kelvin-Voigt damping: a dashpot in parallel with the passive law.
///
/// **Energy of a step.** `h psi((E - E_n)/h)`, `psi(D) = eta |dev D|^2 + (zeta/2) (tr D)^2`, with Green-Lagrange's strain `E = (F^T F - 1)/2`
/// and that at the beginning of the step, `E_n`, as internal variable. First order in h; nothing in statics and at an instant.
///
/// **Stress.** `P = F S`, `S = 2 eta dev(D) + zeta tr(D) 1`, `D = (E - E_n)/h`. Objective: a rigid motion changes no E. The dissipation
/// `S : D = 2 psi` is never negative. Rayleigh's damping has neither property.
///
/// **Small strains.** Shear viscosity `eta`, volume viscosity `zeta`.
///
/// **Parameters.** `shear` eta >= 0 and `bulk` zeta >= 0 in Pa s, each a [`Field`]. Slots: `E_n` (xx, yy, zz, yz, xz, xy), `1/h`.
///
/// **Source.** M. Ortiz, L. Stainier, Comput. Methods Appl. Mech. Eng. 171 (1999) 419-444, doi 10.1016/S0045-7825(98)00219-9.
#[derive(Clone, Debug)]
pub struct KelvinVoigt {
    shear: Field<f64>,
    bulk: Field<f64>,
}

/// The slot of 1/h.
const STEP: usize = 6;
/// The entries of a symmetric tensor.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

impl KelvinVoigt {
    /// Name in messages.
    pub const NAME: &str = "kelvin_voigt";

    const SLOTS: [Slot; 7] = [Slot::internal("internal", ""); 7];

    /// From the viscosities of shape and volume (Pa s).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless both are finite and at least zero.
    pub fn new(shear: impl Into<Field<f64>>, bulk: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (shear, bulk) = (shear.into(), bulk.into());
        shear.require(Self::NAME, "shear", |eta| eta >= 0.0, "it must be at least zero")?;
        bulk.require(Self::NAME, "bulk", |zeta| zeta >= 0.0, "it must be at least zero")?;
        Ok(KelvinVoigt { shear, bulk })
    }

    /// `2 eta dev D + zeta tr D`
    fn viscous(&self, at: MaterialPoint, d: &Mat3) -> Mat3 {
        let (eta, zeta) = (self.shear.at(at), self.bulk.at(at));
        d * (2.0 * eta) + Mat3::identity() * ((zeta - 2.0 * eta / 3.0) * d.trace())
    }
}

fn strain(k: &Kinematics) -> Mat3 {
    (k.f().transpose() * k.f() - Mat3::identity()) * 0.5
}

fn symmetric(m: &[f64]) -> Mat3 {
    Mat3::new(m[0], m[5], m[4], m[5], m[1], m[3], m[4], m[3], m[2])
}

fn strain_change(k: &Kinematics, change: &Mat3) -> Mat3 {
    let half = k.f().transpose() * change;
    (half + half.transpose()) * 0.5
}

impl KelvinVoigt {
    fn vjp_at(&self, at: MaterialPoint, k: &Kinematics, m: &[f64], with: &Mat3, by_slots: &mut [f64]) {
        let half = k.f().transpose() * with;
        let pulled = (half + half.transpose()) * 0.5;
        // the viscosity is symmetric
        let by_rate = self.viscous(at, &pulled) * -m[STEP];
        for ((i, j), by) in ENTRIES.into_iter().zip(&mut *by_slots) {
            *by = by_rate[(i, j)] * if i == j { 1.0 } else { 2.0 };
        }
        by_slots[STEP] = self.viscous(at, &(strain(k) - symmetric(m))).dot(&pulled);
    }
}

impl EnergyTerm for KelvinVoigt {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let (m, place) = (m.only(q).values, at.place(q));
            let Some(&rate) = m.get(STEP).filter(|rate| **rate != 0.0) else { continue };
            let d = strain(k) - symmetric(m);
            let stress = self.viscous(place, &d) * rate;
            if want.energy {
                out.energy[q] += 0.5 * stress.dot(&d);
            }
            if want.stress {
                out.stress[q] += k.f() * stress;
            }
            if want.tangent {
                out.tangent[q].add(&Tangent::from_map(|change| {
                    change * stress + k.f() * self.viscous(place, &strain_change(k, change)) * rate
                }));
            }
        }
    }

    /// Zero where it contributes nothing, as in statics.
    fn second_stress_change(
        &self,
        _: &PointBatch,
        m: Slots,
        _: [&[Mat3]; 2],
        _: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        only_at_rest::<Self>(m, STEP, "EnergyTerm::second_stress_change")
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.shear.check_len(Self::NAME, "shear", cells, points)?;
        self.bulk.check_len(Self::NAME, "bulk", cells, points)
    }

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let (own, m, place) = (q * (STEP + 1), m.only(q).values, at.place(q));
            for (entry, (i, j)) in ENTRIES.into_iter().enumerate() {
                let mut unit = Mat3::zeros();
                unit[(i, j)] = 1.0;
                unit[(j, i)] = 1.0;
                out[own + entry] = k.f() * self.viscous(place, &unit) * -m[STEP];
            }
            out[own + STEP] = k.f() * self.viscous(place, &(strain(k) - symmetric(m)));
        }
    }

    /// Zero where it contributes nothing and nothing changes that.
    fn slots_vjp(&self, at: &PointBatch, m: Slots, with: &[Mat3], out: &mut [f64]) {
        let mut own = vec![0.0; m.width];
        for (q, (k, out)) in at.kinematics.iter().zip(out.chunks_exact_mut(m.width)).enumerate() {
            self.vjp_at(at.place(q), k, m.only(q).values, &with[q], &mut own);
            out.iter_mut().zip(&own).for_each(|(out, own)| *out += own);
        }
    }

    fn control_stress_change(
        &self,
        _: &PointBatch,
        m: Slots,
        _: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        out.fill(Mat3::zeros());
        [m, v].into_iter().try_for_each(|m| only_at_rest::<Self>(m, STEP, "EnergyTerm::control_stress_change"))
    }

    fn evolution(&self) -> Option<&dyn Evolution> {
        Some(self)
    }
}

impl Evolution for KelvinVoigt {
    /// At an instant it contributes nothing: there it is known for a body at rest alone.
    fn set_step(&self, _: MaterialPoint, dt: f64, slots: &mut [f64]) {
        slots[STEP] = if dt > 0.0 { 1.0 / dt } else { 0.0 };
    }

    fn is_known_at_instants(&self) -> bool {
        false
    }

    fn advance(&self, _: MaterialPoint, k: &Kinematics, _: &[f64], next: &mut [f64]) {
        let strain = strain(k);
        ENTRIES.into_iter().zip(next).for_each(|(entry, next)| *next = strain[entry]);
    }

    fn advance_vjp(
        &self,
        _: MaterialPoint,
        k: &Kinematics,
        _: &[f64],
        by_next: &[f64],
        by_f: &mut Mat3,
        _: &mut [f64],
    ) {
        let mut by_strain = symmetric(by_next) * 0.5;
        (0..3).for_each(|i| by_strain[(i, i)] = by_next[i]);
        *by_f += k.f() * by_strain;
    }
}
