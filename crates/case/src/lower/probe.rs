//! Probes: points of the body, found in its cells.

use super::context::Context;
use crate::schema::Case;
use nastic_mesh::spatial::Shape;
use nastic_mesh::{CellKind, Mesh};
use nastic_tensor::{Mat3, Vec3};

/// A probe and the nodes whose displacements make up its own.
#[derive(Clone, PartialEq, Debug)]
pub struct LocatedProbe {
    /// Its name.
    pub name: String,
    /// Its reference position.
    pub point: [f64; 3],
    /// The cell it lies in.
    pub cell: usize,
    /// Nodes and the values of their shape functions at the point.
    pub weights: Vec<(u32, f64)>,
}

impl LocatedProbe {
    /// The displacement there; `u` is flat, `dim` per node.
    #[must_use]
    pub fn displacement(&self, u: &[f64], dim: usize) -> [f64; 3] {
        let mut out = [0.0; 3];
        for &(node, weight) in &self.weights {
            for (i, out) in out.iter_mut().enumerate().take(dim) {
                *out += weight * u[node as usize * dim + i];
            }
        }
        out
    }
}

pub(super) fn locate(case: &Case, mesh: &Mesh, context: &mut Context<'_>) -> Vec<LocatedProbe> {
    let mut out = Vec::new();
    for probe in &case.probes {
        let point = probe.point.xyz();
        match find(mesh, point) {
            Some((cell, weights)) => out.push(LocatedProbe { name: probe.name.clone(), point, cell, weights }),
            None => context.complain(&probe.at.key("point"), outside(mesh, point)),
        }
    }
    out
}

fn outside(mesh: &Mesh, point: [f64; 3]) -> String {
    let show = |p: [f64; 3]| format!("({}, {}, {})", p[0], p[1], p[2]);
    let (low, high) = mesh.bounds();
    let near = match Shape::new(mesh, mesh.points(), None) {
        Ok(shape) => {
            let (nearest, distance) = shape.nearest(point);
            format!("the nearest point of it is {}, {distance:.3e} away", show(nearest))
        }
        Err(error) => error.to_string(),
    };
    format!("{} is outside the body, which spans {} to {}; {near}", show(point), show(low), show(high))
}

/// Points this near to a cell's parameter domain belong to it.
const EDGE: f64 = 1e-9;

/// The first cell that holds the point, and the shape functions there.
fn find(mesh: &Mesh, point: [f64; 3]) -> Option<(usize, Vec<(u32, f64)>)> {
    (0..mesh.cells()).find_map(|id| {
        let cell = mesh.cell(id);
        let positions = mesh.gather(mesh.points(), cell.nodes);
        if let Some(node) = positions.iter().position(|x| *x == point) {
            return Some((id, vec![(cell.nodes[node], 1.0)]));
        }
        let xi = invert(cell.kind, &positions, point)?;
        let mut shapes = vec![0.0; cell.kind.nodes()];
        cell.kind.shapes(&xi, &mut shapes);
        Some((id, cell.nodes.iter().copied().zip(shapes).collect()))
    })
}

/// The parameters of a point in a cell, by Newton's method; `None` outside.
fn invert(kind: CellKind, positions: &[[f64; 3]], point: [f64; 3]) -> Option<[f64; 3]> {
    let size = extent(positions);
    // Curved cells bulge beyond their nodes, by less than their size.
    if (0..3).any(|k| point[k] < size.low[k] - size.diagonal || point[k] > size.high[k] + size.diagonal) {
        return None;
    }
    let mut xi = kind.centre();
    for _ in 0..50 {
        let x = kind.map(positions, &xi);
        let gap = Vec3::from(std::array::from_fn::<f64, 3, _>(|k| point[k] - x[k]));
        let tangents = kind.tangents(positions, &xi);
        let mut map = Mat3::from_fn(|i, k| tangents[k][i]);
        for k in kind.dim()..3 {
            map[(k, k)] = 1.0;
        }
        let step = map.try_inverse()? * gap;
        (0..kind.dim()).for_each(|k| xi[k] += step[k]);
        if xi.iter().any(|x| !x.is_finite() || x.abs() > 10.0) {
            return None;
        }
        if (0..kind.dim()).all(|k| step[k].abs() <= 1e-14) || gap.norm() <= 1e-15 * size.diagonal {
            break;
        }
    }
    let x = kind.map(positions, &xi);
    let gap = (0..3).map(|k| (point[k] - x[k]).powi(2)).sum::<f64>().sqrt();
    (gap <= EDGE * size.diagonal && in_domain(kind, &xi)).then_some(xi)
}

fn in_domain(kind: CellKind, xi: &[f64; 3]) -> bool {
    let xi = &xi[..kind.dim()];
    if kind.is_simplex() {
        xi.iter().all(|x| *x >= -EDGE) && xi.iter().sum::<f64>() <= 1.0 + EDGE
    } else {
        xi.iter().all(|x| x.abs() <= 1.0 + EDGE)
    }
}

struct Extent {
    low: [f64; 3],
    high: [f64; 3],
    diagonal: f64,
}

fn extent(positions: &[[f64; 3]]) -> Extent {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for x in positions {
        for k in 0..3 {
            low[k] = low[k].min(x[k]);
            high[k] = high[k].max(x[k]);
        }
    }
    let diagonal = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
    Extent { low, high, diagonal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nastic_mesh::{box_mesh, rectangle};

    #[test]
    fn every_point_of_a_box_is_found_and_no_other() {
        for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27, CellKind::Tet4, CellKind::Tet10] {
            let mesh = box_mesh([1.0, 0.2, 0.3], [3, 2, 1], kind).unwrap();
            for point in [[0.0, 0.0, 0.0], [1.0, 0.2, 0.3], [0.31, 0.07, 0.22], [1.0 / 3.0, 0.1, 0.3]] {
                let (_, weights) = find(&mesh, point).unwrap();
                for k in 0..3 {
                    let x: f64 = weights.iter().map(|(node, w)| w * mesh.points()[*node as usize][k]).sum();
                    assert!((x - point[k]).abs() < 1e-12, "{kind}: {point:?}");
                }
            }
            assert!(find(&mesh, [1.001, 0.1, 0.1]).is_none(), "{kind}");
        }
    }

    #[test]
    fn plane_bodies_have_probes_too() {
        let mesh = rectangle([1.0, 0.2], [4, 2], CellKind::Tri6).unwrap();
        assert!(find(&mesh, [0.7, 0.11, 0.0]).is_some());
        assert!(find(&mesh, [0.7, 0.11, 0.1]).is_none());
    }
}
