use nastic_tensor::Mat3;

use super::engineering::{check_rubber, shear_bulk};
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, TensionBound, combine,
};

/// Neo-Hookean law split into isochoric and volumetric parts, the law of many published benchmarks.
///
/// **Energy.** `W = mu/2 (J^(-2/3) |F|^2 - 3) + kappa/4 (J^2 - 1 - 2 log J)`
///
/// **Stress and tangent.** With `g = J^(-2/3)`: `S_F = mu g F`, `S_H = 0`,
/// `S_J = -mu g |F|^2 / (3 J) + kappa/2 (J - 1/J)`; `W_FF = mu g I`, `W_FJ = -2 mu g F / (3 J)`,
/// `W_JJ = 5 mu g |F|^2 / (9 J^2) + kappa/2 (1 + 1/J^2)`; `W_FFJ = -2 mu g I / (3 J)`, `W_FJJ = 10 mu g F / (9 J^2)`,
/// `W_JJJ = -40 mu g |F|^2 / (27 J^3) - kappa / J^3`; `P` and `dP/dF` by the chain rule of [`ConvexDensity`].
/// Small strain: shear modulus `mu`, bulk modulus `kappa`.
///
/// **Convexity.** Polyconvex for `mu > 0`, `kappa > 0`, which are required; `W -> inf` as `J -> 0`. No positive fibre
/// tension keeps it polyconvex, since `W_FF` fades as `J` grows.
///
/// **Parameters.** `mu`, `kappa` in Pa, each a [`Field`]; or [`from_young_poisson`](Self::from_young_poisson),
/// [`from_c10_d1`](Self::from_c10_d1).
///
/// **Source.** J. C. Simo & T. J. R. Hughes, *Computational Inelasticity* (1998), section 9.2.
#[derive(Clone, Debug)]
pub struct NeoHookeIsochoric {
    mu: Field<f64>,
    kappa: Field<f64>,
}

impl NeoHookeIsochoric {
    /// Name in case files and messages.
    pub const NAME: &str = "neo_hooke_isochoric";

    /// From shear and bulk modulus (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless both are positive and finite.
    pub fn new(mu: impl Into<Field<f64>>, kappa: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        Self::named(["mu", "kappa"], mu.into(), kappa.into())
    }

    /// The same as [`new`](Self::new), under the name other laws use.
    ///
    /// # Errors
    /// As there.
    pub fn from_shear_bulk(shear: impl Into<Field<f64>>, bulk: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        Self::named(["shear", "bulk"], shear.into(), bulk.into())
    }

    /// From the coefficients C10 (Pa) and D1 (1/Pa) of `C10 (I1' - 3) + (J-1)^2 / D1`: `mu = 2 C10`, `kappa = 2 / D1`. The isochoric
    /// part is the same; the volumetric ones agree to second order in `J - 1`.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless both are positive and finite.
    pub fn from_c10_d1(c10: impl Into<Field<f64>>, d1: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (c10, d1) = (c10.into(), d1.into());
        check_rubber(Self::NAME, &c10, None, &d1)?;
        let [mu, kappa] = combine(Self::NAME, [("c10", &c10), ("d1", &d1)], |_, [c10, d1]| Ok([2.0 * c10, 2.0 / d1]))?;
        Self::new(mu, kappa)
    }

    /// From Young's modulus (Pa) and Poisson's ratio.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `E > 0` and `-1 < nu < 1/2`.
    pub fn from_young_poisson(
        young: impl Into<Field<f64>>,
        poisson: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let [shear, bulk] = shear_bulk(Self::NAME, &young.into(), &poisson.into())?;
        Self::from_shear_bulk(shear, bulk)
    }

    fn named(names: [&'static str; 2], mu: Field<f64>, kappa: Field<f64>) -> Result<Self, EnergyError> {
        mu.require_positive(Self::NAME, names[0])?;
        kappa.require_positive(Self::NAME, names[1])?;
        Ok(Self { mu, kappa })
    }
}

/// `J^(-2/3)`.
#[inline(always)]
fn isochoric(j: f64) -> f64 {
    let root = j.cbrt();
    1.0 / (root * root)
}

impl ConvexDensity for NeoHookeIsochoric {
    #[inline]
    fn value(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> f64 {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        0.5 * mu * (isochoric(j) * f.norm_squared() - 3.0) + 0.25 * kappa * (j * j - 1.0 - 2.0 * j.ln())
    }

    #[inline]
    fn first(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Conjugates {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        let scaled = mu * isochoric(j);
        let volumetric = 0.5 * kappa * (j - 1.0 / j);
        Conjugates { f: f * scaled, h: Mat3::zeros(), j: volumetric - scaled * f.norm_squared() / (3.0 * j) }
    }

    #[inline]
    fn second(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        let scaled = mu * isochoric(j);
        let square = j * j;
        let jj = 5.0 / 9.0 * scaled * f.norm_squared() / square + 0.5 * kappa * (1.0 + 1.0 / square);
        let fj = Some(f * (-2.0 / 3.0 * scaled / j));
        Curvature { fj, ..Curvature::split(Block::Isotropic(scaled), Block::Zero, jj) }
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        _h: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let [a, b] = along;
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        let scaled = mu * isochoric(j);
        let (ffj, fjj) = (-2.0 / 3.0 * scaled / j, 10.0 / 9.0 * scaled / (j * j));
        let jjj = -(40.0 / 27.0 * scaled * f.norm_squared() + kappa) / (j * j * j);
        Ok(Conjugates {
            f: (a.f * b.j + b.f * a.j) * ffj + f * (fjj * a.j * b.j),
            h: Mat3::zeros(),
            j: ffj * a.f.dot(&b.f) + fjj * (f.dot(&a.f) * b.j + f.dot(&b.f) * a.j) + jjj * a.j * b.j,
        })
    }

    fn conditions(&self, _at: MaterialPoint) -> Option<Existence> {
        Some(Existence { polyconvex: true, resists_collapse: true, growth: Growth::isochoric(1.0) })
    }

    fn tension_bound(&self, _at: MaterialPoint) -> Option<TensionBound> {
        Some(TensionBound::isotropic(0.0))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu.check_len(Self::NAME, "mu", cells, points)?;
        self.kappa.check_len(Self::NAME, "kappa", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let (mu, kappa) = (self.mu.at(at), self.kappa.at(at));
        Some(Moduli::isotropic(kappa - 2.0 * mu / 3.0, mu))
    }
}

impl LinearInModuli for NeoHookeIsochoric {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu", self.mu.clone()), ("kappa", self.kappa.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        NeoHookeIsochoric { mu: theta[0].into(), kappa: theta[1].into() }
    }
}
