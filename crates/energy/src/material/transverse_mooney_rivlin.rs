use nastic_tensor::{Mat3, Vec3};

use crate::{
    Block, Change, Conjugates, ConvexDensity, Curvature, EnergyError, Existence, Field, Growth, LinearInModuli,
    MaterialPoint, Moduli, TensionBound,
};

/// Transversely isotropic Mooney-Rivlin law with stiffening fibres along unit vectors `f(X)`.
///
/// **Energy.** `W = mu1 |F|^2 + mu2 |H|^2 + mu3 (|F f|^2 + |H f|^2) + mu4 (J-1)^2 - 2 (mu1 + 2 mu2 + mu3) log J
/// - (3 mu1 + 3 mu2 + 2 mu3)`
///
/// **Stress and tangent.** `S_F = 2 F M1`, `S_H = 2 H M2` with `M1 = mu1 I + mu3 f f`, `M2 = mu2 I + mu3 f f`,
/// `S_J = 2 mu4 (J-1) - 2 c / J` with `c = mu1 + 2 mu2 + mu3`; `W_FF = 2 delta M1`, `W_HH = 2 delta M2`,
/// `W_JJ = 2 mu4 + 2 c / J^2`, `W_JJJ = -4 c / J^3`, no mixed parts; `P` and `dP/dF` by the chain rule of [`ConvexDensity`]. Small strain:
/// `mu_T = 2 (mu1 + mu2)`, `mu_L = 2 (mu1 + mu2 + mu3)`, `lambda = 4 mu2 + 4 mu3 + 2 mu4`, `alpha = -4 mu3`, `beta = 0`.
///
/// **Convexity.** Polyconvex for `mu1 > 0` and `mu2`, `mu3`, `mu4 >= 0`, which are required; `W -> inf` as `J -> 0`.
/// A tension along `a` keeps it polyconvex exactly up to `2 mu1 (mu1 + mu3) / (mu1 + mu3 (1 - (a.f)^2))`, which is
/// `2 mu1` across the fibre and `2 (mu1 + mu3)` along it. In plane strain with `f` in the plane or normal to it the
/// law is isotropic in the plane: its anisotropy needs three dimensions.
///
/// **Parameters.** `mu1` ... `mu4` in Pa and the unit vectors `f`, each a [`Field`].
///
/// **Source.** Section 4.2.1 of "Mathematical modeling, analysis and control in soft robotics", SeMA Journal 2023,
/// doi 10.1007/s40324-023-00334-4, with the sign of its logarithm and its constant corrected so that the rest state is
/// free of stress and energy.
#[derive(Clone, Debug)]
pub struct TransverseMooneyRivlin {
    mu1: Field<f64>,
    mu2: Field<f64>,
    mu3: Field<f64>,
    mu4: Field<f64>,
    fiber: Field<Vec3>,
}

impl TransverseMooneyRivlin {
    /// Name in case files and messages.
    pub const NAME: &str = "transverse_mooney_rivlin";

    /// From the coefficients (Pa) and the fibre.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless `mu1 > 0`, the others `>= 0`, all finite; [`EnergyError::Direction`] unless
    /// `|f| = 1` to 1e-6.
    pub fn new(
        mu1: impl Into<Field<f64>>,
        mu2: impl Into<Field<f64>>,
        mu3: impl Into<Field<f64>>,
        mu4: impl Into<Field<f64>>,
        fiber: impl Into<Field<Vec3>>,
    ) -> Result<Self, EnergyError> {
        let fiber = fiber.into().unit_directions(Self::NAME, "fiber")?;
        let law = Self { mu1: mu1.into(), mu2: mu2.into(), mu3: mu3.into(), mu4: mu4.into(), fiber };
        law.mu1.require_positive(Self::NAME, "mu1")?;
        law.mu2.require_non_negative(Self::NAME, "mu2")?;
        law.mu3.require_non_negative(Self::NAME, "mu3")?;
        law.mu4.require_non_negative(Self::NAME, "mu4")?;
        Ok(law)
    }

    #[inline(always)]
    fn at(&self, at: MaterialPoint) -> ([f64; 4], Vec3) {
        ([self.mu1.at(at), self.mu2.at(at), self.mu3.at(at), self.mu4.at(at)], self.fiber.at(at))
    }
}

/// `2 (mu I + mu3 f f)`.
#[inline(always)]
fn twice_metric(mu: f64, mu3: f64, f: &Vec3) -> Mat3 {
    Mat3::from_diagonal_element(2.0 * mu) + f * (f * (2.0 * mu3)).transpose()
}

impl ConvexDensity for TransverseMooneyRivlin {
    #[inline]
    fn value(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> f64 {
        let ([mu1, mu2, mu3, mu4], fiber) = self.at(at);
        mu1 * (f.norm_squared() - 3.0)
            + mu2 * (h.norm_squared() - 3.0)
            + mu3 * ((f * fiber).norm_squared() + (h * fiber).norm_squared() - 2.0)
            + mu4 * (j - 1.0).powi(2)
            - 2.0 * (mu1 + 2.0 * mu2 + mu3) * j.ln()
    }

    #[inline]
    fn first(&self, at: MaterialPoint, f: &Mat3, h: &Mat3, j: f64) -> Conjugates {
        let ([mu1, mu2, mu3, mu4], fiber) = self.at(at);
        Conjugates {
            f: f * twice_metric(mu1, mu3, &fiber),
            h: h * twice_metric(mu2, mu3, &fiber),
            j: 2.0 * mu4 * (j - 1.0) - 2.0 * (mu1 + 2.0 * mu2 + mu3) / j,
        }
    }

    #[inline]
    fn second(&self, at: MaterialPoint, _f: &Mat3, _h: &Mat3, j: f64) -> Curvature {
        let ([mu1, mu2, mu3, mu4], fiber) = self.at(at);
        let jj = 2.0 * mu4 + 2.0 * (mu1 + 2.0 * mu2 + mu3) / (j * j);
        let ff = Block::Metric(twice_metric(mu1, mu3, &fiber));
        let hh = Block::Metric(twice_metric(mu2, mu3, &fiber));
        Curvature::split(ff, hh, jj)
    }

    fn third(
        &self,
        at: MaterialPoint,
        _f: &Mat3,
        _h: &Mat3,
        j: f64,
        along: [&Change; 2],
    ) -> Result<Conjugates, EnergyError> {
        let ([mu1, mu2, mu3, _], _) = self.at(at);
        Ok(Conjugates::third_by_j(-4.0 * (mu1 + 2.0 * mu2 + mu3) / (j * j * j), along))
    }

    fn conditions(&self, at: MaterialPoint) -> Option<Existence> {
        let ([_, mu2, _, mu4], _) = self.at(at);
        let exponent = |factor: f64| if factor > 0.0 { 2.0 } else { 0.0 };
        let growth = Growth { p: 2.0, q: exponent(mu2), r: exponent(mu4) };
        Some(Existence { polyconvex: true, resists_collapse: true, growth })
    }

    fn tension_bound(&self, at: MaterialPoint) -> Option<TensionBound> {
        let ([mu1, _, mu3, _], fiber) = self.at(at);
        Some(TensionBound::stiffer_along(2.0 * mu1, 2.0 * mu3, &fiber))
    }

    fn check_fields(&self, cells: usize, points: usize) -> Result<(), EnergyError> {
        self.mu1.check_len(Self::NAME, "mu1", cells, points)?;
        self.mu2.check_len(Self::NAME, "mu2", cells, points)?;
        self.mu3.check_len(Self::NAME, "mu3", cells, points)?;
        self.mu4.check_len(Self::NAME, "mu4", cells, points)?;
        self.fiber.check_len(Self::NAME, "fiber", cells, points)
    }

    fn fiber(&self, at: MaterialPoint) -> Option<Vec3> {
        Some(self.fiber.at(at))
    }

    fn small_strain(&self, at: MaterialPoint) -> Option<Moduli> {
        let ([mu1, mu2, mu3, mu4], fiber) = self.at(at);
        Some(Moduli {
            lambda: 4.0 * mu2 + 4.0 * mu3 + 2.0 * mu4,
            mu_t: 2.0 * (mu1 + mu2),
            mu_l: 2.0 * (mu1 + mu2 + mu3),
            alpha: -4.0 * mu3,
            beta: 0.0,
            fiber: Some(fiber),
        })
    }
}

impl LinearInModuli for TransverseMooneyRivlin {
    fn own(&self) -> Vec<(&'static str, Field<f64>)> {
        vec![("mu1", self.mu1.clone()), ("mu2", self.mu2.clone()), ("mu3", self.mu3.clone()), ("mu4", self.mu4.clone())]
    }

    fn with_moduli(&self, theta: &[f64]) -> Self {
        let [mu1, mu2, mu3, mu4] = [theta[0], theta[1], theta[2], theta[3]].map(Field::Uniform);
        TransverseMooneyRivlin { mu1, mu2, mu3, mu4, fiber: self.fiber.clone() }
    }
}
