//! [`System`]: the matrix of a linear system, and where it was taken.

use super::LinearError;
use crate::factor::rotations::Rotations;
use crate::krylov::conjugate_gradients::CgReport;
use crate::krylov::volume_modes::VolumeModes;
use crate::multigrid::{CellProducts, Corners};
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::operator::Operator;
use crate::space::Space;
use std::sync::Arc;

/// Rounding of a residual, as a share of the sum of absolute values that it is a difference of.
const RESIDUAL_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Largest residual that is accepted as rounding, over the one asked for.
const MAX_ROUNDING_RATIO: f64 = 1e3;

/// Where a matrix was taken: what preconditioners need besides its entries.
pub trait Configuration: Sync {
    /// Current positions of the nodes (z = 0 in two dimensions).
    fn positions(&self) -> &[[f64; 3]];

    /// Rotation of the body at every node.
    fn rotations(&self) -> &Arc<Rotations>;

    /// The corner nodes of second-order elements.
    fn corners(&self) -> Option<&Corners>;

    /// The changes of volume that a nearly incompressible matrix resists, as a part of that matrix; nothing where none stands out.
    fn volume_modes(&self) -> Option<&VolumeModes> {
        None
    }

    /// By unknown, whether the potential has a maximum by it, and it is neither eliminated nor follows others; empty where there is none.
    fn maxima(&self) -> &[bool] {
        &[]
    }

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
    /// What stands for its entries, which there are none of then: for solvers that [take products](super::SolverState::takes_products) alone.
    pub products: Option<&'a Arc<dyn CellProducts>>,
    /// By unknown: whether its row and column were eliminated.
    pub fixed: &'a [bool],
    /// Where the matrix was taken.
    pub configuration: &'a dyn Configuration,
    /// Whether the system is that of the transpose.
    pub transposed: bool,
    /// Whether to use all threads; the bits are the same.
    pub parallel: bool,
}

impl System<'_> {
    /// What sums over its unknowns.
    pub fn space(&self) -> &Space {
        self.configuration.space()
    }

    /// Number of free unknowns by which the potential has a [maximum](Configuration::maxima).
    pub fn maxima(&self) -> usize {
        self.configuration.maxima().iter().filter(|is| **is).count()
    }

    /// So many negative eigenvalues of the matrix, less one for each unknown by which the potential has a maximum.
    pub(super) fn beyond_maxima(&self, negative: usize) -> Result<usize, LinearError> {
        let maxima = self.maxima();
        negative.checked_sub(maxima).ok_or(LinearError::NoMaximum { negative, maxima })
    }

    /// The system of the transpose.
    #[must_use]
    pub fn transpose(self) -> Self {
        System { transposed: !self.transposed, ..self }
    }

    /// `out = A v`, or `A^T v` of a transposed system; of several ranks with the sum of their matrices.
    pub fn multiply(&self, v: &[f64], out: &mut [f64]) {
        self.product()(v, out);
    }

    /// The same for several vectors.
    pub fn product(&self) -> impl Fn(&[f64], &mut [f64]) + '_ {
        let of_entries = || self.matrix.products(self.transposed && !self.matrix.is_symmetric());
        let entries = self.products.is_none().then(of_entries);
        move |v, out| {
            match (self.products, &entries) {
                (Some(of_cells), _) => of_cells.multiply(v, out, self.parallel),
                (None, Some(of_entries)) => of_entries.multiply(v, out, self.parallel),
                (None, None) => out.fill(0.0),
            }
            self.space().add_up(out);
        }
    }

    /// Whether the solution of an iteration is as good as wanted, or as double precision has one where that is not far from it:
    /// `|r| <= 8 eps | |A| |x| |`, with the absolute values of the symmetric part of A. A body that hardly anything holds moves far.
    pub(super) fn is_solved(&self, x: &[f64], report: &CgReport, b: &[f64], tolerance: f64) -> bool {
        if report.converged() || report.residual.is_nan() || report.residual > MAX_ROUNDING_RATIO * tolerance {
            return report.converged();
        }
        let (magnitudes, mut sums) = (self.matrix.magnitudes(), vec![0.0; x.len()]);
        let x: Vec<f64> = x.iter().map(|x| x.abs()).collect();
        magnitudes.multiply_on(&x, &mut sums, self.parallel);
        report.residual * self.space().norm(b) <= RESIDUAL_ROUNDING * self.space().norm(&sums)
    }
}

impl Operator for System<'_> {
    fn apply(&self, v: &[f64], out: &mut [f64]) {
        self.multiply(v, out);
    }

    fn apply_transposed(&self, v: &[f64], out: &mut [f64]) {
        self.transpose().multiply(v, out);
    }
}
