//! The change of the internal forces along a change of the controls.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::body_energy::assembly::slots;
use crate::contributions::controls::Controls;
use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, Cells, sweep};
use crate::kernels::kernel;
use nastic_energy::{PointBatch, Slots};
use nastic_tensor::Mat3;

/// `out += dr/dm v`: at every point the change of stress `sum_k v_k dP/dm_k`, spread like a stress.
pub(super) fn add(
    body: &BodyEnergy,
    at: (&[f64], &Controls),
    v: &Controls,
    out: &mut [f64],
    parallel: bool,
) -> Result<(), InvertedAt> {
    let disc = body.discretization();
    for part in &disc.points().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let cells = Cells { part, kernel, dim: disc.dim() };
        let work = Product { body, cells, u: at.0, controls: at.1, v };
        sweep(&work, parallel, |c, rows| cells.scatter(c, rows, out))?;
    }
    Ok(())
}

struct Product<'a> {
    body: &'a BodyEnergy,
    cells: Cells<'a>,
    u: &'a [f64],
    controls: &'a Controls,
    v: &'a Controls,
}

impl CellWork for Product<'_> {
    type Answer = Vec<f64>;
    type Error = InvertedAt;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (Vec<f64>, usize) {
        let rows = self.cells.rows();
        let size = rows.len();
        (rows, size)
    }

    fn compute(&self, c: usize, scratch: &mut Scratch, rows: &mut Vec<f64>) -> Result<(), InvertedAt> {
        let (part, points) = (self.cells.part, self.cells.part.table.points);
        let (id, first) = (part.cells[c] as usize, part.first_point(c));
        let composition = &self.body.compositions[self.body.of_cell[id] as usize];
        rows.fill(0.0);
        if composition.actuations.is_empty() {
            return Ok(());
        }
        self.body.kinematics(self.cells, c, self.u, scratch)?;
        scratch.clear_stress();
        let at = PointBatch { kinematics: &scratch.kinematics, cell: id, first };
        for &k in &composition.actuations {
            let (m, v) = (slots(self.controls, k, first, points), slots(self.v, k, first, points));
            scratch.by_control.resize(points * m.width, Mat3::zeros());
            self.body.actuations[k].law.stress_by_control(&at, m, &mut scratch.by_control);
            add_weighted(&scratch.by_control, v, &mut scratch.stress);
        }
        let weights = &self.body.discretization().points().weights()[first..first + points];
        scratch.stress.iter_mut().zip(weights).for_each(|(stress, &w)| *stress *= w);
        self.body.arithmetic_of(id).add_force(self.cells, scratch, &scratch.stress, rows);
        Ok(())
    }
}

/// Adds `sum_k v_k by_control_k` at every point.
pub(super) fn add_weighted(by_control: &[Mat3], v: Slots, stress: &mut [Mat3]) {
    let at_points = by_control.chunks_exact(v.width).zip(v.values.chunks_exact(v.width));
    for (stress, (by_control, v)) in stress.iter_mut().zip(at_points) {
        by_control.iter().zip(v).for_each(|(change, v)| *stress += change * *v);
    }
}
