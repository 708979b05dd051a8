use nastic_tensor::Mat3;

use super::engineering::bulk_of_d1;
use super::isochoric::{Function, IsochoricLaw, moduli};
use crate::{EnergyError, Existence, Field, Growth, LinearInModuli, MaterialPoint, Moduli, combine};

/// Yeoh's law: a cubic in the first invariant.
///
/// **Energy.** `W = C10 x + C20 x^2 + C30 x^3 + kappa/4 (J^2 - 1 - 2 log J)`, `x = J^(-2/3) |F|^2 - 3`. `P` and `dP/dF` by the chain
/// rule of its invariant and that of [`ConvexDensity`](crate::ConvexDensity).
///
/// **Parameters.** `c10 > 0`, `c30 >= 0`, `c20 >= -sqrt(3 c10 c30)` in Pa, which makes the energy increase with x; the bulk modulus
/// `bulk > 0` in Pa, or `d1 = 2 / bulk` in 1/Pa. Each a [`Field`].
///
/// **Convexity.** Polyconvex for `c20 >= 0`; with a negative `c20`, as fits of rubber usually have, no statement of it is known: hold the
/// stability range that `nastic fit` reports against it. `W -> inf` as `J -> 0`. Coercive with `c30 > 0` (`p = 3`, `q = 3/2`, `r = 2`). No positive fibre tension
/// keeps it polyconvex.
///
/// **At rest.** Shear modulus `2 C10`, bulk modulus `kappa`.
///
/// **Source.** O. H. Yeoh, Rubber Chem. Technol. 66 (1993) 754-771, doi 10.5254/1.3538343; volumetric part by J. C. Simo & T. J. R.
/// Hughes, *Computational Inelasticity* (1998), section 9.2.
#[derive(Clone, Debug)]
pub struct Yeoh {
    c: [Field<f64>; 3],
    bulk: Field<f64>,
}

impl Yeoh {
    /// Name in case files and messages.
    pub const NAME: &str = "yeoh";

    /// From the coefficients C10, C20, C30 and the bulk modulus (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `c10 > 0`, `c30 >= 0`, `c20 >= -sqrt(3 c10 c30)`, `bulk > 0`, all finite.
    pub fn new(
        c10: impl Into<Field<f64>>,
        c20: impl Into<Field<f64>>,
        c30: impl Into<Field<f64>>,
        bulk: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let (c10, c20, c30, bulk) = (c10.into(), c20.into(), c30.into(), bulk.into());
        c10.require_positive(Self::NAME, "c10")?;
        c20.require(Self::NAME, "c20", |_| true, "it must be finite")?;
        let increases = "it must not be negative: the energy would fall at large stretches";
        c30.require(Self::NAME, "c30", |c| c >= 0.0, increases)?;
        bulk.require_positive(Self::NAME, "bulk")?;
        let named = [("c10", &c10), ("c20", &c20), ("c30", &c30)];
        let requirement = "it must be at least -sqrt(3 c10 c30): below, the energy falls with the stretch somewhere";
        combine(Self::NAME, named, |entry, [c10, c20, c30]| {
            if c20 >= -(3.0 * c10 * c30).sqrt() {
                return Ok([]);
            }
            Err(EnergyError::Parameter { owner: Self::NAME, name: "c20", value: c20, entry, requirement })
        })?;
        Ok(Self { c: [c10, c20, c30], bulk })
    }

    /// From C10, C20, C30 (Pa) and D1 (1/Pa): bulk modulus `2 / D1`.
    ///
    /// # Errors
    /// As [`new`](Self::new), and unless `D1 > 0`.
    pub fn from_d1(
        c10: impl Into<Field<f64>>,
        c20: impl Into<Field<f64>>,
        c30: impl Into<Field<f64>>,
        d1: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        Self::new(c10, c20, c30, bulk_of_d1(Self::NAME, &d1.into())?)
    }
}

impl IsochoricLaw for Yeoh {
    fn each(&self, at: MaterialPoint, visit: &mut dyn FnMut(&Mat3, Function<'_>)) {
        let [c10, c20, c30] = [0, 1, 2].map(|k| self.c[k].at(at));
        visit(&Mat3::identity(), &|x| {
            [
                x * (c10 + x * (c20 + x * c30)),
                c10 + x * (2.0 * c20 + 3.0 * x * c30),
                2.0 * c20 + 6.0 * x * c30,
                6.0 * c30,
            ]
        });
    }

    fn bulk(&self, at: MaterialPoint) -> f64 {
        self.bulk.at(at)
    }

    fn existence(&self, at: MaterialPoint) -> Existence {
        let [_, c20, c30] = [0, 1, 2].map(|k| self.c[k].at(at));
        let degree = if c30 > 0.0 {
            3.0
        } else if c20 > 0.0 {
            2.0
        } else {
            1.0
        };
        Existence { polyconvex: c20 >= 0.0, resists_collapse: true, growth: Growth::isochoric(degree) }
    }

    fn rest_moduli(&self, at: MaterialPoint) -> Moduli {
        moduli(2.0 * self.c[0].at(at), self.bulk.at(at))
    }

    fn check_lengths(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        for (field, name) in self.c.iter().zip(["c10", "c20", "c30"]) {
            field.check_len(Self::NAME, name, cells, points)?;
        }
        self.bulk.check_len(Self::NAME, "bulk", cells, points)
    }
}

impl LinearInModuli for Yeoh {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        let [c10, c20, c30] = self.c.clone();
        vec![("c10", c10), ("c20", c20), ("c30", c30), ("bulk", self.bulk.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        Yeoh { c: [theta[0].into(), theta[1].into(), theta[2].into()], bulk: theta[3].into() }
    }
}
