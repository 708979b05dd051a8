//! [`Rows`]: a matrix row by row, as PETSc takes it.

use crate::session::{PetscError, count};
use nastic_linear::SparseMatrix;

/// All entries of a symmetric matrix by rows, both triangles, rows and columns by unknown in the order of the mesh (compressed sparse rows): entry
/// `(i, columns[k])` is `values[k]` for k from `starts[i]` to `starts[i + 1]`; columns ascend in each row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rows {
    pub starts: Vec<i32>,
    pub columns: Vec<i32>,
    pub values: Vec<f64>,
}

impl Rows {
    /// Of the symmetric part, within the pattern.
    pub fn of(matrix: &SparseMatrix) -> Result<Self, PetscError> {
        let pattern = matrix.pattern();
        let (dim, old) = (pattern.dim(), pattern.ordering().new_to_old());
        // by row node: column node, the number of the block, whether it stands transposed
        let mut blocks: Vec<(u32, u32, usize, bool)> = Vec::new();
        for (j, &column) in old.iter().enumerate() {
            let (first, rows) = pattern.column(j);
            for (k, &i) in (first..).zip(rows) {
                let row = old[i as usize];
                blocks.push((row, column, k, false));
                if row != column {
                    blocks.push((column, row, k, true));
                }
            }
        }
        blocks.sort_unstable();
        let entries = dim * dim * blocks.len();
        count("entries of a matrix", entries)?;
        let mut out =
            Rows { starts: vec![0], columns: Vec::with_capacity(entries), values: Vec::with_capacity(entries) };
        for of_row in blocks.chunk_by(|a, b| a.0 == b.0) {
            for r in 0..dim {
                for &(_, column, k, transposed) in of_row {
                    for c in 0..dim {
                        let at = if transposed { dim * r + c } else { dim * c + r };
                        out.columns.push((column as usize * dim + c) as i32);
                        out.values.push(matrix.values[dim * dim * k + at]);
                    }
                }
                out.starts.push(out.columns.len() as i32);
            }
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::Rows;
    use nastic_linear::{Pattern, SparseMatrix};
    use std::sync::Arc;

    #[test]
    fn rows_have_every_entry_once_in_order() -> Result<(), Box<dyn std::error::Error>> {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
        let cells: [&[u32]; 3] = [&[2, 0], &[0, 3], &[3, 1]];
        let pattern = Arc::new(Pattern::of_elements(&points, 2, cells)?);
        let mut matrix = SparseMatrix::zeros(pattern.clone());
        for (e, cell) in cells.into_iter().enumerate() {
            let entry = |i: usize, j: usize| (e + 1) as f64 * (1.0 + 0.3 * (i + j) as f64 + (i * j) as f64);
            let element: Vec<f64> = (0..16).map(|at| entry(at / 4, at % 4)).collect();
            matrix.add_element(&pattern.scatter_map(cell)?, &element);
        }
        let rows = Rows::of(&matrix)?;
        assert_eq!((rows.starts.len(), rows.columns.len()), (9, 4 * (4 + 2 * 3)));
        for row in 0..8 {
            let own = rows.starts[row] as usize..rows.starts[row + 1] as usize;
            assert!(rows.columns[own.clone()].is_sorted());
            for at in own {
                assert_eq!(rows.values[at], matrix.get(row, rows.columns[at] as usize), "{row}");
            }
        }
        Ok(())
    }
}
