//! [`JoinedStructure`]: a structure with the pairs of blocks that change from matrix to matrix.

use super::structure::Structure;
use crate::error::StructureError;
use crate::pattern::matrix::{SparseMatrix, Symmetry};
use std::sync::Arc;

/// A [`Structure`] in which some more sets of nodes are coupled, and where the blocks of the first one stand in it: what makes a matrix
/// with blocks [beyond its pattern](SparseMatrix::add_beyond) one that has a factor. The elimination order stays; the fill alone is found
/// anew.
#[derive(Debug)]
pub struct JoinedStructure {
    structure: Arc<Structure>,
    /// For every block of the first pattern the code of its place, as in [`Pattern::scatter_map`](crate::Pattern::scatter_map).
    codes: Vec<u32>,
}

impl JoinedStructure {
    /// A structure with the pairs of the blocks beyond the pattern of a matrix.
    ///
    /// # Errors
    /// A node that does not exist; more blocks than 32 bits can name.
    pub fn new(first: &Structure, matrix: &SparseMatrix) -> Result<Arc<Self>, StructureError> {
        let sets: Vec<Vec<u32>> = matrix.beyond().iter().map(|block| block.nodes.clone()).collect();
        let structure = first.with_couplings(&sets)?;
        let pairs = first.pattern().pairs();
        let codes = pairs.iter().map(|[column, row]| structure.pattern().block_code(*row, *column));
        let codes = codes.collect::<Result<_, _>>()?;
        Ok(Arc::new(JoinedStructure { structure, codes }))
    }

    /// The structure with all pairs.
    pub fn structure(&self) -> &Arc<Structure> {
        &self.structure
    }

    /// A matrix of the first pattern with its blocks beyond that in their places; `None` where a pair of theirs is not coupled here.
    pub fn join(&self, matrix: &SparseMatrix) -> Option<SparseMatrix> {
        let pattern = self.structure.pattern();
        let blocks = matrix.beyond();
        let maps = blocks.iter().map(|block| pattern.scatter_map(&block.nodes).ok()).collect::<Option<Vec<_>>>()?;
        let symmetry = if matrix.is_symmetric() { Symmetry::Symmetric } else { Symmetry::General };
        let mut joined = SparseMatrix::with_symmetry(pattern.clone(), symmetry);
        joined.copy_blocks(matrix, &self.codes);
        maps.iter().zip(blocks).for_each(|(map, block)| joined.add_element(map, &block.entries));
        joined.aside_mut().clone_from(matrix.aside());
        Some(joined)
    }
}
