//! [`Pieces`]: the flat pieces of a surface.

use nastic_body::discretization::Discretization;
use nastic_mesh::spatial::{Aabb, Tree};
use nastic_mesh::{CellKind, Facet};
use nastic_tensor::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Segments or triangles between the nodes of facets.
#[derive(Debug)]
pub(super) struct Pieces {
    /// Nodes of every piece, and the number of its facet.
    pub all: Vec<(Vec<u32>, u32)>,
    /// Nodes of every facet.
    pub facets: Vec<Vec<u32>>,
}

/// Where they are.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    tree: Tree,
}

impl Pieces {
    pub fn new(disc: &Discretization, facets: &[Facet]) -> Self {
        let mut pieces = Pieces { all: Vec::new(), facets: Vec::new() };
        for (number, &facet) in facets.iter().enumerate() {
            let (kind, nodes) = disc.mesh().facet_nodes(facet);
            let own = corners(kind).iter().map(|corners| (corners.iter().map(|&a| nodes[a]).collect(), number as u32));
            pieces.all.extend(own);
            pieces.facets.push(nodes);
        }
        pieces
    }

    /// The edges of pieces, each once, with the numbers of the facets that they are of; ascending.
    pub fn edges(&self) -> Vec<([u32; 2], Vec<u32>)> {
        let mut all: BTreeMap<[u32; 2], BTreeSet<u32>> = BTreeMap::new();
        for (nodes, facet) in &self.all {
            for (k, &a) in nodes.iter().enumerate() {
                let b = nodes[(k + 1) % nodes.len()];
                all.entry([a.min(b), a.max(b)]).or_default().insert(*facet);
            }
        }
        all.into_iter().map(|(nodes, facets)| (nodes, facets.into_iter().collect())).collect()
    }

    /// Of some sets of nodes the facets around them and the neighbours of those, ascending.
    pub fn around(&self, sets: impl Iterator<Item = BTreeSet<u32>>) -> Vec<Vec<u32>> {
        let mut of_node: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (number, nodes) in self.facets.iter().enumerate() {
            nodes.iter().for_each(|&node| of_node.entry(node).or_default().push(number as u32));
        }
        let around = |nodes: &BTreeSet<u32>| -> BTreeSet<u32> {
            nodes.iter().filter_map(|node| of_node.get(node)).flatten().copied().collect()
        };
        let ring = |own: BTreeSet<u32>| -> Vec<u32> {
            let nodes = around(&own).iter().flat_map(|&facet| self.facets[facet as usize].iter().copied()).collect();
            around(&nodes).into_iter().collect()
        };
        sets.map(ring).collect()
    }

    /// A tree over the boxes that pieces have at two moments.
    pub fn placed(&self, places: &[&dyn Fn(u32) -> Vec3]) -> Placed {
        let around = |(nodes, _): &(Vec<u32>, u32)| {
            let all: Vec<Vec3> = places.iter().flat_map(|at| nodes.iter().map(|&node| at(node))).collect();
            Aabb::around(&all)
        };
        Placed { tree: Tree::build(&self.all.iter().map(around).collect::<Vec<_>>()) }
    }
}

impl Placed {
    /// The pieces whose boxes overlap one, ascending.
    pub fn overlapping(&self, range: &Aabb) -> Vec<usize> {
        let mut found = Vec::new();
        self.tree.overlapping(range, |piece| {
            found.push(piece);
            false
        });
        found.sort_unstable();
        found
    }

    /// The least value of a distance that is no less than that from the pieces' boxes, with its piece.
    pub fn least(&self, x: &Vec3, distance: impl Fn(usize) -> Option<f64>) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        self.tree.nearest(x, f64::INFINITY, |piece, squared| match distance(piece) {
            Some(d) if best.is_none_or(|(known, of)| (d, piece) < (known, of)) => {
                best = Some((d, piece));
                squared.min(d * d)
            }
            _ => squared,
        });
        best
    }
}

/// The pieces of a facet, by its nodes.
fn corners(kind: CellKind) -> &'static [&'static [usize]] {
    match kind {
        CellKind::Line2 => &[&[0, 1]],
        CellKind::Line3 => &[&[0, 2], &[2, 1]],
        CellKind::Tri3 => &[&[0, 1, 2]],
        CellKind::Tri6 => &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
        CellKind::Quad4 => &[&[0, 1, 2], &[0, 2, 3]],
        CellKind::Quad8 => &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6], &[4, 6, 7]],
        CellKind::Quad9 => {
            &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 8], &[5, 6, 8], &[6, 7, 8], &[7, 4, 8]]
        }
        // no facets
        CellKind::Tet4 | CellKind::Tet10 | CellKind::Hex8 | CellKind::Hex20 | CellKind::Hex27 => &[],
    }
}
