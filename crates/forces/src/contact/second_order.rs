//! Second derivatives of a contact without friction.
//!
//! With `Psi(x) = psi(d(x))`, `n = grad d`, `G = psi' n`, `Q = psi'' n n^T + psi' H` and its change `Q'[v]`, at a sample with the arm y, for a direction a
//! (lambda there) and a turn omega of the obstacle: `lambda . r` changes by the place as `Q a`, by the translation as `-Q a` and by omega as
//! `m = -a x G - y x Q a`. Along a change of the place dx, a translation and a turn,
//!
//! ```text
//! z = dx - dtau - omega x y        dG = omega x G + Q z
//! d(Q a) = omega x Q a + Q'[z] a - Q (omega x a)
//! dm = -a x dG - (dx - dtau) x Q a - y x d(Q a)
//! ```

use super::bound::STIFFNESS;
use super::point::{Touch, TouchPoint};
use crate::rigid_motion::{each_slot, vectors};
use nastic_body::contribution::Contribution;
use nastic_body::contribution::sensitivities::{Increment, SecondSensitivities};
use nastic_body::controls::Controls;
use nastic_body::error::SecondDerivativeError;
use nastic_body::instant::Instant;
use nastic_tensor::{Mat3, Vec3};

/// Derivatives of `Psi` at a touching sample.
struct Potential<'t> {
    touch: &'t Touch,
    /// `psi'`, `psi''`, `psi'''`
    psi: [f64; 3],
    n: Vec3,
    h: Mat3,
    q: Mat3,
}

impl<'t> Potential<'t> {
    fn at(point: &TouchPoint, touch: &'t Touch, at: &Instant) -> Self {
        let p = point.of.law.at(touch.distance.value, point.of.thickness);
        let k = at.control(STIFFNESS);
        let psi = [-k * p.value, -k * p.slope, -k * p.second];
        let (n, h) = (Vec3::from(touch.distance.gradient), touch.distance.hessian());
        Potential { touch, psi, n, h, q: psi[1] * n * n.transpose() + psi[0] * h }
    }

    fn gradient(&self) -> Vec3 {
        self.psi[0] * self.n
    }

    /// `Q'[v] a`
    fn third(&self, v: &Vec3, a: &Vec3) -> Vec3 {
        let (hv, ha) = (self.h * v, self.h * a);
        let (nv, na) = (self.n.dot(v), self.n.dot(a));
        let bent = Vec3::from(self.touch.distance.third((*v).into(), (*a).into()));
        self.psi[2] * nv * na * self.n + self.psi[1] * (na * hv + nv * ha + a.dot(&hv) * self.n) + self.psi[0] * bent
    }
}

fn refuse(point: &TouchPoint, method: &'static str) -> Result<(), SecondDerivativeError> {
    match point.of.slip_speed {
        None => Ok(()),
        Some(_) => Err(SecondDerivativeError::Contribution { name: point.of.name().to_owned(), method }),
    }
}

/// A change of the controls: of the translation, the turn, the rotation vector and the stiffness, relative.
fn motion_along(
    point: &TouchPoint,
    at: &Instant,
    v: &Controls,
) -> Result<(Vec3, Vec3, Vec3, f64), SecondDerivativeError> {
    let pose = &point.gaps(at)?.pose;
    let [translation, dtheta] = vectors(at, v);
    Ok((translation, pose.turn_along(&dtheta), dtheta, at.slot_of(v, STIFFNESS) / at.control(STIFFNESS)))
}

pub(super) fn add_control_product(
    point: &TouchPoint,
    at: &Instant,
    v: &Controls,
    out: &mut [f64],
) -> Result<(), SecondDerivativeError> {
    refuse(point, "add_control_product")?;
    let (dtau, omega, _, stiffer) = motion_along(point, at, v)?;
    let gaps = point.gaps(at)?;
    for touch in &gaps.touches {
        let potential = Potential::at(point, touch, at);
        let g = potential.gradient();
        let change = omega.cross(&g) - potential.q * (dtau + omega.cross(&gaps.pose.arm(&touch.place))) + stiffer * g;
        point.of.spread(touch.sample, &(point.of.samples.weights[touch.sample] * change), out);
    }
    Ok(())
}

pub(super) fn second_vjp(
    point: &TouchPoint,
    at: &Instant,
    lambda: &[f64],
    along: &Increment,
    into: &mut SecondSensitivities,
) -> Result<(), SecondDerivativeError> {
    refuse(point, "second_vjp")?;
    let (of, gaps) = (point.of, point.gaps(at)?);
    let (dtau, omega, dtheta, stiffer) = motion_along(point, at, along.controls)?;
    let (mut by_translation, mut m, mut dm, mut by_stiffness) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros(), 0.0);
    for touch in &gaps.touches {
        let potential = Potential::at(point, touch, at);
        let weight = of.samples.weights[touch.sample];
        let a = weight * of.samples.of(touch.sample, of.dim, |dof| lambda[dof]);
        let dx = of.samples.of(touch.sample, of.dim, |dof| along.u[dof]);
        let (y, g, qa) = (gaps.pose.arm(&touch.place), potential.gradient(), potential.q * a);
        let z = dx - dtau - omega.cross(&y);
        let dg = omega.cross(&g) + potential.q * z + stiffer * g;
        let dqa = omega.cross(&qa) + potential.third(&z, &a) - potential.q * omega.cross(&a) + stiffer * qa;
        of.spread(touch.sample, &dqa, &mut into.u);
        by_translation -= dqa;
        m -= a.cross(&g) + y.cross(&qa);
        dm -= a.cross(&dg) + (dx - dtau).cross(&qa) + y.cross(&dqa);
        // a . G / k, which is linear in k
        by_stiffness += a.dot(&(dg - stiffer * g)) / at.control(STIFFNESS);
    }
    let by_rotation = gaps.pose.rotation_change(&m, &dm, &dtheta);
    each_slot(of.dim, by_translation, by_rotation, |slot, value| into.add_control(at, slot, value));
    into.add_control(at, STIFFNESS, by_stiffness);
    Ok(())
}
