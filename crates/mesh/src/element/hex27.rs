//! Triquadratic hexahedron: `Hex20`, then the face centres x-, x+, y-, y+, z-, z+, then the centre
//! (VTK_TRIQUADRATIC_HEXAHEDRON).

use super::domain::Domain;
use super::hex8::EDGES;
use super::kind::{CellKind, Element, Face};
use super::product;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "hex27",
    about: "Hexahedron, triquadratic.",
    dim: 3,
    order: 2,
    vtk: 29,
    gmsh: (12, GMSH_ORDER),
    domain: Domain::Box,
    corner_kind: CellKind::Hex8,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19, 20, 21, 22, 23, 25, 24, 26],
    shapes: |xi, out| product::shapes::<3>(NODES, product::quadratic, xi, out),
    gradients: |xi, out| product::gradients::<3>(NODES, product::quadratic, xi, out),
    default_rule: || Rule::tensor(3, 3),
};

/// Edges as for the serendipity hexahedron; faces: Gmsh z-, y-, x-, x+, y+, z+; VTK x-, x+, y-, y+, z-, z+.
const GMSH_ORDER: &[u8] =
    &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26];

const NODES: &[[f64; 3]] = &[
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, 0.0],
];

const FACES: &[Face] = &[
    (CellKind::Quad9, &[0, 4, 7, 3, 16, 15, 19, 11, 20]),
    (CellKind::Quad9, &[1, 2, 6, 5, 9, 18, 13, 17, 21]),
    (CellKind::Quad9, &[0, 1, 5, 4, 8, 17, 12, 16, 22]),
    (CellKind::Quad9, &[3, 7, 6, 2, 19, 14, 18, 10, 23]),
    (CellKind::Quad9, &[0, 3, 2, 1, 11, 10, 9, 8, 24]),
    (CellKind::Quad9, &[4, 5, 6, 7, 12, 13, 14, 15, 25]),
];
