//! A product with the tangent for which no matrix is assembled.

use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::body_energy::assembly::slots;
use crate::contributions::body_energy::formulation::StressJet;
use crate::contributions::controls::Controls;
use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, Cells, sweep};
use crate::kernels::kernel;
use nastic_energy::{EnergyTerm, PointBatch, Response, Slots, Want};
use nastic_tensor::Mat3;

/// `out += K(u, m) v`: at every point the change of stress `dP/dF : F'(u) v`, spread like a stress, and what the stress has by `F''(u)`.
pub(super) fn add(
    body: &BodyEnergy,
    at: (&[f64], &Controls),
    v: &[f64],
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
    v: &'a [f64],
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
        self.body.kinematics(self.cells, c, self.u, scratch)?;
        let formulation = self.body.arithmetic_of(id);
        formulation.change(self.cells, c, self.v, scratch);
        scratch.clear_stress();
        let at = PointBatch { kinematics: &scratch.kinematics, cell: id, first };
        let composition = &self.body.compositions[self.body.of_cell[id] as usize];
        for &t in &composition.terms {
            self.body.terms[t].stress_change(&at, Slots::none(), &scratch.change, &mut scratch.stress);
        }
        for &k in &composition.actuations {
            let m = slots(self.controls, k, first, points);
            self.body.actuations[k].law.stress_change(&at, m, &scratch.change, &mut scratch.stress);
        }
        let weights = &self.body.discretization().points().weights()[first..first + points];
        weigh(&mut scratch.stress, weights);
        rows.fill(0.0);
        if formulation.is_affine() {
            formulation.add_force(self.cells, scratch, &scratch.stress, rows);
            return Ok(());
        }
        let mut stress = self.body.stresses(&at, self.controls);
        weigh(&mut stress, weights);
        let jet = StressJet { along: [&scratch.dilatation.along, &[]], parts: [&stress, &scratch.stress, &[], &[]] };
        formulation.add_force_derivative(self.cells, scratch, jet, 1, rows);
        Ok(())
    }
}

/// Multiplies stresses by the weights of their points.
pub(super) fn weigh(stress: &mut [Mat3], weights: &[f64]) {
    stress.iter_mut().zip(weights).for_each(|(stress, &w)| *stress *= w);
}

impl BodyEnergy {
    /// P of all terms and actuations at the points of a cell.
    pub(super) fn stresses(&self, at: &PointBatch, controls: &Controls) -> Vec<Mat3> {
        let mut stress = vec![Mat3::zeros(); at.len()];
        let mut out = Response { energy: &mut [], stress: &mut stress, tangent: &mut [] };
        let composition = &self.compositions[self.of_cell[at.cell] as usize];
        for &t in &composition.terms {
            self.terms[t].respond(at, Slots::none(), Want::STRESS, &mut out);
        }
        for &k in &composition.actuations {
            let m = slots(controls, k, at.first, at.len());
            self.actuations[k].law.respond(at, m, Want::STRESS, &mut out);
        }
        stress
    }
}
