use std::sync::Arc;

use nastic_tensor::{HyperDual, Kinematics, Mat3, Tangent};

use super::strain_map::Mapped;
use crate::term::forward_statements;
use crate::{
    EnergyError, EnergyTerm, Evolution, MaterialPoint, Outside, PointBatch, PointQuantity, Response, Slot, Slots, Want,
};

/// A law behind a [`StrainMap`](crate::StrainMap).
///
/// **Energy.** `det G W(F_e; m)`, `F_e = F G^-1`. Its slots are those of the law, m, and behind them those of the map, g.
///
/// **Derivatives.** With `T = det G G^-T` and `P_e`, `C_e` of the law at `F_e`, indices k, l changes of g and A a change of F:
///
/// ```text
/// P = P_e T,   dP/dF : A = (C_e : A G^-1) T,   dP/dm = (dP_e/dm) T,   dP/dg_k = P_e T_k + Y_k T,   Y_k = C_e : (F (G^-1)_k)
/// d/de dP/dg_k = P_e T_kl + P_e' T_k + Y_k T_l + Y_k' T                  along e = (A, m', l)
/// ```
///
/// where a dash is the change along e, in which `F_e' = A G^-1 + F (G^-1)_l`. Those of G are its own in hyper-dual numbers.
///
/// **Statements** (existence, bounds of tensions, moduli at rest) are those of the law: `F -> F G^-1` is linear.
///
/// **Source.** As [`Growth`](crate::KinematicGrowth).
#[derive(Clone, Debug)]
pub struct Grown {
    law: Arc<dyn EnergyTerm>,
    map: Arc<dyn EnergyTerm>,
    slots: Vec<Slot>,
}

/// A cell as the law sees it.
struct Seen<'a> {
    kinematics: Vec<Kinematics>,
    at: PointBatch<'a>,
    /// Of the law itself.
    own: Vec<f64>,
    own_width: usize,
    mapped: Vec<Mapped>,
}

impl Seen<'_> {
    fn batch(&self) -> PointBatch<'_> {
        PointBatch { kinematics: &self.kinematics, ..self.at }
    }

    fn slots(&self) -> Slots<'_> {
        if self.own_width == 0 { Slots::none() } else { Slots::by_point(&self.own, self.own_width) }
    }

    /// `A (G^-1)_part` by point.
    fn changes(&self, change: &[Mat3], part: usize) -> Vec<Mat3> {
        change.iter().zip(&self.mapped).map(|(a, mapped)| a * mapped.inverse[part]).collect()
    }

    /// `F (G^-1)_part` by point.
    fn stretched(&self, part: usize) -> Vec<Mat3> {
        self.at.kinematics.iter().zip(&self.mapped).map(|(k, mapped)| k.f() * mapped.inverse[part]).collect()
    }
}

/// What derivatives by the slots of the map go along: one of them first, given changes of all second.
#[derive(Clone, Copy)]
struct Along<'v> {
    slot: Option<usize>,
    changes: Slots<'v>,
}

const STILL: Along = Along { slot: None, changes: Slots::none() };

impl Grown {
    /// Of a law and one with a [strain map](EnergyTerm::strain_map).
    ///
    /// # Errors
    /// [`EnergyError::NoStrainMap`] of a second one without.
    pub fn new(law: Arc<dyn EnergyTerm>, map: Arc<dyn EnergyTerm>) -> Result<Self, EnergyError> {
        if map.strain_map().is_none() {
            return Err(EnergyError::NoStrainMap { owner: format!("{map:?}") });
        }
        let slots = law.slots().iter().chain(map.slots()).copied().collect();
        Ok(Grown { law, map, slots })
    }

    /// Number of slots of the map.
    fn map_width(&self) -> usize {
        self.map.slots().len()
    }

    /// G of a point with the slots of all of the law.
    fn mapped(&self, at: MaterialPoint, m: &[f64], q: usize, along: Along) -> Mapped {
        let width = self.map_width();
        let own = m.len().saturating_sub(width);
        let number = |k: usize| {
            let value = m.get(own + k).copied().unwrap_or_else(|| self.map.rest(at, k));
            let second =
                if along.changes.width == 0 { 0.0 } else { along.changes.get(q, along.changes.width - width + k) };
            HyperDual([value, f64::from(u8::from(along.slot == Some(k))), second, 0.0])
        };
        let numbers: Vec<HyperDual> = (0..width).map(number).collect();
        let identity =
            || std::array::from_fn(|i| std::array::from_fn(|k| HyperDual::constant(f64::from(u8::from(i == k)))));
        Mapped::of(&self.map.strain_map().map_or_else(identity, |map| map.tensor(at, &numbers)))
    }

    /// What the law sees; where that is inverted, which [`check_domain`](EnergyTerm::check_domain) refuses, the rest state.
    fn seen<'a>(&self, at: &PointBatch<'a>, m: Slots, along: Along) -> Seen<'a> {
        let own_width = m.width.saturating_sub(self.map_width());
        let (mut kinematics, mut own, mut mapped) = (Vec::with_capacity(at.len()), Vec::new(), Vec::new());
        for (q, k) in at.kinematics.iter().enumerate() {
            let here = m.only(q).values;
            let of_map = self.mapped(at.place(q), here, q, along);
            kinematics.push(Kinematics::new(k.f() * of_map.inverse[0]).unwrap_or_else(|_| Kinematics::rest()));
            own.extend_from_slice(&here[..own_width.min(here.len())]);
            mapped.push(of_map);
        }
        Seen { kinematics, at: *at, own, own_width, mapped }
    }

    /// The own part of changes of all slots.
    fn own_changes(&self, v: Slots, points: usize) -> Vec<f64> {
        let own = v.width.saturating_sub(self.map_width());
        (0..points).flat_map(|q| (0..own).map(move |k| v.get(q, k))).collect()
    }

    fn stresses(&self, seen: &Seen) -> Vec<Mat3> {
        let mut stress = vec![Mat3::zeros(); seen.kinematics.len()];
        let mut out = Response { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        self.law.respond(&seen.batch(), seen.slots(), Want::STRESS, &mut out);
        stress
    }

    fn stress_changes(&self, seen: &Seen, change: &[Mat3]) -> Vec<Mat3> {
        let mut out = vec![Mat3::zeros(); change.len()];
        self.law.stress_change(&seen.batch(), seen.slots(), change, &mut out);
        out
    }

    /// The change of `dP_e/dm_k` along `change` and v, all zero of a law without slots here.
    fn own_slot_changes(&self, seen: &Seen, change: &[Mat3], v: &[f64]) -> Result<Vec<Mat3>, EnergyError> {
        let mut out = vec![Mat3::zeros(); seen.own.len()];
        if !out.is_empty() {
            let v = if v.is_empty() { Slots::none() } else { Slots::by_point(v, seen.own_width) };
            self.law.control_stress_change(&seen.batch(), seen.slots(), change, v, &mut out)?;
        }
        Ok(out)
    }

    fn by_own_slots(&self, seen: &Seen) -> Vec<Mat3> {
        let mut out = vec![Mat3::zeros(); seen.own.len()];
        if !out.is_empty() {
            self.law.stress_by_control(&seen.batch(), seen.slots(), &mut out);
        }
        out
    }
}

/// `sum_k v_k x_k` of a point.
fn weighted(by_slot: &[Mat3], v: &[f64], q: usize, width: usize) -> Mat3 {
    if v.is_empty() {
        return Mat3::zeros();
    }
    let own = q * width..(q + 1) * width;
    by_slot[own.clone()].iter().zip(&v[own]).map(|(x, v)| x * *v).sum()
}

/// Adds `det G C_iMkN (G^-1)_JM (G^-1)_LN`.
fn add_tangent(tangent: &Tangent, mapped: &Mapped, out: &mut Tangent) {
    let (inverse, volume) = (&mapped.inverse[0], mapped.volume.real());
    for (i, k) in (0..3).flat_map(|i| (0..3).map(move |k| (i, k))) {
        let block = Mat3::from_fn(|m, n| tangent.get(i, m, k, n));
        let pulled = inverse * block * inverse.transpose() * volume;
        for (j, l) in (0..3).flat_map(|j| (0..3).map(move |l| (j, l))) {
            out.0[9 * (3 * i + j) + 3 * k + l] += pulled[(j, l)];
        }
    }
}

impl EnergyTerm for Grown {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        let seen = self.seen(at, m, STILL);
        let n = at.len();
        let count = |wanted: bool| if wanted { n } else { 0 };
        let (mut energy, mut stress, mut tangent) = (
            vec![0.0; count(want.energy)],
            vec![Mat3::zeros(); count(want.stress)],
            vec![Tangent::zero(); count(want.tangent)],
        );
        let mut own = Response { energy: &mut energy, stress: &mut stress, tangent: &mut tangent };
        self.law.respond(&seen.batch(), seen.slots(), want, &mut own);
        for (q, mapped) in seen.mapped.iter().enumerate() {
            if want.energy {
                out.energy[q] += mapped.volume.real() * energy[q];
            }
            if want.stress {
                out.stress[q] += stress[q] * mapped.cofactor[0];
            }
            if want.tangent {
                add_tangent(&tangent[q], mapped, &mut out.tangent[q]);
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        let seen = self.seen(at, m, STILL);
        let found = self.stress_changes(&seen, &seen.changes(change, 0));
        out.iter_mut().zip(found).zip(&seen.mapped).for_each(|((out, p), mapped)| *out += p * mapped.cofactor[0]);
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        [a, b]: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let seen = self.seen(at, m, STILL);
        let mut found = vec![Mat3::zeros(); at.len()];
        let changes = [&seen.changes(a, 0)[..], &seen.changes(b, 0)[..]];
        self.law.second_stress_change(&seen.batch(), seen.slots(), changes, &mut found)?;
        out.iter_mut().zip(found).zip(&seen.mapped).for_each(|((out, p), mapped)| *out += p * mapped.cofactor[0]);
        Ok(())
    }

    fn check_domain(&self, at: &PointBatch, m: Slots) -> Result<(), Outside> {
        let seen = self.seen(at, m, STILL);
        for (point, mapped) in seen.mapped.iter().enumerate() {
            let Some(map) = self.map.strain_map() else { continue };
            let (shrink, limit) = (-mapped.volume.real(), 0.0 - map.least_volume());
            if !(shrink < limit && shrink.is_finite()) {
                let (law, meaning) = (map.owner(), map.limit());
                return Err(Outside { law, measure: "-det G", value: shrink, limit, meaning, point });
            }
        }
        self.law.check_domain(&seen.batch(), seen.slots())
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        let still = self.seen(at, m, STILL);
        let (stress, by_own, own) = (self.stresses(&still), self.by_own_slots(&still), still.own_width);
        let width = own + self.map_width();
        for (n, by_slot) in by_own.iter().enumerate() {
            out[n / own * width + n % own] = by_slot * still.mapped[n / own].cofactor[0];
        }
        for k in 0..self.map_width() {
            let seen = self.seen(at, m, Along { slot: Some(k), ..STILL });
            let stretched = self.stress_changes(&seen, &seen.stretched(1));
            for (q, mapped) in seen.mapped.iter().enumerate() {
                out[q * width + own + k] = stress[q] * mapped.cofactor[1] + stretched[q] * mapped.cofactor[0];
            }
        }
    }

    fn control_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        change: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let along = self.seen(at, m, Along { slot: None, changes: v });
        let (own, own_v) = (along.own_width, self.own_changes(v, at.len()));
        let width = own + self.map_width();
        // F_e' and what follows from it
        let moved: Vec<Mat3> = along.changes(change, 0).iter().zip(along.stretched(2)).map(|(a, f)| a + f).collect();
        let (stress, by_own) = (self.stresses(&along), self.by_own_slots(&along));
        let mut changed = self.stress_changes(&along, &moved);
        changed.iter_mut().enumerate().for_each(|(q, p)| *p += weighted(&by_own, &own_v, q, own));
        for (n, by_slot) in self.own_slot_changes(&along, &moved, &own_v)?.iter().enumerate() {
            let mapped = &along.mapped[n / own];
            out[n / own * width + n % own] = by_slot * mapped.cofactor[0] + by_own[n] * mapped.cofactor[2];
        }
        for k in 0..self.map_width() {
            let seen = self.seen(at, m, Along { slot: Some(k), changes: v });
            let first = seen.stretched(1);
            let y = self.stress_changes(&seen, &first);
            let second: Vec<Mat3> = seen.changes(change, 1).iter().zip(seen.stretched(3)).map(|(a, f)| a + f).collect();
            let mut y_changed = self.stress_changes(&seen, &second);
            self.law.second_stress_change(&seen.batch(), seen.slots(), [&first, &moved], &mut y_changed)?;
            let mixed = self.own_slot_changes(&seen, &first, &[])?;
            for (q, mapped) in seen.mapped.iter().enumerate() {
                let [t, t_k, t_l, t_kl] = &mapped.cofactor;
                let y_changed = y_changed[q] + weighted(&mixed, &own_v, q, own);
                out[q * width + own + k] = stress[q] * t_kl + changed[q] * t_k + y[q] * t_l + y_changed * t;
            }
        }
        Ok(())
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        let own = self.law.slots().len();
        if slot < own { self.law.rest(at, slot) } else { self.map.rest(at, slot - own) }
    }

    fn is_material(&self) -> bool {
        self.law.is_material()
    }

    fn point_quantity(&self) -> Option<PointQuantity> {
        self.law.point_quantity()
    }

    fn point_values(&self, at: &PointBatch, m: Slots, out: &mut [f64]) {
        let seen = self.seen(at, m, STILL);
        self.law.point_values(&seen.batch(), seen.slots(), out);
    }

    fn point_limit(&self, at: MaterialPoint) -> Option<f64> {
        self.law.point_limit(at)
    }

    fn evolution(&self) -> Option<&dyn Evolution> {
        self.law.evolution().map(|_| self as &dyn Evolution)
    }

    fn turn(&self, q: &Mat3, m: &mut [f64]) {
        let own = m.len().saturating_sub(self.map_width());
        self.law.turn(q, &mut m[..own]);
    }

    forward_statements!(self, self.law);
}

/// That of a viscous law, at `F_e`; the slots of the map are none of its internal variables.
impl Evolution for Grown {
    fn set_step(&self, at: MaterialPoint, dt: f64, slots: &mut [f64]) {
        if let Some(evolution) = self.law.evolution() {
            evolution.set_step(at, dt, slots);
        }
    }

    fn is_known_at_instants(&self) -> bool {
        self.law.evolution().is_none_or(Evolution::is_known_at_instants)
    }

    fn advance(&self, at: MaterialPoint, k: &Kinematics, slots: &[f64], next: &mut [f64]) {
        let own = self.law.slots().len();
        let mapped = self.mapped(at, slots, 0, STILL);
        let seen = Kinematics::new(k.f() * mapped.inverse[0]);
        if let (Some(evolution), Ok(seen)) = (self.law.evolution(), seen) {
            evolution.advance(at, &seen, &slots[..own], &mut next[..own]);
        }
    }

    fn advance_vjp(
        &self,
        at: MaterialPoint,
        k: &Kinematics,
        slots: &[f64],
        by_next: &[f64],
        by_f: &mut Mat3,
        by_slots: &mut [f64],
    ) {
        let own = self.law.slots().len();
        let mapped = self.mapped(at, slots, 0, STILL);
        let (Some(evolution), Ok(seen)) = (self.law.evolution(), Kinematics::new(k.f() * mapped.inverse[0])) else {
            return;
        };
        let mut by_seen = Mat3::zeros();
        evolution.advance_vjp(at, &seen, &slots[..own], &by_next[..own], &mut by_seen, &mut by_slots[..own]);
        *by_f += by_seen * mapped.inverse[0].transpose();
        for k_slot in 0..self.map_width() {
            let along = self.mapped(at, slots, 0, Along { slot: Some(k_slot), ..STILL });
            by_slots[own + k_slot] += by_seen.dot(&(k.f() * along.inverse[1]));
        }
    }
}
