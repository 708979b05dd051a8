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

    /// Which of the corners' unknowns are fixed: those from which a `fixed` one would move. What is left of the first-order space is then a part of the
    /// second-order one.
    pub fn fixed(&self, dim: usize, fixed: &[bool]) -> Vec<bool> {
        let mut of_corners = vec![false; dim * self.nodes.len()];
        for (own, fixed) in self.starts.windows(2).zip(fixed.chunks_exact(dim)) {
            for &corner in &self.parents[own[0]..own[1]] {
                of_corners[dim * corner as usize..][..dim]
                    .iter_mut()
                    .zip(fixed)
                    .for_each(|(of_corner, f)| *of_corner |= f);
            }
        }
        of_corners
    }

    /// A field at the corners as it is at all nodes.
    #[must_use]
    pub fn interpolated(&self, at_corners: &[f64]) -> Vec<f64> {
        let of_node = |own: &[usize]| {
            let parents = self.parents[own[0]..own[1]].iter().zip(&self.weights[own[0]..own[1]]);
            parents.map(|(&corner, weight)| weight * at_corners[corner as usize]).sum()
        };
        self.starts.windows(2).map(of_node).collect()
    }

    /// The transpose of [`interpolated`](Self::interpolated): forces at all nodes as they are at the corners.
    #[must_use]
    pub fn restricted(&self, at_nodes: &[f64]) -> Vec<f64> {
        let mut at_corners = vec![0.0; self.nodes.len()];
        for (own, force) in self.starts.windows(2).zip(at_nodes) {
            for (&corner, weight) in self.parents[own[0]..own[1]].iter().zip(&self.weights[own[0]..own[1]]) {
                at_corners[corner as usize] += weight * force;
            }
        }
        at_corners
    }

    /// The interpolation with `dim` components per node: nothing comes from unknowns of corners that are [fixed](Self::fixed).
    pub(super) fn transfer(&self, dim: usize, of_corners: &[bool]) -> Transfer {
        let mut rows = BlockRows { block_columns: self.nodes.len(), starts: vec![0], columns: Vec::new() };
        let mut values = Vec::new();
        for node in 0..self.starts.len() - 1 {
            for k in self.starts[node]..self.starts[node + 1] {
                let parent = self.parents[k] as usize;
                let (corner, fixed) = (self.nodes[parent] as usize, &of_corners[dim * parent..][..dim]);
                // a corner keeps its place though nothing of it is free: the next level must know that it is idle
                if corner != node && !fixed.contains(&false) {
                    continue;
                }
                rows.columns.push(self.parents[k]);
                for at in 0..dim * dim {
                    let (r, c) = (at / dim, at % dim);
                    values.push(if r == c && !fixed[r] { self.weights[k] as f32 } else { 0.0 });
                }
            }
            rows.starts.push(rows.columns.len());
        }
        Transfer { values, ..Transfer::new((dim, dim), rows) }
    }
}
