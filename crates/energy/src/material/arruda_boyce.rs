use nastic_tensor::Mat3;

use super::engineering::{bulk_of_d1, shear_bulk};
use super::isochoric::{Function, IsochoricLaw, moduli};
use crate::{EnergyError, Existence, Field, Growth, LinearInModuli, MaterialPoint, Moduli, combine};

/// Arruda and Boyce's law of eight chains, by the first five terms of the inverse Langevin function.
///
/// **Energy.** `W = mu sum_i c_i lambda_m^(2 - 2i) (I^i - 3^i) + kappa/4 (J^2 - 1 - 2 log J)`, `I = J^(-2/3) |F|^2`,
/// `c = 1/2, 1/20, 11/1050, 19/7000, 519/673750`. `P` and `dP/dF` by the chain rule of its invariant and that of
/// [`ConvexDensity`](crate::ConvexDensity).
///
/// **Parameters.** `mu > 0` in Pa, the locking stretch `lambda_m > 1` (`lambda_m^2` is the number N of links of a chain), the bulk modulus
/// `bulk > 0` in Pa, or `d1 = 2 / bulk` in 1/Pa; or the shear modulus at rest, or [`from_young_poisson`](Self::from_young_poisson). Each a
/// [`Field`].
///
/// **Convexity.** Polyconvex; `W -> inf` as `J -> 0`; coercive (`p = 15/4`, `r = 2`). No positive fibre tension keeps it polyconvex. The
/// series has no locking: its energy is finite at every stretch.
///
/// **At rest.** Shear modulus `mu (1 + 3/(5 N) + 99/(175 N^2) + 513/(875 N^3) + 42039/(67375 N^4))`, bulk modulus `kappa`. As `N -> inf` it
/// becomes [`NeoHookeIsochoric`](crate::NeoHookeIsochoric).
///
/// **Source.** E. M. Arruda & M. C. Boyce, J. Mech. Phys. Solids 41 (1993) 389-412, doi 10.1016/0022-5096(93)90013-6, equation 22;
/// volumetric part by J. C. Simo & T. J. R. Hughes, *Computational Inelasticity* (1998), section 9.2.
#[derive(Clone, Debug)]
pub struct ArrudaBoyce {
    mu: Field<f64>,
    lambda_m: Field<f64>,
    bulk: Field<f64>,
}

/// Coefficients of the series.
const SERIES: [f64; 5] = [1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];

fn check_locking(lambda_m: &Field<f64>) -> Result<(), EnergyError> {
    let requirement = "it must exceed 1: a chain is longer stretched than at rest";
    lambda_m.require(ArrudaBoyce::NAME, "lambda_m", |l| l > 1.0, requirement)
}

impl ArrudaBoyce {
    /// Shear modulus at rest over `mu`: `2 sum_i i c_i (3/N)^(i-1)`.
    pub(crate) fn shear_ratio(lambda_m: f64) -> f64 {
        let x = 3.0 / (lambda_m * lambda_m);
        SERIES.iter().enumerate().map(|(i, c)| 2.0 * (i + 1) as f64 * c * x.powi(i as i32)).sum()
    }

    /// Name in case files and messages.
    pub const NAME: &str = "arruda_boyce";

    /// From `mu` (Pa), the locking stretch and the bulk modulus (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `mu > 0`, `lambda_m > 1`, `bulk > 0`, all finite.
    pub fn new(
        mu: impl Into<Field<f64>>,
        lambda_m: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let law = Self { mu: mu.into(), lambda_m: lambda_m.into(), bulk: bulk.into() };
        law.mu.require_positive(Self::NAME, "mu")?;
        check_locking(&law.lambda_m)?;
        law.bulk.require_positive(Self::NAME, "bulk")?;
        Ok(law)
    }

    /// From the shear modulus at rest (Pa), the locking stretch and the bulk modulus (Pa).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_shear_bulk(
        shear: impl Into<Field<f64>>,
        lambda_m: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let (shear, lambda_m) = (shear.into(), lambda_m.into());
        shear.require_positive(Self::NAME, "shear")?;
        check_locking(&lambda_m)?;
        let named = [("shear", &shear), ("lambda_m", &lambda_m)];
        let [mu] = combine(Self::NAME, named, |_, [shear, lambda_m]| Ok([shear / Self::shear_ratio(lambda_m)]))?;
        Self::new(mu, lambda_m, bulk)
    }

    /// From `mu` (Pa), the locking stretch and D1 (1/Pa): bulk modulus `2 / D1`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and unless `D1 > 0`.
    pub fn from_d1(
        mu: impl Into<Field<f64>>,
        lambda_m: impl Into<Field<f64>>,
        d1: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        Self::new(mu, lambda_m, bulk_of_d1(Self::NAME, &d1.into())?)
    }

    /// From Young's modulus (Pa) and Poisson's ratio at rest, and the locking stretch.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `E > 0`, `-1 < nu < 1/2`, `lambda_m > 1`.
    pub fn from_young_poisson(
        young: impl Into<Field<f64>>,
        poisson: impl Into<Field<f64>>,
        lambda_m: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let [shear, bulk] = shear_bulk(Self::NAME, &young.into(), &poisson.into())?;
        Self::from_shear_bulk(shear, lambda_m, bulk)
    }
}

impl IsochoricLaw for ArrudaBoyce {
    fn each(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>)) {
        let (mu, n) = (self.mu.at(at), self.lambda_m.at(at).powi(2));
        visit(&Mat3::identity(), &|x| {
            let mut sum = [0.0; 4];
            for (k, c) in SERIES.iter().enumerate() {
                let (i, c) = (k as i32 + 1, mu * c / n.powi(k as i32));
                let (invariant, degree) = (x + 3.0, f64::from(i));
                sum[0] += c * difference_of_powers(x, i);
                sum[1] += c * degree * invariant.powi(i - 1);
                sum[2] += c * degree * (degree - 1.0) * invariant.powi(i - 2);
                sum[3] += c * degree * (degree - 1.0) * (degree - 2.0) * invariant.powi(i - 3);
            }
            sum
        });
    }

    fn bulk(&self, at: MaterialPoint) -> f64 {
        self.bulk.at(at)
    }

    fn existence(&self, _at: MaterialPoint) -> Existence {
        Existence { polyconvex: true, resists_collapse: true, growth: Growth::isochoric(5.0) }
    }

    fn rest_moduli(&self, at: MaterialPoint) -> Moduli {
        moduli(self.mu.at(at) * Self::shear_ratio(self.lambda_m.at(at)), self.bulk.at(at))
    }

    fn check_lengths(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu.check_len(Self::NAME, "mu", cells, points)?;
        self.lambda_m.check_len(Self::NAME, "lambda_m", cells, points)?;
        self.bulk.check_len(Self::NAME, "bulk", cells, points)
    }
}

/// `(3 + x)^i - 3^i = x sum_k (3 + x)^k 3^(i-1-k)`, exact for small x.
fn difference_of_powers(x: f64, i: i32) -> f64 {
    x * (0..i).map(|k| (3.0 + x).powi(k) * 3f64.powi(i - 1 - k)).sum::<f64>()
}

impl LinearInModuli for ArrudaBoyce {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu", self.mu.clone()), ("bulk", self.bulk.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        ArrudaBoyce { mu: theta[0].into(), lambda_m: self.lambda_m.clone(), bulk: theta[1].into() }
    }
}
