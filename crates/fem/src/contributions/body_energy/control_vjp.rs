//! The control derivative of a body's virtual work.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::body_energy::assembly::slots;
use crate::contributions::controls::Controls;
use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, Cells, sweep};
use crate::kernels::kernel;
use nastic_energy::PointBatch;
use nastic_tensor::Mat3;

/// `int (dP/dm_k) : grad lambda dX`, split by point and slot, for every actuation.
pub(super) fn add(
    body: &BodyEnergy,
    at: (&[f64], &Controls),
    lambda: &[f64],
    out: &mut Controls,
    parallel: bool,
) -> Result<(), InvertedAt> {
    let disc = body.discretization();
    for part in &disc.points().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let cells = Cells { part, kernel, dim: disc.dim() };
        let work = ControlVjp { body, cells, u: at.0, controls: at.1, lambda };
        sweep(&work, parallel, |c, values: &Vec<f64>| {
            let mut values = values.as_slice();
            for &k in &body.compositions[body.of_cell[part.cells[c] as usize] as usize].actuations {
                let (width, first) = (at.1.slots(k), part.first_point(c));
                let (own, rest) = values.split_at(width * part.table.points);
                let sums = &mut out.values_mut(k)[width * first..][..own.len()];
                sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                values = rest;
            }
        })?;
    }
    Ok(())
}

struct ControlVjp<'a> {
    body: &'a BodyEnergy,
    cells: Cells<'a>,
    u: &'a [f64],
    controls: &'a Controls,
    lambda: &'a [f64],
}

impl CellWork for ControlVjp<'_> {
    /// Of the cell's actuations one after the other, shape `[points][slots]`.
    type Answer = Vec<f64>;
    type Error = InvertedAt;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (Vec<f64>, usize) {
        let slots: usize = (0..self.controls.len()).map(|k| self.controls.slots(k)).sum();
        (Vec::new(), slots * self.cells.part.table.points)
    }

    fn compute(&self, c: usize, scratch: &mut Scratch, values: &mut Vec<f64>) -> Result<(), InvertedAt> {
        let (part, points) = (self.cells.part, self.cells.part.table.points);
        let (id, first) = (part.cells[c] as usize, part.first_point(c));
        let composition = &self.body.compositions[self.body.of_cell[id] as usize];
        values.clear();
        if composition.actuations.is_empty() {
            return Ok(());
        }
        self.body.kinematics(self.cells, c, self.u, scratch)?;
        self.body.arithmetic_of(id).change(self.cells, c, self.lambda, scratch);
        let at = PointBatch { kinematics: &scratch.kinematics, cell: id, first };
        let weights = &self.body.discretization().points().weights()[first..first + points];
        for &k in &composition.actuations {
            let m = slots(self.controls, k, first, points);
            scratch.by_control.resize(points * m.width, Mat3::zeros());
            let by_control = &mut scratch.by_control[..];
            self.body.actuations[k].law.stress_by_control(&at, m, by_control);
            let at_points = by_control.chunks_exact(m.width).zip(&scratch.change).zip(weights);
            for ((by_control, change), weight) in at_points {
                values.extend(by_control.iter().map(|stress| weight * stress.dot(change)));
            }
        }
        Ok(())
    }
}
