//! The last level: small enough for a factor.

use std::sync::Arc;

use super::block_matrix::BlockMatrix;
use crate::error::{FactorError, StructureError};
use crate::factor::{Factor, Pivots};
use crate::graph::Graph;
use crate::matrix::SparseMatrix;
use crate::ordering::Ordering;
use crate::pattern::Pattern;
use crate::symbolic::Symbolic;

/// The analysis of a level's matrix: what a factor of it would cost.
pub(super) fn analyse(matrix: &BlockMatrix<f64>) -> Result<Arc<Symbolic>, StructureError> {
    let below = |i: usize| matrix.columns[matrix.row(i)].iter().filter(move |&&j| (j as usize) < i);
    let pairs: Vec<[u32; 2]> = (0..matrix.rows()).flat_map(|i| below(i).map(move |&j| [i as u32, j])).collect();
    let graph = Graph::from_cliques(matrix.rows(), pairs.iter().map(|pair| &pair[..]))?;
    let pattern = Pattern::new(&graph, matrix.shape.0, Ordering::multilevel(&graph))?;
    Ok(Arc::new(Symbolic::new(&Arc::new(pattern))))
}

/// The factor; its error names a node of this level.
pub(super) fn factorise(
    matrix: &BlockMatrix<f64>,
    symbolic: &Arc<Symbolic>,
    parallel: bool,
) -> Result<Factor, FactorError> {
    let pattern = symbolic.pattern();
    let size = matrix.shape.0 * matrix.shape.1;
    let old = pattern.ordering().new_to_old();
    let mut symmetric = SparseMatrix::zeros(Arc::clone(pattern));
    for (j, &column) in old.iter().enumerate() {
        let (first, rows) = pattern.column(j);
        for (k, &i) in rows.iter().enumerate() {
            let row = matrix.row(old[i as usize] as usize);
            if let Ok(at) = matrix.columns[row.clone()].binary_search(&column) {
                symmetric.values[size * (first + k)..][..size].copy_from_slice(matrix.block(row.start + at));
            }
        }
    }
    symbolic.factorize(&symmetric, Pivots::Positive, parallel)
}
