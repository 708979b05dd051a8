//! Sums over the cells: energy, force and tangent of a [`Body`](crate::Body).
//!
//! Cells are computed in parallel, a wave at a time, and added up by one thread in mesh order, so the sums have the same
//! bits for any number of threads. While one wave is added the next is being computed.

use crate::body::{Body, Evaluation};
use crate::controls::Controls;
use crate::error::InvertedAt;
use crate::kernel::{CellKernel, block_index, kernel};
use crate::linear::SymmetricMatrix;
use crate::sampling::{Part, gather_rows, scatter_rows};
use nastic_energy::{EnergyTerm, Points, Response, Slots, Want};
use nastic_tensor::{Kinematics, Mat3, Tangent};
use rayon::prelude::*;

/// Cells computed before they are added up. Large enough to keep threads busy, small enough for the cache.
const WAVE: usize = 256;
/// Cells one task computes.
const CHUNK: usize = 16;

/// How much of the response is wanted.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
pub(crate) enum Demand {
    Energy,
    Force,
    Tangent,
}

/// What a cell hands over to be added up.
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
        let job = Job { body, part, kernel, u, controls, demand };
        let (mut ready, mut next) = (job.buffers(), job.buffers());
        let waves: Vec<usize> = (0..part.cells.len()).step_by(WAVE).collect();
        let mut done: Option<usize> = None;
        for &start in waves.iter() {
            let add = |results: &[CellResult], total: &mut Evaluation, tangent: &mut Option<&mut SymmetricMatrix>| {
                done.map_or(Ok(()), |first| job.add(first, results, total, tangent.as_deref_mut(), scatter))
            };
            let added = if parallel {
                let (added, ()) =
                    rayon::join(|| add(&ready, &mut total, &mut tangent), || job.compute(start, &mut next, true));
                added
            } else {
                let added = add(&ready, &mut total, &mut tangent);
                job.compute(start, &mut next, false);
                added
            };
            added?;
            std::mem::swap(&mut ready, &mut next);
            done = Some(start);
        }
        if let Some(first) = done {
            job.add(first, &ready, &mut total, tangent.as_deref_mut(), scatter)?;
        }
    }
    Ok(total)
}

struct Job<'a> {
    body: &'a Body,
    part: &'a Part,
    kernel: &'static dyn CellKernel,
    u: &'a [f64],
    controls: &'a Controls,
    demand: Demand,
}

impl Job<'_> {
    fn buffers(&self) -> Vec<CellResult> {
        let dim = self.body.discretization().dim();
        let rows = if self.demand >= Demand::Force { dim * self.kernel.width() } else { 0 };
        let matrix = if self.demand == Demand::Tangent { self.kernel.matrix_len() } else { 0 };
        let empty = || CellResult {
            energy: 0.0,
            energy_scale: 0.0,
            min_j: f64::INFINITY,
            rows: vec![0.0; rows],
            scale: vec![0.0; rows],
            matrix: vec![0.0; matrix],
            inverted: None,
        };
        (0..WAVE.min(self.part.cells.len())).map(|_| empty()).collect()
    }

    fn compute(&self, start: usize, results: &mut [CellResult], parallel: bool) {
        let chunk = |(k, results): (usize, &mut [CellResult])| {
            let mut scratch = Scratch::new(self.part, self.body.discretization().dim());
            for (c, result) in results.iter_mut().enumerate() {
                let cell = start + k * CHUNK + c;
                if cell < self.part.cells.len() {
                    self.cell(cell, &mut scratch, result);
                }
            }
        };
        if parallel {
            results.par_chunks_mut(CHUNK).enumerate().for_each(chunk);
        } else {
            results.chunks_mut(CHUNK).enumerate().for_each(chunk);
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
        start: usize,
        results: &[CellResult],
        total: &mut Evaluation,
        mut tangent: Option<&mut SymmetricMatrix>,
        scatter: &[u32],
    ) -> Result<(), InvertedAt> {
        let (dim, width) = (self.body.discretization().dim(), self.kernel.width());
        let cells = start..(start + results.len()).min(self.part.cells.len());
        let per_cell = scatter.len() / self.part.cells.len();
        for (c, result) in cells.zip(results) {
            if let Some(inverted) = result.inverted {
                return Err(inverted);
            }
            total.energy += result.energy;
            total.energy_scale += result.energy_scale;
            total.min_j = total.min_j.min(result.min_j);
            let nodes = self.part.nodes_of(c);
            if self.demand >= Demand::Force {
                scatter_rows(&result.rows, nodes, dim, width, &mut total.force);
                for (a, &node) in nodes.iter().enumerate() {
                    for i in 0..dim {
                        total.force_scale[node as usize * dim + i] += result.scale[i * width + a];
                    }
                }
            }
            if let Some(tangent) = tangent.as_deref_mut() {
                let map = &scatter[c * per_cell..(c + 1) * per_cell];
                match dim {
                    2 => scatter_matrix::<2>(map, nodes.len(), width, &result.matrix, &mut tangent.values),
                    _ => scatter_matrix::<3>(map, nodes.len(), width, &result.matrix, &mut tangent.values),
                }
            }
        }
        Ok(())
    }
}

/// Adds an element matrix in component blocks (see [`CellKernel`]) to the node blocks of the global one (see
/// [`Pattern::scatter_map`](crate::linear::Pattern::scatter_map) for the codes).
pub(crate) fn scatter_matrix<const D: usize>(
    map: &[u32],
    nodes: usize,
    width: usize,
    matrix: &[f64],
    values: &mut [f64],
) {
    let (columns, _) = values.as_chunks_mut::<D>();
    let entry = |a: usize, r: usize, b: usize, c: usize| match r <= c {
        true => matrix[(block_index(r, c, D) * nodes + a) * width + b],
        false => matrix[(block_index(c, r, D) * nodes + b) * width + a],
    };
    let pairs = (0..nodes).flat_map(|a| (0..=a).map(move |b| (a, b)));
    for ((a, b), &code) in pairs.zip(map) {
        let block = &mut columns[D * (code >> 1) as usize..][..D];
        for r in 0..D {
            for c in 0..D {
                if code & 1 == 0 {
                    block[c][r] += entry(a, r, b, c);
                } else {
                    block[r][c] += entry(a, r, b, c);
                }
            }
        }
    }
}

/// Working memory of one task.
pub(crate) struct Scratch {
    pub g: Vec<f64>,
    pub rows: Vec<f64>,
    gradients: Vec<Mat3>,
    pub kinematics: Vec<Kinematics>,
    energy: Vec<f64>,
    stress: Vec<Mat3>,
    /// Stress of the actuations alone.
    driving: Vec<Mat3>,
    tangent: Vec<Tangent>,
    work: Vec<f64>,
}

impl Scratch {
    pub fn new(part: &Part, dim: usize) -> Self {
        let points = part.table.points;
        Scratch {
            g: vec![0.0; part.table.gradients.len()],
            rows: vec![0.0; dim * part.table.width],
            gradients: vec![Mat3::zeros(); points],
            kinematics: Vec::with_capacity(points),
            energy: Vec::new(),
            stress: Vec::new(),
            driving: Vec::new(),
            tangent: Vec::new(),
            work: Vec::new(),
        }
    }

    fn clear(&mut self, want: Want) {
        let points = self.gradients.len();
        self.energy.clear();
        self.energy.resize(points, 0.0);
        if want.stress {
            for stress in [&mut self.stress, &mut self.driving] {
                stress.clear();
                stress.resize(points, Mat3::zeros());
            }
        }
        if want.tangent {
            self.tangent.clear();
            self.tangent.resize(points, Tangent::zero());
        }
    }

    /// Shape gradients and kinematics of the c-th cell displaced by u.
    pub fn move_to(
        &mut self,
        part: &Part,
        kernel: &dyn CellKernel,
        c: usize,
        u: &[f64],
        dim: usize,
    ) -> Result<(), InvertedAt> {
        let points = part.table.points;
        kernel.gradients(&part.table.gradients, &part.inverse[c * points..(c + 1) * points], &mut self.g);
        gather_rows(u, part.nodes_of(c), dim, part.table.width, &mut self.rows);
        self.gradients.fill(Mat3::identity());
        kernel.displacement_gradients(&self.g, &self.rows, &mut self.gradients);
        self.kinematics.clear();
        for (q, f) in self.gradients.iter().enumerate() {
            let kinematics = Kinematics::new(*f).map_err(|inverted| InvertedAt {
                cell: part.cells[c] as usize,
                point: q,
                jacobian: inverted.jacobian,
            })?;
            self.kinematics.push(kinematics);
        }
        Ok(())
    }
}

/// The longest step `s <= 1` along which no point loses more than nine tenths of its volume on the way:
/// `det(F + t G) >= det F / 10` for all `t` in `[0, s]`, with `G = grad du`.
///
/// Looking at the end alone is not enough: a section turned over in both directions has J > 0 again.
pub(crate) fn max_step(body: &Body, u: &[f64], du: &[f64], parallel: bool) -> Result<f64, InvertedAt> {
    let disc = body.discretization();
    let dim = disc.dim();
    let mut least: f64 = 1.0;
    for part in &disc.body().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let chunk = |cells: &[usize]| -> Result<f64, InvertedAt> {
            let mut scratch = Scratch::new(part, dim);
            let mut gradients = vec![Mat3::zeros(); part.table.points];
            let mut least: f64 = 1.0;
            for &c in cells {
                scratch.move_to(part, kernel, c, u, dim)?;
                gather_rows(du, part.nodes_of(c), dim, part.table.width, &mut scratch.rows);
                gradients.fill(Mat3::zeros());
                kernel.displacement_gradients(&scratch.g, &scratch.rows, &mut gradients);
                for (kinematics, g) in scratch.kinematics.iter().zip(&gradients) {
                    least = least.min(volume_step(kinematics, g));
                }
            }
            Ok(least)
        };
        let cells: Vec<usize> = (0..part.cells.len()).collect();
        let steps: Vec<Result<f64, InvertedAt>> = match parallel {
            true => cells.par_chunks(8 * CHUNK).map(chunk).collect(),
            false => cells.chunks(8 * CHUNK).map(chunk).collect(),
        };
        for step in steps {
            least = least.min(step?);
        }
    }
    Ok(least)
}

/// The condition of [`max_step`] at one point, to a factor of two: the Bernstein coefficients of the cubic
/// `det(F + t G) - det F / 10` on `[0, s]` are positive.
pub(crate) fn volume_step(at: &Kinematics, g: &Mat3) -> f64 {
    let constant = 0.9 * at.j();
    let linear = at.h().dot(g);
    let quadratic = at.f().dot(&nastic_tensor::cofactor(g));
    let cubic = g.determinant();
    let mut s = 1.0;
    for _ in 0..50 {
        let (b, c, d) = (linear * s, quadratic * s * s, cubic * s * s * s);
        let bernstein = [constant + b / 3.0, constant + 2.0 * b / 3.0 + c / 3.0, constant + b + c + d];
        if bernstein.iter().all(|&coefficient| coefficient > 0.0) {
            break;
        }
        s *= 0.5;
    }
    s
}

fn slots(controls: &Controls, k: usize, first: usize, points: usize) -> Slots<'_> {
    let width = controls.slots(k);
    Slots { values: &controls.values(k)[first * width..(first + points) * width], width }
}

pub(crate) fn pull_back(body: &Body, u: &[f64], controls: &Controls, lambda: &[f64]) -> Result<Controls, InvertedAt> {
    let disc = body.discretization();
    let dim = disc.dim();
    let mut out = body.controls();
    for part in &disc.body().parts {
        let Some(kernel) = kernel(part.kind) else { continue };
        let points = part.table.points;
        let mut scratch = Scratch::new(part, dim);
        let mut adjoint = vec![Mat3::zeros(); points];
        for c in 0..part.cells.len() {
            let id = part.cells[c] as usize;
            let composition = &body.compositions[body.of_cell[id] as usize];
            if composition.actuations.is_empty() {
                continue;
            }
            scratch.move_to(part, kernel, c, u, dim)?;
            gather_rows(lambda, part.nodes_of(c), dim, part.table.width, &mut scratch.rows);
            adjoint.fill(Mat3::zeros());
            kernel.displacement_gradients(&scratch.g, &scratch.rows, &mut adjoint);
            let first = part.first_point(c);
            let at = Points { kinematics: &scratch.kinematics, cell: id, first };
            for &k in &composition.actuations {
                let width = controls.slots(k);
                let mut by_control = vec![Mat3::zeros(); points * width];
                body.actuations[k].law.stress_by_control(&at, slots(controls, k, first, points), &mut by_control);
                let target = &mut out.values_mut(k)[first * width..(first + points) * width];
                for (s, value) in target.iter_mut().enumerate() {
                    let q = s / width;
                    *value = disc.body().weights()[first + q] * by_control[s].dot(&adjoint[q]);
                }
            }
        }
    }
    Ok(out)
}
