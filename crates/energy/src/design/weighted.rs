//! [`Weighted`]: laws times functions of a number of the body.

use super::scale::Scale;
use crate::slot::lasting;
use crate::{
    EnergyError, EnergyTerm, Existence, Growth, MaterialPoint, Moduli, Outside, PointBatch, PointQuantity, Response,
    Slot, Slots, Want,
};
use nastic_tensor::{Mat3, Tangent, Vec3};
use std::sync::Arc;

/// Laws times functions of a number s of the body: `W(F; s, m_1, ..) = sum_i f_i(s) W_i(F; m_i)`, s before the slots of the laws in their order.
///
/// | | f | s at rest |
/// |---|---|---|
/// | [`scaled`](Self::scaled) | chi(s), a [`Scale`]: density, filler, factor | 1 of a density or factor, 0 of a filler: f = 1 |
/// | [`mixture`](Self::mixture) | 1 - s and s of two laws | 0 |
///
/// **Derivatives.** `P = sum f_i P_i`, `dP/ds = sum f_i' P_i`, `dP/dm_i = f_i dP_i/dm_i`, `d2P/ds2 = sum f_i'' P_i`.
///
/// **Convexity and growth.** At every fixed s what is true of each of the laws. No statement is made of fibre tensions, whose bound falls with f.
#[derive(Clone, Debug)]
pub struct Weighted {
    name: &'static str,
    terms: Vec<Term>,
    range: [f64; 2],
    slots: Vec<Slot>,
}

const TAKEN: &str = "another slot of the same name stands beside its own";

/// How far s may leave its range: values at points are sums of those of nodes or grids, or filtered.
const RANGE_TOLERANCE: f64 = 1e-9;

#[derive(Clone, Debug)]
struct Term {
    law: Arc<dyn EnergyTerm>,
    weight: Weight,
    /// Its first slot.
    first: usize,
}

impl Term {
    fn is_judged(&self) -> bool {
        self.law.point_quantity().is_some()
    }
}

#[derive(Clone, Copy, Debug)]
enum Weight {
    Scale(Scale),
    /// `1 - s`
    Left,
    /// `s`
    Share,
}

impl Weight {
    /// f, f', f''.
    fn derivatives(self, s: f64) -> [f64; 3] {
        match self {
            Weight::Scale(scale) => scale.derivatives(s),
            Weight::Left => [1.0 - s, -1.0, 0.0],
            Weight::Share => [s, 1.0, 0.0],
        }
    }

    fn is_defined(self, s: f64) -> bool {
        if let Weight::Scale(scale) = self { scale.is_defined(s) } else { true }
    }
}

impl Weighted {
    /// The term whose point quantity the law has to be judged by.
    fn judged(&self) -> Option<&Term> {
        self.terms.iter().find(|term| term.is_judged())
    }

    /// A law scaled by a number of a name.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] of a scale with other numbers than it takes; [`EnergyError::Wrapped`] of a law without an energy of its own, whose
    /// slots are internal variables or of global scope, or have that name.
    pub fn scaled(name: &str, law: Arc<dyn EnergyTerm>, scale: Scale) -> Result<Self, EnergyError> {
        scale.check()?;
        let slot = Slot { group: lasting(name), ..scale.slot() };
        Self::new(scale.name(), slot, scale.range(), vec![(law, Weight::Scale(scale))])
    }

    /// Two laws, of the second the share s of a name, 0 <= s <= 1.
    ///
    /// # Errors
    /// [`EnergyError::Wrapped`] as of [`scaled`](Self::scaled), and of two laws with a slot of one name.
    pub fn mixture(name: &str, first: Arc<dyn EnergyTerm>, second: Arc<dyn EnergyTerm>) -> Result<Self, EnergyError> {
        let share = Slot::design(lasting(name), "1", 0.0);
        Self::new("mixture", share, [0.0, 1.0], vec![(first, Weight::Left), (second, Weight::Share)])
    }

    fn new(
        name: &'static str,
        slot: Slot,
        range: [f64; 2],
        laws: Vec<(Arc<dyn EnergyTerm>, Weight)>,
    ) -> Result<Self, EnergyError> {
        let (mut slots, mut terms) = (vec![slot], Vec::new());
        for (law, weight) in laws {
            let why = match law.slots() {
                _ if law.strain_map().is_some() => Some("it has no energy of its own"),
                own if own.iter().any(|slot| slot.is_internal()) => Some("its slots are internal variables"),
                own if own.iter().any(|slot| slot.is_global()) => Some("its slots have one value for all points"),
                own if own.iter().any(|slot| slots.iter().any(|known| known.group == slot.group)) => Some(TAKEN),
                _ if law.point_quantity().is_some() && terms.iter().any(Term::is_judged) => {
                    Some("both laws have a number to be judged by at the points")
                }
                _ => None,
            };
            if let Some(why) = why {
                return Err(EnergyError::Wrapped { owner: name, why });
            }
            let first = slots.len();
            slots.extend(law.slots());
            terms.push(Term { law, weight, first });
        }
        Ok(Weighted { name, terms, range, slots })
    }

    /// s at a point: at rest where nothing gives a value, and within its range where rounding of a sum of shape functions leaves it.
    fn number(&self, m: Slots, q: usize) -> f64 {
        let ([least, most], s) = (self.range, if m.width == 0 { self.slots[0].rest() } else { m.get(q, 0) });
        if (least - RANGE_TOLERANCE..=most + RANGE_TOLERANCE).contains(&s) { s.clamp(least, most) } else { s }
    }

    /// Every term with its weights f, f', f'' at the points and the values of its slots.
    fn each<'a>(&'a self, at: &PointBatch, m: Slots) -> impl Iterator<Item = Evaluated<'a>> {
        let points = at.len();
        self.terms.iter().map(move |term| {
            let width = if m.width == 0 { 0 } else { term.law.slots().len() };
            let weights = (0..points).map(|q| term.weight.derivatives(self.number(m, q))).collect();
            let own = (0..points * width).map(|k| m.get(k / width, term.first + k % width)).collect();
            Evaluated { term, weights, own, width }
        })
    }
}

/// A term at the points of a cell.
struct Evaluated<'a> {
    term: &'a Term,
    weights: Vec<[f64; 3]>,
    own: Vec<f64>,
    width: usize,
}

impl Evaluated<'_> {
    fn law(&self) -> &dyn EnergyTerm {
        self.term.law.as_ref()
    }

    fn slots(&self) -> Slots<'_> {
        if self.width == 0 { Slots::none() } else { Slots::by_point(&self.own, self.width) }
    }

    /// Of other values of all slots those of its own.
    fn part_of(&self, v: Slots) -> Vec<f64> {
        (0..self.own.len()).map(|k| v.get(k / self.width, self.term.first + k % self.width)).collect()
    }

    fn stress(&self, at: &PointBatch) -> Vec<Mat3> {
        let mut stress = vec![Mat3::zeros(); at.len()];
        let mut out = Response { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        self.law().respond(at, self.slots(), Want::STRESS, &mut out);
        stress
    }

    fn by_control(&self, at: &PointBatch) -> Vec<Mat3> {
        let mut by_control = vec![Mat3::zeros(); self.own.len()];
        if self.width > 0 {
            self.law().stress_by_control(at, self.slots(), &mut by_control);
        }
        by_control
    }

    /// Adds what a law gives at the points, weighted.
    fn add(&self, out: &mut [Mat3], own: &[Mat3]) {
        out.iter_mut().zip(own).zip(&self.weights).for_each(|((out, own), [f, ..])| *out += own * *f);
    }
}

impl EnergyTerm for Weighted {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        let count = |wanted: bool| if wanted { at.len() } else { 0 };
        for own in self.each(at, m) {
            let mut energy = vec![0.0; count(want.energy)];
            let mut stress = vec![Mat3::zeros(); count(want.stress)];
            let mut tangent = vec![Tangent::zero(); count(want.tangent)];
            let mut response = Response { energy: &mut energy, stress: &mut stress, tangent: &mut tangent };
            own.law().respond(at, own.slots(), want, &mut response);
            out.energy.iter_mut().zip(&energy).zip(&own.weights).for_each(|((out, w), [f, ..])| *out += w * f);
            own.add(out.stress, &stress);
            for ((out, mut tangent), [f, ..]) in out.tangent.iter_mut().zip(tangent).zip(&own.weights) {
                tangent.0.iter_mut().for_each(|c| *c *= f);
                out.add(&tangent);
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for own in self.each(at, m) {
            let mut changed = vec![Mat3::zeros(); at.len()];
            own.law().stress_change(at, own.slots(), change, &mut changed);
            own.add(out, &changed);
        }
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        changes: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        for own in self.each(at, m) {
            let mut changed = vec![Mat3::zeros(); at.len()];
            own.law().second_stress_change(at, own.slots(), changes, &mut changed)?;
            own.add(out, &changed);
        }
        Ok(())
    }

    fn check_domain(&self, at: &PointBatch, m: Slots) -> Result<(), Outside> {
        let [least, most] = self.range;
        for q in 0..at.len() {
            let s = self.number(m, q);
            let defined = self.terms.iter().all(|term| term.weight.is_defined(s));
            if !((least..=most).contains(&s) && defined) {
                let (limit, meaning) = if s < least { (least, "its least value") } else { (most, "its largest value") };
                return Err(Outside {
                    law: self.name,
                    measure: self.slots[0].group,
                    value: s,
                    limit,
                    meaning,
                    point: q,
                });
            }
        }
        self.each(at, m).try_for_each(|own| own.law().check_domain(at, own.slots()))
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        let width = self.slots.len();
        out.fill(Mat3::zeros());
        for own in self.each(at, m) {
            let by_control = own.by_control(at);
            for (q, (stress, [f, slope, _])) in own.stress(at).iter().zip(&own.weights).enumerate() {
                out[q * width] += stress * *slope;
                for k in 0..own.width {
                    out[q * width + own.term.first + k] = by_control[q * own.width + k] * *f;
                }
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
        let width = self.slots.len();
        out.fill(Mat3::zeros());
        for own in self.each(at, m) {
            let (stress, by_control, along) = (own.stress(at), own.by_control(at), own.part_of(v));
            let mut changed = vec![Mat3::zeros(); at.len()];
            own.law().stress_change(at, own.slots(), change, &mut changed);
            let mut by_changed = vec![Mat3::zeros(); by_control.len()];
            if own.width > 0 {
                let along = Slots::by_point(&along, own.width);
                own.law().control_stress_change(at, own.slots(), change, along, &mut by_changed)?;
            }
            for (q, [f, slope, curvature]) in own.weights.iter().enumerate() {
                let (mut along_slots, v_s) = (changed[q], v.get(q, 0));
                for (k, at_slot) in (q * own.width..(q + 1) * own.width).enumerate() {
                    along_slots += by_control[at_slot] * along[at_slot];
                    out[q * width + own.term.first + k] =
                        by_changed[at_slot] * *f + by_control[at_slot] * (slope * v_s);
                }
                out[q * width] += along_slots * *slope + stress[q] * (curvature * v_s);
            }
        }
        Ok(())
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        let own = self.terms.iter().rev().find(|term| term.first <= slot);
        own.map_or(self.slots[slot].rest(), |term| term.law.rest(at, slot - term.first))
    }

    fn is_material(&self) -> bool {
        self.terms.iter().all(|term| term.law.is_material())
    }

    /// Of what is true at every s: of a mixture of each of its laws, of a factor that may be zero no growth.
    fn existence(&self, at: MaterialPoint) -> Option<Existence> {
        let stated = self.terms.iter().map(|term| term.law.existence(at)).reduce(|a, b| Some(a?.or(b?)))??;
        let vanishes = matches!(&self.terms[..], [Term { weight: Weight::Scale(scale), .. }] if scale.vanishes());
        let nothing = Existence { resists_collapse: false, growth: Growth::default(), ..stated };
        Some(if vanishes { nothing } else { stated })
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.terms.iter().try_for_each(|term| term.law.check(cells, points))
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        self.terms.iter().find_map(|term| term.law.direction(at))
    }

    /// At rest the first law has the weight 1, others 0.
    fn moduli(&self, at: MaterialPoint) -> Option<Moduli> {
        self.terms.first().and_then(|term| term.law.moduli(at))
    }

    fn point_quantity(&self) -> Option<PointQuantity> {
        self.judged().and_then(|term| term.law.point_quantity())
    }

    fn point_values(&self, at: &PointBatch, m: Slots, out: &mut [f64]) {
        for own in self.each(at, m).filter(|own| own.term.is_judged()) {
            own.law().point_values(at, own.slots(), out);
            // the field of a dielectric is s E
            if let Weight::Scale(Scale::Electrode) = own.term.weight {
                out.iter_mut().enumerate().for_each(|(q, value)| *value *= self.number(m, q));
            }
        }
    }

    fn point_limit(&self, at: MaterialPoint) -> Option<f64> {
        self.judged().and_then(|term| term.law.point_limit(at))
    }

    fn turn(&self, q: &Mat3, m: &mut [f64]) {
        for term in &self.terms {
            let own = &mut m[term.first..term.first + term.law.slots().len()];
            term.law.turn(q, own);
        }
    }
}
