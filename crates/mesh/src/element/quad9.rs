//! Biquadratic quadrilateral: `Quad8`, then the centre.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::product;
use super::quad4::EDGES;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "quad9",
    about: "Quadrilateral in plane strain, biquadratic.",
    dim: 2,
    order: 2,
    vtk: 28,
    gmsh: (10, &[]),
    domain: Domain::Box,
    corner_kind: CellKind::Quad4,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[0, 3, 2, 1, 7, 6, 5, 4, 8],
    shapes: |xi, out| product::shapes::<2>(NODES, product::quadratic, xi, out),
    gradients: |xi, out| product::gradients::<2>(NODES, product::quadratic, xi, out),
    default_rule: || Rule::tensor(2, 3),
};

const NODES: &[[f64; 3]] = &[
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0],
];

const FACES: &[Face] = &[
    (CellKind::Line3, &[0, 1, 4]),
    (CellKind::Line3, &[1, 2, 5]),
    (CellKind::Line3, &[2, 3, 6]),
    (CellKind::Line3, &[3, 0, 7]),
];
