//! [`Operator`]: a linear map known by its products.

use super::matrix::SparseMatrix;

/// A square matrix by its products, dofs by mesh node.
pub trait Operator {
    /// `out = A v`.
    fn apply(&self, v: &[f64], out: &mut [f64]);

    /// `out = A^T v`; the same for a symmetric matrix.
    fn apply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.apply(v, out);
    }
}

/// A function `(v, out)` is a symmetric operator.
impl<F: Fn(&[f64], &mut [f64])> Operator for F {
    fn apply(&self, v: &[f64], out: &mut [f64]) {
        self(v, out);
    }
}

impl Operator for SparseMatrix {
    fn apply(&self, v: &[f64], out: &mut [f64]) {
        self.multiply(v, out);
    }

    fn apply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.multiply_transposed(v, out, false);
    }
}

/// A matrix whose products use all threads, to the same bits, if `parallel`.
pub struct OnThreads<'a> {
    /// The matrix.
    pub matrix: &'a SparseMatrix,
    /// Whether to use all threads.
    pub parallel: bool,
}

impl Operator for OnThreads<'_> {
    fn apply(&self, v: &[f64], out: &mut [f64]) {
        self.matrix.multiply_on(v, out, self.parallel);
    }

    fn apply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.matrix.multiply_transposed(v, out, self.parallel);
    }
}
