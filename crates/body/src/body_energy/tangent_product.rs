//! A product with the tangent for which no matrix is assembled.

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::body_energy::formulation::StressJet;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, sweep};
use crate::kernels::cells::Cells;
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, Response, Want};
use nastic_tensor::Mat3;

/// `out += K(u, m) v`: at every point the change of stress `dP/dF : F'(u) v`, spread like a stress, and what the stress has by `F''(u)`.
pub(super) fn add(
    body: &BodyEnergy,
    at: (Displaced, Driving),
    v: &[f64],
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
    v: &'a [f64],
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
        self.body.kinematics(self.cells, patch, self.to, scratch)?;
        let formulation = self.body.arithmetic_of(self.cells.first(patch));
        formulation.change(self.cells, patch, self.v, scratch);
        scratch.clear_stress();
        for (range, at) in self.cells.batches(patch, &scratch.kinematics) {
            let (change, stress) = (&scratch.change[range.clone()], &mut scratch.stress[range]);
            for (law, m) in self.body.laws(&at, self.driving) {
                law.stress_change(&at, m, change, stress);
            }
        }
        weigh(&mut scratch.stress, &scratch.weights);
        self.cells.clear_rows(patch, rows);
        if formulation.is_affine() {
            formulation.add_force(self.cells, scratch, &scratch.stress, rows);
            return Ok(());
        }
        let mut stress = self.body.stresses(self.cells, patch, scratch, self.driving);
        weigh(&mut stress, &scratch.weights);
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
    /// P of all terms and actuations at the points of a patch that was moved to.
    pub(super) fn stresses(&self, cells: Cells, patch: Patch, scratch: &Scratch, driving: Driving) -> Vec<Mat3> {
        let mut stress = vec![Mat3::zeros(); scratch.kinematics.len()];
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let mut out = Response { energy: &mut [], stress: &mut stress[range], tangent: &mut [] };
            for (law, m) in self.laws(&at, driving) {
                law.respond(&at, m, Want::STRESS, &mut out);
            }
        }
        stress
    }
}
