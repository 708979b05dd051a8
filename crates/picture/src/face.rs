//! The faces of a body that are seen, and how a curved face is cut into nearly flat pieces.

use nastic_mesh::{CellKind, Mesh};

/// A face that is seen: a boundary facet, or a cell of a plane mesh.
#[derive(Clone, Debug)]
pub struct Face {
    /// Its kind: a triangle or a quadrangle of some order.
    pub kind: CellKind,
    /// Its nodes, numbered as in the mesh.
    pub nodes: Vec<u32>,
    /// The cell it belongs to.
    pub cell: usize,
}

impl Face {
    /// All faces of a mesh that are seen.
    pub fn all(mesh: &Mesh) -> Vec<Face> {
        if mesh.dim() == 2 {
            let of = |cell: usize| Face { kind: mesh.cell(cell).kind, nodes: mesh.cell(cell).nodes.to_vec(), cell };
            return (0..mesh.cells()).map(of).collect();
        }
        let of = |facet: &nastic_mesh::Facet| {
            let (kind, nodes) = mesh.facet_nodes(*facet);
            Face { kind, nodes, cell: facet.cell as usize }
        };
        mesh.boundary().iter().map(of).collect()
    }
}

/// How a kind of face is cut: points on the reference face, and flat pieces between them.
#[derive(Clone, Debug)]
pub struct FacePattern {
    /// Reference coordinates.
    pub points: Vec<[f64; 3]>,
    /// Triangles and quadrangles, as indices of points.
    pub pieces: Vec<Vec<usize>>,
    /// Points along each side, from corner to corner.
    pub sides: Vec<Vec<usize>>,
}

impl FacePattern {
    /// Cuts faces of second order `fineness` times along each side, triangles of first order not at all and
    /// quadrangles of first order, which may be warped, twice; a fineness of 1 leaves every face whole.
    pub fn of(kind: CellKind, fineness: usize) -> Self {
        let cuts = if kind.order() > 1 { fineness.max(1) } else { fineness.clamp(1, kind.corners() - 2) };
        if kind.corners() == 3 { Self::triangle(cuts) } else { Self::quadrangle(cuts) }
    }

    fn triangle(n: usize) -> Self {
        let share = |k: usize| k as f64 / n as f64;
        // Row i has n + 1 - i points.
        let at = |i: usize, j: usize| i * (2 * n + 3 - i) / 2 + j;
        let points = (0..=n).flat_map(|i| (0..=n - i).map(move |j| [share(i), share(j), 0.0])).collect();
        let mut pieces = Vec::new();
        for i in 0..n {
            for j in 0..n - i {
                pieces.push(vec![at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 2 <= n {
                    pieces.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
        let along = |point: &dyn Fn(usize) -> usize| (0..=n).map(point).collect();
        let sides = vec![along(&|k| at(k, 0)), along(&|k| at(n - k, k)), along(&|k| at(0, n - k))];
        Self { points, pieces, sides }
    }

    fn quadrangle(n: usize) -> Self {
        let place = |k: usize| 2.0 * (k as f64 / n as f64) - 1.0;
        let at = |i: usize, j: usize| i * (n + 1) + j;
        let points = (0..=n).flat_map(|i| (0..=n).map(move |j| [place(i), place(j), 0.0])).collect();
        let pieces = (0..n * n).map(|k| {
            let (i, j) = (k / n, k % n);
            vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        });
        let along = |point: &dyn Fn(usize) -> usize| (0..=n).map(point).collect();
        let sides =
            vec![along(&|k| at(k, 0)), along(&|k| at(n, k)), along(&|k| at(n - k, n)), along(&|k| at(0, n - k))];
        Self { points, pieces: pieces.collect(), sides }
    }
}
