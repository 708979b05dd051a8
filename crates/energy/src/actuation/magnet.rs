//! Hard-magnetic bodies in an applied field, with the three published choices of what carries the remanence along.

use std::fmt::Debug;
use std::marker::PhantomData;

use nastic_tensor::{Kinematics, Mat3, Tangent, Vec3};

use super::polar::Polar;
use crate::{Actuation, EnergyError, EnergyTerm, Field, Place, PointBatch, Response, Slot, Slots, Want};

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

    /// Adds `s d2phi/dF2`.
    fn add_second(k: &Kinematics, b: &Mat3, s: f64, out: &mut Tangent);
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
/// `G dw = -axial([omega] R^T B) - (tr dU) w + dU w`.
#[derive(Clone, Copy, Debug)]
pub struct Rotation;

impl Carrier for Gradient {
    fn value(k: &Kinematics, b: &Mat3) -> f64 {
        k.f().dot(b)
    }

    fn first(_: &Kinematics, b: &Mat3) -> Mat3 {
        *b
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

    fn add_second(k: &Kinematics, b: &Mat3, s: f64, out: &mut Tangent) {
        let Polar { r, u, compliance } = Polar::new(k);
        let carried = r.transpose() * b;
        let w = compliance * axial(&carried);
        out.add(&Tangent::from_map(|df| {
            let turned = r.transpose() * df;
            let omega = (compliance * axial(&turned)).cross_matrix();
            let du = turned - omega * u;
            let dw = compliance * (du * w - w * du.trace() - axial(&(omega * carried)));
            r * (omega * w.cross_matrix() + dw.cross_matrix()) * s
        }));
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

    fn factor(&self, at: Place) -> f64 {
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

    fn check(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.permeability.check_len(Self::NAME, "mu0", cells, points)
    }
}

impl<C: Carrier> Actuation for Magnetic<C> {
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

    fn turn(&self, q: &Mat3, m: &mut [f64]) {
        let turned = q * Vec3::new(m[3], m[4], m[5]);
        m[3..6].copy_from_slice(turned.as_slice());
    }
}
