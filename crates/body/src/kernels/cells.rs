//! [`Cells`]: the cells of one kind with their arithmetic.

use crate::discretization::Discretization;
use crate::discretization::quadrature_points::{CellGroup, scatter_rows};
use crate::error::{Inadmissible, InvertedAt};
use crate::kernels::patch::Patch;
use crate::kernels::{CellKernel, kernel};
use crate::structure::TangentStructure;
use nastic_energy::PointBatch;
use nastic_linear::SparseMatrix;
use nastic_tensor::{Kinematics, Mat3, Tangent};
use rayon::prelude::*;
use std::ops::Range;

/// Quadrature points of a group below which one thread goes over it.
const POINTS: usize = 1024;

/// The cells of one kind with their arithmetic, a [`Patch`] at a time.
#[derive(Clone, Copy)]
pub struct Cells<'a> {
    /// Nodes and points.
    pub part: &'a CellGroup,
    /// Arithmetic of compile-time size.
    pub kernel: &'static dyn CellKernel,
    /// Spatial dimension.
    pub dim: usize,
    /// Of all points of the body.
    weights: &'a [f64],
    group: usize,
}

/// What a patch adds to a tangent: the element matrices of its cells, and one of all its nodes where there are several cells, as
/// [`Pattern::scatter`](nastic_linear::Pattern::scatter) has it.
#[derive(Debug, Clone, Default)]
pub struct PatchMatrix {
    cells: Vec<f64>,
    across: Vec<f64>,
}

impl<'a> Cells<'a> {
    /// The p-th group of a discretisation; `None` of lines, which are no bodies.
    pub fn of(disc: &'a Discretization, p: usize) -> Option<Self> {
        let part = &disc.points().parts[p];
        Some(Cells { part, kernel: kernel(part.kind)?, dim: disc.dim(), weights: disc.points().weights(), group: p })
    }

    /// All groups of a discretisation.
    pub fn all(disc: &'a Discretization) -> impl Iterator<Item = Self> {
        (0..disc.points().parts.len()).filter_map(|p| Self::of(disc, p))
    }

    /// Whether to go over the cells on all threads: where that takes longer than to wake them.
    pub fn on_threads(&self, parallel: bool) -> bool {
        parallel && self.part.cells.len() * self.part.table.points >= POINTS
    }

    /// What is found of chunks of items, in their order; `items` are cells or patches of the group.
    pub fn map<T: Sync, R: Send>(
        &self,
        items: &[T],
        chunk: usize,
        parallel: bool,
        of: impl Fn(&[T]) -> R + Sync + Send,
    ) -> Vec<R> {
        match self.on_threads(parallel) {
            true => items.par_chunks(chunk).map(of).collect(),
            false => items.chunks(chunk).map(of).collect(),
        }
    }

    /// The first cell of a patch, by its number in the mesh.
    pub fn first(&self, patch: Patch) -> usize {
        self.part.cells[self.number(patch)] as usize
    }

    /// The same by its number in the group.
    pub fn number(&self, patch: Patch) -> usize {
        patch.cells.first().map_or(0, |&c| c as usize)
    }

    /// The q-th point of a patch, inverted.
    pub fn inverted_at(&self, patch: Patch, q: usize, jacobian: f64) -> Inadmissible {
        let points = self.part.table.points;
        let cell = self.part.cells[patch.cells[q / points] as usize] as usize;
        Inadmissible::Inverted(InvertedAt { cell, point: q % points, jacobian })
    }

    /// Quadrature weights of a cell.
    pub fn weights_of(&self, c: u32) -> &'a [f64] {
        &self.weights[self.part.first_point(c as usize)..][..self.part.table.points]
    }

    /// The cells of a patch with the kinematics at their points: which points of the patch these are, and the batch.
    pub fn batches<'k>(
        &self,
        patch: Patch<'k>,
        kinematics: &'k [Kinematics],
    ) -> impl Iterator<Item = (Range<usize>, PointBatch<'k>)> + use<'a, 'k> {
        let part = self.part;
        let points = part.table.points;
        patch.cells.iter().enumerate().map(move |(slot, &c)| {
            let range = slot * points..(slot + 1) * points;
            let (cell, first) = (part.cells[c as usize] as usize, part.first_point(c as usize));
            (range.clone(), PointBatch { kinematics: &kinematics[range], cell, first })
        })
    }

    /// Numbers in the rows of one cell.
    pub fn row_length(&self) -> usize {
        self.dim * self.kernel.width()
    }

    /// Numbers in the matrix of one cell.
    pub fn matrix_length(&self) -> usize {
        self.kernel.matrix_len()
    }

    /// Zero rows of a patch.
    pub fn clear_rows(&self, patch: Patch, rows: &mut Vec<f64>) {
        rows.clear();
        rows.resize(patch.cells.len() * self.row_length(), 0.0);
    }

    /// Adds `sum_q P_iJ g_J[a]` to the rows of every cell.
    pub fn force(&self, g: &[f64], weighted_stress: &[Mat3], rows: &mut [f64]) {
        let (shapes, points) = (self.part.table.gradients.len(), self.part.table.points);
        let cells = g.chunks_exact(shapes).zip(weighted_stress.chunks_exact(points));
        for ((g, stress), rows) in cells.zip(rows.chunks_exact_mut(self.row_length())) {
            self.kernel.force(g, stress, rows);
        }
    }

    /// Sets the matrices of the cells, and nothing across them.
    pub fn tangent(
        &self,
        patch: Patch,
        g: &[f64],
        weighted: &[Tangent],
        matrix: &mut PatchMatrix,
        work: &mut Vec<f64>,
    ) {
        let (shapes, points) = (self.part.table.gradients.len(), self.part.table.points);
        matrix.cells.resize(patch.cells.len() * self.matrix_length(), 0.0);
        matrix.across.clear();
        matrix.across.resize((self.dim * patch.nodes).pow(2), 0.0);
        let cells = g.chunks_exact(shapes).zip(weighted.chunks_exact(points));
        for ((g, tangents), matrix) in cells.zip(matrix.cells.chunks_exact_mut(self.matrix_length())) {
            self.kernel.tangent(g, tangents, matrix, work);
        }
    }

    /// Adds `a b^T + b a^T`, for rows a and b.
    pub fn add_symmetric_product(&self, patch: Patch, a: &[f64], b: &[f64], matrix: &mut PatchMatrix) {
        if patch.cells.len() == 1 {
            self.kernel.add_symmetric_product(a, b, &mut matrix.cells);
            return;
        }
        let (a, b) = (self.at_nodes(patch, a), self.at_nodes(patch, b));
        let n = self.dim * patch.nodes;
        for (i, row) in matrix.across.chunks_exact_mut(n).enumerate() {
            // the diagonal block in full, nothing behind it
            let read = self.dim * (i / self.dim + 1);
            for (entry, (x, y)) in row[..read].iter_mut().zip(a.iter().zip(&b)) {
                *entry += a[i] * y + b[i] * x;
            }
        }
    }

    /// The distinct nodes of a patch, and every one of several rows added up at these.
    pub fn summed_at_nodes(&self, patch: Patch, rows: &[Vec<f64>]) -> (Vec<u32>, Vec<Vec<f64>>) {
        let of_cell = |&c: &u32| self.part.nodes_of(c as usize);
        if patch.cells.len() > 1 {
            let mut nodes = vec![0; patch.nodes];
            let local = patch.cells.iter().flat_map(of_cell).zip(patch.local);
            local.for_each(|(&node, &local)| nodes[local as usize] = node);
            return (nodes, rows.iter().map(|rows| self.at_nodes(patch, rows)).collect());
        }
        let nodes: Vec<u32> = patch.cells.iter().flat_map(of_cell).copied().collect();
        let local: Vec<u32> = (0..nodes.len() as u32).collect();
        let summed = |rows: &Vec<f64>| {
            let mut sums = vec![0.0; self.dim * nodes.len()];
            scatter_rows(rows, &local, self.dim, self.kernel.width(), &mut sums);
            sums
        };
        let summed = rows.iter().map(summed).collect();
        (nodes, summed)
    }

    /// Rows added up at the nodes of a patch of several cells.
    fn at_nodes(&self, patch: Patch, rows: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.dim * patch.nodes];
        let nodes = patch.local.chunks_exact(self.part.table.nodes);
        for (rows, nodes) in rows.chunks_exact(self.row_length()).zip(nodes) {
            scatter_rows(rows, nodes, self.dim, self.kernel.width(), &mut sums);
        }
        sums
    }

    /// Adds the rows of a patch to a nodal vector.
    pub fn scatter(&self, patch: Patch, rows: &[f64], nodal: &mut [f64]) {
        for (rows, &c) in rows.chunks_exact(self.row_length()).zip(patch.cells) {
            scatter_rows(rows, self.part.nodes_of(c as usize), self.dim, self.kernel.width(), nodal);
        }
    }

    /// Puts values at the points of a patch among those of the body.
    pub fn put<T: Copy>(&self, patch: Patch, values: &[T], all: &mut [T]) {
        let points = self.part.table.points;
        for (own, &c) in values.chunks_exact(points).zip(patch.cells) {
            all[self.part.first_point(c as usize)..][..points].copy_from_slice(own);
        }
    }

    /// Those of the points of a patch.
    pub fn taken<T: Copy>(&self, patch: Patch, all: &[T]) -> Vec<T> {
        let points = self.part.table.points;
        let of_cell = |&c: &u32| &all[self.part.first_point(c as usize)..][..points];
        patch.cells.iter().flat_map(of_cell).copied().collect()
    }

    /// Adds the matrix of a patch to a tangent of a structure, in whose blocks of nodes the displacement comes first.
    pub fn scatter_matrix(
        &self,
        patch: Patch,
        matrix: &PatchMatrix,
        of: &TangentStructure,
        tangent: &mut SparseMatrix,
    ) {
        let maps = of.scatter(self.group);
        let pairs = maps.len() / self.part.cells.len();
        for (matrix, &c) in matrix.cells.chunks_exact(self.matrix_length()).zip(patch.cells) {
            let block = tangent.pattern().dim();
            self.kernel.scatter(&maps[c as usize * pairs..][..pairs], matrix, block, &mut tangent.values);
        }
        if patch.cells.len() > 1 {
            tangent.add_symmetric_element(patch.map(of.pattern()), &matrix.across);
        }
    }
}
