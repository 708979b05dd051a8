//! Hard-magnetic bodies in an applied field, with the three published choices of what carries the remanence along.

use std::fmt::Debug;
use std::marker::PhantomData;

use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3, cross};

use super::polar::Polar;
use crate::{EnergyError, EnergyTerm, Field, MaterialPoint, PointBatch, Response, Slot, Slots, Want};

/// Vacuum permeability in SI units, N/A^2, which is T^2/Pa.
pub const VACUUM_PERMEABILITY: f64 = 1.25663706e-6;

/// The remanence moves with `F`: right in bending, too strong where the body stretches. The default.
pub type Magnet = Magnetic<Gradient>;
/// The remanence moves with the isochoric part `J^(-1/3) F`.
pub type MagnetIsochoric = Magnetic<Isochoric>;
/// The remanence moves with the rotation `R` of `F = R U`: stretching leaves it alone.
pub type MagnetRotation = Magnetic<Rotation>;

/// A hard-magnetic material with remanence `B_r(X)` in an applied field `B_a`.
///
/// **Energy.** `-(1/mu0) (C B_r) . B_a`, added to the passive energy, with the carrier `C` one of `F` ([`Magnet`]),
/// `J^(-1/3) F` ([`MagnetIsochoric`]) and `R` ([`MagnetRotation`]).
///
/// **Stress and tangent.** For `F`: `P = -(1/mu0) B_a (x) B_r`, `dP/dF = 0`,
/// `dP/dB_r,k = -(1/mu0) B_a (x) e_k`, `dP/dB_a,k = -(1/mu0) e_k (x) B_r`. The other carriers: see [`Isochoric`] and
/// [`Rotation`].
///
/// **Convexity.** For `F` linear, hence polyconvex for every control. The others are not convex in `F`.
///
/// **Parameters.** `mu0`, the vacuum permeability, N/A^2 in SI units and to be given in any other system; controls
/// `remanence` and `field`, vectors, T. The remanence is a vector of the reference body, the field one of space.
///
/// **Source.** R. Zhao, Y. Kim, S. A. Chester, P. Sharma, X. Zhao, *Mechanics of hard-magnetic soft materials*,
/// J. Mech. Phys. Solids 124 (2019); for the rotation, K. Danas & P. M. Reis, *Stretch-independent magnetization in
/// incompressible magnetorheological elastomers* (2024), arXiv:2403.03096.
#[derive(Clone, Debug)]
pub struct Magnetic<C> {
    permeability: Field<f64>,
    carrier: PhantomData<C>,
}

/// What carries the remanence along: a function `C(F)`, used through `phi(F) = C(F) : B` with `B = B_a (x) B_r`.
pub trait Carrier: Debug + Send + Sync {
    /// `phi = C(F) : B`.
    fn value(k: &Kinematics, b: &Mat3) -> f64;

    /// `dphi/dF`, linear in `B`.
    fn first(k: &Kinematics, b: &Mat3) -> Mat3;

    /// `d2phi/dF2 : A`, linear in `B`.
    fn second(k: &Kinematics, b: &Mat3, a: &Mat3) -> Mat3;

    /// `d3phi/dF3 : (A1, A2)`, linear in `B`.
    fn third(k: &Kinematics, b: &Mat3, along: [&Mat3; 2]) -> Mat3;

    /// Adds `s d2phi/dF2`.
    fn add_second(k: &Kinematics, b: &Mat3, s: f64, out: &mut Tangent) {
        out.add(&Tangent::from_map(|a| Self::second(k, b, a) * s));
    }
}

/// `C = F`.
#[derive(Clone, Copy, Debug)]
pub struct Gradient;

/// `C = J^(-1/3) F`: with `g = J^(-1/3)` and `phi = g F : B`,
/// `dphi/dF = g B - phi/(3J) H`, and
/// `d2phi/dF2 = -g/(3J) (B (x) H + H (x) B) + 4 phi/(9 J^2) H (x) H - phi/(3J) X(F)`.
#[derive(Clone, Copy, Debug)]
pub struct Isochoric;

/// `C = R` of `F = R U`: with `G = (tr U) I - U` and `w = G^-1 axial(R^T B)`, `axial(C)_l = eps_ljk C_kj`,
/// `dphi/dF = R [w]`, and along `dF`, with the spin `omega = G^-1 axial(dF^T R)` of `R` and
/// `dU = R^T dF - [omega] U`, `d(R [w]) = R ([omega] [w] + [dw])`,
/// `G dw = -axial([omega] R^T B) - (tr dU) w + dU w`. Third derivatives differentiate these equations once more, along a second
/// change with spin `omega2`: `d(R^T dF) = -[omega2] R^T dF`, `dG v = (tr dU) v - dU v`.
#[derive(Clone, Copy, Debug)]
pub struct Rotation;

impl Carrier for Gradient {
    fn value(k: &Kinematics, b: &Mat3) -> f64 {
        k.f().dot(b)
    }

    fn first(_: &Kinematics, b: &Mat3) -> Mat3 {
        *b
    }

    fn second(_: &Kinematics, _: &Mat3, _: &Mat3) -> Mat3 {
        Mat3::zeros()
    }

    fn third(_: &Kinematics, _: &Mat3, _: [&Mat3; 2]) -> Mat3 {
        Mat3::zeros()
    }

    fn add_second(_: &Kinematics, _: &Mat3, _: f64, _: &mut Tangent) {}
}

impl Carrier for Isochoric {
    fn value(k: &Kinematics, b: &Mat3) -> f64 {
        k.f().dot(b) / k.j().cbrt()
    }

    fn first(k: &Kinematics, b: &Mat3) -> Mat3 {
        b / k.j().cbrt() - k.h() * (Self::value(k, b) / (3.0 * k.j()))
    }

    fn second(k: &Kinematics, b: &Mat3, a: &Mat3) -> Mat3 {
        let [_, g1, g2, _] = Self::factors(k.j());
        let (beta, dj, dbeta) = (k.f().dot(b), k.h().dot(a), a.dot(b));
        b * (g1 * dj) + k.h() * (g1 * dbeta + g2 * dj * beta) + cross(k.f(), a) * (g1 * beta)
    }

    fn third(k: &Kinematics, b: &Mat3, [a1, a2]: [&Mat3; 2]) -> Mat3 {
        let [_, g1, g2, g3] = Self::factors(k.j());
        let (f, h) = (k.f(), k.h());
        let (dh1, dh2) = (cross(f, a1), cross(f, a2));
        let (beta, b1, b2) = (f.dot(b), a1.dot(b), a2.dot(b));
        let (j1, j2, j12) = (h.dot(a1), h.dot(a2), dh2.dot(a1));
        b * (g2 * j1 * j2 + g1 * j12)
            + h * (g3 * j1 * j2 * beta + g2 * (j2 * b1 + j1 * b2 + j12 * beta))
            + dh1 * (g2 * j2 * beta + g1 * b2)
            + dh2 * (g2 * j1 * beta + g1 * b1)
            + cross(a1, a2) * (g1 * beta)
    }

    fn add_second(k: &Kinematics, b: &Mat3, s: f64, out: &mut Tangent) {
        let (j, phi) = (k.j(), Self::value(k, b));
        out.add_outer_symmetric(b, k.h(), -s / (3.0 * j * j.cbrt()));
        out.add_outer(k.h(), k.h(), s * 4.0 * phi / (9.0 * j * j));
        out.add_cross(k.f(), -s * phi / (3.0 * j));
    }
}

impl Carrier for Rotation {
    fn value(k: &Kinematics, b: &Mat3) -> f64 {
        Polar::new(k).r.dot(b)
    }

    fn first(k: &Kinematics, b: &Mat3) -> Mat3 {
        let polar = Polar::new(k);
        polar.r * (polar.compliance * axial(&(polar.r.transpose() * b))).cross_matrix()
    }

    fn second(k: &Kinematics, b: &Mat3, a: &Mat3) -> Mat3 {
        let spinning = Spinning::new(k, b);
        spinning.polar.r * spinning.along(a).image(&spinning.w)
    }

    fn third(k: &Kinematics, b: &Mat3, [a1, a2]: [&Mat3; 2]) -> Mat3 {
        let spinning = Spinning::new(k, b);
        let Spinning { polar: Polar { r, u, compliance }, carried, w } = &spinning;
        let (one, two) = (spinning.along(a1), spinning.along(a2));
        let g = |du: &Mat3, v: &Vec3| v * du.trace() - du * v;
        let turned = two.spin * one.turned;
        let d_spin = (compliance * (-axial(&turned) - g(&two.du, &one.omega))).cross_matrix();
        let ddu = -turned - d_spin * u - one.spin * two.du;
        let d_axial = axial(&(d_spin * carried - one.spin * (two.spin * carried)));
        let ddw = compliance * (-d_axial - g(&ddu, w) - g(&one.du, &two.dw) - g(&two.du, &one.dw));
        let changed = d_spin * w.cross_matrix() + one.spin * two.dw.cross_matrix() + ddw.cross_matrix();
        r * (two.spin * one.image(w) + changed)
    }
}

/// `F`, `B` and what [`Rotation`] makes of them: `C = R^T B` and `w`.
struct Spinning {
    polar: Polar,
    carried: Mat3,
    w: Vec3,
}

/// Changes along a change `A` of `F`: `R^T A`, the spin `omega` as vector and matrix, `dU` and `dw`.
struct SpinChange {
    turned: Mat3,
    omega: Vec3,
    spin: Mat3,
    du: Mat3,
    dw: Vec3,
}

impl Spinning {
    fn new(k: &Kinematics, b: &Mat3) -> Self {
        let polar = Polar::new(k);
        let carried = polar.r.transpose() * b;
        let w = polar.compliance * axial(&carried);
        Spinning { polar, carried, w }
    }

    fn along(&self, a: &Mat3) -> SpinChange {
        let Spinning { polar: Polar { r, u, compliance }, carried, w } = self;
        let turned = r.transpose() * a;
        let omega = compliance * axial(&turned);
        let spin = omega.cross_matrix();
        let du = turned - spin * u;
        let dw = compliance * (du * w - w * du.trace() - axial(&(spin * carried)));
        SpinChange { turned, omega, spin, du, dw }
    }
}

impl SpinChange {
    /// `R^T d(R [w]) = [omega] [w] + [dw]`.
    fn image(&self, w: &Vec3) -> Mat3 {
        self.spin * w.cross_matrix() + self.dw.cross_matrix()
    }
}

impl Isochoric {
    /// `g = J^(-1/3)` and its first three derivatives by `J`.
    fn factors(j: f64) -> [f64; 4] {
        let g = 1.0 / j.cbrt();
        [g, -g / (3.0 * j), 4.0 * g / (9.0 * j * j), -28.0 * g / (27.0 * j * j * j)]
    }
}

/// `axial(C)_l = eps_ljk C_kj`, so that `[v] : C = v . axial(C)`.
fn axial(c: &Mat3) -> Vec3 {
    Vec3::new(c[(2, 1)] - c[(1, 2)], c[(0, 2)] - c[(2, 0)], c[(1, 0)] - c[(0, 1)])
}

impl<C> Magnetic<C> {
    /// Name in case files and messages.
    pub const NAME: &str = "magnet";
    const SLOTS: [Slot; 6] = {
        let ([a, b, c], [d, e, f]) = (Slot::vector("remanence", "T"), Slot::vector("field", "T"));
        [a, b, c, d, e, f]
    };

    /// A magnet in SI units: `mu0` is [`VACUUM_PERMEABILITY`].
    pub fn new() -> Self {
        Magnetic { permeability: Field::Uniform(VACUUM_PERMEABILITY), carrier: PhantomData }
    }

    /// A magnet in another consistent system of units.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `mu0` is positive and finite.
    pub fn with_permeability(mu0: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let permeability = mu0.into();
        permeability.require_positive(Self::NAME, "mu0")?;
        Ok(Magnetic { permeability, carrier: PhantomData })
    }

    fn factor(&self, at: MaterialPoint) -> f64 {
        -1.0 / self.permeability.at(at)
    }
}

impl<C> Default for Magnetic<C> {
    fn default() -> Self {
        Self::new()
    }
}

/// Remanence and field at the `q`-th point.
fn vectors(m: &Slots, q: usize) -> (Vec3, Vec3) {
    let component = |first: usize| Vec3::from_fn(|k, _| m.get(q, first + k));
    (component(0), component(3))
}

impl<C: Carrier> EnergyTerm for Magnetic<C> {
    fn respond(&self, at: &PointBatch, m: Slots, want: Want, out: &mut Response) {
        for (q, k) in at.kinematics.iter().enumerate() {
            let factor = self.factor(at.place(q));
            let (remanence, field) = vectors(&m, q);
            let b = field * remanence.transpose();
            if want.energy {
                out.energy[q] += factor * C::value(k, &b);
            }
            if want.stress {
                out.stress[q] += C::first(k, &b) * factor;
            }
            if want.tangent {
                C::add_second(k, &b, factor, &mut out.tangent[q]);
            }
        }
    }

    fn stress_change(&self, at: &PointBatch, m: Slots, change: &[Mat3], out: &mut [Mat3]) {
        for (q, ((k, change), out)) in at.kinematics.iter().zip(change).zip(out).enumerate() {
            let (remanence, field) = vectors(&m, q);
            *out += C::second(k, &(field * remanence.transpose()), change) * self.factor(at.place(q));
        }
    }

    fn second_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        [a, b]: [&[Mat3]; 2],
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        for (q, (k, out)) in at.kinematics.iter().zip(out).enumerate() {
            let (remanence, field) = vectors(&m, q);
            *out += C::third(k, &(field * remanence.transpose()), [&a[q], &b[q]]) * self.factor(at.place(q));
        }
        Ok(())
    }

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.permeability.check_len(Self::NAME, "mu0", cells, points)
    }

    fn slots(&self) -> &[Slot] {
        &Self::SLOTS
    }

    fn stress_by_control(&self, at: &PointBatch, m: Slots, out: &mut [Mat3]) {
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        for (q, k) in at.kinematics.iter().enumerate() {
            let factor = self.factor(at.place(q));
            let (remanence, field) = vectors(&m, q);
            for (n, axis) in axes.iter().enumerate() {
                out[6 * q + n] = C::first(k, &(field * axis.transpose())) * factor;
                out[6 * q + 3 + n] = C::first(k, &(axis * remanence.transpose())) * factor;
            }
        }
    }

    /// The energy is bilinear in the two vectors: `d2P/dB_r,k dB_a : v = dP/dB_r,k` at the field `v`, and the other way round.
    fn control_stress_change(
        &self,
        at: &PointBatch,
        m: Slots,
        change: &[Mat3],
        v: Slots,
        out: &mut [Mat3],
    ) -> Result<(), EnergyError> {
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        for (q, (k, change)) in at.kinematics.iter().zip(change).enumerate() {
            let factor = self.factor(at.place(q));
            let (remanence, field) = vectors(&m, q);
            let (d_remanence, d_field) = vectors(&v, q);
            let along = |b: &Mat3, db: &Mat3| (C::second(k, b, change) + C::first(k, db)) * factor;
            for (n, axis) in axes.iter().enumerate() {
                out[6 * q + n] = along(&(field * axis.transpose()), &(d_field * axis.transpose()));
                out[6 * q + 3 + n] = along(&(axis * remanence.transpose()), &(axis * d_remanence.transpose()));
            }
        }
        Ok(())
    }

    fn turn(&self, q: &Mat3, m: &mut [f64]) {
        let turned = q * Vec3::new(m[3], m[4], m[5]);
        m[3..6].copy_from_slice(turned.as_slice());
    }
}
