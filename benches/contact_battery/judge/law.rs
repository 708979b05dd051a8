//! Energies and stresses of the laws that problems are made of.

use nastic::tensor::Mat3;

/// A passive law.
#[derive(Debug, Clone, Copy)]
pub enum Law {
    /// `mu/2 (I1 - 3) - mu ln J + lambda/2 (J - 1)^2`
    NeoHooke { mu: f64, lambda: f64 },
    /// `a (I1 - 3) + b (I2 - 3) + c (J - 1)^2 - 2 (a + 2 b) ln J`
    Mooney { a: f64, b: f64, c: f64 },
}

impl Law {
    /// All its moduli times a factor.
    pub fn scaled(&self, by: f64) -> Self {
        match *self {
            Law::NeoHooke { mu, lambda } => Law::NeoHooke { mu: by * mu, lambda: by * lambda },
            Law::Mooney { a, b, c } => Law::Mooney { a: by * a, b: by * b, c: by * c },
        }
    }

    pub fn energy(&self, f: &Mat3) -> f64 {
        let (j, first, second) = (f.determinant(), f.norm_squared(), cofactor(f).norm_squared());
        match *self {
            Law::NeoHooke { mu, lambda } => mu / 2.0 * (first - 3.0) - mu * j.ln() + lambda / 2.0 * (j - 1.0).powi(2),
            Law::Mooney { a, b, c } => {
                a * (first - 3.0) + b * (second - 3.0) + c * (j - 1.0).powi(2) - 2.0 * (a + 2.0 * b) * j.ln()
            }
        }
    }

    /// The first Piola-Kirchhoff stress.
    pub fn stress(&self, f: &Mat3) -> Mat3 {
        let (j, h) = (f.determinant(), cofactor(f));
        match *self {
            Law::NeoHooke { mu, lambda } => mu * f + (lambda * (j - 1.0) - mu / j) * h,
            Law::Mooney { a, b, c } => {
                let right = f.transpose() * f;
                2.0 * a * f
                    + 2.0 * b * (right.trace() * f - f * right)
                    + (2.0 * c * (j - 1.0) - 2.0 * (a + 2.0 * b) / j) * h
            }
        }
    }
}

/// `det(F) F^-T`
pub fn cofactor(f: &Mat3) -> Mat3 {
    let minor = |i: usize, j: usize| {
        let [a, b, c, d] = [(i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3];
        f[(a, c)] * f[(b, d)] - f[(a, d)] * f[(b, c)]
    };
    Mat3::from_fn(minor)
}
