//! [`ByParameters`]: a law with moduli as slots, by the numbers that it is written with.

use crate::term::forward_statements;
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, Outside, PointBatch, Response, Slot, Slots, Want};
use nastic_tensor::{HyperDual, Mat3};
use std::sync::Arc;

/// How one modulus of a law follows from numbers p that the law may be written with, `theta = f(p)`.
#[derive(Clone, Copy, Debug)]
pub struct Conversion {
    /// The modulus theta.
    pub modulus: &'static str,
    /// The names of p.
    pub from: &'static [&'static str],
    /// How many of them, the last ones, are numbers that the law depends on in another way too: they are held.
    pub held: usize,
    /// f, in numbers that carry their derivatives.
    pub value: fn(&[HyperDual]) -> HyperDual,
}

/// One modulus by the numbers given, of which `from` are indices.
#[derive(Clone, Debug)]
struct Modulus {
    from: Vec<usize>,
    value: fn(&[HyperDual]) -> HyperDual,
}

/// A number that a law is written with.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub name: &'static str,
    pub unit: &'static str,
    pub values: Field<f64>,
}

/// A law with numbers p that it is written with as slots of the role [`Role::Design`](crate::Role): Young's modulus, say, of one whose moduli
/// are mu and lambda. What is not a slot is held.
///
/// **Energy.** `W(F; theta(p))` of a law whose slots are its moduli theta.
///
/// **Derivatives.** `dP/dp_k = sum_j (dtheta_j/dp_k) dP/dtheta_j`;
/// `d2P/dp_k dF : A + sum_l d2P/dp_k dp_l v_l = sum_j (dtheta_j/dp_k) (d2P/dtheta_j dF : A + sum_i d2P/dtheta_j dtheta_i w_i) + sum_j (d2theta_j/dp_k dp . v) dP/dtheta_j`,
/// `w = dtheta/dp v`, with those of theta in hyper-dual numbers.
///
/// **Statements** (existence, bounds of tensions, moduli at rest) are those of the law as it is written.
#[derive(Clone, Debug)]
pub struct ByParameters {
    law: Arc<dyn EnergyTerm>,
    given: Vec<Given>,
    /// Which of the numbers given are slots, in their order.
    chosen: Vec<usize>,
    slots: Vec<Slot>,
    moduli: Vec<Modulus>,
}

impl ByParameters {
    /// Of a law whose slots are its moduli, the numbers that it is written with, the conversions there are, the first that fits taken, and the
    /// names of the slots wanted.
    pub(crate) fn new(
        owner: &'static str,
        law: Arc<dyn EnergyTerm>,
        given: Vec<Given>,
        conversions: &[Conversion],
        names: &[&str],
    ) -> Result<Self, EnergyError> {
        let place = |name: &str| given.iter().position(|given| given.name == name);
        let (mut moduli, mut free) = (Vec::new(), Vec::new());
        for slot in law.slots() {
            if let Some(own) = place(slot.group) {
                free.push(own);
                moduli.push(Modulus { from: vec![own], value: |p| p[0] });
                continue;
            }
            let fits =
                |rule: &&Conversion| rule.modulus == slot.group && rule.from.iter().all(|name| place(name).is_some());
            let Some(rule) = conversions.iter().find(fits) else {
                return Err(EnergyError::NoParameters { owner });
            };
            let from: Vec<usize> = rule.from.iter().filter_map(|name| place(name)).collect();
            free.extend(&from[..from.len() - rule.held]);
            moduli.push(Modulus { from, value: rule.value });
        }
        let mut chosen = Vec::new();
        for name in names {
            match place(name).filter(|own| free.contains(own)) {
                Some(own) => chosen.push(own),
                None => {
                    let known = given.iter().enumerate().filter(|(k, _)| free.contains(k)).map(|(_, given)| given.name);
                    return Err(EnergyError::NotLinear { owner, name: (*name).to_owned(), known: known.collect() });
                }
            }
        }
        let slot = |&own: &usize| {
            let first = given[own].values.entries().next().map_or(0.0, |(_, value)| value);
            Slot::design(given[own].name, given[own].unit, first)
        };
        let slots = chosen.iter().map(slot).collect();
        Ok(ByParameters { law, chosen, slots, moduli, given })
    }

    /// The numbers given at a point, those of the slots by their values.
    fn numbers(&self, at: MaterialPoint, m: &[f64]) -> Vec<HyperDual> {
        let mut numbers: Vec<_> = self.given.iter().map(|own| HyperDual::constant(own.values.at(at))).collect();
        self.chosen.iter().zip(m).for_each(|(&own, value)| numbers[own] = HyperDual::constant(*value));
        numbers
    }

    /// theta of numbers.
    fn theta<'n>(&'n self, numbers: &'n [HyperDual]) -> impl Iterator<Item = HyperDual> + 'n {
        self.moduli.iter().map(|modulus| {
            let from: Vec<HyperDual> = modulus.from.iter().map(|&own| numbers[own]).collect();
            (modulus.value)(&from)
        })
    }

    /// The moduli at all points of a cell, theta per point; none where nothing gives others than the law's own.
    fn moduli_of(&self, at: &PointBatch, m: Slots) -> Vec<f64> {
        if m.width == 0 {
            return Vec::new();
        }
        let of_point = |q: usize| {
            let numbers = self.numbers(at.place(q), m.only(q).values);
            self.theta(&numbers).map(|theta| theta.real()).collect::<Vec<_>>()
        };
        (0..at.len()).flat_map(of_point).collect()
    }

    fn slots_of<'v>(&self, values: &'v [f64]) -> Slots<'v> {
        if values.is_empty() { Slots::none() } else { Slots::by_point(values, self.moduli.len()) }
    }

    /// The values of the slots at a point: those of the law itself where nothing gives others.
    fn chosen_at(&self, at: &PointBatch, m: Slots, q: usize) -> Vec<f64> {
        match m.width {
            0 => (0..self.slots.len()).map(|slot| self.rest(at.place(q), slot)).collect(),
            _ => m.only(q).values.to_vec(),
        }
    }

    /// Calls with point, slot, and theta along one unit of the slot (first change) and along `v` (second change), both together.
    fn each_slot(&self, at: &PointBatch, m: Slots, v: Slots, mut each: impl FnMut(usize, usize, Vec<HyperDual>)) {
        for q in 0..at.len() {
            let own = self.chosen_at(at, m, q);
            for k in 0..self.slots.len() {
                let mut numbers = self.numbers(at.place(q), &own);
                for (l, &place) in self.chosen.iter().enumerate() {
                    let value = numbers[place].real();
                    numbers[place] = HyperDual([value, f64::from(u8::from(k == l)), v.get(q, l), 0.0]);
                }
                each(q, k, self.theta(&numbers).collect());
            }
        }
    }
}

impl EnergyTerm for ByParameters {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        let theta = self.moduli_of(at, m);
        self.law.respond(at, self.slots_of(&theta), want, out);
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        let theta = self.moduli_of(at, m);
        self.law.stress_change(at, self.slots_of(&theta), change, out);
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        changes: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let theta = self.moduli_of(at, m);
        self.law.second_stress_change(at, self.slots_of(&theta), changes, out)
    }

    fn check_domain(&self, at: &PointBatch, m: Slots) -> Result<(), Outside> {
        let theta = self.moduli_of(at, m);
        self.law.check_domain(at, self.slots_of(&theta))
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        let (theta, width) = (self.moduli_of(at, m), self.moduli.len());
        let mut by_modulus = vec![Mat3::zeros(); at.len() * width];
        self.law.stress_by_control(at, self.slots_of(&theta), &mut by_modulus);
        self.each_slot(at, m, Slots::none(), |q, k, theta| {
            let own = by_modulus[q * width..].iter().zip(&theta);
            out[q * self.slots.len() + k] = own.map(|(stress, theta)| stress * theta.along(0)).sum();
        });
    }

    fn control_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        change: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let (theta, width) = (self.moduli_of(at, m), self.moduli.len());
        let (mut along, mut factors) = (vec![0.0; at.len() * width], vec![[0.0; 2]; out.len() * width]);
        self.each_slot(at, m, v, |q, k, theta| {
            for (j, theta) in theta.iter().enumerate() {
                along[q * width + j] = theta.along(1);
                factors[(q * self.slots.len() + k) * width + j] = [theta.along(0), theta.both()];
            }
        });
        let mut by_modulus = vec![Mat3::zeros(); at.len() * width];
        let mut changed = by_modulus.clone();
        self.law.stress_by_control(at, self.slots_of(&theta), &mut by_modulus);
        let along = Slots::by_point(&along, width);
        self.law.control_stress_change(at, self.slots_of(&theta), change, along, &mut changed)?;
        for (n, (out, factors)) in out.iter_mut().zip(factors.chunks_exact(width)).enumerate() {
            let q = n / self.slots.len();
            let own = by_modulus[q * width..].iter().zip(&changed[q * width..]).zip(factors);
            *out = own.map(|((stress, changed), [first, second])| changed * *first + stress * *second).sum();
        }
        Ok(())
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        self.given[self.chosen[slot]].values.at(at)
    }

    forward_statements!(self, self.law);
}
