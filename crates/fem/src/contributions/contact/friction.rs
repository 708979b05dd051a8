//! [`Slip`]: the direction and share of Coulomb friction by the slip velocity.

use nastic_tensor::{Mat3, Vec3};

/// `f(v) = g(|v|) v` and its derivative, with `g(s) = 2/e - s/e^2` below the slip speed e and `1/s` above: Coulomb's friction over its largest
/// value, smoothed with a continuous derivative. Source: Li et al., Incremental Potential Contact, ACM Trans. Graph. 39 (2020), eq. 11.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slip {
    /// f
    pub share: Vec3,
    /// `D = df/dv = g 1 + g' s m m^T`, `m = v/s`
    pub slope: Mat3,
}

/// `F(s)` with `F' = g(s) s`: what friction takes of power per normal force, smoothed like f.
pub(super) fn dissipation(s: f64, e: f64) -> f64 {
    if s < e { s * s / e - s * s * s / (3.0 * e * e) } else { s - e / 3.0 }
}

impl Slip {
    pub fn at(v: &Vec3, e: f64) -> Self {
        let s = v.norm();
        let (g, bend) = if s < e { (2.0 / e - s / (e * e), -s / (e * e)) } else { (1.0 / s, -1.0 / s) };
        let m = if s > 0.0 { v / s } else { Vec3::zeros() };
        Slip { share: g * v, slope: g * Mat3::identity() + bend * m * m.transpose() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_smooth_and_reaches_one() {
        let e = 1e-3;
        for s in [0.0, 0.4e-3, 0.999e-3, 1.001e-3, 0.3] {
            let (v, h) = (s * Vec3::new(0.6, -0.64, 0.48), 1e-8);
            let at = Slip::at(&v, e);
            for k in 0..3 {
                let to = |sign: f64| Slip::at(&(v + sign * h * Vec3::ith(k, 1.0)), e).share;
                let column = (to(1.0) - to(-1.0)) / (2.0 * h);
                assert!((column - at.slope.column(k)).norm() < 1e-4 * at.slope.norm(), "{s}");
            }
            assert!(at.share.norm() <= 1.0 + 1e-15 && (s < e || (at.share.norm() - 1.0).abs() < 1e-15));
        }
    }
}
