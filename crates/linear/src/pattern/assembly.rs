//! What is added to a [`SparseMatrix`]: element matrices and blocks, over all components of a node or some.

use super::element_block::ElementBlock;
use super::entries::scatter_among;
use super::matrix::SparseMatrix;
use super::skew;
use crate::error::NotCoupled;

impl SparseMatrix {
    /// Sets an element matrix aside that belongs to no product, but to the [stand-in](Self::stand_in): its symmetric part, at pairs of nodes that the
    /// pattern has.
    pub fn add_aside(&mut self, nodes: &[u32], element: Vec<f64>) {
        let block = self.block_of(nodes, element).symmetric_part();
        self.aside.push(block);
    }

    /// `A_ab += E_ab` for every pair of some nodes: `element` has the `n = dim * nodes` rows of a dense matrix one after the
    /// other, unknown `dim * local node + component`. All of it is read where the matrix is general; of a symmetric one it must
    /// be symmetric. Where the same nodes come again, [`add_element`](Self::add_element) with a map kept is cheaper.
    ///
    /// # Errors
    /// [`NotCoupled`] where the pattern lacks a pair; nothing is added then.
    pub fn add_pairs(&mut self, nodes: &[u32], element: &[f64]) -> Result<(), NotCoupled> {
        let map = self.pattern.scatter_map(nodes)?;
        self.add_element(&map, element);
        Ok(())
    }

    /// The same, with the same layout of rows, for nodes whose pairs the pattern may lack, because they change with the state: a block of its
    /// own, which products have in them and a factor only of a matrix that it was [joined](crate::JoinedStructure) to. Pairs that the pattern
    /// has, of nodes that share a cell or are the same, may be among them, and a node may be named more than once: the entries add up.
    pub fn add_beyond(&mut self, nodes: &[u32], element: Vec<f64>) {
        let block = self.block_of(nodes, element);
        self.beyond.push(block);
    }

    /// Places in a node's block of the components that what is added has.
    pub(super) fn seen(&self) -> Vec<usize> {
        self.components.clone().unwrap_or_else(|| (0..self.pattern.dim()).collect())
    }

    fn block_of(&self, nodes: &[u32], element: Vec<f64>) -> ElementBlock {
        let dim = self.pattern.dim();
        debug_assert_eq!(element.len(), (self.components.as_ref().map_or(dim, Vec::len) * nodes.len()).pow(2));
        let block = ElementBlock::merged(nodes, element);
        self.components.as_ref().map_or_else(|| block.clone(), |own| block.widened(dim, own))
    }

    /// Calls with the matrix as it is seen by some of the components of every node, whose places in a node's block are given: what is added meanwhile, element matrices
    /// and blocks, has these alone.
    pub fn among<T>(&mut self, components: &[usize], call: impl FnOnce(&mut Self) -> T) -> T {
        let before = self.components.replace(components.to_vec());
        let answer = call(self);
        self.components = before;
        answer
    }

    /// Adds an element matrix: see [`Pattern::scatter`](crate::Pattern::scatter) for the arguments. All of it is read where the matrix is general;
    /// of a symmetric one it must be symmetric.
    pub fn add_element(&mut self, map: &[u32], element: &[f64]) {
        if self.skew.is_none() {
            return self.add_symmetric_element(map, element);
        }
        let (symmetric, antisymmetric) = skew::split(element);
        self.add_symmetric_element(map, &symmetric);
        let (dim, components) = (self.pattern.dim(), self.seen());
        self.skew.iter_mut().for_each(|skew| scatter_among(dim, &components, map, &antisymmetric, skew, -1.0));
    }

    /// The same of a symmetric element matrix, whatever the symmetry of this one.
    pub fn add_symmetric_element(&mut self, map: &[u32], element: &[f64]) {
        match &self.components {
            None => self.pattern.scatter(map, element, &mut self.values),
            Some(own) => scatter_among(self.pattern.dim(), own, map, element, &mut self.values, 1.0),
        }
    }
}
