//! [`BodySurface`]: the faces of a body that are seen, on the nodes that they need.

use crate::encode::indices;
use nastic_mesh::{CellKind, Mesh};
use nastic_picture::{Face, FacePattern};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Pieces along each side of a second-order face.
const FINENESS: usize = 4;
/// Triangles above which faces are cut less finely.
const MOST_TRIANGLES: usize = 200_000;
/// Most arrows of one field.
const MOST_ARROWS: usize = 900;

/// The faces of a body that are seen.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodySurface {
    /// Nodes of the mesh that lie on a face, ascending.
    pub nodes: Vec<u32>,
    /// By kind, in the order of the mesh within each.
    blocks: Vec<FaceBlock>,
    plane: bool,
}

/// Faces of one kind.
#[derive(Clone, Debug, PartialEq)]
struct FaceBlock {
    kind: CellKind,
    /// Places of their nodes in [`BodySurface::nodes`].
    nodes: Vec<u32>,
    /// The cell of each.
    cells: Vec<u32>,
}

impl BodySurface {
    pub fn of(mesh: &Mesh) -> Self {
        Self::of_faces(mesh, Face::all(mesh))
    }

    /// The faces all of whose nodes are marked.
    pub fn of_marked(mesh: &Mesh, marked: impl Fn(u32) -> bool) -> Self {
        let mut faces = Face::all(mesh);
        faces.retain(|face| face.nodes.iter().all(|node| marked(*node)));
        Self::of_faces(mesh, faces)
    }

    fn of_faces(mesh: &Mesh, faces: Vec<Face>) -> Self {
        let nodes: BTreeSet<u32> = faces.iter().flat_map(|face| face.nodes.iter().copied()).collect();
        let nodes: Vec<u32> = nodes.into_iter().collect();
        let mut place = vec![0; mesh.points().len()];
        nodes.iter().enumerate().for_each(|(k, node)| place[*node as usize] = k as u32);
        let mut blocks: BTreeMap<&str, FaceBlock> = BTreeMap::new();
        for face in faces {
            let block = blocks.entry(face.kind.name()).or_insert_with(|| FaceBlock {
                kind: face.kind,
                nodes: Vec::new(),
                cells: Vec::new(),
            });
            block.nodes.extend(face.nodes.iter().map(|node| place[*node as usize]));
            block.cells.push(face.cell as u32);
        }
        Self { nodes, blocks: blocks.into_values().collect(), plane: mesh.dim() == 2 }
    }

    /// The cell of every face.
    pub fn cells(&self) -> Vec<u32> {
        self.blocks.iter().flat_map(|block| block.cells.iter().copied()).collect()
    }

    /// Faces that bear an arrow: one for every cell, fewer where there are too many.
    pub fn arrow_faces(&self) -> Vec<u32> {
        let mut seen = BTreeSet::new();
        let cells = self.cells().into_iter().enumerate();
        let firsts: Vec<u32> = cells.filter(|(_, cell)| seen.insert(*cell)).map(|(face, _)| face as u32).collect();
        let step = firsts.len().div_ceil(MOST_ARROWS).max(1);
        firsts.into_iter().step_by(step).collect()
    }

    /// Pieces along each side of a second-order face, for no more triangles than can be shown at ease.
    fn fineness(&self) -> usize {
        let fits = |fineness: &usize| self.triangles(*fineness) <= MOST_TRIANGLES;
        [FINENESS, 2].into_iter().find(fits).unwrap_or(1)
    }

    fn triangles(&self, fineness: usize) -> usize {
        let of = |block: &FaceBlock| {
            let pieces = FacePattern::of(block.kind, fineness).pieces;
            block.cells.len() * pieces.iter().map(|piece| piece.len() - 2).sum::<usize>()
        };
        self.blocks.iter().map(of).sum()
    }

    /// The surface for the page, which moves its points with the nodes: `nodes` (how many), `plane`, `arrows` and, for
    /// every kind of face, `weights` (the shape functions of its nodes at its points, row by row), `triangles` and
    /// `sides` of one face, `corners`, `faces` (nodes of each face) and `edges` (4 face + side: every edge once).
    pub fn json(&self) -> Value {
        let fineness = self.fineness();
        let mut edges = BTreeSet::new();
        let blocks: Vec<Value> = self.blocks.iter().map(|block| block.json(fineness, &mut edges)).collect();
        json!({
            "nodes": self.nodes.len(),
            "plane": self.plane,
            "arrows": indices(self.arrow_faces()),
            "blocks": blocks,
        })
    }
}

impl FaceBlock {
    fn json(&self, fineness: usize, known: &mut BTreeSet<[u32; 2]>) -> Value {
        let (kind, corners) = (self.kind, self.kind.corners());
        let pattern = FacePattern::of(kind, fineness);
        let mut weights = Vec::new();
        for point in &pattern.points {
            let mut shapes = vec![0.0; kind.nodes()];
            kind.shapes(point, &mut shapes);
            weights.extend(shapes.into_iter().map(|x| (x * 1e9).round() / 1e9));
        }
        let triangles: Vec<usize> = pattern
            .pieces
            .iter()
            .flat_map(|piece| (2..piece.len()).flat_map(|k| [piece[0], piece[k - 1], piece[k]]))
            .collect();
        let mut edges = Vec::new();
        for (face, nodes) in self.nodes.chunks_exact(kind.nodes()).enumerate() {
            for side in 0..corners {
                let mut ends = [nodes[side], nodes[(side + 1) % corners]];
                ends.sort_unstable();
                if known.insert(ends) {
                    edges.push((4 * face + side) as u32);
                }
            }
        }
        json!({
            "nodes": kind.nodes(),
            "corners": corners,
            "weights": weights,
            "triangles": triangles,
            "sides": pattern.sides,
            "faces": indices(self.nodes.iter().copied()),
            "edges": indices(edges),
        })
    }
}
