//! The control derivative of a body's virtual work.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::controls::Controls;
use crate::error::Inadmissible;
use crate::history::History;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, sweep};
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_tensor::Mat3;

/// `int (dP/dm_k) : grad lambda dX`, split by point and slot, for every actuation.
pub(super) fn add(
    body: &BodyEnergy,
    at: (Displaced, Driving),
    lambda: &[f64],
    controls: &mut Controls,
    history: &mut History,
    parallel: bool,
) -> Result<(), Inadmissible> {
    for (cells, patches) in body.groups() {
        let work = ControlVjp { body, cells, to: at.0, driving: at.1, lambda };
        sweep(&work, patches, parallel, |patch, values: &Vec<f64>| {
            add_by_slot(body, cells, patch, values, &mut *controls, &mut *history);
        })?;
    }
    Ok(())
}

/// Adds values of the laws with slots of a patch, cell by cell and one law after the other, shape `[points][slots]`, of global scope `[slots]`.
pub(super) fn add_by_slot(
    body: &BodyEnergy,
    cells: Cells,
    patch: Patch,
    mut values: &[f64],
    controls: &mut Controls,
    history: &mut History,
) {
    let (part, points) = (cells.part, cells.part.table.points);
    for &c in patch.cells {
        for &k in &body.composition_of(part.cells[c as usize] as usize).actuations {
            let first = part.first_point(c as usize);
            let (width, sums) = match history.width(k) {
                0 => (controls.slots(k), controls.values_mut(k)),
                width => (width, history.values_mut(k)),
            };
            let shared = sums.len() == width;
            let (own, rest) = values.split_at(if shared { width } else { width * points });
            let sums = &mut sums[if shared { 0 } else { width * first }..][..own.len()];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            values = rest;
        }
    }
}

struct ControlVjp<'a> {
    body: &'a BodyEnergy,
    cells: Cells<'a>,
    to: Displaced<'a>,
    driving: Driving<'a>,
    lambda: &'a [f64],
}

impl CellWork for ControlVjp<'_> {
    /// See [`add_by_slot`].
    type Answer = Vec<f64>;
    type Error = Inadmissible;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (Vec<f64>, usize) {
        let slots: usize = (0..self.body.actuations.len()).map(|k| self.driving.width(k)).sum();
        (Vec::new(), slots * self.cells.part.table.points)
    }

    fn compute(&self, patch: Patch, scratch: &mut Scratch, values: &mut Vec<f64>) -> Result<(), Inadmissible> {
        values.clear();
        if !self.body.is_actuated(self.cells, patch) {
            return Ok(());
        }
        self.body.kinematics(self.cells, patch, self.to, scratch)?;
        self.body.arithmetic_of(self.cells.first(patch)).change(self.cells, patch, self.lambda, scratch);
        for (range, at) in self.cells.batches(patch, &scratch.kinematics) {
            for &k in &self.body.composition_of(at.cell).actuations {
                let m = self.driving.slots(k, &at);
                if m.width == 0 {
                    continue; // relaxed
                }
                let law = &self.body.actuations[k].law;
                let (changes, weights) = (&scratch.change[range.clone()], &scratch.weights[range.clone()]);
                let first = values.len();
                values.resize(first + m.count(at.len()), 0.0);
                let own = &mut values[first..];
                if m.shared {
                    let weighted: Vec<Mat3> = changes.iter().zip(weights).map(|(change, w)| change * *w).collect();
                    law.slots_vjp(&at, m, &weighted, own);
                    continue;
                }
                law.slots_vjp(&at, m, changes, own);
                for (of_point, weight) in own.chunks_exact_mut(m.width).zip(weights) {
                    of_point.iter_mut().for_each(|value| *value *= weight);
                }
            }
        }
        Ok(())
    }
}
