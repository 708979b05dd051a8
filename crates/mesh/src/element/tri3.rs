//! Linear triangle.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::simplex;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "tri3",
    about: "Triangle in plane strain, linear.",
    dim: 2,
    order: 1,
    vtk: 5,
    gmsh: (2, &[]),
    domain: Domain::Simplex,
    corner_kind: CellKind::Tri3,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[0, 2, 1],
    shapes: |xi, out| simplex::linear_shapes(2, xi, out),
    gradients: |_, out| simplex::linear_gradients(2, out),
    default_rule: || Rule::triangle(1),
};

const NODES: &[[f64; 3]] = &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

pub(super) const EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0]];

const FACES: &[Face] = &[(CellKind::Line2, &[0, 1]), (CellKind::Line2, &[1, 2]), (CellKind::Line2, &[2, 0])];
