//! Second derivatives of a body's virtual work `lambda . r = int P(F, m) : grad lambda dX`.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::body_energy::assembly::slots;
use crate::contributions::body_energy::control_product::add_weighted;
use crate::contributions::body_energy::formulation::StressJet;
use crate::contributions::body_energy::tangent_product::weigh;
use crate::contributions::controls::Controls;
use crate::contributions::{Increment, SecondSensitivities};
use crate::error::SecondDerivativeError;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, Cells, sweep};
use crate::kernels::kernel;
use nastic_energy::{EnergyTerm, PointBatch, Slots};
use nastic_tensor::Mat3;

/// With `L = F'(u) lambda` and `D = F'(u) du` at every point, spread like a stress
///
/// `d2P/dF2 : (L, D) + sum_k v_k d2P/dm_k dF : L`,
///
/// and split by point and slot `int (d2P/dm_k dF : D + sum_l d2P/dm_k dm_l v_l) : L dX`. Where F is not affine in u, the nodal forces are
/// the mixed derivative along lambda and (du, v) of those of P, whose own changes are `dP/dF : L`, `dP/dF : D + dP/dm v` and, added to the
/// one above, `dP/dF : F''(lambda, du)`; by slot there is `dP/dm_k : F''(lambda, du)` more.
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
        let formulation = self.body.arithmetic_of(id);
        let curved = !formulation.is_affine();
        formulation.change(self.cells, c, self.lambda, scratch);
        of_lambda.clone_from(&scratch.change);
        let along_lambda = if curved { scratch.dilatation.along.clone() } else { Vec::new() };
        formulation.change(self.cells, c, self.along.u, scratch);
        scratch.clear_stress();
        by_slot.clear();
        let at = PointBatch { kinematics: &scratch.kinematics, cell: id, first };
        let changes: [&[Mat3]; 2] = [of_lambda, &scratch.change];
        let composition = &self.body.compositions[self.body.of_cell[id] as usize];
        let weights = &self.body.discretization().points().weights()[first..first + points];
        let mut bend = curved.then(|| self.bend(scratch, [&along_lambda, &scratch.dilatation.along], &at));
        for &t in &composition.terms {
            let term = &self.body.terms[t];
            term.second_stress_change(&at, Slots::none(), changes, &mut scratch.stress)?;
            if let Some(bend) = &mut bend {
                bend.add(term, &at, Slots::none(), changes, &mut scratch.stress);
            }
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
            let mut by_point: Vec<f64> = Vec::with_capacity(points * m.width);
            for (by_control, of_lambda) in by_control.chunks_exact(m.width).zip(&*of_lambda) {
                by_point.extend(by_control.iter().map(|stress| stress.dot(of_lambda)));
            }
            if let Some(bend) = &mut bend {
                bend.add(law, &at, m, changes, &mut scratch.stress);
                law.stress_by_control(&at, m, by_control);
                add_weighted(by_control, v, &mut bend.of_along);
                let second = bend.second.iter().flat_map(|change| std::iter::repeat_n(change, m.width));
                by_point.iter_mut().zip(&*by_control).zip(second).for_each(|((sum, p), f)| *sum += p.dot(f));
            }
            let weight = weights.iter().flat_map(|weight| std::iter::repeat_n(weight, m.width));
            by_slot.extend(by_point.iter().zip(weight).map(|(value, weight)| weight * value));
        }
        weigh(&mut scratch.stress, weights);
        rows.fill(0.0);
        let Some(mut bend) = bend else {
            formulation.add_force(self.cells, scratch, &scratch.stress, rows);
            return Ok(());
        };
        for part in [&mut bend.stress, &mut bend.of_lambda, &mut bend.of_along] {
            weigh(part, weights);
        }
        let jet = StressJet {
            along: [&along_lambda, &scratch.dilatation.along],
            parts: [&bend.stress, &bend.of_lambda, &bend.of_along, &scratch.stress],
        };
        formulation.add_force_derivative(self.cells, scratch, jet, 3, rows);
        Ok(())
    }
}

impl SecondOrder<'_> {
    fn bend(&self, scratch: &Scratch, along: [&[Mat3]; 2], at: &PointBatch) -> Bend {
        let zeros = vec![Mat3::zeros(); at.len()];
        Bend {
            second: self.body.arithmetic_of(at.cell).second_change(scratch, along),
            stress: self.body.stresses(at, self.controls),
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
    /// Of one law: first changes, and what `F''` adds to the second one.
    fn add(&mut self, law: &dyn EnergyTerm, at: &PointBatch, m: Slots, changes: [&[Mat3]; 2], mixed: &mut [Mat3]) {
        law.stress_change(at, m, changes[0], &mut self.of_lambda);
        law.stress_change(at, m, changes[1], &mut self.of_along);
        law.stress_change(at, m, &self.second, mixed);
    }
}
