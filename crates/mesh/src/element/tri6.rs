//! Quadratic triangle: corners, then the middles of 01, 12, 20.

use super::domain::Domain;
use super::kind::{CellKind, Element, Face};
use super::simplex;
use super::tri3::EDGES;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "tri6",
    about: "Triangle in plane strain, quadratic.",
    dim: 2,
    order: 2,
    vtk: 22,
    gmsh: (9, &[]),
    domain: Domain::Simplex,
    corner_kind: CellKind::Tri3,
    nodes: NODES,
    edges: EDGES,
    faces: FACES,
    mirror: &[0, 2, 1, 5, 4, 3],
    shapes: |xi, out| simplex::quadratic_shapes(2, EDGES, xi, out),
    gradients: |xi, out| simplex::quadratic_gradients(2, EDGES, xi, out),
    default_rule: || Rule::triangle(4),
};

const NODES: &[[f64; 3]] =
    &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]];

const FACES: &[Face] = &[(CellKind::Line3, &[0, 1, 3]), (CellKind::Line3, &[1, 2, 4]), (CellKind::Line3, &[2, 0, 5])];
