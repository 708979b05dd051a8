//! [`CellProducts`]: a matrix known by what its cells make of a vector.

use std::fmt;
use std::sync::Arc;

/// The first-order matrix of a cell: the blocks of its pairs of corners `(a, b)`, `b <= a`, row by row, each `[row][column]`.
pub type CornerMatrix = [[[f64; 3]; 3]; 36];

/// A symmetric matrix of three unknowns per node, cell by cell, in the place of its entries: where these are many more bytes. Rows and columns of
/// supported unknowns are those of the identity.
pub trait CellProducts: fmt::Debug + Send + Sync {
    /// `out = A v`, summed in double precision.
    fn multiply(&self, v: &[f64], out: &mut [f64], parallel: bool);

    /// The same with the rows and columns of supported unknowns as they were.
    fn multiply_whole(&self, v: &[f64], out: &mut [f64], parallel: bool);

    /// What every cell makes of a vector that is rounded to single precision, into room of any length and contents: what a cycle smooths with.
    /// Supported unknowns take no part.
    fn of_cells(&self, v: &[f64], room: &mut Vec<f32>, parallel: bool);

    /// That product at a node: the sum over its cells.
    fn at_node(&self, node: usize, of_cells: &[f32]) -> [f64; 3];

    /// The blocks on the diagonal, by node.
    fn diagonal_blocks(&self, parallel: bool) -> Vec<[[f64; 3]; 3]>;

    /// The nodes at the corners of every cell.
    fn corners(&self) -> &[[u32; 8]];

    /// The matrices of the cells from the `first` on by the first-order shapes on these corners, of all unknowns: the Galerkin product where the
    /// corner unknowns next to a supported one are left out.
    fn corner_matrices(&self, first: usize, matrices: &mut [CornerMatrix]);

    /// The matrix and a multiple of the identity.
    fn shifted(&self, by: f64) -> Arc<dyn CellProducts>;

    /// Numbers that are kept, without working memory.
    fn numbers(&self) -> usize;

    /// Memory, in bytes.
    fn bytes(&self) -> usize;
}
