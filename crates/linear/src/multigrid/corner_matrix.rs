//! [`CornerCells`]: the matrix of the first-order elements inside second-order ones, added up cell by cell.

use std::sync::Arc;

use super::cell_products::{CellProducts, CornerMatrix};
use super::chunks;
use super::corners::Corners;
use super::couplings::{BlockRows, Couplings};

/// Cells of one task.
const CELLS_PER_TASK: usize = 64;
/// Cells whose matrices are held at a time.
const CELLS_PER_WAVE: usize = 16 * CELLS_PER_TASK;
/// Pairs of corners of a cell.
const PAIRS_PER_CELL: usize = size_of::<CornerMatrix>() / size_of::<[[f64; 3]; 3]>();

/// Which corners share a cell, and where the matrices of cells are added.
#[derive(Debug)]
pub(super) struct CornerCells {
    pub couplings: Arc<Couplings>,
    /// By cell and pair: twice the number of the stored block, plus one where the mirrored one is added.
    codes: Vec<u32>,
}

impl CornerCells {
    /// Of cells and the corners among the nodes of their mesh.
    pub fn new(cells: &[[u32; 8]], corners: &Corners, parallel: bool) -> Self {
        let number = |node: &u32| corners.nodes().partition_point(|known| known < node) as u32;
        let cells: Vec<[u32; 8]> = cells.iter().map(|nodes| std::array::from_fn(|a| number(&nodes[a]))).collect();
        let count = corners.nodes().len();
        let mut starts = vec![0; count + 1];
        cells.as_flattened().iter().for_each(|&corner| starts[corner as usize + 1] += 1);
        (0..count).for_each(|corner| starts[corner + 1] += starts[corner]);
        let (mut next, mut around) = (starts.clone(), vec![0u32; starts[count]]);
        for (cell, corners) in cells.iter().enumerate() {
            for &corner in corners {
                around[next[corner as usize]] = cell as u32;
                next[corner as usize] += 1;
            }
        }
        let rows = BlockRows::collect(
            count,
            count,
            parallel,
            || (),
            |(), row, out| {
                let first = out.len();
                out.push(row as u32);
                for &cell in &around[starts[row]..starts[row + 1]] {
                    for &column in &cells[cell as usize] {
                        if !out[first..].contains(&column) {
                            out.push(column);
                        }
                    }
                }
            },
        );
        let couplings = Couplings::of_lower(3, rows, parallel);
        let code = |i: u32, j: u32| {
            let (row, column) = (i.max(j) as usize, i.min(j));
            let at = couplings.rows.position(row, column).map_or(0, |at| at - couplings.rows.starts[row]);
            2 * (couplings.stored[row] + at) as u32 + u32::from(i < j)
        };
        let of_cell = |corners: &[u32; 8]| -> Vec<u32> {
            (0..8).flat_map(|a| (0..=a).map(move |b| (a, b))).map(|(a, b)| code(corners[a], corners[b])).collect()
        };
        let codes = cells.iter().flat_map(of_cell).collect();
        CornerCells { couplings, codes }
    }

    /// The stored values. Rows and columns of `fixed` unknowns are zero but for the mean diagonal entry of the others.
    pub fn values(&self, products: &dyn CellProducts, fixed: &[bool], parallel: bool) -> Vec<f64> {
        let Couplings { rows, stored, .. } = &*self.couplings;
        let mut blocks = vec![[[0.0; 3]; 3]; stored[rows.rows()]];
        let cells = self.codes.len() / PAIRS_PER_CELL;
        let mut room: Vec<CornerMatrix> = vec![[[[0.0; 3]; 3]; PAIRS_PER_CELL]; CELLS_PER_WAVE.min(cells)];
        for first in (0..cells).step_by(CELLS_PER_WAVE) {
            let matrices = &mut room[..CELLS_PER_WAVE.min(cells - first)];
            chunks::each(
                matrices.chunks_mut(CELLS_PER_TASK).collect(),
                parallel,
                |k, matrices: &mut [CornerMatrix]| {
                    products.corner_matrices(first + CELLS_PER_TASK * k, matrices);
                },
            );
            let codes = self.codes[PAIRS_PER_CELL * first..].chunks_exact(PAIRS_PER_CELL);
            for (block, &code) in matrices.iter().zip(codes).flat_map(|(matrix, codes)| matrix.iter().zip(codes)) {
                let sum = &mut blocks[(code >> 1) as usize];
                for r in 0..3 {
                    (0..3).for_each(|c| sum[r][c] += if code & 1 == 0 { block[r][c] } else { block[c][r] });
                }
            }
        }
        let diagonal = mean_diagonal(&blocks, stored, fixed);
        for i in 0..rows.rows() {
            let columns = &rows.columns[rows.row(i)];
            for (block, &j) in blocks[stored[i]..stored[i + 1]].iter_mut().zip(columns) {
                for (r, c) in (0..9).map(|at| (at / 3, at % 3)) {
                    if fixed[3 * i + r] || fixed[3 * j as usize + c] {
                        block[r][c] = if i == j as usize && r == c { diagonal } else { 0.0 };
                    }
                }
            }
        }
        blocks.into_flattened().into_flattened()
    }

    /// Memory, in bytes; the couplings count with the level below.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.codes[..])
    }
}

/// The mean of the diagonal over unknowns that are not fixed.
fn mean_diagonal(blocks: &[[[f64; 3]; 3]], stored: &[usize], fixed: &[bool]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (row, fixed) in stored[1..].iter().zip(fixed.as_chunks::<3>().0) {
        for (r, _) in fixed.iter().enumerate().filter(|(_, fixed)| !**fixed) {
            sum += blocks[row - 1][r][r].abs();
            count += 1.0;
        }
    }
    if sum > 0.0 { sum / count } else { 1.0 }
}
