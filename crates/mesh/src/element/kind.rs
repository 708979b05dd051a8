//! [`CellKind`] and what is known of each.

use super::domain::Domain;
use crate::quadrature::Rule;

/// A kind of cell. Lines, quadrilaterals and hexahedra live on [-1,1]^d, triangles and tetrahedra on the unit simplex.
///
/// Nodes stand in VTK's order: corners, then midside nodes in the order of [`CellKind::edges`], then face centres
/// (x-, x+, y-, y+, z-, z+ for `Hex27`), then the centre.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Hash)]
pub enum CellKind {
    /// Straight line, 2 nodes.
    Line2,
    /// Quadratic line, 3 nodes.
    Line3,
    /// Linear triangle.
    Tri3,
    /// Quadratic triangle.
    Tri6,
    /// Bilinear quadrilateral.
    Quad4,
    /// Serendipity quadrilateral.
    Quad8,
    /// Biquadratic quadrilateral.
    Quad9,
    /// Linear tetrahedron.
    Tet4,
    /// Quadratic tetrahedron.
    Tet10,
    /// Trilinear hexahedron.
    Hex8,
    /// Serendipity hexahedron.
    Hex20,
    /// Triquadratic hexahedron.
    Hex27,
}

/// A face of a cell: its kind, and its nodes as indices into the cell's.
pub type Face = (CellKind, &'static [usize]);

/// One row of the catalogue.
pub(super) struct Element {
    pub name: &'static str,
    pub about: &'static str,
    pub dim: usize,
    pub order: usize,
    pub vtk: u8,
    /// Gmsh's number, and the permutation `vtk[i] = gmsh[order[i]]` of nodes; empty for the identity.
    pub gmsh: (u8, &'static [u8]),
    pub domain: Domain,
    pub corner_kind: CellKind,
    pub nodes: &'static [[f64; 3]],
    pub edges: &'static [[usize; 2]],
    pub faces: &'static [Face],
    pub mirror: &'static [usize],
    pub shapes: fn(&[f64; 3], &mut [f64]),
    pub gradients: fn(&[f64; 3], &mut [[f64; 3]]),
    pub default_rule: fn() -> Rule,
}
