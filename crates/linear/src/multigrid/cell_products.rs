//! [`CellProducts`]: a matrix known by what its cells make of a vector.

use std::fmt;

/// Products with the finest matrix in single precision, cell by cell, in the place of its entries: what a cycle smooths with where
/// these are fewer bytes. Of three unknowns per node, and symmetric; a supported unknown takes no part. Vectors are rounded to single precision.
pub trait CellProducts: fmt::Debug + Send + Sync {
    /// What every cell makes of a vector, into room of any length and contents.
    fn of_cells(&self, v: &[f64], room: &mut Vec<f32>, parallel: bool);

    /// The product at a node: the sum over its cells.
    fn at_node(&self, node: usize, of_cells: &[f32]) -> [f64; 3];

    /// Memory, in bytes.
    fn bytes(&self) -> usize;
}
