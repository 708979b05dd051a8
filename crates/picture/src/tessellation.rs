//! The surface of a body as nearly flat pieces and polylines: curved faces are cut up.

use std::collections::BTreeMap;

use super::body::{Appearance, Body, FieldValues};
use super::face::{Face, FacePattern};
use super::vector::{V3, unit};

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
    pub fn of(body: &Body, faces: &[Face], fineness: usize) -> Self {
        let mut surface = Surface::default();
        let mut edges = BTreeMap::new();
        let mut patterns: BTreeMap<&'static str, FacePattern> = BTreeMap::new();
        for face in faces {
            let pattern = patterns.entry(face.kind.name()).or_insert_with(|| FacePattern::of(face.kind, fineness));
            Piece::new(body, face).cut(pattern, &mut surface, &mut edges);
        }
        surface.edges = edges.into_values().collect();
        surface
    }
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
                FieldValues::Nodes(values) => face.nodes.iter().map(|node| values[*node as usize]).collect(),
                FieldValues::Cells(values) => vec![values[face.cell]; face.nodes.len()],
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

    fn cut(&self, pattern: &FacePattern, surface: &mut Surface, edges: &mut BTreeMap<[u32; 2], SurfaceEdge>) {
        let points: Vec<SurfacePoint> = pattern.points.iter().map(|xi| self.point(*xi)).collect();
        for piece in &pattern.pieces {
            surface.pieces.push(piece.iter().map(|k| points[*k]).collect());
        }
        self.edges(pattern, &points, edges);
    }

    /// The sides of the face, shared with its neighbours by their corner nodes.
    fn edges(&self, pattern: &FacePattern, points: &[SurfacePoint], edges: &mut BTreeMap<[u32; 2], SurfaceEdge>) {
        let kind = self.face.kind;
        let corners = kind.corners();
        let reference = kind.reference_nodes();
        for (k, side) in pattern.sides.iter().enumerate() {
            let (a, b) = (k, (k + 1) % corners);
            let mut key = [self.face.nodes[a], self.face.nodes[b]];
            key.sort_unstable();
            let middle = std::array::from_fn(|i| 0.5 * (reference[a][i] + reference[b][i]));
            let normal = self.point(middle).normal;
            let edge = edges.entry(key).or_insert_with(|| SurfaceEdge {
                points: side.iter().map(|k| points[*k].at).collect(),
                normals: Vec::new(),
            });
            edge.normals.push(normal);
        }
    }
}
