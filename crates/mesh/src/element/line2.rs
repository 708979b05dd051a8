//! Straight line.

use super::domain::Domain;
use super::kind::{CellKind, Element};
use super::product;
use crate::quadrature::Rule;

pub(super) static ELEMENT: Element = Element {
    name: "line2",
    about: "Line, linear.",
    dim: 1,
    order: 1,
    vtk: 3,
    gmsh: (1, &[]),
    domain: Domain::Box,
    corner_kind: CellKind::Line2,
    nodes: NODES,
    edges: EDGES,
    faces: &[],
    mirror: &[1, 0],
    shapes: |xi, out| product::shapes::<1>(NODES, product::linear, xi, out),
    gradients: |xi, out| product::gradients::<1>(NODES, product::linear, xi, out),
    default_rule: || Rule::tensor(1, 2),
};

const NODES: &[[f64; 3]] = &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]];

pub(super) const EDGES: &[[usize; 2]] = &[[0, 1]];
