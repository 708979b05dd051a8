//! The control derivative of a body's virtual work.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::controls::Controls;
use crate::error::Inadmissible;
use crate::history::History;
use crate::kernels::cell_scratch::Scratch;
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
    let work = ControlVjp { body, to: at.0, driving: at.1, lambda };
    body.sweep(
        parallel,
        |cells| body.slots_of_cell(cells, at.1),
        |cells, patch, scratch, values: &mut Vec<f64>| work.compute(cells, patch, scratch, values),
        |cells, patch, values| add_by_slot(body, cells, patch, values, controls, history),
    )
}

impl BodyEnergy {
    /// Numbers that the slots of all laws have in a cell, at most.
    pub(super) fn slots_of_cell(&self, cells: &Cells, driving: Driving) -> usize {
        let slots: usize = (0..self.actuations.len()).map(|k| driving.width(k)).sum();
        slots * cells.part.table.points
    }
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
        let first = part.first_point(c as usize);
        for law in body.laws_of(part.cells[c as usize] as usize) {
            let width: usize = law.blocks.iter().map(|&k| controls.slots(k).max(history.width(k))).sum();
            let (mut behind, mut taken) = (0, 0);
            for &k in &law.blocks {
                let (own, sums) = match history.width(k) {
                    0 => (controls.slots(k), controls.values_mut(k)),
                    width => (width, history.values_mut(k)),
                };
                let shared = sums.len() == own;
                if shared && law.blocks.len() == 1 {
                    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                    taken = own;
                    continue;
                }
                for q in 0..points {
                    let sums = &mut sums[if shared { 0 } else { own * (first + q) }..][..own];
                    sums.iter_mut().zip(&values[q * width + behind..]).for_each(|(sum, value)| *sum += value);
                }
                (behind, taken) = (behind + own, width * points);
            }
            values = &values[taken..];
        }
    }
}

struct ControlVjp<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    driving: Driving<'a>,
    lambda: &'a [f64],
}

impl ControlVjp<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        values: &mut Vec<f64>,
    ) -> Result<(), Inadmissible> {
        values.clear();
        if !self.body.is_actuated(cells, patch) {
            return Ok(());
        }
        self.body.kinematics(cells, patch, self.to, Some(self.driving), scratch)?;
        self.body.arithmetic_of(cells.first(patch)).change(cells, patch, self.lambda, scratch);
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            for (law, m) in self.body.laws(&at, self.driving) {
                let m = m.get();
                if m.width == 0 {
                    continue; // without slots, or relaxed
                }
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
