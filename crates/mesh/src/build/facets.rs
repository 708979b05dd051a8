//! The facets of all cells, found by their corners in linear time: nodes are numbers, so the lowest corner is a bucket.

use crate::mesh::{CellBlock, Facet};
use crate::{CellKind, Fault};

/// Corners of a facet, ascending, padded with `u32::MAX`.
type Key = [u32; 4];

/// One side of a facet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    key: Key,
    pub facet: Facet,
}

/// Every face of every cell, sorted by corners.
pub(crate) struct FacetTable {
    /// Where the bucket of each node begins.
    starts: Vec<u32>,
    sides: Vec<Side>,
}

/// Boundary facets, and the two sides of inner ones.
type Sorted = (Vec<Facet>, Vec<(Facet, Facet)>);

impl FacetTable {
    pub(crate) fn new(blocks: &[CellBlock], nodes: usize) -> FacetTable {
        let mut starts = vec![0u32; nodes + 1];
        each_side(blocks, |side| starts[side.key[0] as usize + 1] += 1);
        for k in 0..nodes {
            starts[k + 1] += starts[k];
        }
        let mut next = starts.clone();
        let none = Side { key: [0; 4], facet: Facet { cell: 0, face: 0 } };
        let mut sides = vec![none; starts[nodes] as usize];
        each_side(blocks, |side| {
            let slot = &mut next[side.key[0] as usize];
            sides[*slot as usize] = side;
            *slot += 1;
        });
        for k in 0..nodes {
            sides[starts[k] as usize..starts[k + 1] as usize].sort_unstable();
        }
        FacetTable { starts, sides }
    }

    /// The sides (usually one or two) of the facet with these corners, in ascending order of cells.
    pub(crate) fn find(&self, corners: impl Iterator<Item = u32>) -> &[Side] {
        let key = key(corners);
        let (Some(&start), Some(&end)) = (self.starts.get(key[0] as usize), self.starts.get(key[0] as usize + 1))
        else {
            return &[];
        };
        let bucket = &self.sides[start as usize..end as usize];
        let from = bucket.partition_point(|side| side.key < key);
        let to = bucket.partition_point(|side| side.key <= key);
        &bucket[from..to]
    }

    /// Sorts facets into boundary and inner ones, both ascending, and checks that cells meet as they should.
    pub(crate) fn sides(&self, blocks: &[CellBlock], label: impl Fn(usize) -> u64) -> Result<Sorted, Fault> {
        let (mut boundary, mut inner) = (Vec::new(), Vec::new());
        for run in self.sides.chunk_by(|a, b| a.key == b.key) {
            match run {
                [only] => boundary.push(only.facet),
                [a, b] => {
                    meet(blocks, a.facet, b.facet, &label)?;
                    inner.push((a.facet, b.facet));
                }
                _ => {
                    let cells = run.iter().map(|side| label(side.facet.cell as usize)).collect();
                    return Err(Fault::NonManifold { cells });
                }
            }
        }
        boundary.sort_unstable();
        inner.sort_unstable();
        Ok((boundary, inner))
    }
}

fn key(corners: impl Iterator<Item = u32>) -> Key {
    let mut key = [u32::MAX; 4];
    for (slot, corner) in key.iter_mut().zip(corners) {
        *slot = corner;
    }
    key.sort_unstable();
    key
}

fn each_side(blocks: &[CellBlock], mut visit: impl FnMut(Side)) {
    for block in blocks {
        for (k, nodes) in block.iter().enumerate() {
            let cell = (block.first + k) as u32;
            for (face, (kind, local)) in (0u8..).zip(block.kind.faces()) {
                let corners = local[..kind.corners()].iter().map(|&a| nodes[a]);
                visit(Side { key: key(corners), facet: Facet { cell, face } });
            }
        }
    }
}

pub(super) fn facet_nodes(blocks: &[CellBlock], facet: Facet) -> (CellKind, Vec<u32>) {
    let id = facet.cell as usize;
    let block = &blocks[blocks.partition_point(|block| block.first <= id) - 1];
    let n = block.kind.nodes();
    let nodes = &block.nodes[(id - block.first) * n..][..n];
    let (kind, local) = block.kind.faces()[facet.face as usize];
    (kind, local.iter().map(|&a| nodes[a]).collect())
}

/// Two cells share these corners: the rest of the nodes must agree, and the cells must lie on opposite sides.
fn meet(blocks: &[CellBlock], a: Facet, b: Facet, label: &impl Fn(usize) -> u64) -> Result<(), Fault> {
    let ((kind_a, nodes_a), (kind_b, nodes_b)) = (facet_nodes(blocks, a), facet_nodes(blocks, b));
    let cells = [label(a.cell as usize), label(b.cell as usize)];
    if kind_a != kind_b || !same_set(&nodes_a, &nodes_b) {
        let kind = |facet: Facet| blocks[blocks.partition_point(|b| b.first <= facet.cell as usize) - 1].kind;
        return Err(Fault::NonConforming { cells, kinds: [kind(a), kind(b)] });
    }
    let corners = kind_a.corners();
    let (corners_a, corners_b) = (&nodes_a[..corners], &nodes_b[..corners]);
    let reversed: Vec<u32> = corners_b.iter().rev().copied().collect();
    if !same_cycle(corners_a, &reversed) {
        return Err(if same_cycle(corners_a, corners_b) {
            Fault::Overlap { cells }
        } else {
            Fault::NonConforming { cells, kinds: [kind_a, kind_b] }
        });
    }
    Ok(())
}

pub(super) fn same_set(a: &[u32], b: &[u32]) -> bool {
    a.len() == b.len() && a.iter().all(|node| b.contains(node))
}

fn same_cycle(a: &[u32], b: &[u32]) -> bool {
    let Some(shift) = b.iter().position(|node| *node == a[0]) else { return false };
    (0..a.len()).all(|k| a[k] == b[(k + shift) % b.len()])
}
