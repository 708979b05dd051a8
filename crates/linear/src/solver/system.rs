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

/// A dense matrix over the unknowns of some nodes, which need not be coupled in the pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementBlock {
    /// The nodes.
    pub nodes: Vec<u32>,
    /// Its `n = dim * nodes` rows one after the other; unknown `dim * local node + component`.
    pub entries: Vec<f64>,
}

/// The system of a matrix whose supported rows and columns are eliminated, `A = K + sum_e E_e`, with where it was taken.
///
/// The E are blocks beside the pattern of K: they have a part in products, so that solutions are those of A, and none in
/// preconditioners (a factor, a multigrid hierarchy), which are those of K. Their rows and columns of fixed unknowns count as zero.
/// The solvers of symmetric matrices take symmetric ones alone.
#[derive(Clone, Copy)]
pub struct System<'a> {
    /// K.
    pub matrix: &'a SparseMatrix,
    /// E.
    pub extra: &'a [ElementBlock],
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
        self.add_extra(v, out, false);
    }

    /// `out = A^T v`.
    pub fn multiply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.matrix.multiply_transposed(v, out, self.parallel);
        self.add_extra(v, out, true);
    }

    fn add_extra(&self, v: &[f64], out: &mut [f64], transposed: bool) {
        let dim = self.matrix.pattern().dim();
        for ElementBlock { nodes, entries } in self.extra {
            let n = dim * nodes.len();
            let dof = |local: usize| dim * nodes[local / dim] as usize + local % dim;
            let free = |local: &usize| !self.fixed[dof(*local)];
            for i in (0..n).filter(free) {
                let entry = |j: usize| if transposed { entries[n * j + i] } else { entries[n * i + j] };
                out[dof(i)] += (0..n).filter(free).map(|j| entry(j) * v[dof(j)]).sum::<f64>();
            }
        }
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
