//! The memory of levels: counted, and predicted before there are any.

use super::aggregation::{Aggregates, Strength};
use super::block_matrix::BlockMatrix;
use super::couplings::{BlockRows, Couplings};
use super::hierarchy::Multigrid;
use super::modes;
use super::transfer::Transfer;
use crate::pattern::entries::Pattern;

/// Aggregates that a node of a mesh of volumes, and of a mesh of faces, interpolates from: `(5/3)^dim`, those at the corners, edges and
/// faces of groups of 3^dim nodes having more than one.
const PARENTS_PER_NODE: [f64; 3] = [1.7, 2.8, 4.6];
/// The levels below the finest one and its prolongator, as a share of these.
const COARSER_LEVELS_SHARE: f64 = 0.2;

impl Multigrid {
    /// Bytes of the levels of a matrix of a pattern, with the vectors of a cycle: from counts alone, to about a third.
    pub fn predicted_bytes(pattern: &Pattern) -> usize {
        let (dim, nodes) = (pattern.dim(), pattern.nodes() as f64);
        let stored = (pattern.values() / (dim * dim)) as f64;
        let parents = PARENTS_PER_NODE[dim.clamp(1, 3) - 1];
        let of_block = 9.0 + (4 * dim * dim) as f64;
        let of_parent = 12.0 + (4 * dim * modes::count(dim)) as f64;
        let of_node = (4 * dim * dim + 4 * 8 * dim + 32) as f64;
        let finest = (2.0 * stored - nodes) * of_block + nodes * (parents * of_parent + of_node);
        ((1.0 + COARSER_LEVELS_SHARE) * finest) as usize
    }
}

impl Multigrid {
    /// Bytes of the levels of a matrix by products of 27-node cells, without the products: from counts alone, to about a third.
    pub fn predicted_bytes_below_products(nodes: usize, cells: usize) -> usize {
        // a cell has 8 nodes, with 27 parents among the corners, and one corner, with 27 couplings
        let (of_node, of_parent, of_coupling) = (16 + 36 + 4 * 8 * 3, 4 * 9 + 4 + 8, 9 + 4 * 9);
        let of_corner = 27 * of_coupling + 5 * (12 + 4 * 18) + of_node + 4 * 36;
        nodes * of_node + 27 * cells * of_parent + ((1.0 + COARSER_LEVELS_SHARE) * (cells * of_corner) as f64) as usize
    }
}

impl BlockRows {
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.starts[..]) + size_of_val(&self.columns[..])
    }
}

impl Couplings {
    pub(super) fn bytes(&self) -> usize {
        self.rows.bytes() + size_of_val(&self.codes[..]) + size_of_val(&self.stored[..])
    }
}

impl BlockMatrix {
    pub(super) fn bytes(&self) -> usize {
        self.couplings.bytes() + self.bytes_of_values()
    }
}

impl Transfer {
    pub(super) fn bytes(&self) -> usize {
        let back = size_of_val(&self.back_starts[..]) + size_of_val(&self.back[..]);
        self.rows.bytes() + size_of_val(&self.values[..]) + back
    }
}

impl Aggregates {
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.of_node[..]) + self.members.bytes()
    }
}

impl Strength {
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.strong[..])
    }
}
