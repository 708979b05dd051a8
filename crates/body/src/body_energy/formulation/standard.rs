//! [`Standard`]: the displacement formulation.

use super::{CellFormulation, StressJet};
use crate::discretization::Discretization;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_tensor::{Kinematics, Mat3};

/// `F = 1 + grad u` at every point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Standard;

impl CellFormulation for Standard {
    fn is_affine(&self) -> bool {
        true
    }

    fn kinematics(
        &self,
        _: &Discretization,
        cells: Cells,
        patch: Patch,
        to: Displaced,
        scratch: &mut Scratch,
    ) -> Result<(), Inadmissible> {
        scratch.move_to(cells, patch, to)
    }

    fn own<'a>(&self, scratch: &'a Scratch) -> &'a [Kinematics] {
        &scratch.kinematics
    }

    fn projected(&self, _: &Scratch, _: &[f64]) -> Option<Vec<f64>> {
        None
    }

    fn changes_of_modes(&self, _: Cells, _: Patch, _: &Scratch) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn change(&self, cells: Cells, patch: Patch, v: &[f64], scratch: &mut Scratch) {
        scratch.change_by(cells, patch, v);
    }

    fn second_change(&self, scratch: &Scratch, _: [&[Mat3]; 2]) -> Vec<Mat3> {
        vec![Mat3::zeros(); scratch.kinematics.len()]
    }

    fn add_force(&self, cells: Cells, scratch: &Scratch, stress: &[Mat3], rows: &mut [f64]) {
        cells.force(&scratch.g, stress, rows);
    }

    fn add_force_derivative(&self, cells: Cells, scratch: &Scratch, jet: StressJet, which: usize, rows: &mut [f64]) {
        cells.force(&scratch.g, jet.parts[which], rows);
    }

    fn tangent(&self, cells: Cells, patch: Patch, scratch: &mut Scratch, matrix: &mut PatchMatrix) {
        cells.tangent(patch, &scratch.g, &scratch.tangent, matrix, &mut scratch.work);
    }
}
