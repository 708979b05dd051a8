use std::sync::Arc;

use nastic_tensor::{Mat3, Vec3};

use crate::{EnergyError, EnergyTerm, Moduli, Place, PointBatch, Response, Slots, Want};

/// Several passive terms in one body region: energies, stresses and tangents add.
///
/// ```
/// # use nastic_energy::{EnergyTerm, MooneyRivlin, NeoHooke, Place, Sum};
/// # use nastic_tensor::Vec3;
/// # fn main() -> Result<(), nastic_energy::EnergyError> {
/// let blend = Sum::of(MooneyRivlin::new(1e5, 2e4, 1e6)?).plus(NeoHooke::new(5e4, 0.0)?);
/// // Tension limits of polyconvex parts add up to one of the sum: 2e5 + 5e4.
/// assert_eq!(blend.fiber_limit(Place { cell: 0, point: 0 }, &Vec3::x()), Some(2.5e5));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct Sum {
    terms: Vec<Arc<dyn EnergyTerm>>,
}

impl Sum {
    /// A sum of one term.
    pub fn of(term: impl EnergyTerm + 'static) -> Self {
        Sum { terms: vec![Arc::new(term)] }
    }

    /// The sum with one more term.
    #[must_use]
    pub fn plus(mut self, term: impl EnergyTerm + 'static) -> Self {
        self.terms.push(Arc::new(term));
        self
    }

    /// The terms, in order.
    pub fn terms(&self) -> &[Arc<dyn EnergyTerm>] {
        &self.terms
    }
}

impl EnergyTerm for Sum {
    fn respond(&self, at: &PointBatch, _m: Slots, want: Want, out: &mut Response) {
        for term in &self.terms {
            term.respond(at, Slots::none(), want, out);
        }
    }

    fn stress_change(&self, at: &PointBatch, _m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for term in &self.terms {
            term.stress_change(at, Slots::none(), change, out);
        }
    }

    /// The sum of the limits, which is sufficient; none unless every term has one.
    fn fiber_limit(&self, at: Place, a: &Vec3) -> Option<f64> {
        if self.terms.is_empty() {
            return None;
        }
        self.terms.iter().map(|term| term.fiber_limit(at, a)).sum()
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.terms.iter().try_for_each(|term| term.check(cells, points))
    }

    /// That of the first term that has one.
    fn direction(&self, at: Place) -> Option<Vec3> {
        self.terms.iter().find_map(|term| term.direction(at))
    }

    /// The sum of the moduli, where every term knows its own and at most one fibre direction is among them.
    fn moduli(&self, at: Place) -> Option<Moduli> {
        let mut parts = self.terms.iter().map(|term| term.moduli(at));
        let mut sum = parts.next()??;
        for part in parts {
            let part = part?;
            if sum.fiber.is_some() && part.fiber.is_some() && sum.fiber != part.fiber {
                return None;
            }
            sum = Moduli {
                lambda: sum.lambda + part.lambda,
                mu_t: sum.mu_t + part.mu_t,
                mu_l: sum.mu_l + part.mu_l,
                alpha: sum.alpha + part.alpha,
                beta: sum.beta + part.beta,
                fiber: sum.fiber.or(part.fiber),
            };
        }
        Some(sum)
    }
}
