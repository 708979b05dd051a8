//! The matrix of the finest level, from the symmetric storage of the assembly.

use super::block_matrix::BlockMatrix;
use crate::matrix::SparseMatrix;

/// Both triangles by rows, nodes in mesh numbering. Blocks of zeros off the diagonal, which the elimination of supports
/// leaves behind, are left out: they would count as couplings.
pub(super) fn expand(matrix: &SparseMatrix) -> BlockMatrix<f64> {
    let pattern = matrix.pattern();
    let (dim, nodes) = (pattern.dim(), pattern.nodes());
    let size = dim * dim;
    let block = |k: usize| &matrix.values[size * k..size * (k + 1)];
    let mut starts = vec![0; nodes + 1];
    visit(matrix, |row, column, k| {
        if row == column || block(k).iter().any(|&value| value != 0.0) {
            starts[row + 1] += 1;
            if row != column {
                starts[column + 1] += 1;
            }
        }
    });
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    // twice the number of the stored block, plus one where it is read transposed
    let mut entries = vec![(0u32, 0u32); starts[nodes]];
    let mut next = starts.clone();
    visit(matrix, |row, column, k| {
        if row != column && block(k).iter().all(|&value| value == 0.0) {
            return;
        }
        let mut put = |row: usize, column: usize, code: usize| {
            entries[next[row]] = (column as u32, code as u32);
            next[row] += 1;
        };
        put(row, column, 2 * k);
        if row != column {
            put(column, row, 2 * k + 1);
        }
    });
    let mut values = Vec::with_capacity(size * entries.len());
    for node in 0..nodes {
        let row = &mut entries[starts[node]..starts[node + 1]];
        row.sort_unstable();
        for &(_, code) in row.iter() {
            let stored = block((code >> 1) as usize);
            match code & 1 {
                0 => values.extend_from_slice(stored),
                _ => values.extend((0..size).map(|at| stored[dim * (at % dim) + at / dim])),
            }
        }
    }
    let columns = entries.into_iter().map(|(column, _)| column).collect();
    BlockMatrix { shape: (dim, dim), block_columns: nodes, starts, columns, values }
}

/// Calls with row, column (mesh nodes) and number of every stored block.
fn visit(matrix: &SparseMatrix, mut call: impl FnMut(usize, usize, usize)) {
    let pattern = matrix.pattern();
    let old = pattern.ordering().new_to_old();
    for (j, &column) in old.iter().enumerate() {
        let (first, rows) = pattern.column(j);
        for (k, &i) in rows.iter().enumerate() {
            call(old[i as usize] as usize, column as usize, first + k);
        }
    }
}
