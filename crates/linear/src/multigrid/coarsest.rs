//! The last level: small enough for a factor.

use std::sync::Arc;

use super::couplings::{Couplings, Symmetric};
use crate::error::{FactorError, StructureError};
use crate::factor::symbolic::Symbolic;
use crate::factor::symmetric::{Factor, Pivots};
use crate::pattern::entries::Pattern;
use crate::pattern::graph::Graph;
use crate::pattern::matrix::SparseMatrix;
use crate::pattern::ordering::Ordering;

/// The analysis of a level's matrix: what a factor of it would cost.
pub(super) fn analyse(couplings: &Couplings) -> Result<Arc<Symbolic>, StructureError> {
    let rows = &couplings.rows;
    let below = |i: usize| rows.columns[rows.row(i)].iter().filter(move |&&j| (j as usize) < i);
    let pairs: Vec<[u32; 2]> = (0..rows.rows()).flat_map(|i| below(i).map(move |&j| [i as u32, j])).collect();
    let graph = Graph::from_cliques(rows.rows(), pairs.iter().map(|pair| &pair[..]))?;
    let pattern = Pattern::new(&graph, couplings.size, Ordering::multilevel(&graph))?;
    Ok(Arc::new(Symbolic::new(&Arc::new(pattern))))
}

/// The factor; its error names a node of this level.
pub(super) fn factorise(matrix: &Symmetric, symbolic: &Arc<Symbolic>, parallel: bool) -> Result<Factor, FactorError> {
    let (pattern, couplings) = (symbolic.pattern(), matrix.couplings);
    let n = couplings.size;
    let old = pattern.ordering().new_to_old();
    let mut symmetric = SparseMatrix::zeros(Arc::clone(pattern));
    for (j, &column) in old.iter().enumerate() {
        let (first, rows) = pattern.column(j);
        for (k, &i) in rows.iter().enumerate() {
            let Some(at) = couplings.rows.position(old[i as usize] as usize, column) else { continue };
            let (code, into) = (couplings.codes[at], &mut symmetric.values[n * n * (first + k)..][..n * n]);
            let stored = matrix.stored(code);
            for (at, value) in into.iter_mut().enumerate() {
                *value = if code & 1 == 0 { stored[at] } else { stored[n * (at % n) + at / n] };
            }
        }
    }
    symbolic.factorize(&symmetric, Pivots::Positive, parallel).map_err(|error| match error {
        FactorError::Memory { needed, available, .. } => {
            FactorError::Memory { what: FactorError::COARSEST, needed, available }
        }
        other => other,
    })
}
