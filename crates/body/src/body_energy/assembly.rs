//! Sums over the cells: energy, force and tangent of a [`BodyEnergy`].
//!
//! Cells are computed in parallel and added up in mesh order, see [`CellWork`](crate::kernels::cell_sweep::CellWork).

use crate::body_energy::BodyEnergy;
use crate::body_energy::driving::Driving;
use crate::contribution::Sums;
use crate::error::Inadmissible;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cells::{Cells, PatchMatrix};
use crate::kernels::displaced::Displaced;
use crate::kernels::patch::Patch;
use nastic_energy::{EnergyTerm, Response, Want};
use nastic_linear::SparseMatrix;
use nastic_tensor::{Kinematics, Mat3};
use std::ops::Range;

/// What is wanted: the tangent alone is had without the others.
#[derive(Clone, Copy)]
pub(super) struct Terms {
    pub energy: bool,
    pub force: bool,
    pub tangent: bool,
}

/// What a patch hands over to be added up.
#[derive(Clone, Default)]
struct PatchResult {
    energy: f64,
    energy_scale: f64,
    min_j: f64,
    rows: Vec<f64>,
    /// Absolute forces of the materials and of the other laws, each by itself.
    scale: Vec<f64>,
    matrix: PatchMatrix,
    /// `1 + grad u` at the points, where it is kept.
    gradients: Vec<Mat3>,
}

/// Adds to `total` and, where it is wanted, to `tangent`; puts `1 + grad u` at the points of the body into `known`.
pub(super) fn add(
    body: &BodyEnergy,
    to: Displaced,
    driving: Driving,
    demand: Terms,
    (total, mut tangent, mut known): (&mut Sums, Option<&mut SparseMatrix>, Option<&mut [Mat3]>),
    parallel: bool,
) -> Result<(), Inadmissible> {
    let job = Job { body, to, driving, demand, keeps: known.is_some() };
    body.sweep(
        parallel,
        |cells| job.numbers(cells),
        |cells, patch, scratch, result: &mut PatchResult| job.compute(cells, patch, scratch, result),
        |cells, patch, result| {
            job.add(cells, patch, result, total, tangent.as_deref_mut());
            if let Some(known) = known.as_deref_mut() {
                cells.put(patch, &result.gradients, known);
            }
        },
    )
}

struct Job<'a> {
    body: &'a BodyEnergy,
    to: Displaced<'a>,
    driving: Driving<'a>,
    demand: Terms,
    keeps: bool,
}

impl Job<'_> {
    /// Of the answer of a cell.
    fn numbers(&self, cells: &Cells) -> usize {
        let rows = if self.demand.force { cells.row_length() } else { 0 };
        let matrix = if self.demand.tangent { cells.kernel.matrix_len() } else { 0 };
        matrix + 2 * rows
    }

    fn compute(
        &self,
        cells: Cells,
        patch: Patch,
        scratch: &mut Scratch,
        result: &mut PatchResult,
    ) -> Result<(), Inadmissible> {
        self.body.kinematics(cells, patch, self.to, Some(self.driving), scratch)?;
        if self.keeps {
            result.gradients.clone_from(&scratch.gradients);
        }
        let Terms { energy, force, tangent } = self.demand;
        let formulation = self.body.arithmetic_of(cells.first(patch));
        // tangents of formulations that are not affine have the stress in them
        let want = Want { energy, stress: force || tangent && !formulation.is_affine(), tangent };
        scratch.clear(want);
        for (range, at) in cells.batches(patch, &scratch.kinematics) {
            let mut out = Response {
                energy: &mut scratch.energy[range.clone()],
                stress: wanted(&mut scratch.stress, &range),
                tangent: wanted(&mut scratch.tangent, &range),
            };
            for (law, m) in self.body.materials(&at, self.driving) {
                law.respond(&at, m.get(), want, &mut out);
            }
            out.stress = wanted(&mut scratch.driving, &range);
            for (law, m) in self.body.laws(&at, self.driving).filter(|(law, _)| !law.is_material()) {
                law.respond(&at, m.get(), want, &mut out);
            }
        }
        let weights = &scratch.weights;
        result.energy = weights.iter().zip(&scratch.energy).map(|(w, e)| w * e).sum();
        result.energy_scale = weights.iter().zip(&scratch.energy).map(|(w, e)| w * e.abs()).sum();
        let own = formulation.own(scratch).iter();
        result.min_j = own.chain(&scratch.kinematics).map(Kinematics::j).fold(f64::INFINITY, f64::min);
        if want.stress {
            for ((stress, driving), &w) in scratch.stress.iter_mut().zip(&mut scratch.driving).zip(weights) {
                *driving *= w;
                *stress = *stress * w + *driving;
            }
        }
        if force {
            cells.clear_rows(patch, &mut result.rows);
            formulation.add_force(cells, scratch, &scratch.stress, &mut result.rows);
            cells.clear_rows(patch, &mut result.scale);
            if self.body.is_actuated(cells, patch) {
                formulation.add_force(cells, scratch, &scratch.driving, &mut result.scale);
            }
            for (scale, total) in result.scale.iter_mut().zip(&result.rows) {
                *scale = scale.abs() + (total - *scale).abs();
            }
        }
        if want.tangent {
            for (tangent, &w) in scratch.tangent.iter_mut().zip(weights) {
                tangent.0.iter_mut().for_each(|c| *c *= w);
            }
            formulation.tangent(cells, patch, scratch, &mut result.matrix);
        }
        Ok(())
    }

    fn add(
        &self,
        cells: Cells,
        patch: Patch,
        result: &PatchResult,
        total: &mut Sums,
        tangent: Option<&mut SparseMatrix>,
    ) {
        total.energy += result.energy;
        total.energy_scale += result.energy_scale;
        total.min_j = total.min_j.min(result.min_j);
        if self.demand.force {
            cells.scatter(patch, &result.rows, &mut total.force);
            cells.scatter(patch, &result.scale, &mut total.force_scale);
        }
        if let Some(tangent) = tangent {
            cells.scatter_matrix(patch, &result.matrix, self.body.structure(), tangent);
        }
    }
}

/// The values at the points of one cell; none where they are not wanted.
fn wanted<'a, T>(values: &'a mut [T], range: &Range<usize>) -> &'a mut [T] {
    values.get_mut(range.clone()).unwrap_or_default()
}
