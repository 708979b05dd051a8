//! [`BodyPoints`]: the points of a surface, region or node set of a cost.

use nastic_fem::{QuadraturePoints, Solid};
use nastic_fields::ControlError;
use nastic_mesh::GroupNames;

/// Which part of a body.
#[derive(Clone, Debug)]
pub(crate) enum BodyPart {
    Surface(GroupNames),
    Region(GroupNames),
    Nodes(GroupNames),
}

impl BodyPart {
    /// Its quadrature points (or its nodes), and its nodes.
    pub fn points(&self, solid: &Solid) -> Result<(BodyPoints, Vec<u32>), ControlError> {
        let mesh = solid.mesh();
        // Two points more than the shape functions need: targets are curved.
        Ok(match self {
            BodyPart::Surface(names) => {
                let facets = mesh.facets_of(names)?;
                let points = QuadraturePoints::of_facets(mesh, &facets, |k| k.rule_of_points(k.order() + 2));
                (BodyPoints::Points(points), mesh.nodes_of_facets(&facets))
            }
            BodyPart::Region(names) => {
                let cells = mesh.cells_of(names)?;
                let nodes = mesh.nodes_of_cells(&cells);
                let points = QuadraturePoints::of_cells(mesh, cells, |k| k.rule_of_points(k.order() + 2))?;
                (BodyPoints::Points(points), nodes)
            }
            BodyPart::Nodes(names) => {
                let nodes = solid.nodes_of(names)?;
                // nodes between ranks count where they belong
                let owned = solid.discretization().over_ranks().map_or(usize::MAX, |(part, _)| part.owned());
                let counted = nodes.iter().copied().filter(|node| (*node as usize) < owned).collect();
                (BodyPoints::Nodes(counted), nodes)
            }
        })
    }
}

/// Points of a body and their weights: quadrature points, or nodes of weight one each.
#[derive(Debug)]
pub(crate) enum BodyPoints {
    Points(QuadraturePoints),
    Nodes(Vec<u32>),
}

impl BodyPoints {
    /// Reference positions, or displaced ones.
    pub fn positions(&self, solid: &Solid, u: Option<&[f64]>) -> Vec<[f64; 3]> {
        let (mesh, dim) = (solid.mesh(), solid.discretization().dim());
        match self {
            BodyPoints::Points(points) => points.positions(mesh, u),
            BodyPoints::Nodes(nodes) => {
                let position = |&node: &u32| {
                    let mut x = mesh.points()[node as usize];
                    if let Some(u) = u {
                        (0..dim).for_each(|i| x[i] += u[node as usize * dim + i]);
                    }
                    x
                };
                nodes.iter().map(position).collect()
            }
        }
    }

    /// `w_q`.
    pub fn weight(&self, q: usize) -> f64 {
        match self {
            BodyPoints::Points(points) => points.weights()[q],
            BodyPoints::Nodes(_) => 1.0,
        }
    }

    /// `weight w_q v(q)` of a nodal vector at every point, `dim` numbers each.
    pub fn weighted(&self, nodal: &[f64], dim: usize, weight: f64) -> Vec<f64> {
        let mut values = match self {
            BodyPoints::Points(points) => points.interpolate(nodal, dim),
            BodyPoints::Nodes(nodes) => {
                nodes.iter().flat_map(|&node| &nodal[node as usize * dim..][..dim]).copied().collect()
            }
        };
        for (q, value) in values.chunks_exact_mut(dim).enumerate() {
            value.iter_mut().for_each(|v| *v *= weight * self.weight(q));
        }
        values
    }

    /// Adds the nodal image of vectors at the points.
    pub fn spread(&self, values: &[f64], dim: usize, out: &mut [f64]) {
        match self {
            BodyPoints::Points(points) => points.spread(values, dim, out),
            BodyPoints::Nodes(nodes) => {
                for (&node, value) in nodes.iter().zip(values.chunks_exact(dim)) {
                    for (i, v) in value.iter().enumerate() {
                        out[node as usize * dim + i] += v;
                    }
                }
            }
        }
    }
}
