//! [`FacetTangents`]: quadrature points of a surface with its tangent vectors, for costs of its deformed normal.

use nastic_fem::Solid;
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;
use nastic_tensor::Vec3;

/// Quadrature points of a named surface (in plane strain a line) with the gradients of the shape functions along it.
#[derive(Debug)]
pub(crate) struct FacetTangents {
    dim: usize,
    facets: Vec<Facet>,
    points: Vec<FacetPoint>,
}

#[derive(Debug)]
struct Facet {
    nodes: Vec<u32>,
    /// 1 where the normal of the tangents points out of the body, else -1.
    sense: f64,
}

#[derive(Debug)]
struct FacetPoint {
    facet: usize,
    /// Reference area.
    weight: f64,
    /// `dN_a/dxi_K` of its nodes.
    gradients: Vec<[f64; 3]>,
}

impl FacetTangents {
    /// Of a named surface or the union of several.
    pub fn new(solid: &Solid, names: &GroupNames) -> Result<Self, ControlError> {
        let (mesh, dim) = (solid.mesh(), solid.discretization().dim());
        let (mut facets, mut points) = (Vec::new(), Vec::new());
        for facet in mesh.facets_of(names)? {
            let (kind, nodes) = mesh.facet_nodes(facet);
            let inside = Vec3::from(mesh.cell_centre(facet.cell as usize));
            let (index, rule) = (facets.len(), kind.rule_of_points(kind.order() + 2));
            let mut outward = 0.0;
            let mut gradients = vec![[0.0; 3]; nodes.len()];
            for (xi, weight) in rule.points.iter().zip(&rule.weights) {
                kind.gradients(xi, &mut gradients);
                let tangents = tangents(&nodes, &gradients, dim, |node, i| mesh.points()[node][i]);
                let area = area_vector(tangents);
                outward += area.dot(&(Vec3::from(mesh.points()[nodes[0] as usize]) - inside));
                points.push(FacetPoint { facet: index, weight: weight * area.norm(), gradients: gradients.clone() });
            }
            facets.push(Facet { nodes, sense: outward.signum() });
        }
        Ok(FacetTangents { dim, facets, points })
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Reference area of the q-th point.
    pub fn weight(&self, q: usize) -> f64 {
        self.points[q].weight
    }

    /// The tangents of a nodal vector field at the q-th point, such that their cross product points out of the body when the field is
    /// that of positions. In plane strain the second one is that of the axis z, and zero of a change.
    pub fn tangents(&self, q: usize, field: impl Fn(usize, usize) -> f64, change: bool) -> [Vec3; 2] {
        let point = &self.points[q];
        let facet = &self.facets[point.facet];
        let [first, second] = tangents(&facet.nodes, &point.gradients, self.dim, field);
        let second = if change && self.dim == 2 { Vec3::zeros() } else { second };
        [first * facet.sense, second]
    }

    /// Adds the nodal forces of `g1 . dt1 + g2 . dt2` at the q-th point.
    pub fn spread(&self, q: usize, [g1, g2]: [&Vec3; 2], out: &mut [f64]) {
        let point = &self.points[q];
        let facet = &self.facets[point.facet];
        for (&node, gradient) in facet.nodes.iter().zip(&point.gradients) {
            for i in 0..self.dim {
                let second = if self.dim == 3 { gradient[1] * g2[i] } else { 0.0 };
                out[node as usize * self.dim + i] += facet.sense * gradient[0] * g1[i] + second;
            }
        }
    }
}

/// `sum_a v_a dN_a/dxi_K` for both K; in plane strain the second is the axis z.
fn tangents(nodes: &[u32], gradients: &[[f64; 3]], dim: usize, field: impl Fn(usize, usize) -> f64) -> [Vec3; 2] {
    let mut out = [Vec3::zeros(), Vec3::zeros()];
    for (&node, gradient) in nodes.iter().zip(gradients) {
        for i in 0..dim {
            let value = field(node as usize, i);
            out[0][i] += gradient[0] * value;
            out[1][i] += gradient[1] * value;
        }
    }
    if dim == 2 { [out[0], Vec3::z()] } else { out }
}

/// `t1 x t2`, normal to the surface, of the size of its area element.
pub(crate) fn area_vector([first, second]: [Vec3; 2]) -> Vec3 {
    first.cross(&second)
}
