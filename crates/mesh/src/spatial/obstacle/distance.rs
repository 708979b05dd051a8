//! [`SignedDistance`]: the distance of a point from an obstacle, and its derivatives.

use super::V;
use nalgebra::Matrix3;

/// The signed distance d of a point, positive outside, with its derivatives to the third order.
///
/// Of a nearest point p of a plane, a line or a point it is `d(x) = +-|x - p(x)| - r`, with a gradient n of length one; with the curvature k of the
/// surface of equal distance and a direction a without any, `H = d2d/dx2 = k (1 - n n^T - a a^T)`. Interpolated on a grid it has a gradient whose
/// length differs from one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDistance {
    /// d
    pub value: f64,
    /// grad d; zero where the distance has no gradient (the center of a sphere).
    pub gradient: [f64; 3],
    bend: Bend,
}

/// Derivatives of the gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bend {
    /// `1 / +-|x - p|`, zero of a plane, and a direction without curvature beside the gradient: that of the axis of a capsule between its ends; zero
    /// where there is none.
    Round { curvature: f64, straight: V },
    /// H, and the third derivatives by [`THIRD`].
    Entries { second: Matrix3<f64>, third: [f64; 10] },
}

/// The coordinates that third derivatives are taken by: in any order they are the same.
const THIRD: [[usize; 3]; 10] =
    [[0, 0, 0], [0, 0, 1], [0, 0, 2], [0, 1, 1], [0, 1, 2], [0, 2, 2], [1, 1, 1], [1, 1, 2], [1, 2, 2], [2, 2, 2]];

/// The derivative of H by a coordinate.
fn derivative(third: &[f64; 10], by: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| {
        let mut axes = [i, j, by];
        axes.sort_unstable();
        THIRD.iter().zip(third).find_map(|(known, value)| (*known == axes).then_some(*value)).unwrap_or_default()
    })
}

impl SignedDistance {
    /// By the nearest point of a plane, a line or a point, with a gradient of length one.
    pub(super) fn round(value: f64, normal: [f64; 3], curvature: f64, straight: [f64; 3]) -> Self {
        SignedDistance { value, gradient: normal, bend: Bend::Round { curvature, straight: V::from(straight) } }
    }

    /// By all derivatives, given the coordinates that they are taken by.
    pub(super) fn interpolated(of: impl Fn(&[usize]) -> f64) -> Self {
        let bend = Bend::Entries { second: Matrix3::from_fn(|i, j| of(&[i, j])), third: THIRD.map(|axes| of(&axes)) };
        SignedDistance { value: of(&[]), gradient: [0, 1, 2].map(|i| of(&[i])), bend }
    }

    /// `m = |grad d|`
    pub fn steepness(&self) -> f64 {
        match self.bend {
            Bend::Round { .. } => 1.0,
            Bend::Entries { .. } => V::from(self.gradient).norm(),
        }
    }

    /// `dm/dx = H n`, n the normal.
    pub fn steepness_change(&self) -> [f64; 3] {
        match self.bend {
            Bend::Round { .. } => [0.0; 3],
            Bend::Entries { second, .. } => (second * V::from(self.normal())).into(),
        }
    }

    /// `n = grad d / m`; zero where the gradient is.
    pub fn normal(&self) -> [f64; 3] {
        match self.bend {
            Bend::Round { .. } => self.gradient,
            Bend::Entries { .. } => V::from(self.gradient).try_normalize(0.0).unwrap_or_default().into(),
        }
    }

    /// `dn/dx = (1 - n n^T) H / m`, not symmetric where m differs from one.
    pub fn normal_change(&self) -> Matrix3<f64> {
        let Bend::Entries { second, .. } = self.bend else { return self.hessian() };
        let (n, m) = (V::from(self.normal()), self.steepness());
        if m > 0.0 { (second - n * (n.transpose() * second)) / m } else { Matrix3::zeros() }
    }

    /// `H v`.
    pub fn second(&self, v: &[f64]) -> [f64; 3] {
        let v = V::from_fn(|i, _| v.get(i).copied().unwrap_or(0.0));
        self.bend(&v).into()
    }

    /// H
    pub fn hessian(&self) -> Matrix3<f64> {
        match self.bend {
            Bend::Round { curvature, straight: a } => {
                let n = V::from(self.gradient);
                curvature * (Matrix3::identity() - n * n.transpose() - a * a.transpose())
            }
            Bend::Entries { second, .. } => second,
        }
    }

    /// The change of `H b` along a; of a nearest point
    /// `-k ((n.a) H b + (n.b) H a + n (a . H b))`.
    pub fn third(&self, a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        let (a, b) = (V::from(a), V::from(b));
        match self.bend {
            Bend::Round { curvature, .. } => {
                let n = V::from(self.gradient);
                let (bent_a, bent_b) = (self.bend(&a), self.bend(&b));
                (-curvature * (n.dot(&a) * bent_b + n.dot(&b) * bent_a + a.dot(&bent_b) * n)).into()
            }
            Bend::Entries { third, .. } => {
                let along = |k: usize| derivative(&third, k) * a[k];
                ((along(0) + along(1) + along(2)) * b).into()
            }
        }
    }

    fn bend(&self, v: &V) -> V {
        match self.bend {
            Bend::Round { curvature, straight: a } => {
                let n = V::from(self.gradient);
                curvature * (v - n * n.dot(v) - a * a.dot(v))
            }
            Bend::Entries { second, .. } => second * v,
        }
    }

    /// With a length added to d.
    #[must_use]
    pub fn plus(self, length: f64) -> Self {
        SignedDistance { value: self.value + length, ..self }
    }

    /// In axes that are turned by R: the distance of `R x` from the turned obstacle.
    #[must_use]
    pub fn turned(self, r: &Matrix3<f64>) -> Self {
        let bend = match self.bend {
            Bend::Round { curvature, straight } => Bend::Round { curvature, straight: r * straight },
            Bend::Entries { second, third } => {
                let both = |m: Matrix3<f64>| r * m * r.transpose();
                let of = [0, 1, 2].map(|k| both(derivative(&third, k)));
                let turned = |[i, j, k]: [usize; 3]| (0..3).map(|l| r[(k, l)] * of[l][(i, j)]).sum();
                Bend::Entries { second: both(second), third: THIRD.map(turned) }
            }
        };
        SignedDistance { gradient: (r * V::from(self.gradient)).into(), bend, ..self }
    }
}
