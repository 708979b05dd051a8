//! The longest step along which no point of a body is inverted.

use crate::discretization::Discretization;
use crate::discretization::quadrature_points::gather_rows;
use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::Cells;
use crate::kernels::kernel;
use nastic_tensor::{Kinematics, Mat3};
use rayon::prelude::*;

/// Cells of one task.
const CHUNK: usize = 128;

/// The longest step `s <= 1` along which no point loses more than nine tenths of its volume on the way:
/// `det(F + t G) >= det F / 10` for all `t` in `[0, s]`, with `G = grad du`.
///
/// The end of the step alone does not tell: a section reflected in two directions has J > 0 again.
pub(crate) fn max_step(disc: &Discretization, u: &[f64], du: &[f64], parallel: bool) -> Result<f64, InvertedAt> {
    let dim = disc.dim();
    let mut least: f64 = 1.0;
    for part in &disc.points().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let chunk = |cells: &[usize]| -> Result<f64, InvertedAt> {
            let mut scratch = Scratch::new(part, dim);
            let mut gradients = vec![Mat3::zeros(); part.table.points];
            let mut least: f64 = 1.0;
            for &c in cells {
                scratch.move_to(Cells { part, kernel, dim }, c, u)?;
                gather_rows(du, part.nodes_of(c), dim, part.table.width, &mut scratch.rows);
                gradients.fill(Mat3::zeros());
                kernel.displacement_gradients(&scratch.g, &scratch.rows, &mut gradients);
                for (kinematics, g) in scratch.kinematics.iter().zip(&gradients) {
                    least = least.min(volume_step(kinematics, g));
                }
            }
            Ok(least)
        };
        let cells: Vec<usize> = (0..part.cells.len()).collect();
        let steps: Vec<Result<f64, InvertedAt>> = match parallel {
            true => cells.par_chunks(CHUNK).map(chunk).collect(),
            false => cells.chunks(CHUNK).map(chunk).collect(),
        };
        for step in steps {
            least = least.min(step?);
        }
    }
    Ok(least)
}

/// The condition of [`max_step`] at one point, to a factor of two: the Bernstein coefficients of the cubic
/// `det(F + t G) - det F / 10` on `[0, s]` are positive.
pub(crate) fn volume_step(at: &Kinematics, g: &Mat3) -> f64 {
    let constant = 0.9 * at.j();
    let linear = at.h().dot(g);
    let quadratic = at.f().dot(&nastic_tensor::cofactor(g));
    let cubic = g.determinant();
    let mut s = 1.0;
    for _ in 0..50 {
        let (b, c, d) = (linear * s, quadratic * s * s, cubic * s * s * s);
        let bernstein = [constant + b / 3.0, constant + 2.0 * b / 3.0 + c / 3.0, constant + b + c + d];
        if bernstein.iter().all(|&coefficient| coefficient > 0.0) {
            break;
        }
        s *= 0.5;
    }
    s
}
