//! The grid of a control in words.

use nastic_control::{ControlBlock, Reduced};

/// What there is to say of a grid that is finer than the mesh.
pub(super) fn unresolved(block: &ControlBlock, body: &Reduced) -> Option<String> {
    let (grid, disc) = (block.basis.grid()?, body.solid().discretization());
    let most = block.basis.resolved_grid(disc)?;
    let [own, most] = [grid.cells(), most].map(|cells| grid_cells(cells, disc.dim()));
    Some(format!(
        "cells of the grid of {own} are smaller than cells of the mesh and hold too few quadrature points: the mesh resolves a \
         grid of at most {most}"
    ))
}

/// The cells of a grid on a body of a dimension: `4 x 2` in the plane, `4 x 2 x 2` in space.
pub fn grid_cells(cells: [u32; 3], dim: usize) -> String {
    cells.iter().take(dim).map(u32::to_string).collect::<Vec<_>>().join(" x ")
}
