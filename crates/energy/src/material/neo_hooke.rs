use nastic_tensor::Mat3;

use super::engineering::{check_rubber, shear_bulk};
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, TensionBound, combine,
};

/// Compressible neo-Hookean law, polyconvex form.
///
/// **Energy.** `W = mu/2 (|F|^2 - 3) - mu log J + lambda/2 (J-1)^2`
///
/// **Stress and tangent.** `S_F = mu F`, `S_H = 0`, `S_J = lambda (J-1) - mu / J`; `W_FF = mu I`, `W_HH = 0`,
/// `W_JJ = lambda + mu / J^2`, `W_JJJ = -2 mu / J^3`, no mixed parts; `P` and `dP/dF` by the chain rule of [`ConvexDensity`]. Small strain:
/// the Lame constants `mu` and `lambda` themselves.
///
/// **Convexity.** Polyconvex for `mu > 0`, `lambda >= 0`, which are required; `lambda = 0` is valid and is Poisson's
/// ratio 0. `W -> inf` as `J -> 0`. A fibre tension keeps it polyconvex exactly up to `m = mu`.
///
/// **Parameters.** `mu`, `lambda` in Pa, each a [`Field`]; or [`from_shear_bulk`](Self::from_shear_bulk),
/// [`from_young_poisson`](Self::from_young_poisson), [`from_c10_d1`](Self::from_c10_d1).
///
/// **Source.** A member of the family of P. G. Ciarlet, *Mathematical Elasticity*, vol. I (1988), section 4.10.
#[derive(Clone, Debug)]
pub struct NeoHooke {
    mu: Field<f64>,
    lambda: Field<f64>,
}

impl NeoHooke {
    /// Name in case files and messages.
    pub const NAME: &str = "neo_hooke";

    /// From the Lame constants (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `mu > 0` and `lambda >= 0`, both finite.
    pub fn new(mu: impl Into<Field<f64>>, lambda: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let law = Self { mu: mu.into(), lambda: lambda.into() };
        law.mu.require_positive(Self::NAME, "mu")?;
        law.lambda.require_non_negative(Self::NAME, "lambda")?;
        Ok(law)
    }

    /// From shear and bulk modulus (Pa): `lambda = kappa - 2 mu / 3`.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless both are positive and `kappa >= 2 mu / 3` (Poisson's ratio at least 0).
    pub fn from_shear_bulk(shear: impl Into<Field<f64>>, bulk: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (shear, bulk) = (shear.into(), bulk.into());
        shear.require_positive(Self::NAME, "shear")?;
        bulk.require_positive(Self::NAME, "bulk")?;
        let named = [("shear", &shear), ("bulk", &bulk)];
        let [lambda] = combine(Self::NAME, named, |entry, [mu, kappa]| {
            let (least, value) = (2.0 * mu / 3.0, kappa);
            if value >= least {
                return Ok([kappa - least]);
            }
            let requirement = "it must be at least 2/3 of the shear modulus: take neo_hooke_isochoric below that";
            Err(EnergyError::Parameter { owner: Self::NAME, name: "bulk", value, entry, requirement })
        })?;
        Self::new(shear, lambda)
    }

    /// From the coefficients C10 (Pa) and D1 (1/Pa) of `C10 (I1' - 3) + (J-1)^2 / D1`, by their small-strain moduli: `mu = 2 C10`,
    /// `lambda = 2 / D1 - 4 C10 / 3`. Where `J = 1` both laws have the same energy; elsewhere they differ.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `C10 > 0` and `0 < D1 <= 3 / (2 C10)` (Poisson's ratio at least 0).
    pub fn from_c10_d1(c10: impl Into<Field<f64>>, d1: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (c10, d1) = (c10.into(), d1.into());
        check_rubber(Self::NAME, &c10, None, &d1)?;
        let [mu, lambda] = combine(Self::NAME, [("c10", &c10), ("d1", &d1)], |entry, [c10, d1]| {
            let lambda = 2.0 / d1 - 4.0 * c10 / 3.0;
            if lambda >= 0.0 {
                return Ok([2.0 * c10, lambda]);
            }
            let requirement = "it must be at most 3 / (2 C10): take neo_hooke_isochoric beyond that";
            Err(EnergyError::Parameter { owner: Self::NAME, name: "d1", value: d1, entry, requirement })
        })?;
        Self::new(mu, lambda)
    }

    /// From Young's modulus (Pa) and Poisson's ratio.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `E > 0` and `0 <= nu < 1/2`.
    pub fn from_young_poisson(
        young: impl Into<Field<f64>>,
        poisson: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let (young, poisson) = (young.into(), poisson.into());
        let requirement =
            "it must lie in [0, 1/2): 0.49 is nearly incompressible; neo_hooke_isochoric takes negative ratios";
        poisson.require(Self::NAME, "poisson", |nu| (0.0..0.5).contains(&nu), requirement)?;
        let [shear, _] = shear_bulk(Self::NAME, &young, &poisson)?;
        // Not through the bulk modulus: nu = 0 has to give lambda = 0 to the bit.
        let named = [("young", &young), ("poisson", &poisson)];
        let [lambda] = combine(Self::NAME, named, |_, [e, nu]| Ok([e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))]))?;
        Self::new(shear, lambda)
    }
}

impl ConvexDensity for NeoHooke {
    #[inline]
    fn value(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> f64 {
        let (mu, lambda) = (self.mu.at(at), self.lambda.at(at));
        0.5 * mu * (f.norm_squared() - 3.0) - mu * j.ln() + 0.5 * lambda * (j - 1.0).powi(2)
    }

    #[inline]
    fn first(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, j: f64) -> Conjugates {
        let (mu, lambda) = (self.mu.at(at), self.lambda.at(at));
        Conjugates { f: f * mu, h: Mat3::zeros(), j: lambda * (j - 1.0) - mu / j }
    }

    #[inline]
    fn second(&self, at: MaterialPoint, _f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let (mu, lambda) = (self.mu.at(at), self.lambda.at(at));
        Curvature::split(Block::Isotropic(mu), Block::Zero, lambda + mu / (j * j))
    }

    fn third(
        &self,
        at: MaterialPoint,
        _f: &Mat3,
        _h: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        Ok(Conjugates::third_by_j(-2.0 * self.mu.at(at) / (j * j * j), along))
    }

    fn conditions(&self, at: MaterialPoint) -> Option<Existence> {
        let r = if self.lambda.at(at) > 0.0 { 2.0 } else { 0.0 };
        let growth = Growth { p: 2.0, q: 0.0, r };
        Some(Existence { polyconvex: true, resists_collapse: true, growth })
    }

    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        Some(TensionBound::isotropic(self.mu.at(at)))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu.check_len(Self::NAME, "mu", cells, points)?;
        self.lambda.check_len(Self::NAME, "lambda", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        Some(Moduli::isotropic(self.lambda.at(at), self.mu.at(at)))
    }
}

impl LinearInModuli for NeoHooke {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu", self.mu.clone()), ("lambda", self.lambda.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        NeoHooke { mu: theta[0].into(), lambda: theta[1].into() }
    }
}
