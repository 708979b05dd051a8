//! [`Column`]: chains of quadrilaterals or hexahedra through opposite faces, which show how many cells lie over a thickness.

use crate::geometry::{minus, norm};
use crate::{CellKind, Domain, Facet, Mesh};

/// One local axis of a cell, and the chain of cells along it: from the cell through its two opposite faces to the next
/// cells, on through theirs, until the boundary, a cell of another kind or the cell itself (a ring) is met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Extent of the cell along the axis: distance of the centres of the two faces.
    pub extent: f64,
    /// Sum of the extents of the chain; infinite where it is a ring.
    pub length: f64,
    /// Cells of the chain.
    pub cells: usize,
}

/// Faces of a cell.
const MAX_FACES: usize = 6;

impl Mesh {
    /// The columns of every cell, one for each of its local axes: two of a quadrilateral, three of a hexahedron, none of a
    /// simplex.
    pub fn columns(&self) -> Vec<Vec<Column>> {
        let mut across: Vec<[Option<Facet>; MAX_FACES]> = vec![[None; MAX_FACES]; self.cells()];
        for &(a, b) in self.neighbours() {
            across[a.cell as usize][a.face as usize] = Some(b);
            across[b.cell as usize][b.face as usize] = Some(a);
        }
        let axes = |cell: u32| opposite_faces(self.cell(cell as usize).kind);
        let mut out: Vec<Vec<Column>> = (0..self.cells() as u32)
            .map(|cell| {
                let extent = |pair: &[u8; 2]| self.between(cell, *pair);
                axes(cell).iter().map(|pair| Column { extent: extent(pair), length: 0.0, cells: 0 }).collect()
            })
            .collect();
        for first in 0..self.cells() as u32 {
            for axis in 0..axes(first).len() {
                if out[first as usize][axis].cells > 0 {
                    continue;
                }
                let (chain, ring) = chain(&across, axes, first, axis);
                let length: f64 = chain.iter().map(|&(cell, axis)| out[cell as usize][axis].extent).sum();
                let length = if ring { f64::INFINITY } else { length };
                for &(cell, axis) in &chain {
                    let column = &mut out[cell as usize][axis];
                    (column.length, column.cells) = (length, chain.len());
                }
            }
        }
        out
    }

    /// Distance of the centres of two faces.
    fn between(&self, cell: u32, faces: [u8; 2]) -> f64 {
        let centre = |face: u8| {
            let (kind, nodes) = self.facet_nodes(Facet { cell, face });
            let corners = &nodes[..kind.corners()];
            let sum = |k: usize| corners.iter().map(|&node| self.points()[node as usize][k]).sum::<f64>();
            [0, 1, 2].map(|k| sum(k) / corners.len() as f64)
        };
        norm(&minus(&centre(faces[1]), &centre(faces[0])))
    }
}

/// Pairs of opposite faces of a cell, one for each local axis.
fn opposite_faces(kind: CellKind) -> &'static [[u8; 2]] {
    match (kind.domain(), kind.dim()) {
        (Domain::Box, 2) => &[[3, 1], [0, 2]],
        (Domain::Box, 3) => &[[0, 1], [2, 3], [4, 5]],
        (Domain::Box | Domain::Simplex, _) => &[],
    }
}

/// The chain through a cell along one of its axes, as cells with their axes, and whether it closes.
fn chain(
    across: &[[Option<Facet>; MAX_FACES]],
    axes: impl Fn(u32) -> &'static [[u8; 2]],
    first: u32,
    axis: usize,
) -> (Vec<(u32, usize)>, bool) {
    let mut chain = vec![(first, axis)];
    for side in 0..2 {
        let mut leave = Facet { cell: first, face: axes(first)[axis][side] };
        while let Some(enter) = across[leave.cell as usize][leave.face as usize] {
            let pairs = axes(enter.cell);
            let Some(axis) = pairs.iter().position(|pair| pair.contains(&enter.face)) else { break };
            // Along an axis every cell has one successor on either side, so that a chain meets itself at its beginning only.
            if (enter.cell, axis) == chain[0] {
                return (chain, true);
            }
            chain.push((enter.cell, axis));
            let [a, b] = pairs[axis];
            leave = Facet { cell: enter.cell, face: if enter.face == a { b } else { a } };
        }
    }
    (chain, false)
}
