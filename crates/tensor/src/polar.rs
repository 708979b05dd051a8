//! The rotation of a polar decomposition.

use crate::{Mat3, cofactor};

/// Steps of Newton's iteration; stretches sixteen decades apart take ten.
const STEPS: usize = 20;
/// Change of the last step: rounding.
const ENOUGH: f64 = 1e-15;

/// The rotation `R` of `F = R U` with `U` symmetric and positive; `None` unless `det F > 0` and all entries are finite.
///
/// Newton's iteration `X <- (g X + X^-T / g) / 2` with Higham's scaling `g = (|X^-T| / |X|)^(1/2)` (SIAM J. Sci. Stat.
/// Comput. 7, 1986), which converges within ten steps even for stretches sixteen decades apart.
pub fn polar_rotation(f: &Mat3) -> Option<Mat3> {
    let determinant = cofactor(f).dot(f) / 3.0;
    if determinant.is_nan() || determinant <= 0.0 {
        return None;
    }
    let mut r = *f;
    for _ in 0..STEPS {
        let h = cofactor(&r);
        let inverse_transpose = h / (h.dot(&r) / 3.0);
        let scale = (inverse_transpose.norm() / r.norm()).sqrt();
        let next = (r * scale + inverse_transpose / scale) * 0.5;
        let change = (next - r).norm();
        r = next;
        if change < ENOUGH {
            break;
        }
    }
    r.iter().all(|x| x.is_finite()).then_some(r)
}
