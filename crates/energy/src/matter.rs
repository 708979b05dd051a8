//! [`Matter`]: the electric enthalpy of a body by its deformation gradient and the gradient of a potential.

use nastic_tensor::Scalar;

use crate::EnergyError;

/// Three rows of F, and the gradient g of the potential by the drawn body.
pub type Gradients<T> = [[T; 3]; 4];

/// What matter adds to the density of the potential energy in a field, with `s = |e|^2`, `e = F^-T g` (minus the true field), `w = F^-1 e`:
///
/// ```text
/// Omega(F, g) = -J k(s),     dOmega/dF = -J k F^-T + 2 J k' e (x) w,     dOmega/dg = -2 J k' w = D,
/// ```
///
/// D the electric displacement by the drawn area. Equilibria are minima by F and maxima by the potential. Of an ideal dielectric `k = (eps/2) s`, and the stress is that of
/// Maxwell, `eps (e (x) e - |e|^2 1 / 2)`, in the deformed body.
///
/// **Shapes.** F and g in rows of three; densities J/m^3, stress Pa, D C/m^2, g V/m.
///
/// **Source.** A. Dorfmann & R. Ogden, Acta Mech. 174 (2005); R. Bustamante, A. Dorfmann & R. Ogden, Z. angew. Math. Phys. 60 (2009).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Matter {
    /// An ideal dielectric.
    Dielectric {
        /// eps, F/m
        permittivity: f64,
    },
}

/// [`Matter`] at one point, for the changes of its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct MatterPoint {
    /// `k, k', k''`
    co_energy: [f64; 3],
    j: f64,
    /// `F^-1`
    inverse: [[f64; 3]; 3],
    e: [f64; 3],
    w: [f64; 3],
}

impl Matter {
    /// A dielectric.
    ///
    /// # Errors
    /// [`EnergyError::Parameter`] unless the permittivity is positive and finite.
    pub fn dielectric(permittivity: f64) -> Result<Self, EnergyError> {
        crate::Field::Uniform(permittivity).require_positive("dielectric_body", "permittivity")?;
        Ok(Matter::Dielectric { permittivity })
    }

    /// `k` and `k'`.
    fn co_energy<T: Scalar>(&self, s: T) -> [T; 2] {
        let Matter::Dielectric { permittivity } = self;
        let half = T::of(0.5 * permittivity);
        [half * s, half]
    }

    /// `k''`
    fn co_energy_curvature(&self) -> f64 {
        let Matter::Dielectric { .. } = self;
        0.0
    }

    /// Omega; F must have `J > 0`.
    pub fn enthalpy<T: Scalar>(&self, at: &Gradients<T>) -> T {
        let (inverse, j) = inverse(at);
        let e = transposed_times(&inverse, &at[3]);
        T::of(-1.0) * j * self.co_energy(dot(&e, &e))[0]
    }

    /// `dOmega/dF` in three rows and `dOmega/dg`; F must have `J > 0`.
    pub fn duals<T: Scalar>(&self, at: &Gradients<T>) -> Gradients<T> {
        let (inverse, j) = inverse(at);
        let e = transposed_times(&inverse, &at[3]);
        let w = times(&inverse, &e);
        let [k, slope] = self.co_energy(dot(&e, &e));
        let (minus, twice) = (T::of(-1.0) * j * k, T::of(2.0) * j * slope);
        std::array::from_fn(|i| match i {
            3 => std::array::from_fn(|c| T::of(-1.0) * twice * w[c]),
            _ => std::array::from_fn(|c| minus * inverse[c][i] + twice * e[i] * w[c]),
        })
    }

    /// J, and the size of the true field.
    pub fn true_field(&self, at: &Gradients<f64>) -> (f64, f64) {
        let (inverse, j) = inverse(at);
        let e = transposed_times(&inverse, &at[3]);
        (j, dot(&e, &e).sqrt())
    }

    /// At a point; F must have `J > 0`.
    pub fn at(&self, at: &Gradients<f64>) -> MatterPoint {
        let (inverse, j) = inverse(at);
        let e = transposed_times(&inverse, &at[3]);
        let [k, slope] = self.co_energy(dot(&e, &e));
        MatterPoint { co_energy: [k, slope, self.co_energy_curvature()], j, inverse, e, w: times(&inverse, &e) }
    }
}

impl MatterPoint {
    /// How [`Matter::duals`] change along changes of F and g: with `de = F^-T (dg - dF^T e)`, `d(F^-1) = -F^-1 dF F^-1`, `dw = d(F^-1) e + F^-1 de`, `ds = 2 e . de`, `dJ = J F^-T : dF`,
    ///
    /// ```text
    /// d(dOmega/dg) = -2 [(dJ k' + J k'' ds) w + J k' dw],
    /// d(dOmega/dF) = -(dJ k + J k' ds) F^-T - J k d(F^-T) + 2 (dJ k' + J k'' ds) e (x) w + 2 J k' (de (x) w + e (x) dw).
    /// ```
    pub fn change(&self, along: &Gradients<f64>) -> Gradients<f64> {
        let MatterPoint { co_energy: [k, slope, curvature], j, inverse, e, w } = self;
        // dF F^-1
        let turned: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|c| (0..3).map(|m| along[i][m] * inverse[m][c]).sum()));
        let d_inverse: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|c| -(0..3).map(|m| inverse[i][m] * turned[m][c]).sum::<f64>())
        });
        let d_j = j * (0..3).map(|i| turned[i][i]).sum::<f64>();
        let pulled: [f64; 3] = std::array::from_fn(|c| along[3][c] - (0..3).map(|i| along[i][c] * e[i]).sum::<f64>());
        let d_e = transposed_times(inverse, &pulled);
        let (first, second) = (times(&d_inverse, e), times(inverse, &d_e));
        let d_w: [f64; 3] = std::array::from_fn(|c| first[c] + second[c]);
        let d_s = 2.0 * dot(e, &d_e);
        let (d_k, d_slope) = (d_j * k + j * slope * d_s, d_j * slope + j * curvature * d_s);
        std::array::from_fn(|i| match i {
            3 => std::array::from_fn(|c| -2.0 * (d_slope * w[c] + j * slope * d_w[c])),
            _ => std::array::from_fn(|c| {
                -d_k * inverse[c][i] - j * k * d_inverse[c][i]
                    + 2.0 * (d_slope * e[i] * w[c] + j * slope * (d_e[i] * w[c] + e[i] * d_w[c]))
            }),
        })
    }
}

/// `F^-1` and J.
fn inverse<T: Scalar>(f: &Gradients<T>) -> ([[T; 3]; 3], T) {
    let minor = |i: usize, c: usize| {
        let at = |a: usize, b: usize| f[(i + a) % 3][(c + b) % 3];
        at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
    };
    let j = f[0][0] * minor(0, 0) + f[0][1] * minor(0, 1) + f[0][2] * minor(0, 2);
    (std::array::from_fn(|a| std::array::from_fn(|b| minor(b, a) / j)), j)
}

fn dot<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn times<T: Scalar>(a: &[[T; 3]; 3], v: &[T; 3]) -> [T; 3] {
    std::array::from_fn(|i| dot(&a[i], v))
}

fn transposed_times<T: Scalar>(a: &[[T; 3]; 3], v: &[T; 3]) -> [T; 3] {
    std::array::from_fn(|i| a[0][i] * v[0] + a[1][i] * v[1] + a[2][i] * v[2])
}
