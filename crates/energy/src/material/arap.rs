use nastic_tensor::Mat3;

use super::power_trace::Spectrum;
use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli,
};

/// As-rigid-as-possible energy: the squared distance of F from the rotations. Not polyconvex.
///
/// **Energy.** `W = mu |F - R|^2 = mu sum_i (l_i - 1)^2 = mu (|F|^2 - 2 tr (F^T F)^(1/2) + 3)`, R the rotation of F, `l_i` its singular values.
/// `S_F = 2 mu (F - R)`; higher derivatives by those of the trace, exact where stretches coincide; `P` and `dP/dF` by the chain rule of
/// [`ConvexDensity`]. There is no volumetric part.
///
/// **Parameters.** `mu > 0` in Pa, a [`Field`]; or Young's modulus `young = 2 mu`.
///
/// **Convexity.** Neither polyconvex nor rank-one convex where two singular values sum to less than 1, and nothing keeps `J` from 0, where its energy is
/// finite. It grows as `|F|^2`: not coercive. No statement is made of fibre tensions. For comparisons with other codes, and as an energy of shapes rather
/// than of materials.
///
/// **At rest.** Shear modulus `mu`, Poisson's ratio 0.
///
/// **Source.** O. Sorkine & M. Alexa, Symposium on Geometry Processing 2007, 109-116, as an energy of F by I. Chao and others, ACM Trans. Graphics
/// 29 (2010) 38, doi 10.1145/1778765.1778775.
#[derive(Clone, Debug)]
pub struct Arap {
    mu: Field<f64>,
}

impl Arap {
    /// Name in case files and messages.
    pub const NAME: &str = "arap";

    /// From the shear modulus (Pa).
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless it is positive and finite.
    pub fn new(mu: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let mu = mu.into();
        mu.require_positive(Self::NAME, "mu")?;
        Ok(Self { mu })
    }

    /// From Young's modulus (Pa): `mu = E / 2`, for Poisson's ratio is 0.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless it is positive and finite.
    pub fn from_young(young: impl Into<Field<f64>>) -> Result<Self, EnergyError> {
        let young = young.into();
        young.require_positive(Self::NAME, "young")?;
        Self::new(young.try_map(|_, young| Ok(0.5 * young))?)
    }
}

/// Of `tr (F^T F)^(1/2)`.
const HALF: f64 = 0.5;

impl ConvexDensity for Arap {
    fn value(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, _j: f64) -> f64 {
        self.mu.at(at) * (f.norm_squared() - 2.0 * Spectrum::new(f).power(HALF).value() + 3.0)
    }

    fn first(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, _j: f64) -> Conjugates {
        let slope = (f - Spectrum::new(f).power(HALF).first()) * (2.0 * self.mu.at(at));
        Conjugates { f: slope, h: Mat3::zeros(), j: 0.0 }
    }

    fn second(&self, at: MaterialPoint, f: &Mat3, _h: &Mat3, _j: f64) -> Curvature {
        let twice = 2.0 * self.mu.at(at);
        let mut ff = Spectrum::new(f).power(HALF).curvature();
        ff.0.iter_mut().for_each(|c| *c *= -twice);
        ff.add_identity(twice);
        Curvature::split(Block::Full(Box::new(ff)), Block::Zero, 0.0)
    }

    fn third(
        &self,
        at: MaterialPoint,
        f: &Mat3,
        _h: &Mat3,
        _j: f64,
        [a, b]: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let third = Spectrum::new(f).power(HALF).third(&a.f, &b.f) * (-2.0 * self.mu.at(at));
        Ok(Conjugates { f: third, h: Mat3::zeros(), j: 0.0 })
    }

    fn conditions(&self, _at: MaterialPoint) -> Option<Existence> {
        let growth = Growth { p: 2.0, q: 0.0, r: 0.0 };
        Some(Existence { polyconvex: false, resists_collapse: false, growth })
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu.check_len(Self::NAME, "mu", cells, points)
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        Some(Moduli::isotropic(0.0, self.mu.at(at)))
    }
}

impl LinearInModuli for Arap {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu", self.mu.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        Arap { mu: theta[0].into() }
    }
}
