//! Second derivatives of a body's virtual work `lambda . r = int P(F, m) : grad lambda dX`.

use crate::body_energy::BodyEnergy;
use crate::body_energy::control_vjp::add_by_slot;
use crate::body_energy::driving::Driving;
use crate::body_energy::formulation::StressJet;
use crate::body_energy::product::{add_weighted, weigh};
use crate::contribution::sensitivities::{Increment, SecondSensitivities};
use crate::error::SecondDerivativeError;
use crate::history::History;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, PointBatch, Slots};
use nastic_tensor::Mat3;
use std::ops::Range;

/// With `L = F'(u) lambda` and `D = F'(u) du` at every point, spread like a stress
///
/// `d2P/dF2 : (L, D) + sum_k v_k d2P/dm_k dF : L`,
///
/// and split by point and slot `int (d2P/dm_k dF : D + sum_l d2P/dm_k dm_l v_l) : L dX`. Where F is not affine in u, the nodal forces are
/// the mixed derivative along lambda and (du, v) of those of P, whose own changes are `dP/dF : L`, `dP/dF : D + dP/dm v` and, added to the
/// one above, `dP/dF : F''(lambda, du)`; by slot there is `dP/dm_k : F''(lambda, du)` more.
pub(super) fn add(
    body: &BodyEnergy,
    at: (Displaced, Driving),
    lambda: &[f64],
    along: &Increment,
    out: &mut SecondSensitivities,
    parallel: bool,
) -> Result<(), SecondDerivativeError> {
    let SecondSensitivities { u, controls } = out;
    let work = SecondVjp { body, to: at.0, driving: at.1, lambda, along };
    body.sweep(
        parallel,
        |cells| cells.row_length() + body.slots_of_cell(cells, at.1) + 9 * cells.part.table.points,
        |cells, patch, scratch, answer: &mut PatchAnswer| work.compute(cells, patch, scratch, answer),
        |cells, patch, answer| {
            cells.scatter(patch, &answer.rows, u);
            add_by_slot(body, cells, patch, &answer.by_slot, controls, &mut History::default());
        },
    )
}

struct SecondVjp<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    driving: Driving<'a>,
    lambda: &'a [f64],
    along: &'a Increment<'a>,
}

#[derive(Clone, Default)]
struct PatchAnswer {
    rows: Vec<f64>,
    /// See [`add_by_slot`].
    by_slot: Vec<f64>,
    /// Room for `grad lambda` at the points.
    of_lambda: Vec<Mat3>,
}

impl SecondVjp<'_> {
    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        answer: &mut PatchAnswer,
    ) -> Result<(), SecondDerivativeError> {
        let PatchAnswer { rows, by_slot, of_lambda } = answer;
        self.body.kinematics(cells, patch, self.to, Some(self.driving), scratch)?;
        let formulation = self.body.arithmetic_of(cells.first(patch));
        let curved = !formulation.is_affine();
        formulation.change(cells, patch, self.lambda, scratch);
        of_lambda.clone_from(&scratch.change);
        let along_lambda = if curved { scratch.dilatation.along.clone() } else { Vec::new() };
        formulation.change(cells, patch, self.along.u, scratch);
        scratch.clear_stress();
        by_slot.clear();
        let mut bend = curved.then(|| self.bend(cells, patch, scratch, [&along_lambda, &scratch.dilatation.along]));
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let changes: [&[Mat3]; 2] = [&of_lambda[range.clone()], &scratch.change[range.clone()]];
            let stress = &mut scratch.stress[range.clone()];
            for own in self.body.laws_of(at.cell) {
                let (law, m) = (&own.law, self.driving.of_law(own, &at));
                let v = self.driving.changes(own, self.along.controls, &at);
                let (m, v) = (m.get(), v.get());
                law.second_stress_change(&at, m, changes, stress)?;
                if m.width == 0 || law.evolution().is_some() {
                    // a viscous law has second derivatives where it is relaxed, and none by a growth in front of it
                    by_slot.resize(by_slot.len() + m.count(at.len()), 0.0);
                    if let Some(bend) = &mut bend {
                        bend.add(law, &at, &range, m, changes, stress);
                    }
                    continue;
                }
                let by_control = &mut scratch.by_control;
                by_control.resize(at.len() * m.width, Mat3::zeros());
                law.control_stress_change(&at, m, changes[0], Slots::none(), by_control)?;
                add_weighted(by_control, v, stress);
                law.control_stress_change(&at, m, changes[1], v, by_control)?;
                let mut by_point: Vec<f64> = Vec::with_capacity(at.len() * m.width);
                for (by_control, of_lambda) in by_control.chunks_exact(m.width).zip(changes[0]) {
                    by_point.extend(by_control.iter().map(|stress| stress.dot(of_lambda)));
                }
                if let Some(bend) = &mut bend {
                    bend.add(law, &at, &range, m, changes, stress);
                    law.stress_by_control(&at, m, by_control);
                    add_weighted(by_control, v, &mut bend.of_along[range.clone()]);
                    let second = bend.second[range.clone()].iter();
                    let second = second.flat_map(|change| std::iter::repeat_n(change, m.width));
                    by_point.iter_mut().zip(&*by_control).zip(second).for_each(|((sum, p), f)| *sum += p.dot(f));
                }
                let weights = scratch.weights[range.clone()].iter();
                let weight = weights.flat_map(|weight| std::iter::repeat_n(weight, m.width));
                let weighted = by_point.iter().zip(weight).map(|(value, weight)| weight * value);
                let first = by_slot.len();
                by_slot.resize(first + m.count(at.len()), 0.0);
                // of global scope the sum over the points
                let count = m.count(at.len());
                weighted.enumerate().for_each(|(n, value)| by_slot[first + n % count] += value);
            }
        }
        weigh(&mut scratch.stress, &scratch.weights);
        cells.clear_rows(patch, rows);
        let Some(mut bend) = bend else {
            formulation.add_force(cells, scratch, &scratch.stress, rows);
            return Ok(());
        };
        for part in [&mut bend.stress, &mut bend.of_lambda, &mut bend.of_along] {
            weigh(part, &scratch.weights);
        }
        let jet = StressJet {
            along: [&along_lambda, &scratch.dilatation.along],
            parts: [&bend.stress, &bend.of_lambda, &bend.of_along, &scratch.stress],
        };
        formulation.add_force_derivative(cells, scratch, jet, 3, rows);
        Ok(())
    }

    fn bend(&self, cells: Cells, patch: Patch, scratch: &Scratch, along: [&[Mat3]; 2]) -> Bend {
        let zeros = vec![Mat3::zeros(); scratch.kinematics.len()];
        Bend {
            second: self.body.arithmetic_of(cells.first(patch)).second_change(scratch, along),
            stress: self.body.stresses(cells, patch, scratch, self.driving),
            of_lambda: zeros.clone(),
            of_along: zeros,
        }
    }
}

/// What a formulation adds in which F is not affine in u.
struct Bend {
    /// `F''(u)(lambda, du)` at the points.
    second: Vec<Mat3>,
    /// P, and its changes along lambda and along the increment.
    stress: Vec<Mat3>,
    of_lambda: Vec<Mat3>,
    of_along: Vec<Mat3>,
}

impl Bend {
    /// Of one law on a cell: first changes, and what `F''` adds to the second one.
    fn add(
        &mut self,
        law: &dyn EnergyTerm,
        at: &PointBatch,
        range: &Range<usize>,
        m: Slots,
        changes: [&[Mat3]; 2],
        mixed: &mut [Mat3],
    ) {
        law.stress_change(at, m, changes[0], &mut self.of_lambda[range.clone()]);
        law.stress_change(at, m, changes[1], &mut self.of_along[range.clone()]);
        law.stress_change(at, m, &self.second[range.clone()], mixed);
    }
}
