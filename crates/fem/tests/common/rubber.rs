//! Laws of rubber and tissue, written once more as functions of F alone: entries of `homogeneous::cases`.

use super::Outcome;
use super::homogeneous::{Case, SmallStrain};
use nastic_energy::{
    Arap, ArrudaBoyce, Field, Gent, Guccione, HolzapfelGasserOgden, Ogden, SaintVenantKirchhoff, Yeoh,
};
use nastic_tensor::{Mat3, Vec3};

const KAPPA: f64 = 5.0;

/// `J^(-2/3) |F|^2`
fn isochoric(f: &Mat3) -> f64 {
    f.determinant().powf(-2.0 / 3.0) * f.norm_squared()
}

/// `kappa/4 (J^2 - 1 - 2 log J)`
fn volumetric(f: &Mat3) -> f64 {
    let j = f.determinant();
    KAPPA / 4.0 * (j * j - 1.0 - 2.0 * j.ln())
}

fn small(mu: f64) -> SmallStrain {
    SmallStrain::isotropic(KAPPA - 2.0 * mu / 3.0, mu)
}

pub fn cases() -> Outcome<Vec<Case>> {
    let rubber = vec![yeoh()?, gent()?, ogden()?, arruda_boyce()?];
    let others = [holzapfel_gasser_ogden()?, guccione()?, saint_venant_kirchhoff()?, arap()?];
    Ok(rubber.into_iter().chain(others).collect())
}

/// `C10 x + C20 x^2 + C30 x^3`
fn yeoh() -> Outcome<Case> {
    let [c10, c20, c30] = [0.75, 0.1, 0.05];
    Ok(Case::new("yeoh", Yeoh::new(c10, c20, c30, KAPPA)?, small(2.0 * c10), move |f| {
        let x = isochoric(f) - 3.0;
        c10 * x + c20 * x.powi(2) + c30 * x.powi(3) + volumetric(f)
    }))
}

/// `-(mu J_m/2) log(1 - x/J_m)`
fn gent() -> Outcome<Case> {
    let [mu, jm] = [1.5, 20.0];
    Ok(Case::new("gent", Gent::new(mu, jm, KAPPA)?, small(mu), move |f| {
        -mu * jm / 2.0 * (1.0 - (isochoric(f) - 3.0) / jm).ln() + volumetric(f)
    }))
}

/// `sum_p mu_p/alpha_p (sum_i l_i^alpha_p - 3)`, `l_i` the singular values of `J^(-1/3) F`
fn ogden() -> Outcome<Case> {
    let terms = [[0.8, 2.5], [-0.3, -4.0]];
    let fields = terms.map(|term| term.map(Field::from)).to_vec();
    let mu = terms.iter().map(|[mu, alpha]| 0.5 * mu * alpha).sum();
    Ok(Case::new("ogden", Ogden::new(fields, KAPPA)?, small(mu), move |f| {
        let stretches = (f / f.determinant().cbrt()).singular_values();
        let term = |[mu, alpha]: &[f64; 2]| mu / alpha * (stretches.map(|l| l.powf(*alpha)).sum() - 3.0);
        terms.iter().map(term).sum::<f64>() + volumetric(f)
    }))
}

/// `mu sum_i c_i lambda_m^(2-2i) (I^i - 3^i)`
fn arruda_boyce() -> Outcome<Case> {
    let [mu, locking] = [1.3, 2.5];
    let n: f64 = locking * locking;
    let rest = 1.0
        + 3.0 / (5.0 * n)
        + 99.0 / (175.0 * n.powi(2))
        + 513.0 / (875.0 * n.powi(3))
        + 42039.0 / (67375.0 * n.powi(4));
    Ok(Case::new("arruda_boyce", ArrudaBoyce::new(mu, locking, KAPPA)?, small(mu * rest), move |f| {
        let c = [1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];
        let i1 = isochoric(f);
        let term = |(k, c): (i32, f64)| c * n.powi(1 - k) * (i1.powi(k) - 3f64.powi(k));
        mu * (1..).zip(c).map(term).sum::<f64>() + volumetric(f)
    }))
}

/// `mu/2 x + sum_k k1/(2 k2) (exp(k2 r(E_k)^2) - 1)`; a wide toe, for differences across its beginning must be exact.
fn holzapfel_gasser_ogden() -> Outcome<Case> {
    let [mu, k1, k2, d, toe] = [1.5, 0.5, 0.8, 0.1, 0.5];
    let families = [Vec3::new(0.8, 0.6, 0.0), Vec3::new(0.8, -0.6, 0.0)];
    let [first, second] = families.map(Field::from);
    let law = HolzapfelGasserOgden::new(
        [mu, KAPPA].map(Field::from),
        [k1, k2, d, toe].map(Field::from),
        first,
        Some(second),
    )?;
    Ok(Case::new("holzapfel_gasser_ogden", law, small(mu), move |f| {
        let i1 = isochoric(f);
        let fibers = |a: &Vec3| {
            let e = d * i1 + (1.0 - 3.0 * d) * (f * a).norm_squared() * f.determinant().powf(-2.0 / 3.0) - 1.0;
            let s = (e / toe).max(0.0);
            let r = if e < toe { toe * (s.powi(6) - 3.0 * s.powi(5) + 2.5 * s.powi(4)) } else { e - toe / 2.0 };
            k1 / (2.0 * k2) * (k2 * r * r).exp_m1()
        };
        mu / 2.0 * (i1 - 3.0) + families.iter().map(fibers).sum::<f64>() + volumetric(f)
    }))
}

/// `c/2 (exp Q - 1)`, `Q = b_f E_11^2 + b_t (E_22^2 + E_33^2 + 2 E_23^2) + 2 b_fs (E_12^2 + E_13^2)`
fn guccione() -> Outcome<Case> {
    let (c, [bf, bt, bfs]) = (6.0, [0.75, 0.25, 0.5]);
    let law = Guccione::new(c, [bf, bt, bfs].map(Field::from), KAPPA, Vec3::x())?;
    let small = SmallStrain { lambda: KAPPA, mu_t: 0.5 * c * bt, mu_l: 0.5 * c * bfs, alpha: 0.0, fiber: Vec3::x() };
    Ok(Case::new("guccione", law, small, move |f| {
        let e = (f.transpose() * f - Mat3::identity()) / 2.0;
        let square = |i: usize, j: usize| e[(i, j)] * e[(i, j)];
        let across = square(1, 1) + square(2, 2) + 2.0 * square(1, 2);
        let q = bf * square(0, 0) + bt * across + 2.0 * bfs * (square(0, 1) + square(0, 2));
        c / 2.0 * q.exp_m1() + volumetric(f)
    }))
}

/// `lambda/2 (tr E)^2 + mu E : E`, `E = (F^T F - 1)/2`
fn saint_venant_kirchhoff() -> Outcome<Case> {
    let [lambda, mu] = [4.0, 3.0];
    let small = SmallStrain::isotropic(lambda, mu);
    Ok(Case::new("saint_venant_kirchhoff", SaintVenantKirchhoff::new(lambda, mu)?, small, move |f| {
        let e = (f.transpose() * f - Mat3::identity()) / 2.0;
        lambda / 2.0 * e.trace().powi(2) + mu * e.norm_squared()
    }))
}

/// `mu sum_i (l_i - 1)^2`
fn arap() -> Outcome<Case> {
    let mu = 8.0;
    Ok(Case::new("arap", Arap::new(mu)?, SmallStrain::isotropic(0.0, mu), move |f| {
        mu * f.singular_values().map(|l| (l - 1.0).powi(2)).sum()
    }))
}
