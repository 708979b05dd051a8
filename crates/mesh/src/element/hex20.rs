//! Serendipity hexahedron: corners, bottom edges, top edges, upright edges.

use super::domain::Domain;
use super::hex8::EDGES;
use super::kind::{CellKind, Element, Face};
use super::serendipity;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "hex20",
    about: "Hexahedron, quadratic without face and centre nodes.",
    dim: 3,
    order: 2,
    vtk: 25,
    gmsh: (17, GMSH_ORDER),
    domain: Domain::Box,
    corner_kind: CellKind::Hex8,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19],
    shapes: |xi, out| serendipity::shapes::<3>(NODES, xi, out),
    gradients: |xi, out| serendipity::gradients::<3>(NODES, xi, out),
    default_rule: || Rule::tensor(3, 3),
};

/// Gmsh runs over the edges of a corner after another, VTK around the bottom, the top, then up the sides.
const GMSH_ORDER: &[u8] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];

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
];

const FACES: &[Face] = &[
    (CellKind::Quad8, &[0, 4, 7, 3, 16, 15, 19, 11]),
    (CellKind::Quad8, &[1, 2, 6, 5, 9, 18, 13, 17]),
    (CellKind::Quad8, &[0, 1, 5, 4, 8, 17, 12, 16]),
    (CellKind::Quad8, &[3, 7, 6, 2, 19, 14, 18, 10]),
    (CellKind::Quad8, &[0, 3, 2, 1, 11, 10, 9, 8]),
    (CellKind::Quad8, &[4, 5, 6, 7, 12, 13, 14, 15]),
];
