//! The catalogue of reference elements: one file each, one table row per kind.

mod domain;
mod hex20;
mod hex27;
mod hex8;
mod kind;
mod line2;
mod line3;
mod product;
mod quad4;
mod quad8;
mod quad9;
mod serendipity;
mod simplex;
mod tet10;
mod tet4;
mod tri3;
mod tri6;

use crate::quadrature::Rule;
pub use domain::Domain;
use kind::Element;
pub use kind::{CellKind, Face};
use std::sync::OnceLock;

impl CellKind {
    /// Every kind, in the order of the enumeration.
    pub const ALL: [CellKind; 12] = [
        CellKind::Line2,
        CellKind::Line3,
        CellKind::Tri3,
        CellKind::Tri6,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
    ];

    fn element(self) -> &'static Element {
        match self {
            CellKind::Line2 => &line2::ELEMENT,
            CellKind::Line3 => &line3::ELEMENT,
            CellKind::Tri3 => &tri3::ELEMENT,
            CellKind::Tri6 => &tri6::ELEMENT,
            CellKind::Quad4 => &quad4::ELEMENT,
            CellKind::Quad8 => &quad8::ELEMENT,
            CellKind::Quad9 => &quad9::ELEMENT,
            CellKind::Tet4 => &tet4::ELEMENT,
            CellKind::Tet10 => &tet10::ELEMENT,
            CellKind::Hex8 => &hex8::ELEMENT,
            CellKind::Hex20 => &hex20::ELEMENT,
            CellKind::Hex27 => &hex27::ELEMENT,
        }
    }

    /// The name in case files: `hex8`, `tet10`, ...
    pub fn name(self) -> &'static str {
        self.element().name
    }

    /// What it is, in a few words.
    pub fn about(self) -> &'static str {
        self.element().about
    }

    /// The number of this kind in Gmsh's files.
    pub fn gmsh_type(self) -> u8 {
        self.element().gmsh.0
    }

    /// Where Gmsh has the nodes: `vtk[i] = gmsh[order[i]]`; empty where both have the same order.
    pub fn gmsh_order(self) -> &'static [u8] {
        self.element().gmsh.1
    }

    /// The kind of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        self.element().nodes.len()
    }

    /// Dimension of the reference domain: 1, 2 or 3.
    pub fn dim(self) -> usize {
        self.element().dim
    }

    /// Degree of the complete polynomials the shapes span: 1 or 2.
    pub fn order(self) -> usize {
        self.element().order
    }

    /// VTK's number of the cell type.
    pub fn vtk(self) -> u8 {
        self.element().vtk
    }

    /// The kind of that VTK number, if nastic knows it.
    pub fn from_vtk(vtk: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.vtk() == vtk)
    }

    /// Number of corners; they come first among the nodes.
    pub fn corners(self) -> usize {
        self.corner_kind().nodes()
    }

    /// The first-order kind on the same corners.
    pub fn corner_kind(self) -> CellKind {
        self.element().corner_kind
    }

    /// The reference domain.
    pub fn domain(self) -> Domain {
        self.element().domain
    }

    /// Reference coordinates of the nodes; unused components are 0.
    pub fn reference_nodes(self) -> &'static [[f64; 3]] {
        self.element().nodes
    }

    /// Centroid of the reference domain.
    pub fn centre(self) -> [f64; 3] {
        match (self.domain(), self.dim()) {
            (Domain::Box, _) => [0.0; 3],
            (Domain::Simplex, 2) => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            (Domain::Simplex, _) => [0.25; 3],
        }
    }

    /// Measure of the reference domain.
    pub fn reference_measure(self) -> f64 {
        match (self.domain(), self.dim()) {
            (Domain::Box, dim) => f64::from(1u32 << dim),
            (Domain::Simplex, 2) => 0.5,
            (Domain::Simplex, _) => 1.0 / 6.0,
        }
    }

    /// Corner pairs. For second-order kinds, node `corners() + k` is the middle of edge k.
    pub fn edges(self) -> &'static [[usize; 2]] {
        self.element().edges
    }

    /// Faces with outward orientation: seen from outside, the corners of a surface face run counterclockwise; the
    /// edges of a plane cell run counterclockwise round it, so that (t_y, -t_x) points outwards. Lines have none.
    pub fn faces(self) -> &'static [Face] {
        self.element().faces
    }

    /// The permutation of nodes that reverses the orientation: `new[k] = old[mirror[k]]`.
    pub fn mirror(self) -> &'static [usize] {
        self.element().mirror
    }

    /// Shape functions N_a(xi) into `out`, one per node.
    pub fn shapes(self, xi: &[f64; 3], out: &mut [f64]) {
        debug_assert_eq!(out.len(), self.nodes());
        (self.element().shapes)(xi, out);
    }

    /// Gradients dN_a/dxi_k into `out[a][k]`; components beyond `dim()` are 0.
    pub fn gradients(self, xi: &[f64; 3], out: &mut [[f64; 3]]) {
        debug_assert_eq!(out.len(), self.nodes());
        (self.element().gradients)(xi, out);
    }

    /// The default body rule: integrates the tangent of an affine cell properly. Gauss with order + 1 points per
    /// direction on lines, quadrilaterals and hexahedra; on simplices one point for the linear, degree 4 for the
    /// quadratic kinds.
    pub fn rule(self) -> &'static Rule {
        static RULES: [OnceLock<Rule>; CellKind::ALL.len()] = [const { OnceLock::new() }; CellKind::ALL.len()];
        RULES[self as usize].get_or_init(self.element().default_rule)
    }

    /// A rule with positive weights and inner points that is exact for polynomials of that total degree (in each
    /// variable, on lines, quadrilaterals and hexahedra).
    pub fn rule_of_degree(self, degree: usize) -> Rule {
        match (self.domain(), self.dim()) {
            (Domain::Box, dim) => Rule::tensor(dim, degree / 2 + 1),
            (Domain::Simplex, 2) => Rule::triangle(degree),
            (Domain::Simplex, _) => Rule::tetrahedron(degree),
        }
    }

    /// The rule with n Gauss points per direction; on simplices the one of degree 2n - 1. At least one point is taken.
    pub fn rule_of_points(self, n: usize) -> Rule {
        self.rule_of_degree(2 * n.max(1) - 1)
    }
}

impl std::fmt::Display for CellKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
