//! `T(A) = tr (A^T A)^s = sum_i l_i^(2s)` over the singular values of A, with exact derivatives whether these coincide or not.

use nastic_tensor::{Mat3, SymmetricSpectrum, Tangent, Vec3};

/// Eigenvalues `c_i` and eigenvectors `Q` of `C = A^T A`.
///
/// `T` is the trace of a function of C, so only divided differences of `g(c) = s c^(s-1)` enter (R. Bhatia, *Matrix Analysis* (1997),
/// theorem V.3.3; the second derivative by F. Hiai & D. Petz, *Introduction to Matrix Analysis and Applications* (2014), theorem 3.33):
/// with `E = A^T B + B^T A`, in the eigenbasis,
///
/// `T_A = 2 A g(C)`, `T_AA : B = 2 B g(C) + 2 A Dg[E]`, `Dg[E]_ij = g[c_i, c_j] E_ij`,
/// `D2g[E, E']_ij = sum_k g[c_i, c_k, c_j] (E_ik E'_kj + E'_ik E_kj)`.
///
/// Where arguments coincide, divided differences are derivatives: nothing is perturbed.
pub(super) struct Spectrum {
    a: Mat3,
    values: Vec3,
    /// `ln c_i`, from which all powers are.
    logs: Vec3,
    vectors: Mat3,
}

/// What T needs at one exponent.
pub(super) struct PowerTrace<'a> {
    of: &'a Spectrum,
    s: f64,
    /// `c_i^(s-1)`.
    powers: Vec3,
    /// `g(C)`.
    g: Mat3,
}

impl Spectrum {
    pub fn new(a: &Mat3) -> Self {
        let SymmetricSpectrum { values, axes } = SymmetricSpectrum::new(&(a.transpose() * a));
        // Rounding may make a vanishing eigenvalue negative.
        let least = f64::EPSILON * f64::EPSILON * values.max();
        let values = values.map(|c| c.max(least));
        Spectrum { a: *a, values, logs: values.map(f64::ln), vectors: axes }
    }

    pub fn power(&self, s: f64) -> PowerTrace<'_> {
        let powers = match whole_or_half(s - 1.0) {
            Some([whole, half]) => self.values.map(|c| c.powi(whole) * if half == 1 { c.sqrt() } else { 1.0 }),
            None => self.logs.map(|log| ((s - 1.0) * log).exp()),
        };
        let g = self.vectors * Mat3::from_diagonal(&(powers * s)) * self.vectors.transpose();
        PowerTrace { of: self, s, powers, g }
    }

    /// `A^T B + B^T A` in the eigenbasis.
    fn strain(&self, b: &Mat3) -> Mat3 {
        let half = self.a.transpose() * b;
        self.vectors.transpose() * (half + half.transpose()) * self.vectors
    }

    fn back(&self, m: &Mat3) -> Mat3 {
        self.vectors * m * self.vectors.transpose()
    }
}

impl PowerTrace<'_> {
    /// `T`.
    pub fn value(&self) -> f64 {
        self.of.values.dot(&self.powers)
    }

    /// `T_A`.
    pub fn first(&self) -> Mat3 {
        self.of.a * self.g * 2.0
    }

    /// `T_AA : B`.
    pub fn second(&self, b: &Mat3) -> Mat3 {
        (b * self.g + self.of.a * self.change_of_g(&self.of.strain(b))) * 2.0
    }

    /// `T_AA`: with the eigenvectors q_a of C and `M_ab = A q_a (x) q_b` it is `2 delta_ik g(C)_JL + 2 sum_ab g[c_a, c_b] M_ab (x) (M_ab + M_ba)`.
    pub fn curvature(&self) -> Tangent {
        let Spectrum { a, vectors, .. } = self.of;
        let mut out = Tangent::zero();
        out.add_metric(&(self.g * 2.0));
        out.add_spectral(&(a * vectors), vectors, &(self.differences_of_g() * 2.0));
        out
    }

    /// `T_AAA : (B, B')`.
    pub fn third(&self, b: &Mat3, other: &Mat3) -> Mat3 {
        let (e, f) = (self.of.strain(b), self.of.strain(other));
        let both = b.transpose() * other;
        let both = self.of.vectors.transpose() * (both + both.transpose()) * self.of.vectors;
        let c = &self.of.values;
        let curved = Mat3::from_fn(|i, j| {
            let term = |k: usize| {
                let three = self.s * second_difference(self.s - 1.0, [c[i], c[k], c[j]]);
                three * (e[(i, k)] * f[(k, j)] + f[(i, k)] * e[(k, j)])
            };
            term(0) + term(1) + term(2)
        });
        let own = self.of.a * (self.of.back(&curved) + self.change_of_g(&both));
        (b * self.change_of_g(&f) + other * self.change_of_g(&e) + own) * 2.0
    }

    /// `Dg[E]` of an E in the eigenbasis.
    fn change_of_g(&self, e: &Mat3) -> Mat3 {
        self.of.back(&self.differences_of_g().component_mul(e))
    }

    /// `g[c_i, c_j]`.
    fn differences_of_g(&self) -> Mat3 {
        let (c, p) = (&self.of.values, self.s - 1.0);
        let of = |i: usize, j: usize| self.s * difference(p, [c[i], c[j]], [self.powers[i], self.powers[j]]);
        let (xy, xz, yz) = (of(0, 1), of(0, 2), of(1, 2));
        Mat3::new(of(0, 0), xy, xz, xy, of(1, 1), yz, xz, yz, of(2, 2))
    }
}

/// An exponent as a whole number and 0 or 1 halves, if it is that and small: such powers take neither exponential nor logarithm.
fn whole_or_half(p: f64) -> Option<[i32; 2]> {
    let twice = 2.0 * p;
    (twice == twice.round() && twice.abs() <= MOST_HALVES).then(|| {
        let twice = twice as i32;
        [twice.div_euclid(2), twice.rem_euclid(2)]
    })
}

/// `(x^p - y^p) / (x - y)` of positive numbers, `p x^(p-1)` where they coincide; to rounding wherever they are.
fn first_difference(p: f64, x: f64, y: f64) -> f64 {
    difference(p, [x, y], [x.powf(p), y.powf(p)])
}

/// The same with the powers `x^p`, `y^p` at hand: numbers that are far apart lose no more than a digit by their difference.
fn difference(p: f64, [x, y]: [f64; 2], [of_x, of_y]: [f64; 2]) -> f64 {
    let (low, high, of_low) = if x <= y { (x, y, of_x) } else { (y, x, of_y) };
    let t = (high - low) / low;
    if t > 10.0 * NEAR {
        return (of_x - of_y) / (x - y);
    }
    let ratio = if t == 0.0 { p } else { (p * t.ln_1p()).exp_m1() / t };
    of_low / low * ratio
}

/// The divided difference of `x^p` over three positive numbers.
fn second_difference(p: f64, mut x: [f64; 3]) -> f64 {
    x.sort_by(f64::total_cmp);
    let [low, middle, high] = x;
    let mean = (low + middle + high) / 3.0;
    if high - low > NEAR * mean {
        return (first_difference(p, middle, high) - first_difference(p, low, middle)) / (high - low);
    }
    // Taylor's series about the mean: sum_n binom(p, n) m^(p-n) h_(n-2), h the complete homogeneous symmetric polynomials of the distances.
    let d = x.map(|x| (x - mean) / mean);
    let (e1, e2, e3) = (d[0] + d[1] + d[2], d[0] * d[1] + d[0] * d[2] + d[1] * d[2], d[0] * d[1] * d[2]);
    let mut h = [1.0, 0.0, 0.0];
    let mut binomial = p * (p - 1.0) / 2.0;
    let mut sum = 0.0;
    for n in 2..2 + TERMS {
        sum += binomial * h[0];
        h = [e1 * h[0] - e2 * h[1] + e3 * h[2], h[0], h[1]];
        binomial *= (p - n as f64) / (n + 1) as f64;
    }
    mean.powf(p - 2.0) * sum
}

/// Numbers within this share of their mean go by the series, others by differences, which lose no more than a digit.
const NEAR: f64 = 0.1;
/// Largest exponent, in halves, that is taken by products.
const MOST_HALVES: f64 = 24.0;
/// Terms of the series: `0.1^20` is below rounding, whatever the power.
const TERMS: usize = 20;

#[cfg(test)]
mod tests {
    use super::{first_difference, second_difference};

    /// Against `x^3`: divided differences x^2 + xy + y^2 and x + y + z; and `1/x`: -1/(xy), 1/(xyz).
    #[test]
    fn divided_differences_of_powers() {
        for [x, y, z] in
            [[1.0, 1.0, 1.0], [2.0, 2.0, 3.0], [1.0, 1.0 + 1e-9, 1.0 - 1e-12], [0.5, 0.52, 0.49], [4.0, 1.0, 0.2]]
        {
            let close = |found: f64, expected: f64| {
                assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected} at {x} {y} {z}");
            };
            close(first_difference(3.0, x, y), x * x + x * y + y * y);
            close(first_difference(-1.0, x, y), -1.0 / (x * y));
            close(second_difference(3.0, [x, y, z]), x + y + z);
            close(second_difference(-1.0, [x, y, z]), 1.0 / (x * y * z));
        }
    }

    /// Both sides of the border between series and differences.
    #[test]
    fn series_and_differences_meet() {
        for p in [-3.7, -0.35, 0.65, 1.5, 6.2] {
            let at = |spread: f64| second_difference(p, [1.0 - spread / 2.0, 1.01, 1.0 + spread / 2.0]);
            let [inside, outside] = [0.0999, 0.1005].map(at);
            let slope = (at(0.1010) - outside) / 0.0005;
            assert!((inside + slope * 0.0006 - outside).abs() < 1e-5 * outside.abs(), "{p}: {inside} {outside}");
        }
    }
}
