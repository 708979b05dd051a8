//! Quadratic line: ends, then the middle.

use super::domain::Domain;
use super::kind::{CellKind, Element};
use super::line2::EDGES;
use super::product;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "line3",
    about: "Line, quadratic.",
    dim: 1,
    order: 2,
    vtk: 21,
    gmsh: (8, &[]),
    domain: Domain::Box,
    corner_kind: CellKind::Line2,
    nodes: NODES,
    edges: EDGES,
    faces: &[],
    mirror: &[1, 0, 2],
    shapes: |xi, out| product::shapes::<1>(NODES, product::quadratic, xi, out),
    gradients: |xi, out| product::gradients::<1>(NODES, product::quadratic, xi, out),
    default_rule: || Rule::tensor(1, 3),
};

const NODES: &[[f64; 3]] = &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
