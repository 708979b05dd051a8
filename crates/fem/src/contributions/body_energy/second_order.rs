//! Second derivatives of a body's virtual work `lambda . r = int P(F, m) : grad lambda dX`.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::body_energy::assembly::slots;
use crate::contributions::body_energy::control_product::add_weighted;
use crate::contributions::controls::Controls;
use crate::contributions::{Increment, SecondSensitivities};
use crate::error::SecondDerivativeError;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, Cells, sweep};
use crate::kernels::kernel;
use nastic_energy::{EnergyTerm, PointBatch, Slots};
use nastic_tensor::Mat3;

/// With `L = grad lambda` and `D = grad du` at every point, spread like a stress
///
/// `d2P/dF2 : (L, D) + sum_k v_k d2P/dm_k dF : L`,
///
/// and split by point and slot `int (d2P/dm_k dF : D + sum_l d2P/dm_k dm_l v_l) : L dX`. In every formulation F is affine in u.
pub(super) fn add(
    body: &BodyEnergy,
    at: (&[f64], &Controls),
    (lambda, along): (&[f64], &Increment),
    out: &mut SecondSensitivities,
    parallel: bool,
) -> Result<(), SecondDerivativeError> {
    let disc = body.discretization();
    let SecondSensitivities { u, controls } = out;
    for part in &disc.points().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let cells = Cells { part, kernel, dim: disc.dim() };
        let work = SecondOrder { body, cells, u: at.0, controls: at.1, lambda, along };
        sweep(&work, parallel, |c, answer: &CellAnswer| {
            cells.scatter(c, &answer.rows, u);
            let mut values = answer.by_slot.as_slice();
            for &k in &body.compositions[body.of_cell[part.cells[c] as usize] as usize].actuations {
                let (width, first) = (at.1.slots(k), part.first_point(c));
                let (own, rest) = values.split_at(width * part.table.points);
                let sums = &mut controls.values_mut(k)[width * first..][..own.len()];
                sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                values = rest;
            }
        })?;
    }
    Ok(())
}

struct SecondOrder<'a> {
    body: &'a BodyEnergy,
    cells: Cells<'a>,
    u: &'a [f64],
    controls: &'a Controls,
    lambda: &'a [f64],
    along: &'a Increment<'a>,
}

#[derive(Clone)]
struct CellAnswer {
    rows: Vec<f64>,
    /// Of the cell's actuations one after the other, shape `[points][slots]`.
    by_slot: Vec<f64>,
    /// Room for `grad lambda` at the points.
    of_lambda: Vec<Mat3>,
}

impl CellWork for SecondOrder<'_> {
    type Answer = CellAnswer;
    type Error = SecondDerivativeError;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (CellAnswer, usize) {
        let points = self.cells.part.table.points;
        let slots: usize = (0..self.controls.len()).map(|k| self.controls.slots(k)).sum();
        let rows = self.cells.rows();
        let size = rows.len() + (slots + 9) * points;
        (CellAnswer { rows, by_slot: Vec::new(), of_lambda: Vec::new() }, size)
    }

    fn compute(&self, c: usize, scratch: &mut Scratch, answer: &mut CellAnswer) -> Result<(), SecondDerivativeError> {
        let (part, points) = (self.cells.part, self.cells.part.table.points);
        let (id, first) = (part.cells[c] as usize, part.first_point(c));
        let CellAnswer { rows, by_slot, of_lambda } = answer;
        self.body.kinematics(self.cells, c, self.u, scratch)?;
        self.body.formulation.change(self.cells, c, self.lambda, scratch);
        of_lambda.clone_from(&scratch.change);
        self.body.formulation.change(self.cells, c, self.along.u, scratch);
        scratch.clear_stress();
        by_slot.clear();
        let at = PointBatch { kinematics: &scratch.kinematics, cell: id, first };
        let changes: [&[Mat3]; 2] = [of_lambda, &scratch.change];
        let composition = &self.body.compositions[self.body.of_cell[id] as usize];
        let weights = &self.body.discretization().points().weights()[first..first + points];
        for &t in &composition.terms {
            self.body.terms[t].second_stress_change(&at, Slots::none(), changes, &mut scratch.stress)?;
        }
        for &k in &composition.actuations {
            let law = &self.body.actuations[k].law;
            let (m, v) = (slots(self.controls, k, first, points), slots(self.along.controls, k, first, points));
            law.second_stress_change(&at, m, changes, &mut scratch.stress)?;
            let by_control = &mut scratch.by_control;
            by_control.resize(points * m.width, Mat3::zeros());
            law.control_stress_change(&at, m, of_lambda, Slots::none(), by_control)?;
            add_weighted(by_control, v, &mut scratch.stress);
            law.control_stress_change(&at, m, &scratch.change, v, by_control)?;
            for ((by_control, of_lambda), weight) in by_control.chunks_exact(m.width).zip(&*of_lambda).zip(weights) {
                by_slot.extend(by_control.iter().map(|stress| weight * stress.dot(of_lambda)));
            }
        }
        scratch.stress.iter_mut().zip(weights).for_each(|(stress, &w)| *stress *= w);
        rows.fill(0.0);
        self.body.formulation.add_force(self.cells, &scratch.g, &scratch.stress, rows);
        Ok(())
    }
}
