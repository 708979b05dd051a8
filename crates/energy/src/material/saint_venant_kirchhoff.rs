use nastic_tensor::Mat3;

use super::engineering::shear_bulk;
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, combine,
};
use nastic_tensor::Tangent;

/// Saint Venant-Kirchhoff law: linear between Green-Lagrange strain and second Piola-Kirchhoff stress. Not polyconvex.
///
/// **Energy.** `W = lambda/2 (tr E)^2 + mu E : E`, `E = (F^T F - 1)/2`, that is, with `I = |F|^2`,
/// `lambda/8 (I - 3)^2 + mu/4 (I^2 - 2 |H|^2 - 2 I + 3)`. `S_F = (lambda/2 (I - 3) + mu (I - 1)) F`, `S_H = -mu H`;
/// `W_FF = (lambda/2 (I - 3) + mu (I - 1)) I + (lambda + 2 mu) F F`, `W_HH = -mu I`; `P` and `dP/dF` by the chain rule of
/// [`ConvexDensity`]. There is no volumetric part.
///
/// **Parameters.** `lambda >= 0`, `mu > 0` in Pa, or shear and bulk modulus, or Young's modulus and Poisson's ratio. Each a [`Field`].
///
/// **Convexity.** Neither polyconvex nor rank-one convex: it softens in compression, without stiffness along an axis at the stretch
/// `1/sqrt 3`, and nothing keeps `J` from 0, where its energy is finite. It grows as `|F|^4`. No statement is made of fibre tensions. For small
/// strains and comparisons with other codes; take `neo_hooke` else.
///
/// **At rest.** Lame constants `lambda`, `mu`.
///
/// **Source.** P. G. Ciarlet, *Mathematical Elasticity*, volume I (1988), sections 3.9 and 4.10 (A. Raoult, 1986: not polyconvex).
#[derive(Clone, Debug)]
pub struct SaintVenantKirchhoff {
    lambda: Field<f64>,
    mu: Field<f64>,
}

impl SaintVenantKirchhoff {
    /// Name in case files and messages.
    pub const NAME: &str = "saint_venant_kirchhoff";

    /// From the Lame constants (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `lambda >= 0`, `mu > 0`.
    pub fn new(lambda: impl Into<Field<f64>>, mu: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (lambda, mu) = (lambda.into(), mu.into());
        lambda.require(Self::NAME, "lambda", |l| l >= 0.0, "it must not be negative")?;
        mu.require_positive(Self::NAME, "mu")?;
        Ok(Self { lambda, mu })
    }

    /// From shear and bulk modulus (Pa): `lambda = kappa - 2 mu / 3`.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless both are positive and `bulk >= 2 shear / 3`.
    pub fn from_shear_bulk(shear: impl Into<Field<f64>>, bulk: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let (shear, bulk) = (shear.into(), bulk.into());
        shear.require_positive(Self::NAME, "shear")?;
        let [lambda] = combine(Self::NAME, [("shear", &shear), ("bulk", &bulk)], |entry, [shear, bulk]| {
            let lambda = bulk - 2.0 * shear / 3.0;
            // Poisson's ratio 0, rounded, is meant to be 0
            if lambda >= -1e-14 * bulk {
                return Ok([lambda.max(0.0)]);
            }
            let requirement = "it must be at least 2 shear / 3";
            Err(EnergyError::Parameter { owner: Self::NAME, name: "bulk", value: bulk, entry, requirement })
        })?;
        Self::new(lambda, shear)
    }

    /// From Young's modulus (Pa) and Poisson's ratio.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `E > 0` and `0 <= nu < 1/2`.
    pub fn from_young_poisson(
        young: impl Into<Field<f64>>,
        poisson: impl Into<Field<f64>>,
    ) -> Result<Self, EnergyError> {
        let poisson = poisson.into();
        poisson.require(Self::NAME, "poisson", |nu| (0.0..0.5).contains(&nu), "it must lie in [0, 1/2)")?;
        let [shear, bulk] = shear_bulk(Self::NAME, &young.into(), &poisson)?;
        Self::from_shear_bulk(shear, bulk)
    }

    fn slope(&self, at: MaterialPoint, f: &Mat3) -> f64 {
        let square = f.norm_squared();
        0.5 * self.lambda.at(at) * (square - 3.0) + self.mu.at(at) * (square - 1.0)
    }
}

impl ConvexDensity for SaintVenantKirchhoff {
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, _j: f64) -> f64 {
        let (lambda, mu, x) = (self.lambda.at(at), self.mu.at(at), f.norm_squared() - 3.0);
        // I^2 - 2 |H|^2 - 2 I + 3 by the differences since rest
        0.125 * lambda * x * x + 0.25 * mu * (x * (x + 4.0) - 2.0 * (h.norm_squared() - 3.0))
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, _j: f64) -> Conjugates {
        Conjugates { f: f * self.slope(at, f), h: h * -self.mu.at(at), j: 0.0 }
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, _j: f64) -> Curvature {
        let mut ff = Tangent::zero();
        ff.add_identity(self.slope(at, f));
        ff.add_outer(f, f, self.lambda.at(at) + 2.0 * self.mu.at(at));
        Curvature::split(Block::Full(Box::new(ff)), Block::Isotropic(-self.mu.at(at)), 0.0)
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        _h: &Mat3,
        _j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let sum = b.f * f.dot(&a.f) + a.f * f.dot(&b.f) + f * a.f.dot(&b.f);
        Ok(Conjugates { f: sum * (self.lambda.at(at) + 2.0 * self.mu.at(at)), h: Mat3::zeros(), j: 0.0 })
    }

    fn conditions(&self, _at: MaterialPoint) -> Option<Existence> {
        let growth = Growth { p: 4.0, q: 0.0, r: 0.0 };
        Some(Existence { polyconvex: false, resists_collapse: false, growth })
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.lambda.check_len(Self::NAME, "lambda", cells, points)?;
        self.mu.check_len(Self::NAME, "mu", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        Some(Moduli::isotropic(self.lambda.at(at), self.mu.at(at)))
    }
}

impl LinearInModuli for SaintVenantKirchhoff {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("lambda", self.lambda.clone()), ("mu", self.mu.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        SaintVenantKirchhoff { lambda: theta[0].into(), mu: theta[1].into() }
    }
}
