use nastic_tensor::Mat3;

use super::engineering::{bulk_of_d1, shear_bulk};
use super::isochoric::{Function, Invariant, IsochoricLaw, moduli};
use crate::{EnergyError, Existence, Field, Growth, LinearInModuli, MaterialPoint, Moduli, Outside};

/// Gent's law: chains of limited length.
///
/// **Energy.** `W = -(mu J_m / 2) log(1 - x / J_m) + kappa/4 (J^2 - 1 - 2 log J)`, `x = J^(-2/3) |F|^2 - 3`; infinite for `x >= J_m`, which is
/// refused as a deformation beyond the domain ([`Outside`]), as `J <= 0` is. `P` and `dP/dF` by the chain rule of its invariant and that of
/// [`ConvexDensity`](crate::ConvexDensity).
///
/// **Parameters.** `mu > 0` in Pa, `jm > 0` (a pure number), the bulk modulus `bulk > 0` in Pa, or `d1 = 2 / bulk` in 1/Pa; or
/// [`from_young_poisson`](Self::from_young_poisson). Each a [`Field`].
///
/// **Convexity.** Polyconvex; `W -> inf` as `J -> 0`; coercive (`p = 6`, `r = 2`, for x is bounded). No positive fibre tension keeps it polyconvex.
///
/// **At rest.** Shear modulus `mu`, bulk modulus `kappa`. As `J_m -> inf` it becomes
/// [`NeoHookeIsochoric`](crate::NeoHookeIsochoric).
///
/// **Source.** A. N. Gent, Rubber Chem. Technol. 69 (1996) 59-61, doi 10.5254/1.3538357; volumetric part by J. C. Simo & T. J. R.
/// Hughes, *Computational Inelasticity* (1998), section 9.2.
#[derive(Clone, Debug)]
pub struct Gent {
    mu: Field<f64>,
    jm: Field<f64>,
    bulk: Field<f64>,
}

impl Gent {
    /// Name in case files and messages.
    pub const NAME: &str = "gent";

    /// From shear modulus (Pa), limit of `I1' - 3`, bulk modulus (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless all are positive and finite.
    pub fn new(
        mu: impl Into<Field<f64>>,
        jm: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        Self::named("mu", mu.into(), jm.into(), bulk.into())
    }

    /// The same as [`new`](Self::new), the shear modulus under the name other laws use.
    ///
    /// # Errors
    /// As there.
    pub fn from_shear_bulk(
        shear: impl Into<Field<f64>>,
        jm: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        Self::named("shear", shear.into(), jm.into(), bulk.into())
    }

    fn named(name: &'static str, mu: Field<f64>, jm: Field<f64>, bulk: Field<f64>) -> Result<Self, EnergyError> {
        mu.require_positive(Self::NAME, name)?;
        jm.require_positive(Self::NAME, "jm")?;
        bulk.require_positive(Self::NAME, "bulk")?;
        Ok(Self { mu, jm, bulk })
    }

    /// From shear modulus (Pa), limit of `I1' - 3`, and D1 (1/Pa): bulk modulus `2 / D1`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and unless `D1 > 0`.
    pub fn from_d1(
        mu: impl Into<Field<f64>>,
        jm: impl Into<Field<f64>>,
        d1: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        Self::new(mu, jm, bulk_of_d1(Self::NAME, &d1.into())?)
    }

    /// From Young's modulus (Pa), Poisson's ratio at rest, and the limit of `I1' - 3`.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `E > 0`, `-1 < nu < 1/2`, `jm > 0`.
    pub fn from_young_poisson(
        young: impl Into<Field<f64>>,
        poisson: impl Into<Field<f64>>,
        jm: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let [shear, bulk] = shear_bulk(Self::NAME, &young.into(), &poisson.into())?;
        Self::from_shear_bulk(shear, jm, bulk)
    }
}

impl IsochoricLaw for Gent {
    fn each(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>)) {
        let (mu, jm) = (self.mu.at(at), self.jm.at(at));
        visit(&Mat3::identity(), &|x| {
            if x >= jm {
                return [f64::INFINITY; 4];
            }
            let left = jm - x;
            let first = 0.5 * mu * jm / left;
            // ln_1p keeps the digits of small strains and of large J_m
            [-0.5 * mu * jm * (-x / jm).ln_1p(), first, first / left, 2.0 * first / (left * left)]
        });
    }

    fn bulk(&self, at: MaterialPoint) -> f64 {
        self.bulk.at(at)
    }

    fn within(&self, at: MaterialPoint, f: &Mat3, j: f64) -> Result<(), Outside> {
        let (value, limit) = (Invariant::new(&Mat3::identity(), f, j).change(), self.jm.at(at));
        if value < limit {
            return Ok(());
        }
        let (law, measure) = (Self::NAME, "J^(-2/3) |F|^2 - 3");
        Err(Outside { law, measure, value, limit, meaning: "the limit jm of the law", point: 0 })
    }

    fn existence(&self, _at: MaterialPoint) -> Existence {
        Existence { polyconvex: true, resists_collapse: true, growth: Growth::isochoric(f64::INFINITY) }
    }

    fn rest_moduli(&self, at: MaterialPoint) -> Moduli {
        moduli(self.mu.at(at), self.bulk.at(at))
    }

    fn check_lengths(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu.check_len(Self::NAME, "mu", cells, points)?;
        self.jm.check_len(Self::NAME, "jm", cells, points)?;
        self.bulk.check_len(Self::NAME, "bulk", cells, points)
    }
}

impl LinearInModuli for Gent {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu", self.mu.clone()), ("bulk", self.bulk.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        Gent { mu: theta[0].into(), jm: self.jm.clone(), bulk: theta[1].into() }
    }
}
