//! Connected pieces of a body.

use crate::Mesh;
use nastic_numeric::DisjointSets;

impl Mesh {
    /// For every cell the number of the connected piece it belongs to. Cells are connected when they share a node;
    /// pieces are numbered from 0 by their first cells. A support holds one of them alone.
    pub fn pieces(&self) -> Vec<u32> {
        let mut sets = DisjointSets::new(self.points.len());
        for nodes in self.blocks.iter().flat_map(|block| block.iter()) {
            nodes[1..].iter().for_each(|&node| sets.union(nodes[0], node));
        }
        let mut number = vec![u32::MAX; self.points.len()];
        let mut next = 0;
        let mut piece_of = |nodes: &[u32]| {
            let number = &mut number[sets.find(nodes[0]) as usize];
            if *number == u32::MAX {
                *number = next;
                next += 1;
            }
            *number
        };
        self.blocks.iter().flat_map(|block| block.iter()).map(&mut piece_of).collect()
    }
}
