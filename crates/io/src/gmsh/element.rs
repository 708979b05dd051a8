//! Gmsh's element types, and the way from its node order to VTK's.

use nastic_mesh::CellKind;

/// What an element number of Gmsh means here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementType {
    /// A point: names a node.
    Point,
    /// A cell, with the permutation `vtk[i] = gmsh[order[i]]` of its nodes; empty for the identity.
    Cell(CellKind, &'static [u8]),
    /// Known to Gmsh, not taken here: its name there.
    Foreign(&'static str),
}

impl ElementType {
    /// By Gmsh's number; `None` for a number that Gmsh does not know either.
    pub fn of(number: i64) -> Option<Self> {
        if let Some(kind) = CellKind::ALL.into_iter().find(|kind| i64::from(kind.gmsh_type()) == number) {
            return Some(ElementType::Cell(kind, kind.gmsh_order()));
        }
        Some(match number {
            15 => ElementType::Point,
            6 => ElementType::Foreign("the 6-node prism"),
            13 => ElementType::Foreign("the 18-node prism"),
            18 => ElementType::Foreign("the 15-node prism"),
            7 => ElementType::Foreign("the 5-node pyramid"),
            14 => ElementType::Foreign("the 14-node pyramid"),
            19 => ElementType::Foreign("the 13-node pyramid"),
            20 => ElementType::Foreign("the 9-node incomplete third-order triangle"),
            21 => ElementType::Foreign("the 10-node third-order triangle"),
            22 => ElementType::Foreign("the 12-node incomplete fourth-order triangle"),
            23 => ElementType::Foreign("the 15-node fourth-order triangle"),
            24 => ElementType::Foreign("the 15-node incomplete fifth-order triangle"),
            25 => ElementType::Foreign("the 21-node fifth-order triangle"),
            26 => ElementType::Foreign("the 4-node third-order line"),
            27 => ElementType::Foreign("the 5-node fourth-order line"),
            28 => ElementType::Foreign("the 6-node fifth-order line"),
            29 => ElementType::Foreign("the 20-node third-order tetrahedron"),
            30 => ElementType::Foreign("the 35-node fourth-order tetrahedron"),
            31 => ElementType::Foreign("the 56-node fifth-order tetrahedron"),
            36 => ElementType::Foreign("the 16-node third-order quadrangle"),
            39 => ElementType::Foreign("the 12-node incomplete third-order quadrangle"),
            90 => ElementType::Foreign("the 40-node third-order prism"),
            92 => ElementType::Foreign("the 64-node third-order hexahedron"),
            93 => ElementType::Foreign("the 125-node fourth-order hexahedron"),
            118 => ElementType::Foreign("the 30-node third-order pyramid"),
            32..=140 => ElementType::Foreign("an element of third or higher order, or a polygon or polyhedron"),
            _ => return None,
        })
    }

    /// Number of nodes; zero for foreign ones.
    pub fn nodes(self) -> usize {
        match self {
            ElementType::Point => 1,
            ElementType::Cell(kind, _) => kind.nodes(),
            ElementType::Foreign(_) => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_permutations_of_the_right_length() {
        let mut seen = 0;
        for number in 1..=140 {
            let Some(ElementType::Cell(kind, order)) = ElementType::of(number) else { continue };
            seen += 1;
            let mut sorted = order.to_vec();
            sorted.sort_unstable();
            assert!(order.is_empty() || sorted == (0..kind.nodes() as u8).collect::<Vec<_>>(), "{kind:?}");
        }
        assert_eq!(seen, CellKind::ALL.len());
    }
}
