//! Sums over the cells: energy, force and tangent of a [`Body`](crate::Body).
//!
//! Cells are computed in parallel, a wave at a time, and added up by one thread in mesh order, so the sums have the same
//! bits for any number of threads. While one wave is added the next is being computed.

use crate::body::{Body, Evaluation};
use crate::controls::Controls;
use crate::error::InvertedAt;
use crate::kernel::{CellKernel, kernel};
use crate::linear::SymmetricMatrix;
use crate::sampling::{Part, scatter_rows};
use crate::scratch::Scratch;
use nastic_energy::{EnergyTerm, Points, Response, Slots, Want};
use nastic_tensor::Kinematics;
use rayon::prelude::*;

/// Memory that the results of a wave may take, in numbers: they should still be in the cache when they are added up.
const WAVE: usize = 1 << 16;
/// Waves are split into this many tasks at most.
const TASKS: usize = 16;

/// How much of the response is wanted.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub(crate) enum Demand {
    Energy,
    Force,
    Tangent,
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
    inverted: Option<InvertedAt>,
}

pub(crate) fn evaluate(
    body: &Body,
    u: &[f64],
    controls: &Controls,
    demand: Demand,
    mut tangent: Option<&mut SymmetricMatrix>,
    parallel: bool,
) -> Result<Evaluation, InvertedAt> {
    let disc = body.discretization();
    let dofs = if demand >= Demand::Force { disc.dofs() } else { 0 };
    let mut total = Evaluation {
        min_j: f64::INFINITY,
        force: vec![0.0; dofs],
        force_scale: vec![0.0; dofs],
        ..Evaluation::default()
    };
    for (p, part) in disc.body().parts.iter().enumerate() {
        let Some(kernel) = kernel(part.kind) else { continue };
        let scatter = if demand == Demand::Tangent { disc.scatter(p) } else { &[] };
        let job = Job { body, part, kernel, scatter, u, controls, demand };
        match parallel && rayon::current_num_threads() > 1 {
            true => job.in_waves(&mut total, tangent.as_deref_mut())?,
            false => job.one_by_one(&mut total, tangent.as_deref_mut())?,
        }
    }
    Ok(total)
}

struct Job<'a> {
    body: &'a Body,
    part: &'a Part,
    kernel: &'static dyn CellKernel,
    scatter: &'a [u32],
    u: &'a [f64],
    controls: &'a Controls,
    demand: Demand,
}

impl Job<'_> {
    /// Each cell is added while it is in the innermost cache.
    fn one_by_one(&self, total: &mut Evaluation, mut tangent: Option<&mut SymmetricMatrix>) -> Result<(), InvertedAt> {
        let mut scratch = self.scratch();
        let mut result = self.result();
        for c in 0..self.part.cells.len() {
            self.cell(c, &mut scratch, &mut result);
            self.add(c, &result, total, tangent.as_deref_mut())?;
        }
        Ok(())
    }

    /// One thread adds a wave in mesh order while the others compute the next.
    fn in_waves(&self, total: &mut Evaluation, mut tangent: Option<&mut SymmetricMatrix>) -> Result<(), InvertedAt> {
        let first = self.result();
        let wave = (WAVE / (first.matrix.len() + 2 * first.rows.len() + 64)).clamp(8, 256);
        let cells: Vec<usize> = (0..self.part.cells.len()).collect();
        let (mut ready, mut next) = (vec![first.clone(); wave], vec![first; wave]);
        let mut done: &[usize] = &[];
        for cells in cells.chunks(wave).chain([&[][..]]) {
            let add = || done.iter().zip(&ready).try_for_each(|(&c, r)| self.add(c, r, total, tangent.as_deref_mut()));
            let (added, ()) = rayon::join(add, || self.compute(cells, &mut next));
            added?;
            std::mem::swap(&mut ready, &mut next);
            done = cells;
        }
        Ok(())
    }

    fn compute(&self, cells: &[usize], results: &mut [CellResult]) {
        let chunk = results.len().div_ceil(TASKS);
        let tasks = cells.par_chunks(chunk).zip(results.par_chunks_mut(chunk));
        tasks.for_each_init(
            || self.scratch(),
            |scratch, (cells, results)| {
                cells.iter().zip(results).for_each(|(&c, result)| self.cell(c, scratch, result))
            },
        );
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(self.part, self.body.discretization().dim())
    }

    fn result(&self) -> CellResult {
        let dim = self.body.discretization().dim();
        let rows = if self.demand >= Demand::Force { dim * self.kernel.width() } else { 0 };
        let matrix = if self.demand == Demand::Tangent { self.kernel.matrix_len() } else { 0 };
        CellResult {
            energy: 0.0,
            energy_scale: 0.0,
            min_j: f64::INFINITY,
            rows: vec![0.0; rows],
            scale: vec![0.0; rows],
            matrix: vec![0.0; matrix],
            inverted: None,
        }
    }

    fn cell(&self, c: usize, scratch: &mut Scratch, result: &mut CellResult) {
        let (part, points) = (self.part, self.part.table.points);
        let id = part.cells[c] as usize;
        let first = part.first_point(c);
        result.inverted = scratch.move_to(part, self.kernel, c, self.u, self.body.discretization().dim()).err();
        if result.inverted.is_some() {
            return;
        }
        let want = Want { energy: true, stress: self.demand >= Demand::Force, tangent: self.demand == Demand::Tangent };
        scratch.clear(want);
        let at = Points { kinematics: &scratch.kinematics, cell: id, first };
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
        let weights = &self.body.discretization().body().weights()[first..first + points];
        result.energy = weights.iter().zip(&scratch.energy).map(|(w, e)| w * e).sum();
        result.energy_scale = weights.iter().zip(&scratch.energy).map(|(w, e)| w * e.abs()).sum();
        result.min_j = scratch.kinematics.iter().map(Kinematics::j).fold(f64::INFINITY, f64::min);
        if want.stress {
            for ((stress, driving), &w) in scratch.stress.iter_mut().zip(&mut scratch.driving).zip(weights) {
                *driving *= w;
                *stress = *stress * w + *driving;
            }
            result.rows.fill(0.0);
            self.kernel.force(&scratch.g, &scratch.stress, &mut result.rows);
            result.scale.fill(0.0);
            if !composition.actuations.is_empty() {
                self.kernel.force(&scratch.g, &scratch.driving, &mut result.scale);
            }
            for (scale, total) in result.scale.iter_mut().zip(&result.rows) {
                *scale = scale.abs() + (total - *scale).abs();
            }
        }
        if want.tangent {
            for (tangent, &w) in scratch.tangent.iter_mut().zip(weights) {
                tangent.0.iter_mut().for_each(|c| *c *= w);
            }
            self.kernel.tangent(&scratch.g, &scratch.tangent, &mut result.matrix, &mut scratch.work);
        }
    }

    fn add(
        &self,
        c: usize,
        result: &CellResult,
        total: &mut Evaluation,
        tangent: Option<&mut SymmetricMatrix>,
    ) -> Result<(), InvertedAt> {
        if let Some(inverted) = result.inverted {
            return Err(inverted);
        }
        let (dim, width) = (self.body.discretization().dim(), self.kernel.width());
        total.energy += result.energy;
        total.energy_scale += result.energy_scale;
        total.min_j = total.min_j.min(result.min_j);
        if self.demand >= Demand::Force {
            let nodes = self.part.nodes_of(c);
            scatter_rows(&result.rows, nodes, dim, width, &mut total.force);
            scatter_rows(&result.scale, nodes, dim, width, &mut total.force_scale);
        }
        if let Some(tangent) = tangent {
            let pairs = self.scatter.len() / self.part.cells.len();
            self.kernel.scatter(&self.scatter[c * pairs..(c + 1) * pairs], &result.matrix, &mut tangent.values);
        }
        Ok(())
    }
}

/// The values of the k-th actuation at the points of one cell.
pub(crate) fn slots(controls: &Controls, k: usize, first: usize, points: usize) -> Slots<'_> {
    let width = controls.slots(k);
    Slots { values: &controls.values(k)[first * width..(first + points) * width], width }
}
