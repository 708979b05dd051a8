//! The change of the internal forces along a change of the controls.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::{Driving, slots};
use crate::body_energy::tangent_product::weigh;
use crate::controls::Controls;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, sweep};
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::Slots;
use nastic_tensor::Mat3;

/// `out += dr/dm v`: at every point the change of stress `sum_k v_k dP/dm_k`, spread like a stress.
pub(super) fn add(
    body: &BodyEnergy,
    at: (Displaced, Driving),
    v: &Controls,
    out: &mut [f64],
    parallel: bool,
) -> Result<(), Inadmissible> {
    for (cells, patches) in body.groups() {
        let work = Product { body, cells, to: at.0, driving: at.1, v };
        sweep(&work, patches, parallel, |patch, rows| cells.scatter(patch, rows, out))?;
    }
    Ok(())
}

struct Product<'a> {
    body: &'a BodyEnergy,
    cells: Cells<'a>,
    to: Displaced<'a>,
    driving: Driving<'a>,
    v: &'a Controls,
}

impl CellWork for Product<'_> {
    type Answer = Vec<f64>;
    type Error = Inadmissible;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (Vec<f64>, usize) {
        (Vec::new(), self.cells.row_length())
    }

    fn compute(&self, patch: Patch, scratch: &mut Scratch, rows: &mut Vec<f64>) -> Result<(), Inadmissible> {
        self.cells.clear_rows(patch, rows);
        if !self.body.is_actuated(self.cells, patch) {
            return Ok(());
        }
        self.body.kinematics(self.cells, patch, self.to, scratch)?;
        scratch.clear_stress();
        for (range, at) in self.cells.batches(patch, &scratch.kinematics) {
            for &k in &self.body.composition_of(at.cell).actuations {
                let (m, v) = (self.driving.slots(k, &at), slots(self.v, k, &at));
                if v.width == 0 {
                    continue; // a viscous law
                }
                scratch.by_control.resize(at.len() * m.width, Mat3::zeros());
                self.body.actuations[k].law.stress_by_control(&at, m, &mut scratch.by_control);
                add_weighted(&scratch.by_control, v, &mut scratch.stress[range.clone()]);
            }
        }
        weigh(&mut scratch.stress, &scratch.weights);
        self.body.arithmetic_of(self.cells.first(patch)).add_force(self.cells, scratch, &scratch.stress, rows);
        Ok(())
    }
}

/// Adds `sum_k v_k by_control_k` at every point.
pub(super) fn add_weighted(by_control: &[Mat3], v: Slots, stress: &mut [Mat3]) {
    for (q, (stress, by_control)) in stress.iter_mut().zip(by_control.chunks_exact(v.width)).enumerate() {
        by_control.iter().zip(v.only(q).values).for_each(|(change, v)| *stress += change * *v);
    }
}
