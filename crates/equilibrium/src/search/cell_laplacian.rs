//! [`CellLaplacian`]: the Laplace operator of a body of 27-node hexahedra by the products of its cells.

use crate::search::gradient_fit::{CELLS_PER_TASK, TASKS_PER_WAVE, elements};
use nastic_body::discretization::hexahedra::Hexahedra;
use nastic_body::discretization::quadrature_points::CellGroup;
use nastic_body::discretization::{Discretization, corner_shapes};
use nastic_body::kernels::hexahedra::{CELLS, LaplaceBatch, METRIC, NODES};
use nastic_body::kernels::kernel;
use nastic_linear::{
    Corners, Factor, Geometry, Multigrid, Pattern, Preconditioner, SparseMatrix, Structure, conjugate_gradient,
};
use rayon::prelude::*;
use std::array::from_fn;
use std::sync::{Arc, Mutex, PoisonError};

/// Numbers of a batch.
const VALUES_PER_BATCH: usize = NODES * METRIC * CELLS;
/// Rows of a batch.
const ROWS_PER_BATCH: usize = NODES * CELLS;
/// Batches handled by one task.
const BATCHES_PER_TASK: usize = 16;
/// Nodes handled by one task.
const NODES_PER_TASK: usize = 4096;
/// Share of the diagonal's inverse beside the correction at the corners: about the inverse of the largest eigenvalue of `D^-1 A`.
const DAMPING: f64 = 0.5;
/// Unknowns at corners up to which a factor solves for them.
const MAX_FACTORISED_UNKNOWNS: usize = 50_000;

/// One number per node, in single precision, before any is held.
pub(crate) struct CellLaplacian {
    hexahedra: Arc<Hexahedra>,
    /// By batch, `[point][6][cell]`: `w dxi_K/dX_J dxi_M/dX_J`.
    metric: Vec<f32>,
    diagonal: Vec<f64>,
    /// With the first-order shapes on the corners.
    at_corners: SparseMatrix,
    /// Rooms for the field and what cells make of it.
    rooms: Mutex<Vec<Vec<f32>>>,
}

/// The same with some nodes held, and what conjugate gradients are preconditioned with: `omega D^-1 + P A_c^-1 P^T`, A_c with the first-order
/// shapes P on the corners.
pub(crate) struct Held {
    of: Arc<CellLaplacian>,
    fixed: Vec<bool>,
    corners: Corners,
    fixed_corners: Vec<bool>,
    below: Below,
}

enum Below {
    Factor(Factor),
    Multigrid(Multigrid),
}

impl CellLaplacian {
    /// Nothing of a mesh of other cells.
    pub fn new(disc: &Discretization, hexahedra: &Arc<Hexahedra>, parallel: bool) -> Option<Self> {
        let ([part], corners) = (disc.points().parts.as_slice(), disc.corners()?) else { return None };
        let mut metric = vec![0.0; hexahedra.batches() * VALUES_PER_BATCH];
        for c in 0..hexahedra.cells() {
            let batch = &mut metric[c / CELLS * VALUES_PER_BATCH..][..VALUES_PER_BATCH];
            for (q, inverse) in part.inverse[c * NODES..][..NODES].iter().enumerate() {
                let weight = disc.points().weights()[part.first_point(c) + q];
                let pairs = (0..3).flat_map(|k| (k..3).map(move |m| (k, m)));
                for (entry, (k, m)) in pairs.enumerate() {
                    let sum: f64 = (0..3).map(|j| inverse[3 * k + j] * inverse[3 * m + j]).sum();
                    batch[(hexahedra.point(q) * METRIC + entry) * CELLS + c % CELLS] = (weight * sum) as f32;
                }
            }
        }
        let (diagonal, at_corners) = assembled(disc, part, corners, parallel)?;
        Some(CellLaplacian { hexahedra: hexahedra.clone(), metric, diagonal, at_corners, rooms: Mutex::default() })
    }

    /// With some nodes held; nothing if that fails.
    pub fn held(self: &Arc<Self>, disc: &Discretization, fixed: &[bool], parallel: bool) -> Option<Held> {
        let corners = disc.corners()?.clone();
        let fixed_corners = corners.fixed(1, fixed);
        let mut matrix = self.at_corners.clone();
        matrix.eliminate(&fixed_corners, matrix.diagonal().into_iter().fold(0.0, f64::max));
        let below = if corners.nodes().len() <= MAX_FACTORISED_UNKNOWNS {
            let structure = Structure::new(matrix.pattern().clone());
            Below::Factor(structure.symbolic().approximate(&matrix, parallel).ok()?)
        } else {
            let points = points_of(&corners, disc);
            let geometry = Geometry { points: &points, fixed: &fixed_corners, corners: None, products: None };
            Below::Multigrid(Multigrid::new(&matrix, &geometry, parallel).ok()?)
        };
        Some(Held { of: self.clone(), fixed: fixed.to_vec(), corners, fixed_corners, below })
    }

    /// `out = A v`, held nodes left out.
    fn multiply(&self, v: &[f64], fixed: &[bool], out: &mut [f64], parallel: bool) {
        let hexahedra = &*self.hexahedra;
        let mut room = self.rooms.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        room.resize(v.len() + hexahedra.batches() * ROWS_PER_BATCH, 0.0);
        let (own, rows) = room.split_at_mut(v.len());
        own.iter_mut()
            .zip(v.iter().zip(fixed))
            .for_each(|(own, (v, fixed))| *own = if *fixed { 0.0 } else { *v as f32 });
        let own = &*own;
        let multiply = |(task, rows): (usize, &mut [f32])| {
            for (batch, rows) in (BATCHES_PER_TASK * task..).zip(rows.chunks_exact_mut(ROWS_PER_BATCH)) {
                let (line, nodes) = (hexahedra.line(), hexahedra.nodes_of(batch));
                LaplaceBatch {
                    line,
                    metric: &self.metric[batch * VALUES_PER_BATCH..][..VALUES_PER_BATCH],
                    nodes,
                    v: own,
                    rows,
                }
                .multiply();
            }
        };
        match parallel {
            true => rows.par_chunks_mut(BATCHES_PER_TASK * ROWS_PER_BATCH).enumerate().for_each(multiply),
            false => rows.chunks_mut(BATCHES_PER_TASK * ROWS_PER_BATCH).enumerate().for_each(multiply),
        }
        let rows = &*rows;
        let add = |(task, out): (usize, &mut [f64])| {
            for (node, out) in (NODES_PER_TASK * task..).zip(out) {
                // from the place of three rows to that of one
                let row = |&place: &u32| rows[place as usize / (3 * CELLS) * CELLS + place as usize % CELLS];
                let sum: f64 = hexahedra.places(node).iter().map(|place| f64::from(row(place))).sum();
                *out = if fixed[node] { 0.0 } else { sum };
            }
        };
        match parallel {
            true => out.par_chunks_mut(NODES_PER_TASK).enumerate().for_each(add),
            false => out.chunks_mut(NODES_PER_TASK).enumerate().for_each(add),
        }
        self.rooms.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }
}

impl Held {
    /// `A x = b` to a relative residual, within a number of iterations; b is zero where nodes are held.
    pub fn solve(&self, b: &[f64], tolerance: f64, most: usize, parallel: bool) -> Vec<f64> {
        let mut x = vec![0.0; b.len()];
        let product = |v: &[f64], out: &mut [f64]| self.of.multiply(v, &self.fixed, out, parallel);
        conjugate_gradient(&product, self, b, &mut x, tolerance, most);
        x
    }
}

impl Preconditioner for Held {
    fn apply(&self, vector: &mut [f64]) {
        let mut at_corners = self.corners.restricted(vector);
        at_corners.iter_mut().zip(&self.fixed_corners).filter(|(_, fixed)| **fixed).for_each(|(x, _)| *x = 0.0);
        match &self.below {
            Below::Factor(factor) => factor.solve(&mut at_corners, 1),
            Below::Multigrid(levels) => levels.apply(&mut at_corners),
        }
        let corrections = self.corners.interpolated(&at_corners);
        for ((x, correction), (diagonal, fixed)) in
            vector.iter_mut().zip(corrections).zip(self.of.diagonal.iter().zip(&self.fixed))
        {
            *x = if *fixed { 0.0 } else { DAMPING * *x / diagonal + correction };
        }
    }
}

/// The diagonal, and the matrix with the first-order shapes on the corners.
fn assembled(
    disc: &Discretization,
    part: &CellGroup,
    corners: &Corners,
    parallel: bool,
) -> Option<(Vec<f64>, SparseMatrix)> {
    let number = |node: &u32| corners.nodes().partition_point(|known| known < node) as u32;
    let of_cell = |c: usize| -> [u32; 8] { from_fn(|a| number(&part.nodes_of(c)[a])) };
    let cells: Vec<[u32; 8]> = (0..part.cells.len()).map(of_cell).collect();
    let pattern = Pattern::of_elements(&points_of(corners, disc), 1, cells.iter().map(<[u32; 8]>::as_slice)).ok()?;
    let mut matrix = SparseMatrix::zeros(Arc::new(pattern));
    let (kernel, shapes) = (kernel(part.kind)?, corner_shapes(part));
    let mut diagonal = vec![0.0; disc.mesh().points().len()];
    let numbers: Vec<usize> = (0..cells.len()).collect();
    for numbers in numbers.chunks(TASKS_PER_WAVE * CELLS_PER_TASK) {
        let of = |cells: &[usize]| elements(disc, part, kernel, cells);
        let elements: Vec<Vec<f64>> = match parallel {
            true => numbers.par_chunks(CELLS_PER_TASK).map(of).collect(),
            false => numbers.chunks(CELLS_PER_TASK).map(of).collect(),
        };
        let triangles = elements.iter().flat_map(|of_task| of_task.chunks_exact(NODES * (NODES + 1) / 2));
        for (&c, triangle) in numbers.iter().zip(triangles) {
            for (a, &node) in part.nodes_of(c).iter().enumerate() {
                diagonal[node as usize] += triangle[a * (a + 3) / 2];
            }
            matrix.add_pairs(&cells[c], &galerkin(triangle, shapes.as_chunks::<8>().0)).ok()?;
        }
    }
    Some((diagonal, matrix))
}

/// `S^T A S` of a symmetric matrix of which one triangle is given row by row; S by rows.
fn galerkin(triangle: &[f64], shapes: &[[f64; 8]]) -> [f64; 64] {
    let mut product = [0.0; 64];
    let mut entries = triangle.iter();
    for (a, of_a) in shapes.iter().enumerate() {
        // A S in row a, of which the other triangle is the transpose
        let mut row = [0.0; 8];
        for (b, (of_b, entry)) in shapes[..=a].iter().zip(&mut entries).enumerate() {
            let entry = if a == b { 0.5 * entry } else { *entry };
            (0..8).for_each(|c| row[c] += entry * of_b[c]);
        }
        for (r, c) in (0..64).map(|at| (at / 8, at % 8)) {
            product[8 * r + c] += of_a[r] * row[c] + row[r] * of_a[c];
        }
    }
    product
}

fn points_of(corners: &Corners, disc: &Discretization) -> Vec<[f64; 3]> {
    corners.nodes().iter().map(|&node| disc.mesh().points()[node as usize]).collect()
}
