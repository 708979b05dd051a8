//! Functions of symmetric positive definite tensors and their derivatives.

use nastic_tensor::{Mat3, SymmetricSpectrum};

/// Eigenvalues and eigenvectors of a symmetric tensor.
#[derive(Debug)]
pub(super) struct Spectrum {
    values: [f64; 3],
    axes: Mat3,
}

impl Spectrum {
    pub fn new(a: &Mat3) -> Self {
        let SymmetricSpectrum { values, axes } = SymmetricSpectrum::new(a);
        Spectrum { values: values.into(), axes }
    }

    pub fn values(&self) -> &[f64; 3] {
        &self.values
    }

    /// The eigenvectors, column by column.
    pub fn axes(&self) -> &Mat3 {
        &self.axes
    }

    /// `f(A) = sum_i f(x_i) n_i (x) n_i`
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Mat3 {
        let diagonal = Mat3::from_diagonal(&self.values.map(f).into());
        self.axes * diagonal * self.axes.transpose()
    }

    /// The divided differences `f[x_i, x_j]`, `f[x, y] = (f(x) - f(y))/(x - y)`, `f'(x)` where `x = y`.
    pub fn divided(&self, f: impl Fn(f64, f64) -> f64) -> Mat3 {
        let [x, y, z] = self.values;
        let (xy, xz, yz) = (f(x, y), f(x, z), f(y, z));
        Mat3::new(f(x, x), xy, xz, xy, f(y, y), yz, xz, yz, f(z, z))
    }

    /// `Df(A)[D]` of a symmetric D: in the axes of A the entries `f[x_i, x_j] D_ij` (Daleckii and Krein), of the divided differences of f. It is its
    /// own transpose.
    pub fn change(&self, divided: &Mat3, d: &Mat3) -> Mat3 {
        let inside = (self.axes.transpose() * d * self.axes).component_mul(divided);
        self.axes * inside * self.axes.transpose()
    }
}

/// `ln x / x`
pub(super) fn log_over(x: f64) -> f64 {
    x.ln() / x
}

/// The divided difference of `ln x / x`, to rounding where x and y are close: with `x = y (1 + t)`
/// it is `(ln(1 + t)/t - ln y)/(x y)`.
pub(super) fn log_over_divided(x: f64, y: f64) -> f64 {
    let t = (x - y) / y;
    let slope = if t == 0.0 { 1.0 } else { t.ln_1p() / t };
    (slope - y.ln()) / (x * y)
}

/// The divided difference of `x^p`, likewise: `y^(p-1) ((1 + t)^p - 1)/t`.
pub(super) fn power_divided(p: f64) -> impl Fn(f64, f64) -> f64 {
    move |x, y| {
        let t = (x - y) / y;
        let slope = if t == 0.0 { p } else { (p * t.ln_1p()).exp_m1() / t };
        y.powf(p - 1.0) * slope
    }
}
