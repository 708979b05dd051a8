//! Bilinear quadrilateral, counterclockwise.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::product;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "quad4",
    about: "Quadrilateral in plane strain, bilinear.",
    dim: 2,
    order: 1,
    vtk: 9,
    gmsh: (3, &[]),
    domain: Domain::Box,
    corner_kind: CellKind::Quad4,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[0, 3, 2, 1],
    shapes: |xi, out| product::shapes::<2>(NODES, product::linear, xi, out),
    gradients: |xi, out| product::gradients::<2>(NODES, product::linear, xi, out),
    default_rule: || Rule::tensor(2, 2),
};

const NODES: &[[f64; 3]] = &[[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];

pub(super) const EDGES: &[[usize; 2]] = &[[0, 1], [1, 2], [2, 3], [3, 0]];

const FACES: &[Face] =
    &[(CellKind::Line2, &[0, 1]), (CellKind::Line2, &[1, 2]), (CellKind::Line2, &[2, 3]), (CellKind::Line2, &[3, 0])];
