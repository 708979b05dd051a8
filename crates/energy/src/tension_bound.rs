//! [`TensionBound`]: the fibre tensions that a passive law bears.

use nastic_tensor::{Mat3, Vec3};
use std::ops::Add;

/// The fibre tensions that a law bears together: a symmetric matrix `B` (Pa), positive definite or zero, for which
/// `W - 1/2 sum_k m_k |F a_k|^2` stays polyconvex as long as no eigenvalue of `B - sum_k m_k a_k (x) a_k` is negative.
///
/// `sum_k m_k |F a_k|^2 = T : F^T F` with `T = sum_k m_k a_k (x) a_k`, so what is left to show is that `W - 1/2 B : F^T F` is convex in
/// `(F, H, J)`; the contract tests do. Bounds of laws on the same cell add up. Of an isotropic law `B = limit I`, and the condition is
/// `lambda_max(T) <= limit`.
///
/// Source: survey, Prop. 1, for one family.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionBound(Mat3);

impl TensionBound {
    /// The same in every direction, Pa; zero where no positive tension is borne.
    #[must_use]
    pub fn isotropic(limit: f64) -> Self {
        Self(Mat3::from_diagonal_element(limit))
    }

    /// `across I + stiffer f (x) f`, Pa: stiffer along the unit vector `f`.
    #[must_use]
    pub fn stiffer_along(across: f64, stiffer: f64, f: &Vec3) -> Self {
        Self(Mat3::from_diagonal_element(across) + f * f.transpose() * stiffer)
    }

    /// The matrix `B`, Pa.
    #[must_use]
    pub fn matrix(&self) -> &Mat3 {
        &self.0
    }

    /// The largest tension along the unit vector `a` alone, Pa: `1 / (a . B^-1 a)`.
    #[must_use]
    pub fn along(&self, a: &Vec3) -> f64 {
        self.whitened().map_or(0.0, |(scale, inverse)| scale / (inverse * a).norm_squared())
    }

    /// The largest tension alone along whatever unit vector, Pa: the smallest eigenvalue of `B`.
    #[must_use]
    pub fn in_any_direction(&self) -> f64 {
        self.0.symmetric_eigenvalues().min()
    }

    /// The largest `s` for which the tensions `s T` are borne: `1 / lambda_max(B^(-1/2) T B^(-1/2))`; infinite where `T`
    /// has no positive eigenvalue. `T = sum_k m_k a_k (x) a_k`, Pa (the `s` of tensions of 1 is a tension itself).
    #[must_use]
    pub fn largest_multiple(&self, tensions: &Mat3) -> f64 {
        let Some((scale, inverse)) = self.whitened() else {
            let pulls = tensions.symmetric_eigenvalues().max() > 0.0;
            return if pulls { 0.0 } else { f64::INFINITY };
        };
        let most = (inverse * tensions * inverse.transpose()).symmetric_eigenvalues().max();
        if most > 0.0 { scale / most } else { f64::INFINITY }
    }

    /// A number and the inverse of `L` with `B = scale L L^T`; none unless positive definite.
    fn whitened(&self) -> Option<(f64, Mat3)> {
        let scale = self.0[(0, 0)];
        if scale <= 0.0 {
            return None;
        }
        let factor = (self.0 / scale).cholesky()?;
        Some((scale, factor.l().try_inverse()?))
    }
}

impl Add for TensionBound {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}
