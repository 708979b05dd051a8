//! Connected pieces of a body.

use crate::Mesh;

impl Mesh {
    /// For every cell the number of the connected piece it belongs to. Cells are connected when they share a node;
    /// pieces are numbered from 0 by their first cells. Each piece needs its own support.
    pub fn pieces(&self) -> Vec<u32> {
        let mut parent: Vec<u32> = (0..self.points.len() as u32).collect();
        for nodes in self.blocks.iter().flat_map(|block| block.iter()) {
            for &node in &nodes[1..] {
                let (a, b) = (root(&mut parent, nodes[0]), root(&mut parent, node));
                // The lower number wins, so that the outcome depends on nothing else.
                parent[a.max(b) as usize] = a.min(b);
            }
        }
        let mut number = vec![u32::MAX; self.points.len()];
        let mut next = 0;
        let mut piece_of = |nodes: &[u32]| {
            let number = &mut number[root(&mut parent, nodes[0]) as usize];
            if *number == u32::MAX {
                *number = next;
                next += 1;
            }
            *number
        };
        self.blocks.iter().flat_map(|block| block.iter()).map(&mut piece_of).collect()
    }
}

fn root(parent: &mut [u32], mut node: u32) -> u32 {
    while parent[node as usize] != node {
        let grandparent = parent[parent[node as usize] as usize];
        parent[node as usize] = grandparent;
        node = grandparent;
    }
    node
}
