//! [`Obstacle::drawn`]: an obstacle as a mesh, for pictures.

use super::Obstacle;
use crate::{CellKind, Mesh, box_mesh, rectangle};

/// Cells per direction; odd, so that a layer in the middle can be stretched.
const CELLS_PER_DIRECTION: usize = 11;

/// Thickness of the plate that represents a half-space, as a share of the body's diagonal.
const PLATE_THICKNESS: f64 = 0.02;
/// Half of the width of this plate, likewise.
const PLATE_HALF_WIDTH: f64 = 0.75;

impl Obstacle {
    /// A mesh of it beside a body, in its plane or in space: a ball or a capsule of bricks, a box; of a half-space, which has no end, a plate in
    /// front of the body. `None` of a solid, which is a mesh, and of what has no size.
    #[must_use]
    pub fn drawn(&self, body: &Mesh) -> Option<Mesh> {
        let dim = body.dim();
        match self {
            Obstacle::Sphere { center, radius } => round([*center; 2], *radius, dim),
            Obstacle::Capsule { ends, radius } => round(*ends, *radius, dim),
            Obstacle::Box { low, high, .. } => {
                let size = std::array::from_fn(|i| high[i] - low[i]);
                let at = |x: [f64; 3]| std::array::from_fn(|i| if i < dim { low[i] + x[i] } else { 0.0 });
                block(size, [CELLS_PER_DIRECTION; 3], dim)?.mapped(at).ok()
            }
            Obstacle::HalfSpace { point, normal } => plate(*point, *normal, body),
            Obstacle::Solid { .. } | Obstacle::Grid(_) => None,
        }
    }
}

/// A block of cells along the axes of a plane or of space, one corner at the origin.
fn block(size: [f64; 3], cells: [usize; 3], dim: usize) -> Option<Mesh> {
    match dim {
        2 => rectangle([size[0], size[1]], [cells[0], cells[1]], CellKind::Quad4).ok(),
        _ => box_mesh(size, cells, CellKind::Hex8).ok(),
    }
}

/// A ball, or a capsule between two points.
fn round([from, to]: [[f64; 3]; 2], radius: f64, dim: usize) -> Option<Mesh> {
    let along: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let length = norm(&along);
    let last = dim - 1;
    let axis = if length > 0.0 { along.map(|a| a / length) } else { std::array::from_fn(|i| f64::from(i == last)) };
    let frame = frame(axis, dim);
    let cube = block([2.0; 3], [CELLS_PER_DIRECTION; 3], dim)?;
    let place = |x: [f64; 3]| {
        // The cube to the unit ball: the same direction, the largest coordinate for a length.
        let p: [f64; 3] = std::array::from_fn(|i| if i < dim { x[i] - 1.0 } else { 0.0 });
        let (size, largest) = (norm(&p), p.iter().fold(0.0, |most: f64, p| most.max(p.abs())));
        let q = p.map(|p| if size > 0.0 { radius * p * largest / size } else { 0.0 });
        let end = if p[last] > 0.0 { to } else { from };
        std::array::from_fn(|i| end[i] + (0..3).map(|k| q[k] * frame[k][i]).sum::<f64>())
    };
    cube.mapped(place).ok()
}

/// Of the half-space behind a plane the part next to the body.
fn plate(point: [f64; 3], normal: [f64; 3], body: &Mesh) -> Option<Mesh> {
    let (dim, normal) = (body.dim(), normal.map(|n| n / norm(&normal)));
    let count = body.points().len() as f64;
    let center: [f64; 3] = std::array::from_fn(|i| body.points().iter().map(|x| x[i]).sum::<f64>() / count);
    let away: f64 = (0..3).map(|i| normal[i] * (center[i] - point[i])).sum();
    let [thickness, reach] = [PLATE_THICKNESS, PLATE_HALF_WIDTH].map(|share| share * body.diagonal());
    let frame = frame(normal, dim);
    let (mut size, mut cells) = ([2.0 * reach; 3], [CELLS_PER_DIRECTION; 3]);
    (size[dim - 1], cells[dim - 1]) = (thickness, 1);
    let slab = block(size, cells, dim)?;
    let place = |x: [f64; 3]| {
        let local: [f64; 3] = std::array::from_fn(|k| match k + 1 {
            k if k < dim => x[k - 1] - reach,
            k if k == dim => x[k - 1] - thickness - away,
            _ => 0.0,
        });
        std::array::from_fn(|i| center[i] + (0..3).map(|k| local[k] * frame[k][i]).sum::<f64>())
    };
    slab.mapped(place).ok()
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// An orthonormal, right-handed frame with this vector as the third, in a plane as the second.
fn frame(c: [f64; 3], dim: usize) -> [[f64; 3]; 3] {
    if dim == 2 {
        return [[c[1], -c[0], 0.0], c, [0.0, 0.0, 1.0]];
    }
    let helper = if c[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let b = cross(c, helper);
    let size = norm(&b);
    let b = b.map(|b| b / size);
    [cross(b, c), b, c]
}
