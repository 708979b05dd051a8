//! The rotation of a deformed body at every node.

use nastic_body::discretization::Discretization;
use nastic_body::kernels::cell_scratch::Scratch;
use nastic_body::kernels::cells::Cells;
use nastic_body::kernels::displaced::Displaced;
use nastic_body::kernels::patch::Patch;
use nastic_linear::Rotations;
use nastic_tensor::{Mat3, polar_rotation};
use rayon::prelude::*;

/// Cells of one task.
const CELLS_PER_TASK: usize = 128;

/// The rotation of the body at every node: that of the polar decomposition of the sum over the cells that meet there of
/// `int F dX`. Cells that are inverted do not count.
pub(crate) fn nodal_rotations(disc: &Discretization, u: &[f64], parallel: bool) -> Rotations {
    let mut sums = vec![Mat3::zeros(); disc.mesh().points().len()];
    for group in Cells::all(disc) {
        let cells: Vec<u32> = (0..group.part.cells.len() as u32).collect();
        let means = group.map(&cells, CELLS_PER_TASK, parallel, |cells| means(group, cells, u));
        for (c, mean) in means.iter().flatten().enumerate() {
            group.part.nodes_of(c).iter().for_each(|&node| sums[node as usize] += mean);
        }
    }
    let parallel = parallel && sums.len() > 8 * CELLS_PER_TASK;
    Rotations(if parallel { sums.par_iter().map(rotation).collect() } else { sums.iter().map(rotation).collect() })
}

/// `int F dX` of each cell.
fn means(group: Cells, cells: &[u32], u: &[f64]) -> Vec<Mat3> {
    let mut scratch = Scratch::new(group);
    let mean = |c: &u32| match scratch.move_to(group, Patch::single(c), Displaced::by(u)) {
        Ok(()) => scratch.kinematics.iter().zip(&scratch.weights).map(|(at, &w)| at.f() * w).sum(),
        Err(_) => Mat3::zeros(),
    };
    cells.iter().map(mean).collect()
}

/// The rotation of a mean deformation gradient; the identity where there is none.
fn rotation(f: &Mat3) -> Mat3 {
    polar_rotation(f).unwrap_or_else(Mat3::identity)
}
