//! [`SignedDistance`]: the distance of a point from an obstacle, and its derivatives.

use super::V;
use nalgebra::Matrix3;

/// The signed distance d of a point, positive outside, with its derivatives: `d(x) = +-|x - p(x)| - r` from the nearest point p of a plane,
/// a line or a point.
///
/// With `n = grad d`, the curvature k of the surface of equal distance and a direction a without any:
/// `d2d/dx2 = H = k P`, `P = 1 - n n^T - a a^T`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDistance {
    /// d
    pub value: f64,
    /// grad d, a unit vector; zero where the distance has no gradient (the center of a sphere).
    pub normal: [f64; 3],
    /// `1 / +-|x - p|`; zero of a plane.
    pub curvature: f64,
    /// A direction without curvature, beside the normal: that of the axis of a capsule between its ends. Zero where there is none.
    pub straight: [f64; 3],
}

impl SignedDistance {
    /// `H v`.
    pub fn second(&self, v: &[f64]) -> [f64; 3] {
        let v = V::from_fn(|i, _| v.get(i).copied().unwrap_or(0.0));
        self.bend(&v).into()
    }

    /// H
    pub fn hessian(&self) -> Matrix3<f64> {
        let (n, a) = (V::from(self.normal), V::from(self.straight));
        self.curvature * (Matrix3::identity() - n * n.transpose() - a * a.transpose())
    }

    /// The change of `H b` along a:
    /// `-k ((n.a) H b + (n.b) H a + n (a . H b))`.
    pub fn third(&self, a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        let (n, a, b) = (V::from(self.normal), V::from(a), V::from(b));
        let (bent_a, bent_b) = (self.bend(&a), self.bend(&b));
        (-self.curvature * (n.dot(&a) * bent_b + n.dot(&b) * bent_a + a.dot(&bent_b) * n)).into()
    }

    fn bend(&self, v: &V) -> V {
        let (n, a) = (V::from(self.normal), V::from(self.straight));
        self.curvature * (v - n * n.dot(v) - a * a.dot(v))
    }

    /// From the shape grown by a radius.
    #[must_use]
    pub(super) fn grown(self, radius: f64) -> Self {
        SignedDistance { value: self.value - radius, ..self }
    }

    /// In axes that are turned by R: the distance of `R x` from the turned obstacle.
    #[must_use]
    pub fn turned(self, r: &Matrix3<f64>) -> Self {
        let turn = |v: [f64; 3]| (r * V::from(v)).into();
        SignedDistance { normal: turn(self.normal), straight: turn(self.straight), ..self }
    }
}
