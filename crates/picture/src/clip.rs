//! Bodies cut by a plane: the kept part of their surface, and the section through their cells.

use super::body::{Appearance, Body, FieldValues};
use super::tessellation::{Surface, SurfaceEdge, SurfacePoint};
use super::vector::{V3, add, cross, dot, scale, sub};
use nastic_mesh::CellKind;

/// A plane `x . normal = offset`; what lies beyond it, at larger values, is cut away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// A unit vector.
    pub normal: V3,
    pub offset: f64,
}

impl Plane {
    /// Height above the plane: positive where the body is cut away.
    pub fn height(&self, p: V3) -> f64 {
        dot(p, self.normal) - self.offset
    }

    /// The point itself, or the nearest of the plane to one that is cut away.
    pub fn kept(&self, p: V3) -> V3 {
        add(p, scale(self.normal, -self.height(p).max(0.0)))
    }
}

/// The kept part of a surface, with the section that closes it; cells are cut up `fineness` times along each side if they are of second order.
pub(super) fn clipped(surface: &Surface, body: &Body, plane: &Plane, fineness: usize) -> Surface {
    let mut out = Surface::default();
    for piece in &surface.pieces {
        let (kept, cut) = cut_polygon(piece, plane);
        if kept.len() > 2 {
            out.pieces.push(kept);
        }
        if let [from, to] = cut[..] {
            out.edges.push(SurfaceEdge { points: vec![from.at, to.at], normals: vec![plane.normal] });
        }
    }
    for edge in &surface.edges {
        out.edges.extend(cut_edge(edge, plane));
    }
    out.pieces.extend(section(body, plane, fineness));
    out
}

/// The kept part of a convex polygon, and the two points in which its outline crosses the plane, if it does.
fn cut_polygon(piece: &[SurfacePoint], plane: &Plane) -> (Vec<SurfacePoint>, Vec<SurfacePoint>) {
    let (mut kept, mut cut) = (Vec::new(), Vec::new());
    for (k, from) in piece.iter().enumerate() {
        let to = &piece[(k + 1) % piece.len()];
        let (a, b) = (plane.height(from.at), plane.height(to.at));
        if a <= 0.0 {
            kept.push(*from);
        }
        if (a <= 0.0) != (b <= 0.0) {
            let crossing = between(from, to, a / (a - b));
            kept.push(crossing);
            cut.push(crossing);
        }
    }
    (kept, cut)
}

fn cut_edge(edge: &SurfaceEdge, plane: &Plane) -> Vec<SurfaceEdge> {
    let mut parts: Vec<Vec<V3>> = Vec::new();
    let mut part: Vec<V3> = Vec::new();
    for (k, at) in edge.points.iter().enumerate() {
        let height = plane.height(*at);
        if k > 0 {
            let before = edge.points[k - 1];
            let last = plane.height(before);
            if (last <= 0.0) != (height <= 0.0) {
                part.push(add(before, scale(sub(*at, before), last / (last - height))));
                if height > 0.0 {
                    parts.push(std::mem::take(&mut part));
                }
            }
        }
        if height <= 0.0 {
            part.push(*at);
        }
    }
    parts.push(part);
    parts.retain(|points| points.len() > 1);
    parts.into_iter().map(|points| SurfaceEdge { points, normals: edge.normals.clone() }).collect()
}

/// The section of the cells by the plane, as flat pieces that face what is cut away.
fn section(body: &Body, plane: &Plane, fineness: usize) -> Vec<Vec<SurfacePoint>> {
    let mut pieces = Vec::new();
    for index in 0..body.mesh.cells() {
        let cell = body.mesh.cell(index);
        let heights = cell.nodes.iter().map(|node| plane.height(body.positions[*node as usize]));
        let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), h| (low.min(h), high.max(h)));
        if low > 0.0 || high <= 0.0 {
            continue;
        }
        let positions = body.mesh.gather(&body.positions, cell.nodes);
        let values: Vec<f64> = match &body.appearance {
            Appearance::Field(field) => match &field.values {
                FieldValues::Nodes(values) => cell.nodes.iter().map(|node| values[*node as usize]).collect(),
                FieldValues::Cells(values) => vec![values[index]; cell.nodes.len()],
            },
            _ => vec![0.0; cell.nodes.len()],
        };
        let cuts = if cell.kind.order() > 1 { fineness.max(1) } else { 1 };
        for corners in tetrahedra(cell.kind, cuts) {
            let points = corners.map(|xi| point(cell.kind, &positions, &values, &xi, plane.normal));
            pieces.extend(cut_tetrahedron(&points, plane));
        }
    }
    pieces
}

/// The point of a cell at reference coordinates.
fn point(kind: CellKind, positions: &[V3], values: &[f64], xi: &V3, normal: V3) -> SurfacePoint {
    let mut shapes = [0.0; 27];
    let shapes = &mut shapes[..kind.nodes()];
    kind.shapes(xi, shapes);
    let value = shapes.iter().zip(values).map(|(n, value)| n * value).sum();
    SurfacePoint { at: kind.map(positions, xi), normal, value }
}

/// Reference coordinates of the tetrahedra that a cell is cut into.
fn tetrahedra(kind: CellKind, cuts: usize) -> Vec<[V3; 4]> {
    let corners = &kind.reference_nodes()[..kind.corners()];
    if let [a, b, c, d] = *corners {
        let whole = vec![[a, b, c, d]];
        return if cuts > 1 { whole.iter().flat_map(eighths).collect() } else { whole };
    }
    // The six tetrahedra around the diagonal from corner 0 to corner 6.
    const AROUND: [[usize; 2]; 6] = [[1, 2], [2, 3], [3, 7], [7, 4], [4, 5], [5, 1]];
    let side = 1.0 / cuts as f64;
    let mut out = Vec::with_capacity(6 * cuts.pow(3));
    for k in 0..cuts.pow(3) {
        let block = [k % cuts, k / cuts % cuts, k / cuts / cuts];
        let corner =
            |c: usize| -> V3 { std::array::from_fn(|i| side * (2.0 * block[i] as f64 + corners[c][i] + 1.0) - 1.0) };
        out.extend(AROUND.map(|[a, b]| [corner(0), corner(a), corner(b), corner(6)]));
    }
    out
}

/// A tetrahedron cut at the middles of its edges.
fn eighths([a, b, c, d]: &[V3; 4]) -> [[V3; 4]; 8] {
    let middle = |p: &V3, q: &V3| scale(add(*p, *q), 0.5);
    let [ab, ac, ad, bc, bd, cd] = [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)].map(|(p, q)| middle(p, q));
    [
        [*a, ab, ac, ad],
        [ab, *b, bc, bd],
        [ac, bc, *c, cd],
        [ad, bd, cd, *d],
        [ab, ac, ad, bd],
        [ab, ac, bc, bd],
        [ac, ad, bd, cd],
        [ac, bc, bd, cd],
    ]
}

fn cut_tetrahedron(points: &[SurfacePoint; 4], plane: &Plane) -> Option<Vec<SurfacePoint>> {
    let heights = points.map(|point| plane.height(point.at));
    let (inside, outside): (Vec<usize>, Vec<usize>) = (0..4).partition(|k| heights[*k] <= 0.0);
    let crossing = |i: usize, j: usize| between(&points[i], &points[j], heights[i] / (heights[i] - heights[j]));
    let mut piece = match (&inside[..], &outside[..]) {
        ([a], [b, c, d]) | ([b, c, d], [a]) => vec![crossing(*a, *b), crossing(*a, *c), crossing(*a, *d)],
        ([a, b], [c, d]) => vec![crossing(*a, *c), crossing(*a, *d), crossing(*b, *d), crossing(*b, *c)],
        _ => return None,
    };
    let [p, q, r] = [0, 1, 2].map(|k| piece[k].at);
    if dot(cross(sub(q, p), sub(r, p)), plane.normal) < 0.0 {
        piece.reverse();
    }
    Some(piece)
}

/// The point at a share of the way.
fn between(from: &SurfacePoint, to: &SurfacePoint, share: f64) -> SurfacePoint {
    let mixed = |a: V3, b: V3| add(a, scale(sub(b, a), share));
    SurfacePoint {
        at: mixed(from.at, to.at),
        normal: mixed(from.normal, to.normal),
        value: from.value + (to.value - from.value) * share,
    }
}
