//! The polynomial space of a Bézier patch, and the control points of a cell in it.

use crate::{CellKind, Domain};

/// Polynomial space of a patch: degree 1 or 2, over the unit box (tensor product) or the unit simplex of 1 to 3
/// dimensions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct PatchSpace {
    pub simplex: bool,
    pub dim: usize,
    pub degree: usize,
}

impl PatchSpace {
    /// The smallest space that holds the kind's shape functions (serendipity kinds sit inside the full tensor product).
    pub fn of(kind: CellKind) -> Self {
        let simplex = match kind.domain() {
            Domain::Box => false,
            Domain::Simplex => true,
        };
        Self { simplex, dim: kind.dim(), degree: kind.order() }
    }

    pub fn controls(self) -> usize {
        match (self.simplex, self.degree) {
            (true, 1) => self.dim + 1,
            (true, _) => (self.dim + 1) * (self.dim + 2) / 2,
            (false, p) => (p + 1).pow(self.dim as u32),
        }
    }

    /// Corners of the parameter domain: d + 1 of a simplex (origin first), 2^d of a box (bit a of the index: coordinate
    /// a).
    pub fn corners(self) -> usize {
        if self.simplex { self.dim + 1 } else { 1 << self.dim }
    }

    /// Parameters of corner `i`.
    pub fn corner(self, i: usize) -> [f64; 3] {
        let mut u = [0.0; 3];
        for (a, value) in u.iter_mut().enumerate().take(self.dim) {
            let set = if self.simplex { i == a + 1 } else { i >> a & 1 == 1 };
            *value = f64::from(u8::from(set));
        }
        u
    }

    /// Index of the control point of the pair (a, b) of barycentric directions of a quadratic simplex: corners first,
    /// then edges.
    pub fn pair(self, a: usize, b: usize) -> usize {
        let (a, b) = (a.min(b), a.max(b));
        if a == b { a } else { self.dim + 1 + a * (2 * self.dim + 1 - a) / 2 + (b - a - 1) }
    }

    /// Parameters at which the patch is sampled to find its control points: the lattice of the same numbering.
    fn lattice(self) -> Vec<[f64; 3]> {
        let mut points = vec![[0.0; 3]; self.controls()];
        if self.simplex {
            for a in 0..=self.dim {
                for b in a..=self.dim {
                    if a != b && self.degree == 1 {
                        continue;
                    }
                    let (p, q) = (self.corner(a), self.corner(b));
                    points[self.pair(a, b)] = [0, 1, 2].map(|i| 0.5 * (p[i] + q[i]));
                }
            }
        } else {
            for (index, point) in points.iter_mut().enumerate() {
                let mut rest = index;
                for value in point.iter_mut().take(self.dim) {
                    *value = (rest % (self.degree + 1)) as f64 / self.degree as f64;
                    rest /= self.degree + 1;
                }
            }
        }
        points
    }

    /// Turns samples on the lattice into Bernstein coefficients, in place.
    fn interpolate(self, values: &mut [f64]) {
        if self.degree == 1 {
            return;
        }
        if self.simplex {
            for a in 0..=self.dim {
                for b in a + 1..=self.dim {
                    values[self.pair(a, b)] = 2.0 * values[self.pair(a, b)] - 0.5 * (values[a] + values[b]);
                }
            }
            return;
        }
        for axis in 0..self.dim {
            let stride = 3usize.pow(axis as u32);
            for i in (0..values.len()).filter(|i| i / stride % 3 == 1) {
                values[i] = 2.0 * values[i] - 0.5 * (values[i - stride] + values[i + stride]);
            }
        }
    }
}

/// The linear map from a kind's nodes to the control points of its patch.
#[derive(Clone, Debug)]
pub(super) struct Conversion {
    pub space: PatchSpace,
    /// Node of the cell at each corner of the parameter domain.
    pub corners: Vec<usize>,
    nodes: usize,
    /// Row major, controls x nodes.
    weights: Vec<f64>,
}

impl Conversion {
    pub fn of(kind: CellKind) -> Self {
        let space = PatchSpace::of(kind);
        let nodes = kind.nodes();
        let reference = |u: [f64; 3]| match kind.domain() {
            Domain::Box => std::array::from_fn(|a| if a < space.dim { 2.0 * u[a] - 1.0 } else { 0.0 }),
            Domain::Simplex => u,
        };
        let mut weights = vec![0.0; space.controls() * nodes];
        for (u, row) in space.lattice().into_iter().zip(weights.chunks_exact_mut(nodes)) {
            kind.shapes(&reference(u), row);
        }
        for node in 0..nodes {
            let mut column: Vec<f64> = (0..space.controls()).map(|i| weights[i * nodes + node]).collect();
            space.interpolate(&mut column);
            for (i, value) in column.into_iter().enumerate() {
                weights[i * nodes + node] = value;
            }
        }
        // The node at a corner is the one whose shape function is 1 there.
        let mut shapes = vec![0.0; nodes];
        let corners = (0..space.corners())
            .map(|i| {
                kind.shapes(&reference(space.corner(i)), &mut shapes);
                (0..nodes).max_by(|&m, &n| shapes[m].total_cmp(&shapes[n])).unwrap_or(0)
            })
            .collect();
        Self { space, corners, nodes, weights }
    }

    /// Appends the control points of a cell with these node positions.
    pub fn append(&self, nodes: &[super::V], out: &mut Vec<super::V>) {
        out.extend(self.weights.chunks_exact(self.nodes).map(|row| {
            row.iter().zip(nodes).filter(|(w, _)| **w != 0.0).fold(super::V::zeros(), |sum, (w, x)| sum + x * *w)
        }));
    }
}
