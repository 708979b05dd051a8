//! The isoparametric map x(xi) = sum_a N_a(xi) x_a of one cell whose node positions have been gathered.

use crate::CellKind;

/// The largest number of nodes any kind has.
pub(crate) const MAX_NODES: usize = 27;

impl CellKind {
    /// The point x(xi). `positions`: one per node, reference or deformed.
    pub fn map(self, positions: &[[f64; 3]], xi: &[f64; 3]) -> [f64; 3] {
        let mut shapes = [0.0; MAX_NODES];
        let shapes = &mut shapes[..self.nodes()];
        self.shapes(xi, shapes);
        let mut x = [0.0; 3];
        for (n, p) in shapes.iter().zip(positions) {
            for i in 0..3 {
                x[i] += n * p[i];
            }
        }
        x
    }

    /// The tangents dx/dxi_k as `[k][i]`; zero for k >= `dim()`.
    pub fn tangents(self, positions: &[[f64; 3]], xi: &[f64; 3]) -> [[f64; 3]; 3] {
        let mut gradients = [[0.0; 3]; MAX_NODES];
        let gradients = &mut gradients[..self.nodes()];
        self.gradients(xi, gradients);
        tangents(gradients, positions)
    }

    /// det dx/dxi of a cell of full dimension: its 2x2 (plane, in x and y) or 3x3 determinant, signed.
    pub fn jacobian(self, positions: &[[f64; 3]], xi: &[f64; 3]) -> f64 {
        determinant(self.dim(), &self.tangents(positions, xi))
    }

    /// The outward area vector of a facet: its length is dA/dxi (dL/dxi for a line), its direction the outward normal
    /// if the nodes stand as [`CellKind::faces`] has them. Lines are taken to bound a plane cell in x and y.
    pub fn area_vector(self, positions: &[[f64; 3]], xi: &[f64; 3]) -> [f64; 3] {
        let t = self.tangents(positions, xi);
        if self.dim() == 1 { [t[0][1], -t[0][0], 0.0] } else { cross(&t[0], &t[1]) }
    }

    /// Length, area or volume by the default rule: positive whatever the winding for lines and
    /// surface elements, signed for hexahedra and tetrahedra.
    pub fn measure(self, positions: &[[f64; 3]]) -> f64 {
        self.rule().iter().map(|(xi, w)| w * density(self.dim(), &self.tangents(positions, xi))).sum()
    }
}

/// dx/dxi_k as `[k][i]` from shape gradients.
pub(crate) fn tangents(gradients: &[[f64; 3]], positions: &[[f64; 3]]) -> [[f64; 3]; 3] {
    let mut t = [[0.0; 3]; 3];
    for (g, p) in gradients.iter().zip(positions) {
        for k in 0..3 {
            for i in 0..3 {
                t[k][i] += g[k] * p[i];
            }
        }
    }
    t
}

pub(crate) fn determinant(dim: usize, t: &[[f64; 3]; 3]) -> f64 {
    match dim {
        1 => t[0][0],
        2 => t[0][0] * t[1][1] - t[0][1] * t[1][0],
        _ => dot(&cross(&t[0], &t[1]), &t[2]),
    }
}

fn density(dim: usize, t: &[[f64; 3]; 3]) -> f64 {
    match dim {
        1 => norm(&t[0]),
        2 => norm(&cross(&t[0], &t[1])),
        _ => determinant(3, t),
    }
}

pub(crate) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm(a: &[f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn minus(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Lowest and highest corner of a set of points; zeros if there are none.
pub(crate) fn bounds<'a>(points: impl IntoIterator<Item = &'a [f64; 3]>) -> ([f64; 3], [f64; 3]) {
    let mut points = points.into_iter();
    let first = points.next().copied().unwrap_or([0.0; 3]);
    points.fold((first, first), |(lo, hi), p| {
        (std::array::from_fn(|i| lo[i].min(p[i])), std::array::from_fn(|i| hi[i].max(p[i])))
    })
}
