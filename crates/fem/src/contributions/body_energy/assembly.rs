//! Sums over the cells: energy, force and tangent of a [`BodyEnergy`].
//!
//! Cells are computed in parallel and added up in mesh order, see [`sweep`].

use crate::contributions::Sums;
use crate::contributions::body_energy::BodyEnergy;
use crate::contributions::controls::Controls;
use crate::error::InvertedAt;
use crate::kernels::cell_scratch::Scratch;
use crate::kernels::cell_sweep::{CellWork, Cells, sweep};
use crate::kernels::kernel;
use nastic_energy::{EnergyTerm, PointBatch, Response, Slots, Want};
use nastic_linear::SparseMatrix;
use nastic_tensor::Kinematics;

/// What is wanted: the tangent alone is had without the others.
#[derive(Clone, Copy)]
pub(super) struct Terms {
    pub energy: bool,
    pub force: bool,
    pub tangent: bool,
}

/// What a cell hands over to be added up.
#[derive(Clone)]
struct CellResult {
    energy: f64,
    energy_scale: f64,
    min_j: f64,
    rows: Vec<f64>,
    /// Absolute forces of the passive terms and of the actuations, each by itself.
    scale: Vec<f64>,
    matrix: Vec<f64>,
}

/// Adds to `total` and, where it is wanted, to `tangent`.
pub(super) fn add(
    body: &BodyEnergy,
    (u, controls): (&[f64], &Controls),
    demand: Terms,
    total: &mut Sums,
    mut tangent: Option<&mut SparseMatrix>,
    parallel: bool,
) -> Result<(), InvertedAt> {
    let disc = body.discretization();
    for (p, part) in disc.points().parts.iter().enumerate() {
        let Some(kernel) = kernel(part.kind) else { continue };
        let scatter = if demand.tangent { disc.scatter(p) } else { &[] };
        let cells = Cells { part, kernel, dim: disc.dim() };
        let job = Job { body, cells, scatter, u, controls, demand };
        sweep(&job, parallel, |c, result| job.add(c, result, total, tangent.as_deref_mut()))?;
    }
    Ok(())
}

struct Job<'a> {
    body: &'a BodyEnergy,
    cells: Cells<'a>,
    scatter: &'a [u32],
    u: &'a [f64],
    controls: &'a Controls,
    demand: Terms,
}

impl CellWork for Job<'_> {
    type Answer = CellResult;
    type Error = InvertedAt;

    fn cells(&self) -> Cells<'_> {
        self.cells
    }

    fn room(&self) -> (CellResult, usize) {
        let rows = if self.demand.force { self.cells.rows() } else { Vec::new() };
        let matrix = if self.demand.tangent { self.cells.kernel.matrix_len() } else { 0 };
        let size = matrix + 2 * rows.len();
        let (scale, matrix) = (rows.clone(), vec![0.0; matrix]);
        (CellResult { energy: 0.0, energy_scale: 0.0, min_j: f64::INFINITY, rows, scale, matrix }, size)
    }

    fn compute(&self, c: usize, scratch: &mut Scratch, result: &mut CellResult) -> Result<(), InvertedAt> {
        let part = self.cells.part;
        let points = part.table.points;
        let (id, first) = (part.cells[c] as usize, part.first_point(c));
        self.body.kinematics(self.cells, c, self.u, scratch)?;
        let Terms { energy, force, tangent } = self.demand;
        let formulation = self.body.arithmetic_of(id);
        // tangents of formulations that are not affine have the stress in them
        let want = Want { energy, stress: force || tangent && !formulation.is_affine(), tangent };
        scratch.clear(want);
        let at = PointBatch { kinematics: &scratch.kinematics, cell: id, first };
        let mut out =
            Response { energy: &mut scratch.energy, stress: &mut scratch.stress, tangent: &mut scratch.tangent };
        let composition = &self.body.compositions[self.body.of_cell[id] as usize];
        for &t in &composition.terms {
            self.body.terms[t].respond(&at, Slots::none(), want, &mut out);
        }
        out.stress = &mut scratch.driving;
        for &k in &composition.actuations {
            self.body.actuations[k].law.respond(&at, slots(self.controls, k, first, points), want, &mut out);
        }
        let weights = &self.body.discretization().points().weights()[first..first + points];
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
            result.rows.fill(0.0);
            formulation.add_force(self.cells, scratch, &scratch.stress, &mut result.rows);
            result.scale.fill(0.0);
            if !composition.actuations.is_empty() {
                formulation.add_force(self.cells, scratch, &scratch.driving, &mut result.scale);
            }
            for (scale, total) in result.scale.iter_mut().zip(&result.rows) {
                *scale = scale.abs() + (total - *scale).abs();
            }
        }
        if want.tangent {
            for (tangent, &w) in scratch.tangent.iter_mut().zip(weights) {
                tangent.0.iter_mut().for_each(|c| *c *= w);
            }
            formulation.tangent(self.cells, scratch, &mut result.matrix);
        }
        Ok(())
    }
}

impl Job<'_> {
    fn add(&self, c: usize, result: &CellResult, total: &mut Sums, tangent: Option<&mut SparseMatrix>) {
        total.energy += result.energy;
        total.energy_scale += result.energy_scale;
        total.min_j = total.min_j.min(result.min_j);
        if self.demand.force {
            self.cells.scatter(c, &result.rows, &mut total.force);
            self.cells.scatter(c, &result.scale, &mut total.force_scale);
        }
        if let Some(tangent) = tangent {
            let pairs = self.scatter.len() / self.cells.part.cells.len();
            let map = &self.scatter[c * pairs..(c + 1) * pairs];
            self.cells.kernel.scatter(map, &result.matrix, &mut tangent.values);
        }
    }
}

/// The values of the k-th actuation at the points of one cell.
pub(crate) fn slots(controls: &Controls, k: usize, first: usize, points: usize) -> Slots<'_> {
    let width = controls.slots(k);
    Slots { values: &controls.values(k)[first * width..(first + points) * width], width }
}
