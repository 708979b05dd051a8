//! Linear tetrahedron.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::simplex;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "tet4",
    about: "Tetrahedron, linear.",
    dim: 3,
    order: 1,
    vtk: 10,
    gmsh: (4, &[]),
    domain: Domain::Simplex,
    corner_kind: CellKind::Tet4,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[0, 2, 1, 3],
    shapes: |xi, out| simplex::linear_shapes(3, xi, out),
    gradients: |_, out| simplex::linear_gradients(3, out),
    default_rule: || Rule::tetrahedron(1),
};

const NODES: &[[f64; 3]] = &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(super) const EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

const FACES: &[Face] = &[
    (CellKind::Tri3, &[0, 1, 3]),
    (CellKind::Tri3, &[1, 2, 3]),
    (CellKind::Tri3, &[2, 0, 3]),
    (CellKind::Tri3, &[0, 2, 1]),
];
