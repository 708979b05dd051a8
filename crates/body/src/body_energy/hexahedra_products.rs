//! [`HexahedraProducts`]: the tangent of a body of 27-node hexahedra by its moduli.

use crate::discretization::hexahedra::Hexahedra;
use crate::kernels::hexahedra::{
    Batch, CELLS, CORNERS, CornerBatch, DiagonalBatch, ENTRIES, MODULI, NODES, PAIRS, ROWS,
};
use nastic_linear::{CellProducts, CornerMatrix};
use pulp::WithSimd;
use rayon::prelude::*;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Moduli of a batch.
pub(super) const BATCH: usize = NODES * MODULI * CELLS;
/// Batches handled by one task, and nodes handled by one.
const TASK: usize = 8;
const NODES_OF_TASK: usize = 4096;

/// `K + shift` of a body whose cells are all 27-node hexahedra of the standard formulation.
pub struct HexahedraProducts {
    hexahedra: Arc<Hexahedra>,
    /// By batch, `[point][45][cell]`: moduli by coordinates of the reference cell, with quadrature weights.
    moduli: Arc<Vec<f32>>,
    fixed: Arc<Vec<bool>>,
    shift: f64,
    /// Rooms for what cells make of a vector.
    rooms: Mutex<Vec<Vec<f64>>>,
}

impl HexahedraProducts {
    /// From moduli by batch.
    pub(super) fn new(hexahedra: Arc<Hexahedra>, moduli: Vec<f32>, fixed: &[bool]) -> Self {
        let (moduli, fixed) = (Arc::new(moduli), Arc::new(fixed.to_vec()));
        HexahedraProducts { hexahedra, moduli, fixed, shift: 0.0, rooms: Mutex::default() }
    }

    /// Bytes of the products of so many cells.
    pub fn bytes_of(cells: usize) -> usize {
        cells.div_ceil(CELLS) * (BATCH * size_of::<f32>() + ROWS * (size_of::<f32>() + size_of::<f64>()))
    }

    /// `out = put(at, (K v)_at)` with the columns of some unknowns left out.
    fn multiply_with(
        &self,
        v: &[f64],
        left_out: impl Fn(usize) -> bool + Sync,
        put: impl Fn(usize, f64) -> f64 + Sync,
        out: &mut [f64],
        parallel: bool,
    ) {
        let kept = self.rooms.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut room = kept.unwrap_or_default();
        self.of_all_cells(v, |x| x, left_out, &mut room, parallel);
        let rows = &room[4 * (v.len() / 3)..];
        let add = |(task, out): (usize, &mut [f64])| {
            for (node, out) in (NODES_OF_TASK * task..).zip(out.as_chunks_mut::<3>().0) {
                let sum = self.sum_at(node, rows);
                *out = std::array::from_fn(|i| put(3 * node + i, sum[i]));
            }
        };
        match parallel {
            true => out.par_chunks_mut(3 * NODES_OF_TASK).enumerate().for_each(add),
            false => out.chunks_mut(3 * NODES_OF_TASK).enumerate().for_each(add),
        }
        self.rooms.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }

    /// The vector by node, four numbers each, and the rows of all cells behind it.
    fn of_all_cells<T: Copy + Default + Send + Sync>(
        &self,
        v: &[f64],
        rounded: impl Fn(f64) -> T + Sync,
        left_out: impl Fn(usize) -> bool + Sync,
        room: &mut Vec<T>,
        parallel: bool,
    ) where
        for<'b> Batch<'b, T>: WithSimd<Output = ()>,
    {
        let hexahedra = &*self.hexahedra;
        let nodes = v.len() / 3;
        room.resize(4 * nodes + hexahedra.batches() * ROWS, T::default());
        let (own, rows) = room.split_at_mut(4 * nodes);
        let own = own.as_chunks_mut::<4>().0;
        let copy = |task: usize, own: &mut [[T; 4]]| {
            for (node, own) in (NODES_OF_TASK * task..).zip(own) {
                (0..3).for_each(|i| {
                    let at = 3 * node + i;
                    own[i] = rounded(if left_out(at) { 0.0 } else { v[at] });
                });
            }
        };
        let multiply = |own: &[[T; 4]], first: usize, rows: &mut [T]| {
            for (at, rows) in rows.chunks_exact_mut(ROWS).enumerate() {
                let batch = first + at;
                let (line, moduli, nodes) = (hexahedra.line(), self.moduli_of(batch), hexahedra.nodes_of(batch));
                Batch { line, moduli, nodes, v: own, rows }.multiply();
            }
        };
        if !parallel {
            own.chunks_mut(NODES_OF_TASK).enumerate().for_each(|(task, own)| copy(task, own));
            multiply(own, 0, rows);
            return;
        }
        own.par_chunks_mut(NODES_OF_TASK).enumerate().for_each(|(task, own)| copy(task, own));
        let own = &*own;
        rows.par_chunks_mut(TASK * ROWS).enumerate().for_each(|(task, rows)| multiply(own, TASK * task, rows));
    }

    fn moduli_of(&self, batch: usize) -> &[f32] {
        &self.moduli[batch * BATCH..][..BATCH]
    }

    /// The sum of the rows of a node over its cells.
    #[inline]
    fn sum_at<T: Copy + Into<f64>>(&self, node: usize, rows: &[T]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &at in self.hexahedra.places(node) {
            for (i, sum) in sum.iter_mut().enumerate() {
                *sum += rows[at as usize + CELLS * i].into();
            }
        }
        sum
    }

    /// The blocks of the cells, `[node][entry][cell]` by batch.
    fn diagonals_of_cells(&self, parallel: bool) -> Vec<f32> {
        let size = NODES * ENTRIES * CELLS;
        let mut all = vec![0.0; self.hexahedra.batches() * size];
        let compute = |(batch, blocks): (usize, &mut [f32])| {
            DiagonalBatch { line: self.hexahedra.line(), moduli: self.moduli_of(batch), blocks }.compute();
        };
        match parallel {
            true => all.par_chunks_mut(size).enumerate().for_each(compute),
            false => all.chunks_mut(size).enumerate().for_each(compute),
        }
        all
    }
}

impl CellProducts for HexahedraProducts {
    fn multiply(&self, v: &[f64], out: &mut [f64], parallel: bool) {
        let put = |at: usize, sum: f64| if self.fixed[at] { v[at] } else { sum + self.shift * v[at] };
        self.multiply_with(v, |at| self.fixed[at], put, out, parallel);
    }

    fn multiply_whole(&self, v: &[f64], out: &mut [f64], parallel: bool) {
        self.multiply_with(v, |_| false, |at, sum| sum + self.shift * v[at], out, parallel);
    }

    fn of_cells(&self, v: &[f64], room: &mut Vec<f32>, parallel: bool) {
        self.of_all_cells(v, |x| x as f32, |at| self.fixed[at], room, parallel);
    }

    #[inline]
    fn at_node(&self, node: usize, of_cells: &[f32]) -> [f64; 3] {
        let (own, rows) = of_cells.split_at(4 * (self.fixed.len() / 3));
        let (sum, fixed) = (self.sum_at(node, rows), &self.fixed[3 * node..3 * node + 3]);
        std::array::from_fn(|i| if fixed[i] { 0.0 } else { sum[i] + self.shift * f64::from(own[4 * node + i]) })
    }

    fn diagonal_blocks(&self, parallel: bool) -> Vec<[[f64; 3]; 3]> {
        let of_cells = self.diagonals_of_cells(parallel);
        let block = |node: usize| {
            let mut sums = [0.0; ENTRIES];
            for &place in self.hexahedra.places(node) {
                // from the place of three rows to that of six entries
                let (place, cell) = (place as usize, place as usize % CELLS);
                let at = 2 * (place - cell) + cell;
                for (entry, sum) in sums.iter_mut().enumerate() {
                    *sum += f64::from(of_cells[at + CELLS * entry]);
                }
            }
            let fixed = &self.fixed[3 * node..3 * node + 3];
            std::array::from_fn(|r| {
                std::array::from_fn(|c| {
                    let (i, j, own) = (r.min(c), r.max(c), f64::from(u8::from(r == c)));
                    if fixed[r] || fixed[c] { own } else { sums[i * (5 - i) / 2 + j] + self.shift * own }
                })
            })
        };
        let nodes = 0..self.fixed.len() / 3;
        match parallel {
            true => nodes.into_par_iter().with_min_len(NODES_OF_TASK).map(block).collect(),
            false => nodes.map(block).collect(),
        }
    }

    fn corners(&self) -> &[[u32; CORNERS]] {
        self.hexahedra.corners()
    }

    fn corner_matrices(&self, first: usize, matrices: &mut [CornerMatrix]) {
        let mut of_batch = vec![0.0; PAIRS * 9 * CELLS];
        let mut held = None;
        for (cell, matrix) in (first..).zip(matrices) {
            let batch = cell / CELLS;
            if held != Some(batch) {
                let (line, moduli) = (self.hexahedra.line(), self.moduli_of(batch));
                CornerBatch { line, moduli, matrices: &mut of_batch }.compute();
                held = Some(batch);
            }
            let numbers = of_batch.iter().skip(cell % CELLS).step_by(CELLS);
            matrix.as_flattened_mut().as_flattened_mut().iter_mut().zip(numbers).for_each(|(into, x)| *into = *x);
            if self.shift != 0.0 {
                self.add_shift(cell, matrix);
            }
        }
    }

    fn shifted(&self, by: f64) -> Arc<dyn CellProducts> {
        Arc::new(HexahedraProducts {
            hexahedra: self.hexahedra.clone(),
            moduli: self.moduli.clone(),
            fixed: self.fixed.clone(),
            shift: self.shift + by,
            rooms: Mutex::default(),
        })
    }

    fn numbers(&self) -> usize {
        self.moduli.len()
    }

    fn bytes(&self) -> usize {
        let rooms = self.rooms.lock().unwrap_or_else(PoisonError::into_inner);
        let rooms = rooms.iter().map(|room| size_of_val(&room[..])).sum::<usize>();
        size_of_val(&self.moduli[..]) + self.fixed.len() + rooms
    }
}

impl HexahedraProducts {
    /// `shift P^T P` with the first-order shapes P at the nodes of a cell, which share a node's part with the other cells around it.
    fn add_shift(&self, cell: usize, matrix: &mut CornerMatrix) {
        let nodes = self.hexahedra.nodes_of(cell / CELLS);
        for place in 0..NODES {
            let at = [place % 3, place / 3 % 3, place / 9].map(|x| 0.5 * x as f64);
            let shapes: [f64; CORNERS] =
                std::array::from_fn(|a| (0..3).map(|k| if a >> k & 1 == 1 { at[k] } else { 1.0 - at[k] }).product());
            let around = self.hexahedra.places(nodes[place * CELLS + cell % CELLS] as usize).len();
            let share = self.shift / around as f64;
            let pairs = (0..CORNERS).flat_map(|a| (0..=a).map(move |b| (a, b)));
            for (block, (a, b)) in matrix.iter_mut().zip(pairs) {
                (0..3).for_each(|c| block[c][c] += share * shapes[a] * shapes[b]);
            }
        }
    }
}

impl fmt::Debug for HexahedraProducts {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "HexahedraProducts({} batches of {CELLS} cells)", self.hexahedra.batches())
    }
}
