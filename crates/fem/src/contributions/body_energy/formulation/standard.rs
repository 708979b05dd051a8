//! [`Standard`]: the displacement formulation.

use super::{CellFormulation, StressJet};
use crate::discretization::Discretization;
use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::Cells;
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
        c: usize,
        u: &[f64],
        scratch: &mut Scratch,
    ) -> Result<(), InvertedAt> {
        scratch.move_to(cells, c, u)
    }

    fn own<'a>(&self, scratch: &'a Scratch) -> &'a [Kinematics] {
        &scratch.kinematics
    }

    fn projected(&self, _: &Scratch, _: &[f64]) -> Option<Vec<f64>> {
        None
    }

    fn change(&self, cells: Cells, c: usize, v: &[f64], scratch: &mut Scratch) {
        scratch.change_by(cells, c, v);
    }

    fn second_change(&self, scratch: &Scratch, _: [&[Mat3]; 2]) -> Vec<Mat3> {
        vec![Mat3::zeros(); scratch.kinematics.len()]
    }

    fn add_force(&self, cells: Cells, scratch: &Scratch, stress: &[Mat3], rows: &mut [f64]) {
        cells.kernel.force(&scratch.g, stress, rows);
    }

    fn add_force_derivative(&self, cells: Cells, scratch: &Scratch, jet: StressJet, which: usize, rows: &mut [f64]) {
        cells.kernel.force(&scratch.g, jet.parts[which], rows);
    }

    fn tangent(&self, cells: Cells, scratch: &mut Scratch, matrix: &mut [f64]) {
        cells.kernel.tangent(&scratch.g, &scratch.tangent, matrix, &mut scratch.work);
    }
}
