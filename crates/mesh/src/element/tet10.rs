//! Quadratic tetrahedron: corners, then the middles of 01, 12, 20, 03, 13, 23.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::simplex;
use super::tet4::EDGES;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "tet10",
    about: "Tetrahedron, quadratic.",
    dim: 3,
    order: 2,
    vtk: 24,
    gmsh: (11, &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
    domain: Domain::Simplex,
    corner_kind: CellKind::Tet4,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
    shapes: |xi, out| simplex::quadratic_shapes(3, EDGES, xi, out),
    gradients: |xi, out| simplex::quadratic_gradients(3, EDGES, xi, out),
    default_rule: || Rule::tetrahedron(4),
};

const NODES: &[[f64; 3]] = &[
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];

const FACES: &[Face] = &[
    (CellKind::Tri6, &[0, 1, 3, 4, 8, 7]),
    (CellKind::Tri6, &[1, 2, 3, 5, 9, 8]),
    (CellKind::Tri6, &[2, 0, 3, 6, 7, 9]),
    (CellKind::Tri6, &[0, 2, 1, 6, 5, 4]),
];
