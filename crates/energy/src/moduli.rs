use nastic_tensor::{Mat3, Tangent, Vec3};

/// Small-strain moduli (Pa) of a stress-free rest state, isotropic or transversely isotropic about a fibre `f`:
///
/// `W = lambda/2 (tr e)^2 + mu_T e:e + alpha (f.ef) tr e + 2 (mu_L - mu_T) |e f|^2 + beta/2 (f.ef)^2`, `e = sym grad u`
///
/// (Spencer's five constants).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli {
    /// First Lame constant.
    pub lambda: f64,
    /// Shear modulus in the plane across the fibre; *the* shear modulus of an isotropic law.
    pub mu_t: f64,
    /// Shear modulus along the fibre.
    pub mu_l: f64,
    /// Coupling of fibre strain and volume change.
    pub alpha: f64,
    /// Extra stiffness of the fibre.
    pub beta: f64,
    /// The fibre; `None` for an isotropic law.
    pub fiber: Option<Vec3>,
}

impl Moduli {
    /// Isotropic: `lambda/2 (tr e)^2 + mu e:e`.
    pub const fn isotropic(lambda: f64, mu: f64) -> Self {
        Moduli { lambda, mu_t: mu, mu_l: mu, alpha: 0.0, beta: 0.0, fiber: None }
    }

    /// Read off `dP/dF` (Pa) of a stress-free rest state that is isotropic, or transversely isotropic about the unit vector `fiber`.
    pub fn of_rest(tangent: &Tangent, fiber: Option<Vec3>) -> Self {
        let f = fiber.unwrap_or_else(Vec3::x);
        let n = if f.x.abs() < 0.7 { Vec3::x().cross(&f) } else { Vec3::y().cross(&f) }.normalize();
        let b = f.cross(&n);
        let of = |p: &Vec3, q: &Vec3, u: &Vec3, v: &Vec3| {
            let change = u * v.transpose() + v * u.transpose();
            p.dot(&(tangent.apply(&change) * q)) / 2.0
        };
        let (lambda, mu_t, mu_l) = (of(&n, &n, &b, &b), of(&n, &b, &n, &b), of(&f, &n, &f, &n));
        if fiber.is_none() {
            return Moduli::isotropic(lambda, mu_t);
        }
        let alpha = of(&n, &n, &f, &f) - lambda;
        let beta = of(&f, &f, &f, &f) - lambda - 2.0 * mu_t - 2.0 * alpha - 4.0 * (mu_l - mu_t);
        Moduli { lambda, mu_t, mu_l, alpha, beta, fiber }
    }

    /// Stress (Pa) of a small displacement gradient.
    pub fn stress(&self, gradient: &Mat3) -> Mat3 {
        let e = (gradient + gradient.transpose()) / 2.0;
        let mut s = Mat3::identity() * (self.lambda * e.trace()) + e * (2.0 * self.mu_t);
        if let Some(f) = &self.fiber {
            let (ef, ff) = (e * f, f * f.transpose());
            let stretch = f.dot(&ef);
            s += Mat3::identity() * (self.alpha * stretch) + ff * (self.alpha * e.trace() + self.beta * stretch);
            s += (ef * f.transpose() + f * ef.transpose()) * (2.0 * (self.mu_l - self.mu_t));
        }
        s
    }

    /// The elasticity tensor, equal to `dP/dF` at the rest state.
    pub fn elasticity(&self) -> Tangent {
        Tangent::from_map(|gradient| self.stress(gradient))
    }

    /// Bulk modulus: a third of the mean stress over the strain of `e = I`, `lambda + 2 mu / 3` for isotropic laws.
    pub fn bulk(&self) -> f64 {
        self.stress(&Mat3::identity()).trace() / 9.0
    }

    /// Young's modulus along the unit vector `a`: stress over strain of a bar that is free to contract.
    /// `None` when the elasticity tensor is singular.
    pub fn young(&self, a: &Vec3) -> Option<f64> {
        let aa = a * a.transpose();
        let compliance = symmetric_matrix(self).try_inverse()?;
        let along = to_symmetric(&aa);
        Some(1.0 / (along.transpose() * compliance * along)[(0, 0)])
    }
}

type Vec6 = nalgebra::SVector<f64, 6>;

/// Orthonormal components of a symmetric matrix: diagonal, then `sqrt 2` times the off-diagonal entries.
fn to_symmetric(m: &Mat3) -> Vec6 {
    let r = std::f64::consts::SQRT_2;
    Vec6::from([m[(0, 0)], m[(1, 1)], m[(2, 2)], r * m[(1, 2)], r * m[(0, 2)], r * m[(0, 1)]])
}

fn from_symmetric(v: &Vec6) -> Mat3 {
    let r = std::f64::consts::FRAC_1_SQRT_2;
    let (a, b, c) = (r * v[3], r * v[4], r * v[5]);
    Mat3::new(v[0], c, b, c, v[1], a, b, a, v[2])
}

fn symmetric_matrix(moduli: &Moduli) -> nalgebra::SMatrix<f64, 6, 6> {
    let columns: [Vec6; 6] = std::array::from_fn(|k| {
        let mut unit = Vec6::zeros();
        unit[k] = 1.0;
        to_symmetric(&moduli.stress(&from_symmetric(&unit)))
    });
    nalgebra::SMatrix::from_columns(&columns)
}
