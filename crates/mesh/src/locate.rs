//! [`Mesh::locate`]: the cell that holds a point of the reference body.

use crate::spatial::Shape;
use crate::{CellKind, Domain, Mesh, MeshError};
use nalgebra::{Matrix3, Vector3};

/// A point of a mesh: the cell that holds it, and the values of that cell's shape functions there.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// The cell.
    pub cell: usize,
    /// Its nodes, each with the value of its shape function.
    pub weights: Vec<(u32, f64)>,
}

impl Located {
    /// The value there of a nodal field, flat with `components` (at most three) per node; what is missing is zero.
    pub fn interpolate(&self, nodal: &[f64], components: usize) -> [f64; 3] {
        let mut out = [0.0; 3];
        for &(node, weight) in &self.weights {
            let values = nodal.iter().skip(node as usize * components).take(components);
            out.iter_mut().zip(values).for_each(|(out, value)| *out += weight * value);
        }
        out
    }
}

/// Distance up to which a point belongs to a cell, as a share of its size.
const CELL_TOLERANCE: f64 = 1e-9;

impl Mesh {
    /// The first cell that holds the point (to 1e-9 of its size), and its shape functions there; a node of the mesh has
    /// the weight one and is alone. `None` outside the body. Looks at every cell: meant for hundreds of points, not for
    /// millions.
    pub fn locate(&self, point: [f64; 3]) -> Option<Located> {
        (0..self.cells()).find_map(|id| self.locate_in(id, point))
    }

    /// The same of one cell.
    pub fn locate_in(&self, id: usize, point: [f64; 3]) -> Option<Located> {
        let cell = self.cell(id);
        let positions = self.gather(self.points(), cell.nodes);
        if let Some(node) = positions.iter().position(|x| *x == point) {
            return Some(Located { cell: id, weights: vec![(cell.nodes[node], 1.0)] });
        }
        let xi = invert(cell.kind, &positions, point)?;
        let mut shapes = vec![0.0; cell.kind.nodes()];
        cell.kind.shapes(&xi, &mut shapes);
        Some(Located { cell: id, weights: cell.nodes.iter().copied().zip(shapes).collect() })
    }

    /// [`locate`](Self::locate), with what is nearest in the place of nothing.
    ///
    /// # Errors
    /// [`MeshError::OutsideBody`].
    pub fn locate_inside(&self, point: [f64; 3]) -> Result<Located, MeshError> {
        self.locate(point).ok_or_else(|| {
            let (low, high) = self.bounds();
            let nearest = Shape::new(self, self.points(), None).ok().map(|shape| shape.nearest(point));
            MeshError::OutsideBody { point, low, high, nearest }
        })
    }
}

/// The parameters of a point in a cell, by Newton's method; `None` outside.
fn invert(kind: CellKind, positions: &[[f64; 3]], point: [f64; 3]) -> Option<[f64; 3]> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for x in positions {
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(x[k]), high[k].max(x[k]));
        }
    }
    let size = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt();
    // A curved cell bulges beyond its nodes, by less than a quarter of its size.
    if (0..3).any(|k| point[k] < low[k] - 0.25 * size || point[k] > high[k] + 0.25 * size) {
        return None;
    }
    let gap = |xi: &[f64; 3]| Vector3::from(point) - Vector3::from(kind.map(positions, xi));
    let mut xi = kind.centre();
    for _ in 0..50 {
        let tangents = kind.tangents(positions, &xi);
        let mut map = Matrix3::from_fn(|i, k| tangents[k][i]);
        for k in kind.dim()..3 {
            map[(k, k)] = 1.0;
        }
        let step = map.try_inverse()? * gap(&xi);
        (0..kind.dim()).for_each(|k| xi[k] += step[k]);
        if xi.iter().any(|x| !x.is_finite() || x.abs() > 10.0) {
            return None;
        }
        if (0..kind.dim()).all(|k| step[k].abs() <= 1e-14) {
            break;
        }
    }
    (gap(&xi).norm() <= CELL_TOLERANCE * size && in_domain(kind, &xi)).then_some(xi)
}

fn in_domain(kind: CellKind, xi: &[f64; 3]) -> bool {
    let xi = &xi[..kind.dim()];
    match kind.domain() {
        Domain::Box => xi.iter().all(|x| x.abs() <= 1.0 + CELL_TOLERANCE),
        Domain::Simplex => xi.iter().all(|x| *x >= -CELL_TOLERANCE) && xi.iter().sum::<f64>() <= 1.0 + CELL_TOLERANCE,
    }
}
