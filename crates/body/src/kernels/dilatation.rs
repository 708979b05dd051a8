//! [`Dilatation`]: deformation gradients whose determinant is projected onto a few modes of the cell or patch.
//!
//! With `J = det F` at its points, their weights w, and modes that are orthonormal there, `sum_q w_q phi_i phi_j = delta_ij`,
//!
//! ```text
//! Jbar_q = sum_i phi_i(q) sum_r w_r phi_i(r) J_r
//! Fbar   = s F,   s = (Jbar / J)^(1/d)          d = 3; in plane strain d = 2 and F_33 = 1 stays: det Fbar = Jbar in both
//! ```
//!
//! The derivative of `sum_q w_q W(Fbar_q)` by `F_q` is the stress that forces are made of: with `P = w dW/dF` at Fbar,
//! `t = P : Fbar / d` (entries in the plane) and `H = cof F`,
//!
//! ```text
//! S = s P + (w pbar - t / J) H,   pbar = sum_i phi_i sum_r phi_i(r) t_r / Jbar_r
//! ```
//!
//! so that pbar is the projected pressure that the Hu-Washizu principle has as an unknown. Both are written once, for any
//! [`Scalar`]: with hyper-dual numbers they give the derivatives along displacements.

use nastic_tensor::{HyperDual, Scalar};
use nastic_tensor::{Kinematics, Mat3};

/// A 3x3 matrix by rows.
pub(crate) type Square<T> = [[T; 3]; 3];

/// The modes of one patch with its kinematics.
#[derive(Debug, Default)]
pub struct Dilatation {
    /// Shape `[mode][point]`.
    modes: Vec<f64>,
    weights: Vec<f64>,
    dim: usize,
    /// F of the displacement at the points.
    pub own: Vec<Kinematics>,
    /// The gradient of another field.
    pub along: Vec<Mat3>,
}

/// What is modified at a point.
struct StretchedPoint<T> {
    h: Square<T>,
    j: T,
    jbar: T,
    scale: T,
}

impl Dilatation {
    /// Modes of the constant, and with `linear` of the positions too, orthonormal in the reference measure of the patch.
    pub fn set_modes(&mut self, dim: usize, weights: &[f64], positions: &[[f64; 3]], linear: bool) {
        self.dim = dim;
        self.weights.clear();
        self.weights.extend_from_slice(weights);
        self.modes.clear();
        let volume: f64 = weights.iter().sum();
        self.modes.resize(weights.len(), 1.0 / volume.sqrt());
        for k in 0..if linear { dim } else { 0 } {
            let first = self.modes.len();
            self.modes.extend(positions.iter().map(|x| x[k]));
            let (before, mode) = self.modes.split_at_mut(first);
            // twice: once leaves what rounding of nearly dependent ones amounts to
            for earlier in [0, 1].iter().flat_map(|_| before.chunks_exact(weights.len())) {
                let share = product(weights, earlier, mode);
                mode.iter_mut().zip(earlier).for_each(|(m, e)| *m -= share * e);
            }
            let size = product(weights, mode, mode).sqrt();
            mode.iter_mut().for_each(|m| *m /= size);
        }
    }

    /// Number of modes.
    pub fn modes(&self) -> impl Iterator<Item = &[f64]> {
        self.modes.chunks_exact(self.weights.len())
    }

    /// Space dimensions: the exponent of s is one over them.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Quadrature weights.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// `sum_i phi_i sum_r w_r phi_i(r) v_r`
    pub fn project<T: Scalar>(&self, values: &[T]) -> Vec<T> {
        let weighted: Vec<T> = values.iter().zip(&self.weights).map(|(v, w)| *v * T::of(*w)).collect();
        self.spread(&weighted)
    }

    /// `sum_i phi_i sum_r phi_i(r) v_r`
    pub fn spread<T: Scalar>(&self, values: &[T]) -> Vec<T> {
        let mut out = vec![T::of(0.0); values.len()];
        for mode in self.modes() {
            let part = values.iter().zip(mode).fold(T::of(0.0), |sum, (v, m)| sum + *v * T::of(*m));
            out.iter_mut().zip(mode).for_each(|(out, m)| *out = *out + part * T::of(*m));
        }
        out
    }

    /// `Jbar` at every point of the cell's own F.
    pub fn jacobians(&self) -> Vec<f64> {
        self.project(&self.own.iter().map(Kinematics::j).collect::<Vec<_>>())
    }

    /// Fbar at every point.
    pub fn modified<T: Scalar>(&self, f: &[Square<T>]) -> Vec<Square<T>> {
        f.iter().zip(self.points(f)).map(|(f, at)| self.scaled(f, at.scale)).collect()
    }

    /// The stress S; stresses carry the weights.
    pub fn stress<T: Scalar>(&self, f: &[Square<T>], p: &[Square<T>]) -> Vec<Square<T>> {
        let points = self.points(f);
        let traces: Vec<T> = (0..f.len()).map(|q| self.trace(&p[q], &self.scaled(&f[q], points[q].scale))).collect();
        let pressures: Vec<T> = traces.iter().zip(&points).map(|(t, at)| *t / at.jbar).collect();
        let projected = self.spread(&pressures);
        let at_points = points.iter().zip(p).zip(&traces).zip(projected.iter().zip(&self.weights));
        let stress = at_points.map(|(((at, p), t), (pressure, w))| {
            let factor = *pressure * T::of(*w) - *t / at.j;
            from_entries(|i, k| at.scale * p[i][k] + factor * at.h[i][k])
        });
        stress.collect()
    }

    /// The cell's own F and derivatives along two fields (none: zero), as hyper-dual numbers.
    pub fn along(&self, [a, b]: [&[Mat3]; 2]) -> Vec<Square<HyperDual>> {
        let f: Vec<Mat3> = self.own.iter().map(|k| *k.f()).collect();
        jets([&f, a, b, &[]])
    }

    fn points<T: Scalar>(&self, f: &[Square<T>]) -> Vec<StretchedPoint<T>> {
        let cofactors: Vec<Square<T>> = f.iter().map(cofactor).collect();
        let expand = |(f, h): (&Square<T>, &Square<T>)| f[0][0] * h[0][0] + f[0][1] * h[0][1] + f[0][2] * h[0][2];
        let jacobians: Vec<T> = f.iter().zip(&cofactors).map(expand).collect();
        let projected = self.project(&jacobians);
        let each = cofactors.into_iter().zip(jacobians).zip(projected);
        each.map(|((h, j), jbar)| StretchedPoint { h, j, jbar, scale: (jbar / j).root(self.dim) }).collect()
    }

    /// s F, in the plane alone where there is one.
    fn scaled<T: Scalar>(&self, f: &Square<T>, scale: T) -> Square<T> {
        from_entries(|i, k| if i < self.dim && k < self.dim { scale * f[i][k] } else { f[i][k] })
    }

    /// `P : Fbar / d`, entries in the plane.
    fn trace<T: Scalar>(&self, p: &Square<T>, fbar: &Square<T>) -> T {
        let mut sum = T::of(0.0);
        for (p, f) in p.iter().zip(fbar).take(self.dim) {
            for (p, f) in p.iter().zip(f).take(self.dim) {
                sum = sum + *p * *f;
            }
        }
        sum * T::of(1.0 / self.dim as f64)
    }
}

/// Values and their three derivatives by point; an empty slice is zero.
pub(crate) fn jets(parts: [&[Mat3]; 4]) -> Vec<Square<HyperDual>> {
    let entry = |q: usize, i: usize, k: usize| parts.map(|part| part.get(q).map_or(0.0, |m| m[(i, k)]));
    (0..parts[0].len()).map(|q| from_entries(|i, k| HyperDual(entry(q, i, k)))).collect()
}

/// One of the four parts by point.
pub(crate) fn part(jets: &[Square<HyperDual>], which: usize) -> Vec<Mat3> {
    jets.iter().map(|jet| Mat3::from_fn(|i, k| jet[i][k].0[which])).collect()
}

/// Numbers by rows.
pub(crate) fn rows(m: &Mat3) -> Square<f64> {
    from_entries(|i, k| m[(i, k)])
}

/// The matrix of rows.
pub(crate) fn matrix(m: &Square<f64>) -> Mat3 {
    Mat3::from_fn(|i, k| m[i][k])
}

fn from_entries<T>(entry: impl Fn(usize, usize) -> T) -> Square<T> {
    std::array::from_fn(|i| std::array::from_fn(|k| entry(i, k)))
}

fn cofactor<T: Scalar>(f: &Square<T>) -> Square<T> {
    from_entries(|i, j| {
        let (k, m) = ((i + 1) % 3, (i + 2) % 3);
        let (l, n) = ((j + 1) % 3, (j + 2) % 3);
        f[k][l] * f[m][n] - f[k][n] * f[m][l]
    })
}

fn product(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    weights.iter().zip(a).zip(b).map(|((w, a), b)| w * a * b).sum()
}
