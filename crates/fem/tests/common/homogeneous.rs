//! Homogeneous deformations by other means: the energies of the catalogue written once more, as functions of F alone,
//! and the stationary points of such functions.

use super::Outcome;
use nalgebra::{DMatrix, DVector};
use nastic_energy::{EnergyTerm, MooneyRivlin, NeoHooke, NeoHookeIsochoric, TransverseMooneyRivlin};
use nastic_tensor::{Mat3, Vec3};
use std::sync::Arc;

pub type Density = Box<dyn Fn(&Mat3) -> f64>;

/// A law, and its energy density as docs/model/materials.md prints it.
pub struct Case {
    pub name: String,
    pub law: Arc<dyn EnergyTerm>,
    pub density: Density,
    pub small: SmallStrain,
}

/// `lambda/2 (tr e)^2 + mu_T e:e + alpha (f.ef) tr e + 2 (mu_L - mu_T) |e f|^2`
#[derive(Clone, Copy)]
pub struct SmallStrain {
    pub lambda: f64,
    pub mu_t: f64,
    pub mu_l: f64,
    pub alpha: f64,
    pub fiber: Vec3,
}

impl SmallStrain {
    pub fn isotropic(lambda: f64, mu: f64) -> Self {
        SmallStrain { lambda, mu_t: mu, mu_l: mu, alpha: 0.0, fiber: Vec3::x() }
    }

    pub fn energy(&self, f: &Mat3) -> f64 {
        let e = (f + f.transpose()) / 2.0 - Mat3::identity();
        let ef = e * self.fiber;
        self.lambda / 2.0 * e.trace().powi(2)
            + self.mu_t * e.norm_squared()
            + self.alpha * self.fiber.dot(&ef) * e.trace()
            + 2.0 * (self.mu_l - self.mu_t) * ef.norm_squared()
    }
}

impl Case {
    pub fn new(
        name: &str,
        law: impl EnergyTerm + 'static,
        small: SmallStrain,
        density: impl Fn(&Mat3) -> f64 + 'static,
    ) -> Self {
        Case { name: name.to_owned(), law: Arc::new(law), density: Box::new(density), small }
    }
}

fn cof(f: &Mat3) -> Mat3 {
    f.try_inverse().map_or(Mat3::from_element(f64::NAN), |i| f.determinant() * i.transpose())
}

/// `mu1 |F|^2 + mu2 |H|^2 + mu3 (J-1)^2 - 2 (mu1 + 2 mu2) log J - 3 (mu1 + mu2)`
pub fn mooney_rivlin([mu1, mu2, mu3]: [f64; 3]) -> Outcome<Case> {
    let law = MooneyRivlin::new(mu1, mu2, mu3)?;
    let small = SmallStrain::isotropic(4.0 * mu2 + 2.0 * mu3, 2.0 * (mu1 + mu2));
    Ok(Case::new("mooney_rivlin", law, small, move |f| {
        let (h, j) = (cof(f), f.determinant());
        mu1 * f.norm_squared() + mu2 * h.norm_squared() + mu3 * (j - 1.0).powi(2)
            - 2.0 * (mu1 + 2.0 * mu2) * j.ln()
            - 3.0 * (mu1 + mu2)
    }))
}

/// The law of section 4.2.1 of the survey, corrected.
pub fn transverse([mu1, mu2, mu3, mu4]: [f64; 4], fiber: Vec3) -> Outcome<Case> {
    let law = TransverseMooneyRivlin::new(mu1, mu2, mu3, mu4, fiber)?;
    let name = format!("transverse_mooney_rivlin, f = ({}, {}, {})", fiber.x, fiber.y, fiber.z);
    let small = SmallStrain {
        lambda: 4.0 * mu2 + 4.0 * mu3 + 2.0 * mu4,
        mu_t: 2.0 * (mu1 + mu2),
        mu_l: 2.0 * (mu1 + mu2 + mu3),
        alpha: -4.0 * mu3,
        fiber,
    };
    Ok(Case::new(&name, law, small, move |f| {
        let (h, j) = (cof(f), f.determinant());
        mu1 * f.norm_squared()
            + mu2 * h.norm_squared()
            + mu3 * ((f * fiber).norm_squared() + (h * fiber).norm_squared())
            + mu4 * (j - 1.0).powi(2)
            - 2.0 * (mu1 + 2.0 * mu2 + mu3) * j.ln()
            - (3.0 * mu1 + 3.0 * mu2 + 2.0 * mu3)
    }))
}

/// `mu/2 (|F|^2 - 3) - mu log J + lambda/2 (J-1)^2`
pub fn neo_hooke(mu: f64, lambda: f64) -> Outcome<Case> {
    Ok(Case::new("neo_hooke", NeoHooke::new(mu, lambda)?, SmallStrain::isotropic(lambda, mu), move |f| {
        let j = f.determinant();
        mu / 2.0 * (f.norm_squared() - 3.0) - mu * j.ln() + lambda / 2.0 * (j - 1.0).powi(2)
    }))
}

/// `mu/2 (J^(-2/3) |F|^2 - 3) + kappa/4 (J^2 - 1 - 2 log J)`
pub fn neo_hooke_isochoric(mu: f64, kappa: f64) -> Outcome<Case> {
    let small = SmallStrain::isotropic(kappa - 2.0 * mu / 3.0, mu);
    Ok(Case::new("neo_hooke_isochoric", NeoHookeIsochoric::new(mu, kappa)?, small, move |f| {
        let j = f.determinant();
        mu / 2.0 * (j.powf(-2.0 / 3.0) * f.norm_squared() - 3.0) + kappa / 4.0 * (j * j - 1.0 - 2.0 * j.ln())
    }))
}

/// Every law of a body, in units of about 1; the fibred one with its fibre along, across and at 45 degrees to x, and in space.
pub fn cases() -> Outcome<Vec<Case>> {
    let mu = [1.0, 0.2, 3.0, 5.0];
    let diagonal = Vec3::new(1.0, 1.0, 0.0).normalize();
    let mut cases = vec![
        mooney_rivlin([1.0, 0.2, 5.0])?,
        neo_hooke(1.5, 4.0)?,
        neo_hooke_isochoric(1.5, 5.0)?,
        transverse(mu, Vec3::x())?,
        transverse(mu, Vec3::y())?,
        transverse(mu, diagonal)?,
        transverse(mu, Vec3::new(0.48, 0.64, 0.6))?,
    ];
    cases.extend(super::rubber::cases()?);
    Ok(cases)
}

/// The upper triangular matrix of three (plane) or six numbers: `F_11, F_22, F_12` (, `F_33, F_13, F_23`).
pub fn upper(p: &[f64]) -> Mat3 {
    match *p {
        [xx, yy, xy] => Mat3::new(xx, xy, 0.0, 0.0, yy, 0.0, 0.0, 0.0, 1.0),
        [xx, yy, xy, zz, xz, yz] => Mat3::new(xx, xy, xz, 0.0, yy, yz, 0.0, 0.0, zz),
        _ => Mat3::from_element(f64::NAN),
    }
}

/// The upper triangular F (plane: with `F_33 = 1`) where the energy is least, found from rest by Newton's method with
/// differences of the energy. Any F is an upper triangular one turned.
pub fn relaxed(dim: usize, energy: impl Fn(&Mat3) -> f64) -> Mat3 {
    let rest: &[f64] = if dim == 2 { &[1.0, 1.0, 0.0] } else { &[1.0, 1.0, 0.0, 1.0, 0.0, 0.0] };
    upper(&minimise(rest, |p| {
        let f = upper(p);
        if f.determinant() > 0.0 { energy(&f) } else { f64::INFINITY }
    }))
}

fn minimise(start: &[f64], energy: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut p = DVector::from_column_slice(start);
    for _ in 0..60 {
        let g = gradient(&p, &energy);
        let mut hessian = DMatrix::from_fn(p.len(), p.len(), |_, _| 0.0);
        for k in 0..p.len() {
            let step = |s: f64| {
                let mut q = p.clone();
                q[k] += s;
                gradient(&q, &energy)
            };
            hessian.set_column(k, &((step(1e-4) - step(-1e-4)) / 2e-4));
        }
        // downhill where the energy is not convex
        let eigen = ((&hessian + hessian.transpose()) / 2.0).symmetric_eigen();
        let along = eigen.eigenvectors.transpose() * &g;
        let along = along.zip_map(&eigen.eigenvalues, |g, h| -g / h.abs().max(1e-6));
        let mut step = &eigen.eigenvectors * along;
        let here = energy(p.as_slice());
        while energy((&p + &step).as_slice()) > here + 1e-12 * (1.0 + here.abs()) {
            step *= 0.5;
        }
        p += &step;
        if step.amax() < 1e-14 {
            break;
        }
    }
    p.as_slice().to_vec()
}

/// Sixth-order differences.
fn gradient(p: &DVector<f64>, energy: &impl Fn(&[f64]) -> f64) -> DVector<f64> {
    const H: f64 = 2e-3;
    DVector::from_fn(p.len(), |k, _| {
        let at = |s: f64| {
            let mut q = p.clone();
            q[k] += s * H;
            energy(q.as_slice())
        };
        let difference = |s| at(s) - at(-s);
        (45.0 * difference(1.0) - 9.0 * difference(2.0) + difference(3.0)) / (60.0 * H)
    })
}
