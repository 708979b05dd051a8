//! [`Formulation`]: what stands between element and law.

use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::Cells;
use nastic_tensor::{Mat3, Tangent};
use std::fmt::Debug;

/// How the displacement of a cell becomes the deformation gradients that laws see at its points, and the transposes of that:
/// `F = F(u)`, `dF = F'(u) v`, `f = F'(u)^T P`, `K = F'(u)^T (dP/dF) F'(u) + P : F''(u)`. Stresses and tangents carry their
/// quadrature weights.
pub(crate) trait Formulation: Debug + Send + Sync {
    /// Shape gradients and kinematics of the c-th cell displaced by u, into the scratch.
    fn kinematics(&self, cells: Cells, c: usize, u: &[f64], scratch: &mut Scratch) -> Result<(), InvertedAt>;

    /// The change of F along a nodal field v at the cell whose kinematics are in the scratch.
    fn change(&self, cells: Cells, c: usize, v: &[f64], scratch: &mut Scratch);

    /// Adds the nodal forces of stresses to rows, with the shape gradients g of the scratch.
    fn add_force(&self, cells: Cells, g: &[f64], stress: &[Mat3], rows: &mut [f64]);

    /// Sets the element matrix.
    fn tangent(&self, cells: Cells, g: &[f64], tangents: &[Tangent], matrix: &mut [f64], work: &mut Vec<f64>);
}

/// `F = 1 + grad u` at every point: the displacement formulation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Standard;

impl Formulation for Standard {
    fn kinematics(&self, cells: Cells, c: usize, u: &[f64], scratch: &mut Scratch) -> Result<(), InvertedAt> {
        scratch.move_to(cells, c, u)
    }

    fn change(&self, cells: Cells, c: usize, v: &[f64], scratch: &mut Scratch) {
        scratch.change_by(cells, c, v);
    }

    fn add_force(&self, cells: Cells, g: &[f64], stress: &[Mat3], rows: &mut [f64]) {
        cells.kernel.force(g, stress, rows);
    }

    fn tangent(&self, cells: Cells, g: &[f64], tangents: &[Tangent], matrix: &mut [f64], work: &mut Vec<f64>) {
        cells.kernel.tangent(g, tangents, matrix, work);
    }
}
