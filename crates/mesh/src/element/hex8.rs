//! Trilinear hexahedron: the bottom counterclockwise, then the top.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::product;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "hex8",
    about: "Hexahedron, trilinear.",
    dim: 3,
    order: 1,
    vtk: 12,
    gmsh: (5, &[]),
    domain: Domain::Box,
    corner_kind: CellKind::Hex8,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[4, 5, 6, 7, 0, 1, 2, 3],
    shapes: |xi, out| product::shapes::<3>(NODES, product::linear, xi, out),
    gradients: |xi, out| product::gradients::<3>(NODES, product::linear, xi, out),
    default_rule: || Rule::tensor(3, 2),
};

const NODES: &[[f64; 3]] = &[
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

pub(super) const EDGES: &[[usize; 2]] =
    &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

const FACES: &[Face] = &[
    (CellKind::Quad4, &[0, 4, 7, 3]),
    (CellKind::Quad4, &[1, 2, 6, 5]),
    (CellKind::Quad4, &[0, 1, 5, 4]),
    (CellKind::Quad4, &[3, 7, 6, 2]),
    (CellKind::Quad4, &[0, 3, 2, 1]),
    (CellKind::Quad4, &[4, 5, 6, 7]),
];
