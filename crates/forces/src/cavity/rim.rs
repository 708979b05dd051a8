//! Where a surface is open, and how it is closed.

use nastic_body::error::FemError;
use nastic_mesh::{Facet, Mesh};
use nastic_numeric::DisjointSets;
use nastic_numeric::format::short;
use std::collections::BTreeMap;

/// A plane of symmetry, across an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    pub axis: usize,
    pub at: f64,
}

/// An edge that only one facet has: its nodes (two corners, then the one between them, if any), in the sense in which the
/// facet goes round its outward normal. In plane strain an end of the line, one node: the last one is entered, the first left.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RimEdge {
    pub nodes: Vec<u32>,
    /// In plane strain: whether the line ends here (else it begins).
    pub end: bool,
}

/// Distance from a plane up to which a node lies on it, as a share of the body's diagonal.
pub(super) const PLANE_TOLERANCE: f64 = 1e-9;

impl Plane {
    /// The plane of a surface whose nodes share a coordinate.
    pub fn of(mesh: &Mesh, surface: &str) -> Result<Self, FemError> {
        let nodes = mesh.nodes_of_facets(mesh.surface(surface)?);
        for axis in 0..mesh.dim() {
            let coordinate = |node: &u32| mesh.points()[*node as usize][axis];
            let (least, most) =
                nodes.iter().map(coordinate).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), x| (l.min(x), m.max(x)));
            if most - least <= PLANE_TOLERANCE * mesh.diagonal() {
                return Ok(Plane { axis, at: 0.5 * (least + most) });
            }
        }
        let what = format!(
            "surface \"{surface}\" is no plane across x, y or z, so it cannot be a plane of symmetry of a cavity"
        );
        Err(FemError::Meaningless { what })
    }

    pub fn has(&self, mesh: &Mesh, node: u32) -> bool {
        (mesh.points()[node as usize][self.axis] - self.at).abs() <= PLANE_TOLERANCE * mesh.diagonal()
    }
}

/// The edges at which the surface is open, those on planes of symmetry left out.
pub(super) fn open_edges(mesh: &Mesh, facets: &[Facet], planes: &[Plane]) -> Vec<RimEdge> {
    let mut seen: BTreeMap<Vec<u32>, (usize, RimEdge)> = BTreeMap::new();
    for &facet in facets {
        let (kind, nodes) = mesh.facet_nodes(facet);
        for edge in edges_of(kind, &nodes) {
            let mut key: Vec<u32> = edge.nodes.iter().take(2).copied().collect();
            key.sort_unstable();
            seen.entry(key).or_insert((0, edge)).0 += 1;
        }
    }
    let single = seen.into_values().filter(|(count, _)| *count == 1).map(|(_, edge)| edge);
    let on_plane = |edge: &RimEdge| planes.iter().any(|plane| edge.nodes.iter().all(|&node| plane.has(mesh, node)));
    single.filter(|edge| !on_plane(edge)).collect()
}

fn edges_of(kind: nastic_mesh::CellKind, nodes: &[u32]) -> Vec<RimEdge> {
    if kind.dim() == 1 {
        return vec![RimEdge { nodes: vec![nodes[0]], end: false }, RimEdge { nodes: vec![nodes[1]], end: true }];
    }
    let corners = kind.corners();
    let edge = |(e, &[a, b]): (usize, &[usize; 2])| {
        let mut edge = vec![nodes[a], nodes[b]];
        edge.extend((kind.order() == 2).then(|| nodes[corners + e]));
        RimEdge { nodes: edge, end: true }
    };
    kind.edges().iter().enumerate().map(edge).collect()
}

/// Where a surface is open, for people: `4 around (1, 0.5, 0.5), 4 around (0, 0.5, 0.5)`.
pub(super) fn places(mesh: &Mesh, open: Vec<RimEdge>) -> String {
    const MAX_NAMED: usize = 4;
    let rims = rims(open, mesh.dim() == 2);
    let place = |rim: &Vec<RimEdge>| {
        let nodes: Vec<u32> = rim.iter().flat_map(|edge| edge.nodes.iter().copied()).collect();
        let middle = |axis: usize| {
            let sum: f64 = nodes.iter().map(|node| mesh.points()[*node as usize][axis]).sum();
            short(sum / nodes.len() as f64)
        };
        format!("{} around ({}, {}, {})", rim.len(), middle(0), middle(1), middle(2))
    };
    let more = rims.len().saturating_sub(MAX_NAMED);
    let rest = if more > 0 { format!(" and {more} more rims") } else { String::new() };
    rims.iter().take(MAX_NAMED).map(place).collect::<Vec<_>>().join(", ") + &rest
}

/// Edges that hang together, rim by rim.
pub(super) fn rims(edges: Vec<RimEdge>, plane_strain: bool) -> Vec<Vec<RimEdge>> {
    if plane_strain {
        // two ends of one line are closed together
        return if edges.is_empty() { Vec::new() } else { vec![edges] };
    }
    let mut nodes: Vec<u32> = edges.iter().flat_map(|edge| edge.nodes.iter().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let index = |node: u32| nodes.binary_search(&node).unwrap_or_default() as u32;
    let mut sets = DisjointSets::new(nodes.len());
    for edge in &edges {
        edge.nodes.windows(2).for_each(|pair| sets.union(index(pair[0]), index(pair[1])));
    }
    let mut rims: BTreeMap<u32, Vec<RimEdge>> = BTreeMap::new();
    for edge in edges {
        rims.entry(sets.find(index(edge.nodes[0]))).or_default().push(edge);
    }
    rims.into_values().collect()
}
