//! The first-order elements inside second-order ones: the space below the finest.

use super::couplings::BlockRows;
use super::transfer::Transfer;

/// Interpolation from the corner nodes of a mesh to all its nodes, by the first-order shapes on the same corners.
#[derive(Clone, Debug)]
pub struct Corners {
    /// The mesh nodes that are corners, ascending.
    nodes: Vec<u32>,
    starts: Vec<usize>,
    /// Numbers of corners (positions in `nodes`).
    parents: Vec<u32>,
    weights: Vec<f64>,
}

impl Corners {
    /// From elements of a mesh with `nodes` nodes: the nodes of each, its corners first, their number, and the first-order
    /// shapes at the nodes, `[node][corner]`. Nothing where every node is a corner already.
    ///
    /// Elements that share an edge or a face agree on the shapes there.
    pub fn new<'a>(nodes: usize, elements: impl Iterator<Item = (&'a [u32], usize, &'a [f64])>) -> Option<Self> {
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); nodes];
        for (element, corners, shapes) in elements {
            for (&node, shapes) in element.iter().zip(shapes.chunks_exact(corners)) {
                let row = &mut rows[node as usize];
                if row.is_empty() {
                    let parents = element[..corners].iter().zip(shapes);
                    row.extend(parents.filter(|&(_, &shape)| shape != 0.0).map(|(&corner, &shape)| (corner, shape)));
                }
            }
        }
        let is_corner = |(node, row): (usize, &Vec<(u32, f64)>)| row.is_empty() || row[0].0 as usize == node;
        let corner: Vec<bool> = rows.iter().enumerate().map(is_corner).collect();
        if corner.iter().all(|&corner| corner) {
            return None;
        }
        let list: Vec<u32> = (0..nodes as u32).filter(|&node| corner[node as usize]).collect();
        let mut number = vec![0; nodes];
        list.iter().enumerate().for_each(|(at, &node)| number[node as usize] = at as u32);
        let mut out = Corners { nodes: list, starts: vec![0], parents: Vec::new(), weights: Vec::new() };
        for (node, mut row) in rows.into_iter().enumerate() {
            if row.is_empty() {
                row.push((node as u32, 1.0));
            }
            row.sort_unstable_by_key(|&(corner, _)| corner);
            out.parents.extend(row.iter().map(|&(corner, _)| number[corner as usize]));
            out.weights.extend(row.iter().map(|&(_, weight)| weight));
            out.starts.push(out.parents.len());
        }
        Some(out)
    }

    /// The mesh nodes that are corners, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Which of the corners' unknowns are fixed.
    pub(super) fn fixed(&self, dim: usize, fixed: &[bool]) -> Vec<bool> {
        self.nodes.iter().flat_map(|&node| fixed[dim * node as usize..][..dim].iter().copied()).collect()
    }

    /// The interpolation with `dim` components per node: nothing comes from or goes to `fixed` unknowns.
    pub(super) fn transfer(&self, dim: usize, fixed: &[bool]) -> Transfer {
        let mut rows = BlockRows { block_columns: self.nodes.len(), starts: vec![0], columns: Vec::new() };
        let mut values = Vec::new();
        for node in 0..self.starts.len() - 1 {
            for k in self.starts[node]..self.starts[node + 1] {
                let corner = self.nodes[self.parents[k] as usize] as usize;
                let free: Vec<bool> = (0..dim).map(|c| !fixed[dim * node + c] && !fixed[dim * corner + c]).collect();
                // a corner keeps its place though nothing of it is free: the next level must know that it is idle
                if corner != node && free.iter().all(|&free| !free) {
                    continue;
                }
                rows.columns.push(self.parents[k]);
                for at in 0..dim * dim {
                    let (r, c) = (at / dim, at % dim);
                    values.push(if r == c && free[r] { self.weights[k] as f32 } else { 0.0 });
                }
            }
            rows.starts.push(rows.columns.len());
        }
        Transfer { values, ..Transfer::new((dim, dim), rows) }
    }
}
