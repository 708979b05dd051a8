use nastic_tensor::Mat3;

use super::engineering::{check_rubber, shear_bulk};
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, TensionBound, combine,
};

/// Compressible Mooney-Rivlin law.
///
/// **Energy.** `W = mu1 |F|^2 + mu2 |H|^2 + mu3 (J-1)^2 - 2 (mu1 + 2 mu2) log J - 3 (mu1 + mu2)`
///
/// **Stress and tangent.** `S_F = 2 mu1 F`, `S_H = 2 mu2 H`, `S_J = 2 mu3 (J-1) - 2 (mu1 + 2 mu2) / J`;
/// `W_FF = 2 mu1 I`, `W_HH = 2 mu2 I`, `W_JJ = 2 mu3 + 2 (mu1 + 2 mu2) / J^2`, `W_JJJ = -4 (mu1 + 2 mu2) / J^3`, no mixed parts; `P` and `dP/dF` by the
/// chain rule of [`ConvexDensity`]. Small strain: `mu = 2 (mu1 + mu2)`, `lambda = 4 mu2 + 2 mu3`.
///
/// **Convexity.** Polyconvex for `mu1 > 0`, `mu2 >= 0`, `mu3 >= 0`, which are required; `W -> inf` as `J -> 0`. A fibre
/// tension keeps it polyconvex exactly up to `m = 2 mu1` (proposition 1 of the source), where the growth along the
/// fibre is already lost.
///
/// **Parameters.** `mu1`, `mu2`, `mu3` in Pa, each a [`Field`]; or [`from_shear_bulk`](Self::from_shear_bulk),
/// [`from_young_poisson`](Self::from_young_poisson), [`from_c10_c01_d1`](Self::from_c10_c01_d1).
///
/// **Source.** Equation (3) of "Mathematical modeling, analysis and control in soft robotics", SeMA Journal 2023,
/// doi 10.1007/s40324-023-00334-4.
#[derive(Clone, Debug)]
pub struct MooneyRivlin {
    mu1: Field<f64>,
    mu2: Field<f64>,
    mu3: Field<f64>,
}

impl MooneyRivlin {
    /// Name in case files and messages.
    pub const NAME: &str = "mooney_rivlin";

    /// From the coefficients (Pa) of `|F|^2`, `|H|^2` and `(J-1)^2`.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `mu1 > 0`, `mu2 >= 0`, `mu3 >= 0`, all finite.
    pub fn new(
        mu1: impl Into<Field<f64>>,
        mu2: impl Into<Field<f64>>,
        mu3: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let law = Self { mu1: mu1.into(), mu2: mu2.into(), mu3: mu3.into() };
        law.mu1.require_positive(Self::NAME, "mu1")?;
        law.mu2.require_non_negative(Self::NAME, "mu2")?;
        law.mu3.require_non_negative(Self::NAME, "mu3")?;
        Ok(law)
    }

    /// From shear and bulk modulus (Pa) and the share `U` in (0, 1) of the shear modulus carried by `|F|^2`:
    /// `mu1 = mu U / 2`, `mu2 = mu (1-U) / 2`, `mu3 = (kappa + mu (2U - 8/3)) / 2`.
    ///
    /// # Errors
    /// [`EnergyError::Inadmissible`] where `mu3 <= 0`, that is `kappa/mu <= 8/3 - 2U`; it says which share would do.
    pub fn from_shear_bulk(
        shear: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
        share: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let (shear, bulk, share) = (shear.into(), bulk.into(), share.into());
        shear.require_positive(Self::NAME, "shear")?;
        bulk.require_positive(Self::NAME, "bulk")?;
        share.require(Self::NAME, "share", |u| u > 0.0 && u < 1.0, "it must lie between 0 and 1, ends excluded")?;
        let named = [("shear", &shear), ("bulk", &bulk), ("share", &share)];
        let [mu1, mu2, mu3] = combine(Self::NAME, named, |entry, [shear, bulk, share]| {
            let value = (bulk + shear * (2.0 * share - 8.0 / 3.0)) / 2.0;
            if value > 0.0 {
                return Ok([shear * share / 2.0, shear * (1.0 - share) / 2.0, value]);
            }
            Err(EnergyError::Inadmissible { owner: Self::NAME, name: "mu3", value, entry, shear, bulk, share })
        })?;
        Self::new(mu1, mu2, mu3)
    }

    /// From Young's modulus (Pa), Poisson's ratio and the share of [`from_shear_bulk`](Self::from_shear_bulk).
    ///
    /// # Errors
    /// As there; `nu = 0.25` needs a share above 0.5, `nu = 0.3` one above 0.25.
    pub fn from_young_poisson(
        young: impl Into<Field<f64>>,
        poisson: impl Into<Field<f64>>,
        share: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let [shear, bulk] = shear_bulk(Self::NAME, &young.into(), &poisson.into())?;
        Self::from_shear_bulk(shear, bulk, share)
    }

    /// From the coefficients C10, C01 (Pa) and D1 (1/Pa) of `C10 (I1' - 3) + C01 (I2' - 3) + (J-1)^2 / D1`, by their small-strain
    /// moduli: `mu1 = C10`, `mu2 = C01`, `mu3 = 1/D1 - 2 C10 / 3 - 8 C01 / 3`. Where `J = 1` both laws have the same energy;
    /// elsewhere they differ.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `C10 > 0`, `C01 >= 0` and `0 < D1 <= 3 / (2 C10 + 8 C01)`.
    pub fn from_c10_c01_d1(
        c10: impl Into<Field<f64>>,
        c01: impl Into<Field<f64>>,
        d1: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let (c10, c01, d1) = (c10.into(), c01.into(), d1.into());
        check_rubber(Self::NAME, &c10, Some(&c01), &d1)?;
        let named = [("c10", &c10), ("c01", &c01), ("d1", &d1)];
        let [mu1, mu2, mu3] = combine(Self::NAME, named, |entry, [c10, c01, d1]| {
            let mu3 = 1.0 / d1 - (2.0 * c10 + 8.0 * c01) / 3.0;
            if mu3 >= 0.0 {
                return Ok([c10, c01, mu3]);
            }
            let requirement =
                "it must be at most 3 / (2 C10 + 8 C01): the material would be more compressible than this law can be";
            Err(EnergyError::Parameter { owner: Self::NAME, name: "d1", value: d1, entry, requirement })
        })?;
        Self::new(mu1, mu2, mu3)
    }

    #[inline(always)]
    fn at(&self, at: MaterialPoint) -> [f64; 3] {
        [self.mu1.at(at), self.mu2.at(at), self.mu3.at(at)]
    }
}

impl ConvexDensity for MooneyRivlin {
    #[inline]
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        let [mu1, mu2, mu3] = self.at(at);
        mu1 * (f.norm_squared() - 3.0) + mu2 * (h.norm_squared() - 3.0) + mu3 * (j - 1.0).powi(2)
            - 2.0 * (mu1 + 2.0 * mu2) * j.ln()
    }

    #[inline]
    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let [mu1, mu2, mu3] = self.at(at);
        Conjugates { f: f * (2.0 * mu1), h: h * (2.0 * mu2), j: 2.0 * mu3 * (j - 1.0) - 2.0 * (mu1 + 2.0 * mu2) / j }
    }

    #[inline]
    fn second(&self, at: MaterialPoint, _f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let [mu1, mu2, mu3] = self.at(at);
        let jj = 2.0 * mu3 + 2.0 * (mu1 + 2.0 * mu2) / (j * j);
        Curvature::split(Block::Isotropic(2.0 * mu1), Block::Isotropic(2.0 * mu2), jj)
    }

    fn third(
        &self,
        at: MaterialPoint,
        _f: &Mat3,
        _h: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let [mu1, mu2, _] = self.at(at);
        Ok(Conjugates::third_by_j(-4.0 * (mu1 + 2.0 * mu2) / (j * j * j), along))
    }

    fn conditions(&self, at: MaterialPoint) -> Option<Existence> {
        let [_, mu2, mu3] = self.at(at);
        let exponent = |factor: f64| if factor > 0.0 { 2.0 } else { 0.0 };
        let growth = Growth { p: 2.0, q: exponent(mu2), r: exponent(mu3) };
        Some(Existence { polyconvex: true, resists_collapse: true, growth })
    }

    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        Some(TensionBound::isotropic(2.0 * self.mu1.at(at)))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu1.check_len(Self::NAME, "mu1", cells, points)?;
        self.mu2.check_len(Self::NAME, "mu2", cells, points)?;
        self.mu3.check_len(Self::NAME, "mu3", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let [mu1, mu2, mu3] = self.at(at);
        Some(Moduli::isotropic(4.0 * mu2 + 2.0 * mu3, 2.0 * (mu1 + mu2)))
    }
}

impl LinearInModuli for MooneyRivlin {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu1", self.mu1.clone()), ("mu2", self.mu2.clone()), ("mu3", self.mu3.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        MooneyRivlin { mu1: theta[0].into(), mu2: theta[1].into(), mu3: theta[2].into() }
    }
}
