use crate::Mat3;

/// Tensor cross product `(A x B)_iJ = eps_ikm eps_JLN A_kL B_mN`: bilinear and symmetric.
///
/// With `H = (F x F)/2` and `J = (H:F)/3` it turns derivatives of cofactor and determinant into products:
/// `dH = F x dF`, `dJ = H : dF`.
///
/// ```
/// use nastic_tensor::{Mat3, cofactor, cross};
/// let (f, df) = (Mat3::new(1.0, 0.2, 0.0, 0.1, 0.9, 0.3, 0.0, 0.0, 1.2), Mat3::new(0.0, 1.0, 2.0, 0.5, 0.1, 0.0, 1.0, 0.0, 0.3));
/// // The cofactor is quadratic, so a central difference of any step is exact.
/// let difference = (cofactor(&(f + df)) - cofactor(&(f - df))) / 2.0;
/// assert!((cross(&f, &df) - difference).norm() < 1e-14);
/// ```
#[inline]
pub fn cross(a: &Mat3, b: &Mat3) -> Mat3 {
    let entry = |i: usize, j: usize| {
        let (k, m) = ((i + 1) % 3, (i + 2) % 3);
        let (l, n) = ((j + 1) % 3, (j + 2) % 3);
        a[(k, l)] * b[(m, n)] - a[(k, n)] * b[(m, l)] + a[(m, n)] * b[(k, l)] - a[(m, l)] * b[(k, n)]
    };
    Mat3::new(
        entry(0, 0),
        entry(0, 1),
        entry(0, 2),
        entry(1, 0),
        entry(1, 1),
        entry(1, 2),
        entry(2, 0),
        entry(2, 1),
        entry(2, 2),
    )
}

/// Cofactor `H = (F x F)/2`, equal to `J F^-T` where `F` is invertible.
#[inline]
pub fn cofactor(f: &Mat3) -> Mat3 {
    let entry = |i: usize, j: usize| {
        let (k, m) = ((i + 1) % 3, (i + 2) % 3);
        let (l, n) = ((j + 1) % 3, (j + 2) % 3);
        f[(k, l)] * f[(m, n)] - f[(k, n)] * f[(m, l)]
    };
    Mat3::new(
        entry(0, 0),
        entry(0, 1),
        entry(0, 2),
        entry(1, 0),
        entry(1, 1),
        entry(1, 2),
        entry(2, 0),
        entry(2, 1),
        entry(2, 2),
    )
}
