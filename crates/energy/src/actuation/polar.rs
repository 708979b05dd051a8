use nastic_tensor::{Kinematics, Mat3, cofactor};

/// Polar decomposition `F = R U`, and what turns moments about the axes of `U` into spins.
pub struct Polar {
    /// Rotation.
    pub r: Mat3,
    /// Right stretch, symmetric.
    pub u: Mat3,
    /// `G^-1`, `G = (tr U) I - U`.
    pub compliance: Mat3,
}

impl Polar {
    /// By Newton's iteration `X <- (g X + X^-T / g) / 2` with Higham's scaling, which ends within ten steps even for
    /// stretches sixteen decades apart.
    pub fn new(k: &Kinematics) -> Self {
        let mut r = *k.f();
        for _ in 0..20 {
            let h = cofactor(&r);
            let inverse_transpose = h / (h.dot(&r) / 3.0);
            let scale = (inverse_transpose.norm() / r.norm()).sqrt();
            let next = (r * scale + inverse_transpose / scale) * 0.5;
            let change = (next - r).norm();
            r = next;
            if change < 1e-15 {
                break;
            }
        }
        let ru = r.transpose() * k.f();
        let u = (ru + ru.transpose()) * 0.5;
        let g = Mat3::from_diagonal_element(u.trace()) - u;
        let h = cofactor(&g);
        // G is symmetric with eigenvalues the sums of two stretches, all positive.
        Polar { r, u, compliance: h / (h.dot(&g) / 3.0) }
    }
}
