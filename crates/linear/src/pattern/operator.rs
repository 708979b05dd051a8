//! [`Operator`] and [`Preconditioner`]: linear maps known by their products.

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

/// An approximate inverse, symmetric and positive definite: `vector = M^-1 vector`.
pub trait Preconditioner {
    /// Overwrites the vector, dofs by mesh node.
    fn apply(&self, vector: &mut [f64]);

    /// Whether it uses all threads: the vectors of an iteration then do so too, to the same bits.
    fn parallel(&self) -> bool {
        false
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
