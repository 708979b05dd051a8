//! The control derivative of a body's virtual work.

use crate::assembly::slots;
use crate::body::Body;
use crate::controls::Controls;
use crate::error::InvertedAt;
use crate::kernel::kernel;
use crate::sampling::gather_rows;
use crate::scratch::Scratch;
use nastic_energy::Points;
use nastic_tensor::Mat3;

pub(crate) fn pull_back(body: &Body, u: &[f64], controls: &Controls, lambda: &[f64]) -> Result<Controls, InvertedAt> {
    let disc = body.discretization();
    let dim = disc.dim();
    let mut out = body.controls();
    for part in &disc.body().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let points = part.table.points;
        let mut scratch = Scratch::new(part, dim);
        let mut adjoint = vec![Mat3::zeros(); points];
        for c in 0..part.cells.len() {
            let id = part.cells[c] as usize;
            let composition = &body.compositions[body.of_cell[id] as usize];
            if composition.actuations.is_empty() {
                continue;
            }
            scratch.move_to(part, kernel, c, u, dim)?;
            gather_rows(lambda, part.nodes_of(c), dim, part.table.width, &mut scratch.rows);
            adjoint.fill(Mat3::zeros());
            kernel.displacement_gradients(&scratch.g, &scratch.rows, &mut adjoint);
            let first = part.first_point(c);
            let at = Points { kinematics: &scratch.kinematics, cell: id, first };
            for &k in &composition.actuations {
                let width = controls.slots(k);
                let mut by_control = vec![Mat3::zeros(); points * width];
                body.actuations[k].law.stress_by_control(&at, slots(controls, k, first, points), &mut by_control);
                let target = &mut out.values_mut(k)[first * width..(first + points) * width];
                for (s, value) in target.iter_mut().enumerate() {
                    let q = s / width;
                    *value = disc.body().weights()[first + q] * by_control[s].dot(&adjoint[q]);
                }
            }
        }
    }
    Ok(out)
}
