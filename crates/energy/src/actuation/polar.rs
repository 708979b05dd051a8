use nastic_tensor::{Kinematics, Mat3, cofactor, polar_rotation};

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
    /// Of `F`; its `J > 0`, so that there is a rotation.
    pub fn new(k: &Kinematics) -> Self {
        let r = polar_rotation(k.f()).unwrap_or_else(|| Mat3::repeat(f64::NAN));
        let ru = r.transpose() * k.f();
        let u = (ru + ru.transpose()) * 0.5;
        let g = Mat3::from_diagonal_element(u.trace()) - u;
        let h = cofactor(&g);
        // G is symmetric with eigenvalues the sums of two stretches, all positive.
        Polar { r, u, compliance: h / (h.dot(&g) / 3.0) }
    }
}
