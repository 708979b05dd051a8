//! The surface of a body as nearly flat pieces and polylines: curved faces are cut up.

use std::collections::BTreeMap;

use nastic_mesh::{CellKind, Mesh};

use super::vector::{V3, unit};
use super::{Appearance, Body, Values};

/// A point of the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    pub at: V3,
    /// Unit outward normal; zero where the face is degenerate.
    pub normal: V3,
    pub value: f64,
}

/// An edge between faces, or at the end of one.
#[derive(Clone, Debug)]
pub(super) struct SurfaceEdge {
    pub points: Vec<V3>,
    /// Normals of the faces that meet there: one or two (or more where a body touches itself).
    pub normals: Vec<V3>,
}

/// Flat pieces of a body's surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    /// Triangles and quadrangles.
    pub pieces: Vec<Vec<SurfacePoint>>,
    pub edges: Vec<SurfaceEdge>,
}

impl Surface {
    /// Cuts second-order faces `fineness` times along each side.
    pub fn of(body: &Body, fineness: usize) -> Self {
        let mut surface = Surface::default();
        let mut edges = BTreeMap::new();
        for face in faces(&body.mesh) {
            let cuts = if face.kind.order() > 1 { fineness } else { face.kind.corners() - 2 };
            Piece::new(body, &face).cut(cuts, &mut surface, &mut edges);
        }
        surface.edges = edges.into_values().collect();
        surface
    }
}

/// A face that is seen: a boundary facet, or a cell of a plane mesh.
struct Face {
    kind: CellKind,
    nodes: Vec<u32>,
    cell: usize,
}

fn faces(mesh: &Mesh) -> Vec<Face> {
    if mesh.dim() == 2 {
        let of = |cell: usize| Face { kind: mesh.cell(cell).kind, nodes: mesh.cell(cell).nodes.to_vec(), cell };
        return (0..mesh.cells()).map(of).collect();
    }
    let boundary = mesh.boundary().iter();
    boundary
        .map(|facet| {
            let (kind, nodes) = mesh.facet_nodes(*facet);
            Face { kind, nodes, cell: facet.cell as usize }
        })
        .collect()
}

/// A face with what lies on it.
struct Piece<'a> {
    face: &'a Face,
    positions: Vec<V3>,
    values: Vec<f64>,
}

impl<'a> Piece<'a> {
    fn new(body: &Body, face: &'a Face) -> Self {
        let positions = body.mesh.gather(&body.positions, &face.nodes);
        let values = match &body.appearance {
            Appearance::Field(field) => match &field.values {
                Values::Nodes(values) => face.nodes.iter().map(|node| values[*node as usize]).collect(),
                Values::Cells(values) => vec![values[face.cell]; face.nodes.len()],
            },
            _ => vec![0.0; face.nodes.len()],
        };
        Self { face, positions, values }
    }

    fn point(&self, xi: [f64; 3]) -> SurfacePoint {
        let kind = self.face.kind;
        let mut shapes = [0.0; 9];
        let shapes = &mut shapes[..kind.nodes()];
        kind.shapes(&xi, shapes);
        let value = shapes.iter().zip(&self.values).map(|(n, value)| n * value).sum();
        let normal = unit(kind.area_vector(&self.positions, &xi)).unwrap_or([0.0; 3]);
        SurfacePoint { at: kind.map(&self.positions, &xi), normal, value }
    }

    fn cut(&self, cuts: usize, surface: &mut Surface, edges: &mut BTreeMap<[u32; 2], SurfaceEdge>) {
        let kind = self.face.kind;
        let n = cuts;
        let share = |k: usize| k as f64 / n as f64;
        if kind.corners() == 3 {
            let point = |i: usize, j: usize| self.point([share(i), share(j), 0.0]);
            for i in 0..n {
                for j in 0..n - i {
                    surface.pieces.push(vec![point(i, j), point(i + 1, j), point(i, j + 1)]);
                    if i + j + 2 <= n {
                        surface.pieces.push(vec![point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                    }
                }
            }
        } else {
            let point = |i: usize, j: usize| self.point([2.0 * share(i) - 1.0, 2.0 * share(j) - 1.0, 0.0]);
            for i in 0..n {
                for j in 0..n {
                    surface.pieces.push(vec![point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
                }
            }
        }
        self.edges(n, edges);
    }

    /// The sides of the face, shared with its neighbours by their corner nodes.
    fn edges(&self, cuts: usize, edges: &mut BTreeMap<[u32; 2], SurfaceEdge>) {
        let kind = self.face.kind;
        let corners = kind.corners();
        let reference = kind.reference_nodes();
        for k in 0..corners {
            let (a, b) = (k, (k + 1) % corners);
            let mut key = [self.face.nodes[a], self.face.nodes[b]];
            key.sort_unstable();
            let along = |s: f64| std::array::from_fn(|i| reference[a][i] * (1.0 - s) + reference[b][i] * s);
            let normal = self.point(along(0.5)).normal;
            let edge = edges.entry(key).or_insert_with(|| {
                let points = (0..=cuts).map(|k| self.point(along(k as f64 / cuts as f64)).at).collect();
                SurfaceEdge { points, normals: Vec::new() }
            });
            edge.normals.push(normal);
        }
    }
}
