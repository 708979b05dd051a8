//! [`SurfaceFilter`]: a scalar field on a surface, smoothed over a length.

use super::operator::{Operator, Piece};
use nastic_body::error::FemError;
use nastic_mesh::{CellKind, Facet, Mesh};
use nastic_tensor::Vec3;

/// The Helmholtz filter of a surface, `(M + R^2 S) a = M p`, with the consistent mass and the stiffness `int grad_S N_a . grad_S N_b dA` of its nodes, and a = p = 0 at those that
/// are not free.
#[derive(Debug)]
pub(super) struct SurfaceFilter {
    operator: Operator,
    /// M among the free nodes: places and entry.
    mass: Vec<(u32, u32, f64)>,
}

/// What facets have of a surface: their matrices, and at nodes area and outward normal.
#[derive(Debug, Default)]
pub(super) struct SurfaceMatrices {
    mass: Vec<Piece>,
    stiffness: Vec<Piece>,
}

impl SurfaceMatrices {
    /// Of facets.
    pub fn new(mesh: &Mesh, facets: &[Facet]) -> Self {
        let mut out = SurfaceMatrices::default();
        for &facet in facets {
            let (kind, nodes) = mesh.facet_nodes(facet);
            let (mass, stiffness) = of_facet(kind, &mesh.gather(mesh.points(), &nodes));
            out.mass.push((nodes.clone(), mass));
            out.stiffness.push((nodes, stiffness));
        }
        out
    }

    /// The nodes with the entries `int N_a^2 dA`: positive shares of the area, of nodes of all orders.
    pub fn each_diagonal(&self, mut each: impl FnMut(u32, f64)) {
        for (nodes, mass) in &self.mass {
            nodes.iter().enumerate().for_each(|(a, node)| each(*node, mass[a * nodes.len() + a]));
        }
    }
}

/// `int N_a N_b dA` and `int grad_S N_a . grad_S N_b dA` of a facet.
fn of_facet(kind: CellKind, places: &[[f64; 3]]) -> (Vec<f64>, Vec<f64>) {
    let (n, rule) = (kind.nodes(), kind.rule_of_points(kind.order() + 1));
    let (mut mass, mut stiffness) = (vec![0.0; n * n], vec![0.0; n * n]);
    let (mut shapes, mut gradients) = (vec![0.0; n], vec![[0.0; 3]; n]);
    for (xi, w) in rule.points.iter().zip(&rule.weights) {
        kind.shapes(xi, &mut shapes);
        kind.gradients(xi, &mut gradients);
        let area = w * Vec3::from(kind.area_vector(places, xi)).norm();
        let [first, second, _] = kind.tangents(places, xi).map(Vec3::from);
        // by the inverse of the metric of the tangents
        let metric = [first.dot(&first), first.dot(&second), second.dot(&second)];
        let along = |g: &[f64; 3]| match kind.dim() {
            1 => first * (g[0] / metric[0]),
            _ => {
                let det = metric[0] * metric[2] - metric[1] * metric[1];
                first * ((metric[2] * g[0] - metric[1] * g[1]) / det)
                    + second * ((metric[0] * g[1] - metric[1] * g[0]) / det)
            }
        };
        let on_surface: Vec<Vec3> = gradients.iter().map(along).collect();
        for (a, b) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))) {
            mass[a * n + b] += area * shapes[a] * shapes[b];
            stiffness[a * n + b] += area * on_surface[a].dot(&on_surface[b]);
        }
    }
    (mass, stiffness)
}

impl SurfaceFilter {
    /// With these nodes free.
    ///
    /// # Errors
    /// One that is too large.
    pub fn new(matrices: &SurfaceMatrices, free: Vec<u32>, length: f64, points: &[[f64; 3]]) -> Result<Self, FemError> {
        let sum = |((nodes, mass), (_, stiffness)): (&Piece, &Piece)| {
            let both = mass.iter().zip(stiffness).map(|(m, s)| m + length * length * s);
            (nodes.clone(), both.collect())
        };
        let pieces: Vec<Piece> = matrices.mass.iter().zip(&matrices.stiffness).map(sum).collect();
        let operator = Operator::new("the filter of the skin", free, &pieces, points)?;
        let mut mass = Vec::new();
        for (nodes, local) in &matrices.mass {
            let places: Vec<_> = nodes.iter().map(|node| operator.free.binary_search(node).ok()).collect();
            for (a, b) in (0..nodes.len()).flat_map(|a| (0..nodes.len()).map(move |b| (a, b))) {
                if let (Some(row), Some(column)) = (places[a], places[b]) {
                    mass.push((row as u32, column as u32, local[a * nodes.len() + b]));
                }
            }
        }
        Ok(SurfaceFilter { operator, mass })
    }

    /// The free nodes, ascending.
    pub fn free(&self) -> &[u32] {
        &self.operator.free
    }

    fn times_mass(&self, p: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; p.len()];
        self.mass.iter().for_each(|(row, column, entry)| out[*row as usize] += entry * p[*column as usize]);
        out
    }

    /// `(M + R^2 S)^-1 M p`.
    pub fn values(&self, p: &[f64]) -> Vec<f64> {
        let mut a = self.times_mass(p);
        self.operator.solve(&mut a);
        a
    }

    /// The transpose, `M (M + R^2 S)^-1 g`.
    pub fn vjp(&self, mut g: Vec<f64>) -> Vec<f64> {
        self.operator.solve(&mut g);
        self.times_mass(&g)
    }
}
