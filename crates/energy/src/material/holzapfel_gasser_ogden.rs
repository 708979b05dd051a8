use nastic_tensor::{Mat3, Vec3};

use super::engineering::bulk_of_d1;
use super::fiber_family::FiberFamily;
use super::isochoric::{Function, IsochoricLaw, moduli};
use crate::{EnergyError, Existence, Field, Growth, LinearInModuli, MaterialPoint, Moduli, Outside};

/// Holzapfel, Gasser and Ogden's law: one or two families of stiffening fibres with dispersion in a neo-Hookean matrix.
///
/// **Energy.** `W = mu/2 (J^(-2/3) |F|^2 - 3) + sum_k k1/(2 k2) (exp(k2 r(E_k)^2) - 1) + kappa/4 (J^2 - 1 - 2 log J)`,
/// `E_k = J^(-2/3) (d |F|^2 + (1 - 3 d) |F a_k|^2) - 1`, with the tension-only switch `r` and its toe as documented at [`FiberFamily`]. `P` and
/// `dP/dF` by the chain rule of the invariants and that of [`ConvexDensity`](crate::ConvexDensity).
///
/// **Parameters.** `mu > 0` in Pa (c of the law of 2000; C10 = mu/2 in Abaqus), `k1 > 0` in Pa, `k2 > 0`, `0 <= dispersion <= 1/3` (kappa
/// of the law of 2006; 0 is that of 2000), the bulk modulus `bulk > 0` in Pa, or `c10` and `d1 = 2 / bulk`; unit vectors `fiber` and, for
/// two families, `fiber2`; the toe (default 0.01). Each a [`Field`]. `k2 r^2 > 600` is beyond the domain ([`Outside`]).
///
/// **Convexity.** Polyconvex; `W -> inf` as `J -> 0`; coercive for `dispersion > 0`, while the matrix alone is not. No positive fibre
/// tension keeps it polyconvex.
///
/// **At rest.** Isotropic with shear modulus `mu`, bulk modulus `kappa`: fibres begin to bear with their stretch.
///
/// **Source.** G. A. Holzapfel, T. C. Gasser & R. W. Ogden, J. Elasticity 61 (2000) 1-48, doi 10.1023/A:1010835316564; with dispersion
/// T. C. Gasser, R. W. Ogden & G. A. Holzapfel, J. R. Soc. Interface 3 (2006) 15-35, doi 10.1098/rsif.2005.0073; the toe is ours.
#[derive(Clone, Debug)]
pub struct HolzapfelGasserOgden {
    mu: Field<f64>,
    bulk: Field<f64>,
    families: Vec<FiberFamily>,
}

const DIRECTIONS: [&str; 2] = ["fiber", "fiber2"];

impl HolzapfelGasserOgden {
    /// Name in case files and messages.
    pub const NAME: &str = "holzapfel_gasser_ogden";

    /// From shear and bulk modulus of the matrix (Pa), and `k1` (Pa), `k2`, dispersion, toe of the fibres along one or two directions.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless all are in the ranges above; [`EnergyError::Direction`] unless `|a| = 1` to 1e-6.
    pub fn new(
        [mu, bulk]: [Field<f64>; 2],
        fibers: [Field<f64>; 4],
        first: impl Into<Field<Vec3>>,
        second: Option<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        mu.require_positive(Self::NAME, "mu")?;
        bulk.require_positive(Self::NAME, "bulk")?;
        let directions = DIRECTIONS.into_iter().zip([Some(first.into()), second]);
        let families = directions.filter_map(|(name, a)| a.map(|a| (name, a)));
        let families = families.map(|(name, a)| FiberFamily::named(Self::NAME, name, fibers.clone(), a));
        Ok(Self { mu, bulk, families: families.collect::<Result<_, _>>()? })
    }

    /// The same with C10 (Pa) and D1 (1/Pa) of the matrix: `mu = 2 C10`, bulk modulus `2 / D1`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and unless `C10 > 0`, `D1 > 0`.
    pub fn from_c10_d1(
        [c10, d1]: [Field<f64>; 2],
        fibers: [Field<f64>; 4],
        first: impl Into<Field<Vec3>>,
        second: Option<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        c10.require_positive(Self::NAME, "c10")?;
        let matrix = [c10.try_map(|_, c10| Ok(2.0 * c10))?, bulk_of_d1(Self::NAME, &d1)?];
        Self::new(matrix, fibers, first, second)
    }
}

impl IsochoricLaw for HolzapfelGasserOgden {
    fn each(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>)) {
        let half = 0.5 * self.mu.at(at);
        visit(&Mat3::identity(), &|x| [half * x, half, 0.0, 0.0]);
        self.families.iter().for_each(|family| family.visit(at, visit));
    }

    fn bulk(&self, at: MaterialPoint) -> f64 {
        self.bulk.at(at)
    }

    fn within(&self, at: MaterialPoint, f: &Mat3, j: f64) -> Result<(), Outside> {
        self.families.iter().try_for_each(|family| family.bounded(Self::NAME, at, f, j))
    }

    fn existence(&self, at: MaterialPoint) -> Existence {
        let degree = self.families.iter().map(|family| family.growth(at)).fold(1.0, f64::max);
        Existence { polyconvex: true, resists_collapse: true, growth: Growth::isochoric(degree) }
    }

    fn rest_moduli(&self, at: MaterialPoint) -> Moduli {
        moduli(self.mu.at(at), self.bulk.at(at))
    }

    fn check_lengths(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu.check_len(Self::NAME, "mu", cells, points)?;
        self.bulk.check_len(Self::NAME, "bulk", cells, points)?;
        let mut families = self.families.iter().zip(DIRECTIONS);
        families.try_for_each(|(family, name)| family.check_of(Self::NAME, name, cells, points))
    }

    fn along(&self, at: MaterialPoint) -> Option<Vec3> {
        self.families.first().map(|family| family.direction(at))
    }
}

impl LinearInModuli for HolzapfelGasserOgden {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        let k1 = self.families.first().map_or(Field::Uniform(0.0), |family| family.own().remove(0).1);
        vec![("mu", self.mu.clone()), ("k1", k1), ("bulk", self.bulk.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        let families = self.families.iter().map(|family| family.with_moduli(&theta[1..2]));
        HolzapfelGasserOgden { mu: theta[0].into(), bulk: theta[2].into(), families: families.collect() }
    }
}
