//! [`Parametrised`]: a law whose moduli are slots.

use nastic_tensor::Mat3;

use crate::term::forward_statements;
use crate::{
    ConvexDensity, EnergyError, EnergyTerm, Field, MaterialPoint, Outside, PointBatch, Response, Slot, Slots, Want,
};

/// A law that is linear in its moduli, `W(F; theta) = sum_k theta_k W_k(F)`.
pub trait LinearInModuli: ConvexDensity + Clone + 'static {
    /// Names and values of the moduli theta, Pa.
    fn own(&self) -> Vec<(&'static str, Field<f64>)>;

    /// The law with these moduli, the same everywhere and not checked.
    fn with_moduli(&self, theta: &[f64]) -> Self;
}

/// A law with its moduli theta as slots of the role [`Role::Design`](crate::Role): what identification, stiffness maps and layout have as
/// unknowns, for the whole, by region or by cell.
///
/// **Energy.** `W(F; theta) = sum_k theta_k W_k(F)`, that of the law.
///
/// **Derivatives.** `dP/dtheta_k = P_k(F)` and `d2P/dtheta_k dF : A = dP_k/dF : A` by the laws W_k, which are the law with the unit
/// vectors for moduli; `d2P/dtheta2 = 0`.
///
/// **Convexity.** Where theta fulfils the conditions of the law. Nothing here checks it: a problem's bounds do.
#[derive(Clone, Debug)]
pub struct Parametrised<L> {
    law: L,
    slots: Vec<Slot>,
    own: Vec<Field<f64>>,
    /// W_k
    units: Vec<L>,
}

impl<L: LinearInModuli> Parametrised<L> {
    /// Of a law, whose moduli hold where nobody gives others.
    pub fn new(law: L) -> Self {
        let (names, own): (Vec<&'static str>, Vec<Field<f64>>) = law.own().into_iter().unzip();
        let first = |field: &Field<f64>| field.entries().next().map_or(0.0, |(_, value)| value);
        let slots: Vec<Slot> = names.iter().zip(&own).map(|(name, own)| Slot::design(name, "Pa", first(own))).collect();
        let unit =
            |k: usize| law.with_moduli(&(0..slots.len()).map(|l| f64::from(u8::from(l == k))).collect::<Vec<_>>());
        let units = (0..slots.len()).map(unit).collect();
        Parametrised { law, slots, own, units }
    }

    /// The law of every point; that of the law itself where nothing gives others.
    fn by_point(&self, at: &PointBatch, m: Slots, mut each: impl FnMut(usize, &L)) {
        for q in 0..at.len() {
            match m.width {
                0 => each(q, &self.law),
                _ => each(q, &self.law.with_moduli(m.only(q).values)),
            }
        }
    }

    /// Sets `out[q * width + k]` from what the laws W_k add at all points of the cell.
    fn by_modulus(&self, out: &mut [Mat3], add: impl Fn(&L, &mut [Mat3])) {
        let width = self.units.len();
        let mut of_unit = vec![Mat3::zeros(); out.len() / width];
        for (k, unit) in self.units.iter().enumerate() {
            of_unit.fill(Mat3::zeros());
            add(unit, &mut of_unit);
            out.iter_mut().skip(k).step_by(width).zip(&of_unit).for_each(|(out, own)| *out = *own);
        }
    }
}

/// The entry of a point, where there are any.
fn only<T>(values: &mut [T], q: usize) -> &mut [T] {
    if values.is_empty() { values } else { &mut values[q..=q] }
}

impl<L: LinearInModuli> EnergyTerm for Parametrised<L> {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        self.by_point(at, m, |q, law| {
            let (energy, stress, tangent) = (only(out.energy, q), only(out.stress, q), only(out.tangent, q));
            law.respond(&at.only(q), Slots::none(), want, &mut Response { energy, stress, tangent });
        });
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        self.by_point(at, m, |q, law| {
            law.stress_change(&at.only(q), Slots::none(), &change[q..=q], &mut out[q..=q]);
        });
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        [a, b]: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let mut outcome = Ok(());
        self.by_point(at, m, |q, law| {
            let changes = [&a[q..=q], &b[q..=q]];
            let own = law.second_stress_change(&at.only(q), Slots::none(), changes, &mut out[q..=q]);
            outcome = std::mem::replace(&mut outcome, Ok(())).and(own);
        });
        outcome
    }

    fn slots(&self) -> &[Slot] {
        &self.slots
    }

    fn stress_by_control(&self, at: &PointBatch, _m: Slots, out: &mut [Mat3]) {
        self.by_modulus(out, |unit, stress| {
            let mut response = Response { energy: &mut [], stress, tangent: &mut [] };
            unit.respond(at, Slots::none(), Want::STRESS, &mut response);
        });
    }

    fn control_stress_change(
        &self,
        at: &PointBatch,
        _m: Slots,
        change: &[Mat3],
        _v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        self.by_modulus(out, |unit, stress| unit.stress_change(at, Slots::none(), change, stress));
        Ok(())
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        self.own[slot].at(at)
    }

    fn check_domain(&self, at: &PointBatch, _: Slots) -> Result<(), Outside> {
        // what a law that is linear in its moduli bounds does not depend on them
        self.law.check_domain(at, Slots::none())
    }

    forward_statements!(self, self.law);
}
