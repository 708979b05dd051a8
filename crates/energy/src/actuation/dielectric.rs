//! Dielectric elastomers in a prescribed electric field.

use nastic_tensor::{Mat3, Vec3};

use super::point_quantity::PointQuantity;
use crate::polyconvex::{Block, Change, Conjugates, ConvexDensity, Curvature};
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want, combine};

/// Permittivity of the vacuum in SI units, F/m.
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// An ideal dielectric elastomer between compliant electrodes, in a prescribed nominal electric field `E e`.
///
/// **Energy.** `-(eps/2) J |F^-T E e|^2 = -(eps/2) E^2 |H e|^2 / J`, added to the passive energy: electric enthalpy at a held
/// voltage. The nominal field `E` is the voltage between the electrodes over their distance in the reference body, `e` the
/// unit normal of the film there; the sign of `E` makes no difference.
///
/// **Stress and tangent.** With `w = |H e|^2 / J` and its partial derivatives `w_H = (2/J) H e (x) e`, `w_J = -|H e|^2 / J^2`:
/// `P = -(eps/2) E^2 (w_H x F + w_J H)`, in the deformed body the Maxwell stress `eps (E_t (x) E_t - |E_t|^2 1 / 2)` of the true field
/// `E_t = E F^-T e`. The tangent and third derivatives follow from the chain rule of [`ConvexDensity`]; `P` is quadratic in `E`.
///
/// **Convexity.** Not polyconvex, and without a lower bound as `J -> 0`: theorems on the existence of minimisers do not
/// cover it. A film loses its stability beyond a critical field (pull-in).
///
/// **Parameters.** `eps > 0`, permittivity, F/m; `e`, unit vectors of the reference body, uniform or a [`Field`]; breakdown
/// strength, V/m, if known: the largest true field `|E_t|` the film bears, which is reported and changes no state. Control
/// `field`, V/m.
///
/// **Source.** Z. Suo, X. Zhao, W. H. Greene, *A nonlinear field theory of deformable dielectrics*, J. Mech. Phys. Solids 56 (2008);
/// pull-in: X. Zhao & Z. Suo, Appl. Phys. Lett. 91 (2007).
#[derive(Clone, Debug)]
pub struct Dielectric {
    permittivity: Field<f64>,
    direction: Field<Vec3>,
    breakdown: Option<Field<f64>>,
}

impl Dielectric {
    /// Name in case files and messages.
    pub const NAME: &str = "dielectric";
    const SLOTS: [Slot; 1] = [Slot::scalar("field", "V/m")];
    /// `|E_t|`.
    pub const TRUE_FIELD: PointQuantity = PointQuantity { name: "true_field", unit: "V/m" };

    /// A film of permittivity `eps` (F/m) whose electrodes are across `e`.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `eps` is positive and finite; [`EnergyError::Direction`] unless `|e| = 1` to 1e-6.
    pub fn new(permittivity: impl Into<Field<f64>>, direction: impl Into<Field<Vec3>>) -> Result<Self, EnergyError> {
        let permittivity = permittivity.into();
        permittivity.require_positive(Self::NAME, "permittivity")?;
        let direction = direction.into().unit_directions(Self::NAME, "direction")?;
        Ok(Dielectric { permittivity, direction, breakdown: None })
    }

    /// The same film by its relative permittivity; `eps0` is [`VACUUM_PERMITTIVITY`] in SI units and to be given in any other
    /// system.
    ///
    /// # Errors
    /// As [`new`](Self::new), of either number.
    pub fn from_relative(
        relative: impl Into<Field<f64>>,
        eps0: impl Into<Field<f64>>,
        direction: impl Into<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        let (relative, eps0) = (relative.into(), eps0.into());
        relative.require_positive(Self::NAME, "relative_permittivity")?;
        eps0.require_positive(Self::NAME, "eps0")?;
        let [eps] =
            combine(Self::NAME, [("relative_permittivity", &relative), ("eps0", &eps0)], |_, [relative, eps0]| {
                Ok([relative * eps0])
            })?;
        Self::new(eps, direction)
    }

    /// With a breakdown strength, V/m.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless it is positive and finite.
    pub fn with_breakdown(self, strength: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let strength = strength.into();
        strength.require_positive(Self::NAME, "breakdown")?;
        Ok(Dielectric { breakdown: Some(strength), ..self })
    }

    /// The energy of the `q`-th point with `factor` in the place of `E^2`.
    fn attraction(&self, at: &PointBatch, q: usize, factor: f64) -> Attraction {
        let place = at.place(q);
        Attraction { half: -0.5 * self.permittivity.at(place) * factor, direction: self.direction.at(place) }
    }
}

impl EnergyTerm for Dielectric {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        for q in 0..at.len() {
            let mut own = Response {
                energy: if want.energy { &mut out.energy[q..=q] } else { &mut [] },
                stress: if want.stress { &mut out.stress[q..=q] } else { &mut [] },
                tangent: if want.tangent { &mut out.tangent[q..=q] } else { &mut [] },
            };
            self.attraction(at, q, m.get(q, 0).powi(2)).respond(&at.only(q), Slots::none(), want, &mut own);
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for q in 0..at.len() {
            let attraction = self.attraction(at, q, m.get(q, 0).powi(2));
            attraction.stress_change(&at.only(q), Slots::none(), &change[q..=q], &mut out[q..=q]);
        }
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        [a, b]: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        (0..at.len()).try_for_each(|q| {
            let attraction = self.attraction(at, q, m.get(q, 0).powi(2));
            attraction.second_stress_change(&at.only(q), Slots::none(), [&a[q..=q], &b[q..=q]], &mut out[q..=q])
        })
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.permittivity.check_len(Self::NAME, "permittivity", cells, points)?;
        self.direction.check_len(Self::NAME, "direction", cells, points)?;
        self.breakdown.as_ref().map_or(Ok(()), |field| field.check_len(Self::NAME, "breakdown", cells, points))
    }

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        for (q, out) in out.iter_mut().enumerate() {
            *out = self.attraction(at, q, 2.0 * m.get(q, 0)).stress(&at.only(q));
        }
    }

    /// `d2P/dE dF : A + d2P/dE2 v`, with `2 E` and `2 v` in the place of `E^2`.
    fn control_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        change: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        for (q, out) in out.iter_mut().enumerate() {
            *out = self.attraction(at, q, 2.0 * v.get(q, 0)).stress(&at.only(q));
            let attraction = self.attraction(at, q, 2.0 * m.get(q, 0));
            attraction.stress_change(&at.only(q), Slots::none(), &change[q..=q], std::slice::from_mut(out));
        }
        Ok(())
    }

    fn point_quantity(&self) -> Option<PointQuantity> {
        Some(Self::TRUE_FIELD)
    }

    /// `|E F^-T e| = |E| |H e| / J`.
    fn point_values(&self, at: &PointBatch, m: Slots, out: &mut [f64]) {
        for (q, (k, out)) in at.kinematics.iter().zip(out).enumerate() {
            *out = m.get(q, 0).abs() * (k.h() * self.direction.at(at.place(q))).norm() / k.j();
        }
    }

    fn point_limit(&self, at: MaterialPoint) -> Option<f64> {
        self.breakdown.as_ref().map(|field| field.at(at))
    }
}

/// `half |H e|^2 / J` at one point: the electric energy as a function of `H` and `J`, with `half = -(eps/2) E^2`. It is concave
/// in them; the chain rule asks for no convexity.
#[derive(Debug)]
struct Attraction {
    half: f64,
    direction: Vec3,
}

impl Attraction {
    /// `P` of a single point.
    fn stress(&self, at: &PointBatch) -> Mat3 {
        let mut stress = [Mat3::zeros()];
        let mut out = Response { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        self.respond(at, Slots::none(), Want::STRESS, &mut out);
        stress[0]
    }
}

impl ConvexDensity for Attraction {
    fn value(&self, _: MaterialPoint, _: &Mat3, h: &Mat3, j: f64) -> f64 {
        self.half * (h * self.direction).norm_squared() / j
    }

    fn first(&self, _: MaterialPoint, _: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let he = h * self.direction;
        let by_h = he * self.direction.transpose() * (2.0 * self.half / j);
        Conjugates { f: Mat3::zeros(), h: by_h, j: -self.half * he.norm_squared() / (j * j) }
    }

    fn second(&self, _: MaterialPoint, _: &Mat3, h: &Mat3, j: f64) -> Curvature {
        let he = h * self.direction;
        let along = self.direction * self.direction.transpose();
        let hh = Block::Metric(along * (2.0 * self.half / j));
        let jj = 2.0 * self.half * he.norm_squared() / j.powi(3);
        let hj = he * self.direction.transpose() * (-2.0 * self.half / (j * j));
        Curvature { hj: Some(hj), ..Curvature::split(Block::Zero, hh, jj) }
    }

    fn third(
        &self,
        _: MaterialPoint,
        _: &Mat3,
        h: &Mat3,
        j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let [he, ae, be] = [h, &a.h, &b.h].map(|m| m * self.direction);
        let by_h = (ae * b.j + be * a.j) * (-2.0 / (j * j)) + he * (4.0 * a.j * b.j / j.powi(3));
        let by_j = -2.0 * ae.dot(&be) / (j * j) + 4.0 * (he.dot(&ae) * b.j + he.dot(&be) * a.j) / j.powi(3)
            - 6.0 * he.norm_squared() * a.j * b.j / j.powi(4);
        Ok(Conjugates { f: Mat3::zeros(), h: by_h * self.direction.transpose() * self.half, j: self.half * by_j })
    }
}
