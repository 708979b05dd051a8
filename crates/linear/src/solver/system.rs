//! [`System`]: the matrix of a linear system, and where it was taken.

use crate::matrix::SparseMatrix;
use crate::multigrid::Corners;
use crate::operator::Operator;
use crate::rotations::Rotations;
use crate::space::Space;
use std::sync::Arc;

/// Where a matrix was taken: what preconditioners need besides its entries.
pub trait Configuration: Sync {
    /// Current positions of the nodes (z = 0 in two dimensions).
    fn positions(&self) -> &[[f64; 3]];

    /// Rotation of the body at every node.
    fn rotations(&self) -> &Arc<Rotations>;

    /// The corner nodes of second-order elements.
    fn corners(&self) -> Option<&Corners>;

    /// The space of the unknowns: what sums over them.
    fn space(&self) -> &Space {
        Space::LOCAL
    }
}

/// The system of a matrix whose supported rows and columns are eliminated, with where it was taken.
#[derive(Clone, Copy)]
pub struct System<'a> {
    /// The matrix.
    pub matrix: &'a SparseMatrix,
    /// By unknown: whether its row and column were eliminated.
    pub fixed: &'a [bool],
    /// Where the matrix was taken.
    pub configuration: &'a dyn Configuration,
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
}

impl System<'_> {
    /// What sums over its unknowns.
    pub fn space(&self) -> &Space {
        self.configuration.space()
    }

    /// `out = A v`.
    pub fn multiply(&self, v: &[f64], out: &mut [f64]) {
        self.matrix.multiply_on(v, out, self.parallel);
    }

    /// `out = A^T v`.
    pub fn multiply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.matrix.multiply_transposed(v, out, self.parallel);
    }
}

impl Operator for System<'_> {
    fn apply(&self, v: &[f64], out: &mut [f64]) {
        self.multiply(v, out);
    }

    fn apply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.multiply_transposed(v, out);
    }
}
