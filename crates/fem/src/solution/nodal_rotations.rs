//! The rotation of a deformed body at every node.

use crate::discretization::Discretization;
use crate::discretization::quadrature_points::CellGroup;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::Cells;
use crate::kernels::kernel;
use nastic_linear::Rotations;
use nastic_tensor::{Mat3, polar_rotation};
use rayon::prelude::*;

/// Cells of one task.
const CHUNK: usize = 128;

/// The rotation of the body at every node: that of the polar decomposition of the sum over the cells that meet there of
/// `int F dX`. Cells that are inverted do not count.
pub(crate) fn nodal_rotations(disc: &Discretization, u: &[f64], parallel: bool) -> Rotations {
    let mut sums = vec![Mat3::zeros(); disc.mesh().points().len()];
    for part in &disc.points().parts {
        let cells: Vec<usize> = (0..part.cells.len()).collect();
        let means: Vec<Vec<Mat3>> = match parallel {
            true => cells.par_chunks(CHUNK).map(|cells| means(disc, part, cells, u)).collect(),
            false => cells.chunks(CHUNK).map(|cells| means(disc, part, cells, u)).collect(),
        };
        for (c, mean) in means.iter().flatten().enumerate() {
            part.nodes_of(c).iter().for_each(|&node| sums[node as usize] += mean);
        }
    }
    Rotations(if parallel { sums.par_iter().map(rotation).collect() } else { sums.iter().map(rotation).collect() })
}

/// `int F dX` of each cell.
fn means(disc: &Discretization, part: &CellGroup, cells: &[usize], u: &[f64]) -> Vec<Mat3> {
    let Some(kernel) = kernel(part.kind) else { return vec![Mat3::zeros(); cells.len()] };
    let mut scratch = Scratch::new(part, disc.dim());
    let mean = |&c: &usize| match scratch.move_to(Cells { part, kernel, dim: disc.dim() }, c, u) {
        Ok(()) => {
            let weights = &disc.points().weights()[part.first_point(c)..][..part.table.points];
            scratch.kinematics.iter().zip(weights).map(|(at, &w)| at.f() * w).sum()
        }
        Err(_) => Mat3::zeros(),
    };
    cells.iter().map(mean).collect()
}

/// The rotation of a mean deformation gradient; the identity where there is none.
fn rotation(f: &Mat3) -> Mat3 {
    polar_rotation(f).unwrap_or_else(Mat3::identity)
}
