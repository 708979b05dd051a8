//! [`Polyhedron`]: a solid bounded by flat triangles, and the signed distance from it.

use super::tree::{Aabb, Tree};
use super::{SpatialError, V, shape};
use crate::{CellKind, GroupNames, Mesh};
use std::collections::HashMap;

/// Difference from 1 of the cosine between a mean normal and that of the face, up to which they have one plane.
const PLANE_TOLERANCE: f64 = 1e-14;
/// Twice the area of a triangle over its longest edge squared, below which it counts as zero.
const MIN_AREA_RATIO: f64 = 1e-12;

/// The cells of a mesh, or of some of its regions, as a solid with flat faces: triangles, of quadrilaterals the two on one side of a
/// diagonal each; segments in the plane. Made for the signed distance of points that move.
#[derive(Clone, Debug)]
pub struct Polyhedron {
    dim: usize,
    triangles: Vec<Triangle>,
    tree: Tree,
}

/// A point of the surface with the signed distance `d(x) = +-|x - p|` from it, negative inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The nearest point p of the surface.
    pub point: [f64; 3],
    /// d
    pub distance: f64,
    /// `grad d`, a unit vector; on an edge or in a corner of the surface itself that of the mean of its faces.
    pub normal: [f64; 3],
    /// What p lies on.
    pub on: Feature,
}

/// A part of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feature {
    /// The inside of a face: d is linear there.
    Face,
    /// The inside of an edge, with its direction: `d2d/dx2 = (1 - n n^T - a a^T)/d`.
    Edge([f64; 3]),
    /// A corner: `d2d/dx2 = (1 - n n^T)/d`.
    Corner,
}

/// A face with the normals of its parts, which distinguish the inside from the outside.
#[derive(Clone, Debug, PartialEq)]
struct Triangle {
    corners: [V; 3],
    face: V,
    /// Sums over the faces at each edge (from corner k to the next); of no unit length.
    edges: [V; 3],
    /// Sums over the faces at each corner, weighted by their angles there.
    at_corners: [V; 3],
}

/// Where the nearest point of a triangle lies.
#[derive(Clone, Copy)]
enum Part {
    Face,
    Edge(usize),
    Corner(usize),
}

impl PartialEq for Polyhedron {
    fn eq(&self, other: &Self) -> bool {
        self.dim == other.dim && self.triangles == other.triangles
    }
}

impl Polyhedron {
    /// The union of the cells of these regions, of all cells without any.
    ///
    /// # Errors
    /// Quadratic cells, whose faces are curved; an unknown or empty region; a face without area.
    pub fn of(mesh: &Mesh, regions: Option<&GroupNames>) -> Result<Self, SpatialError> {
        let cells: Vec<u32> = match regions {
            Some(names) => mesh.cells_of(names)?,
            None => (0..mesh.cells() as u32).collect(),
        };
        if cells.is_empty() {
            let region = regions.map_or_else(|| "(all cells)".to_owned(), ToString::to_string);
            return Err(SpatialError::Empty { mesh: mesh.name().into(), region });
        }
        let mut faces: Vec<[u32; 3]> = Vec::new();
        for (cell, face) in shape::exterior(mesh, &cells) {
            let cell = mesh.cell(cell as usize);
            let (kind, locals) = cell.kind.faces()[face];
            let node = |k: usize| cell.nodes[locals[k]];
            match kind {
                CellKind::Line2 => faces.push([node(0), node(1), node(1)]),
                CellKind::Tri3 => faces.push([node(0), node(1), node(2)]),
                CellKind::Quad4 => faces.extend(halves(mesh, [0, 1, 2, 3].map(node))),
                _ => return Err(SpatialError::Curved { mesh: mesh.name().into(), kind: cell.kind.name() }),
            }
        }
        let triangles = triangles(mesh, &faces)?;
        let boxes: Vec<Aabb> = triangles.iter().map(|triangle| Aabb::around(&triangle.corners)).collect();
        Ok(Self { dim: mesh.dim(), triangles, tree: Tree::build(&boxes) })
    }

    /// Space dimension: 2 or 3.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Lowest and highest corner of its bounding box.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let corners = self.triangles.iter().flat_map(|triangle| triangle.corners);
        let wide = (V::repeat(f64::INFINITY), V::repeat(f64::NEG_INFINITY));
        let (low, high) = corners.fold(wide, |(low, high), x| (low.inf(&x), high.sup(&x)));
        (low.into(), high.into())
    }

    /// Corners of its faces, of segments in the plane the second one twice, and normals.
    pub(super) fn faces(&self) -> impl Iterator<Item = ([V; 3], V)> {
        self.triangles.iter().map(|triangle| (triangle.corners, triangle.face))
    }

    /// The nearest point of the surface, and the signed distance from it. Inside or outside is decided by the mean normal of the part that
    /// is nearest (Baerentzen, Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE TVCG 11, 2005).
    pub fn nearest(&self, x: [f64; 3]) -> SurfacePoint {
        self.nearest_within(x, f64::INFINITY)
    }

    /// The same of a point that is known to be no further from the surface.
    pub(super) fn nearest_within(&self, x: [f64; 3], reach: f64) -> SurfacePoint {
        let x = V::from(x);
        let mut found = (f64::INFINITY, 0, V::zeros(), Part::Face);
        self.tree.nearest(&x, reach * reach, |item, best| {
            let (point, part) = self.triangles[item].nearest(&x);
            let squared = (x - point).norm_squared();
            // of several at one distance the first in the mesh
            if squared < found.0 || (squared == found.0 && item < found.1) {
                found = (squared, item, point, part);
            }
            best.min(squared)
        });
        let (squared, item, point, part) = found;
        let triangle = &self.triangles[item];
        let (mean, on) = match part {
            Part::Face => (triangle.face, Feature::Face),
            Part::Edge(k) => (triangle.edges[k], Feature::Edge(triangle.edge(k).normalize().into())),
            Part::Corner(k) => (triangle.at_corners[k], Feature::Corner),
        };
        // between faces of one plane there is no edge
        let in_plane = mean.dot(&triangle.face) >= (1.0 - PLANE_TOLERANCE) * mean.norm();
        let (part, mean, on) = if in_plane { (Part::Face, triangle.face, Feature::Face) } else { (part, mean, on) };
        let (away, offset) = (squared.sqrt(), x - point);
        let sign = if offset.dot(&mean) < 0.0 { -1.0 } else { 1.0 };
        // of a face its own normal: the offset is rounding near to it
        let normal = match part {
            Part::Face => mean,
            _ if away > f64::EPSILON * x.norm() => offset * (sign / away),
            _ => mean.try_normalize(0.0).unwrap_or(triangle.face),
        };
        SurfacePoint { point: point.into(), distance: sign * away, normal: normal.into(), on }
    }
}

impl Triangle {
    fn edge(&self, k: usize) -> V {
        self.corners[(k + 1) % 3] - self.corners[k]
    }

    /// Ericson, Real-Time Collision Detection (2005), section 5.1.5: by the regions of its plane.
    fn nearest(&self, x: &V) -> (V, Part) {
        let [a, b, c] = &self.corners;
        let (ab, ac) = (b - a, c - a);
        if b == c {
            let t = (x - a).dot(&ab) / ab.norm_squared();
            return match t {
                t if t <= 0.0 => (*a, Part::Corner(0)),
                t if t >= 1.0 => (*b, Part::Corner(1)),
                t => (a + ab * t, Part::Face),
            };
        }
        let (d1, d2) = (ab.dot(&(x - a)), ac.dot(&(x - a)));
        let (d3, d4) = (ab.dot(&(x - b)), ac.dot(&(x - b)));
        let (d5, d6) = (ab.dot(&(x - c)), ac.dot(&(x - c)));
        if d1 <= 0.0 && d2 <= 0.0 {
            return (*a, Part::Corner(0));
        }
        if d3 >= 0.0 && d4 <= d3 {
            return (*b, Part::Corner(1));
        }
        if d6 >= 0.0 && d5 <= d6 {
            return (*c, Part::Corner(2));
        }
        let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
        if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
            return (a + ab * (d1 / (d1 - d3)), Part::Edge(0));
        }
        if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
            return (a + ac * (d2 / (d2 - d6)), Part::Edge(2));
        }
        if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
            return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), Part::Edge(1));
        }
        let sum = va + vb + vc;
        (a + ab * (vb / sum) + ac * (vc / sum), Part::Face)
    }
}

/// The two triangles of a quadrilateral, on the sides of the diagonal that leaves the larger smallest one; of equal ones that from its first corner.
fn halves(mesh: &Mesh, [a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    let area = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|node| V::from(mesh.points()[node as usize]));
        (b - a).cross(&(c - a)).norm()
    };
    let least = |split: &[[u32; 3]; 2]| area(&split[0]).min(area(&split[1]));
    let (first, other) = ([[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]);
    if least(&other) > (1.0 + 1e-6) * least(&first) { other } else { first }
}

fn longest_edge(corners: &[V; 3]) -> f64 {
    (0..3).map(|k| (corners[(k + 1) % 3] - corners[k]).norm()).fold(0.0, f64::max)
}

/// The faces with their normals, outwards, and the sums of these at edges and corners.
fn triangles(mesh: &Mesh, faces: &[[u32; 3]]) -> Result<Vec<Triangle>, SpatialError> {
    let corner = |node: u32| V::from(mesh.points()[node as usize]);
    let mut found = Vec::with_capacity(faces.len());
    let (mut edges, mut corners) = (HashMap::<[u32; 2], V>::new(), HashMap::<u32, V>::new());
    let key = |face: &[u32; 3], k: usize| {
        let (a, b) = (face[k], face[(k + 1) % 3]);
        [a.min(b), a.max(b)]
    };
    for face in faces {
        let [a, b, c] = face.map(corner);
        let area = if mesh.dim() == 2 { (b - a).cross(&V::z()) } else { (b - a).cross(&(c - a)) };
        // the normal of less is rounding
        let least = if mesh.dim() == 2 { 0.0 } else { MIN_AREA_RATIO * longest_edge(&[a, b, c]).powi(2) };
        let normal = area.try_normalize(least).filter(|n| n.iter().all(|n| n.is_finite()));
        let Some(normal) = normal else {
            return Err(SpatialError::Flat { mesh: mesh.name().into(), nodes: face.to_vec() });
        };
        for k in 0..3 {
            *edges.entry(key(face, k)).or_insert_with(V::zeros) += normal;
            let [here, next, last] = [k, k + 1, k + 2].map(|k| corner(face[k % 3]));
            let angle = if mesh.dim() == 2 { 1.0 } else { (next - here).angle(&(last - here)) };
            // the third corner of a segment is its second
            if mesh.dim() == 3 || k < 2 {
                *corners.entry(face[k]).or_insert_with(V::zeros) += normal * angle;
            }
        }
        found.push(Triangle { corners: [a, b, c], face: normal, edges: [V::zeros(); 3], at_corners: [V::zeros(); 3] });
    }
    for (triangle, face) in found.iter_mut().zip(faces) {
        triangle.edges = std::array::from_fn(|k| edges[&key(face, k)]);
        triangle.at_corners = std::array::from_fn(|k| corners[&face[k]]);
    }
    Ok(found)
}
