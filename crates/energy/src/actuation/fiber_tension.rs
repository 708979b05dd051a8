use std::sync::Arc;

use nastic_tensor::{Mat3, Vec3};

use crate::director::{Director, dyad_change, second_dyad_change, vector, with_direction};
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, Outside, PointBatch, Response, Slot, Slots, Want};

/// Tension of a fibre family along unit vectors `a(X)`.
///
/// **Energy.** `-(m/2) |F a|^2`, added to the passive energy; `m > 0` lengthens the fibre, `m < 0` contracts it. As a
/// [`muscle`](Self::muscle) its control is the contraction `c = -m`, energy `(c/2) |F a|^2`: positive pulls.
///
/// **Stress and tangent.** `P = -m F a (x) a`, `dP_iJ/dF_kL = -m delta_ik a_J a_L`, `dP/dm = -F a (x) a`;
/// `d2P/dF2 = 0`, `d2P/dm dF : A = -A a (x) a`.
///
/// **Convexity.** Convex in `F` for `m <= 0`. A positive tension is covered by the passive law up to its
/// [`fiber_limit`](EnergyTerm::fiber_limit); there is no lower bound by theory.
///
/// **Parameters.** `a`, unit vectors of the reference body, uniform or a [`Field`]; control `tension`, of a muscle
/// `contraction`, Pa. With [direction slots](EnergyTerm::with_direction_slots) `a = d / |d|` of a control d, a vector of the body:
/// `dP/dd . v = -m F D(a (x) a) v`.
///
/// **Source.** Section 4.1 of "Mathematical modeling, analysis and control in soft robotics", SeMA Journal 2023,
/// doi 10.1007/s40324-023-00334-4. Another published "fibre tension", `-m (|F a| - 1)`, differs by the stretch in the
/// stress.
#[derive(Clone, Debug)]
pub struct FiberTension {
    direction: Director,
    /// The tension m per control: 1, of a muscle -1.
    sense: f64,
}

impl FiberTension {
    /// Name in case files and messages.
    pub const NAME: &str = "fiber_tension";
    /// Name of the fibres whose control is their contraction.
    pub const MUSCLE: &str = "muscle";
    const TENSION: [Slot; 4] = with_direction(Slot::scalar("tension", "Pa"));
    const CONTRACTION: [Slot; 4] = with_direction(Slot::pulling("contraction", "Pa"));

    /// Fibres along the unit vector `a` everywhere.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] unless `|a| = 1` to 1e-6; it offers the unit vector along `a`.
    pub fn along(a: Vec3) -> Result<Self, EnergyError> {
        Self::along_field(a)
    }

    /// Fibres along unit vectors that vary over the body.
    ///
    /// # Errors
    /// [`EnergyError::Direction`] with the first vector that is not a unit vector, and where it is.
    pub fn along_field(a: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        Ok(Self { direction: Director::new(a, Self::NAME)?, sense: 1.0 })
    }

    /// The same fibres with their contraction as the control: positive pulls.
    #[must_use]
    pub fn muscle(self) -> Self {
        Self { sense: -1.0, ..self }
    }

    /// The tension at a point, Pa.
    fn tension(&self, m: Slots, q: usize) -> f64 {
        self.sense * m.get(q, 0)
    }
}

impl EnergyTerm for FiberTension {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let tension = self.tension(m, q);
            let a = self.direction.unit(at.place(q), m, q);
            let fa = k.f() * a;
            if want.energy {
                out.energy[q] -= 0.5 * tension * fa.norm_squared();
            }
            if want.stress {
                out.stress[q] -= fa * (a * tension).transpose();
            }
            if want.tangent {
                out.tangent[q].add_fiber(&a, -tension);
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for (q, (g, out)) in change.iter().zip(out).enumerate() {
            let a = self.direction.unit(at.place(q), m, q);
            *out -= (g * a) * (a * self.tension(m, q)).transpose();
        }
    }

    fn second_stress_change(
        &self,
        _at: &PointBatch,
        _m: Slots,
        _changes: [&[Mat3]; 2],
        _out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        Ok(())
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.direction.check(cells, points)
    }

    fn direction(&self, at: MaterialPoint) -> Option<Vec3> {
        // A contraction needs no bound: the limit is one of tensions.
        self.direction.fixed(at).filter(|_| self.sense > 0.0)
    }

    fn slots(&self) -> &[Slot] {
        let all = if self.sense > 0.0 { &Self::TENSION } else { &Self::CONTRACTION };
        if self.direction.is_slot { all } else { &all[..1] }
    }

    fn rest(&self, at: MaterialPoint, slot: usize) -> f64 {
        self.direction.rest(at, slot)
    }

    fn with_direction_slots(&self) -> Option<Arc<dyn EnergyTerm>> {
        Some(Arc::new(Self { direction: self.direction.as_slots(), sense: self.sense }))
    }

    fn check_domain(&self, at: &PointBatch, m: Slots) -> Result<(), Outside> {
        let is_lost = |q: usize| !vector(m, q).norm_squared().is_normal();
        let lost = (0..at.len()).find(|&q| self.direction.is_slot && is_lost(q));
        let meaning = "a fibre has a direction, a vector that is not zero";
        let outside = |point| Outside {
            law: Self::NAME,
            measure: "1 / |direction|",
            value: f64::INFINITY,
            limit: f64::MAX,
            meaning,
            point,
        };
        lost.map_or(Ok(()), |point| Err(outside(point)))
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let a = self.direction.unit(at.place(q), m, q);
            let out = &mut out[q * m.width..(q + 1) * m.width];
            out[0] = -(k.f() * a) * (a * self.sense).transpose();
            for (component, out) in out.iter_mut().skip(1).enumerate() {
                *out = k.f() * dyad_change(&vector(m, q), &axis(component)) * -self.tension(m, q);
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
        for (q, change) in change.iter().enumerate() {
            let a = self.direction.unit(at.place(q), m, q);
            let out = &mut out[q * m.width..(q + 1) * m.width];
            out[0] = -(change * a) * (a * self.sense).transpose();
            if !self.direction.is_slot {
                continue;
            }
            let (f, d, turn) = (at.kinematics[q].f(), vector(m, q), vector(v, q));
            out[0] -= f * dyad_change(&d, &turn) * self.sense;
            for (component, out) in out.iter_mut().skip(1).enumerate() {
                let first = dyad_change(&d, &axis(component));
                let second = second_dyad_change(&d, &axis(component), &turn);
                let tension = self.tension(m, q);
                *out = -(change * first + f * second) * tension - f * first * self.tension(v, q);
            }
        }
        Ok(())
    }
}

/// A unit vector along an axis.
fn axis(component: usize) -> Vec3 {
    Vec3::ith(component, 1.0)
}
