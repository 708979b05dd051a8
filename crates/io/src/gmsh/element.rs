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
        use CellKind::*;
        Some(match number {
            15 => ElementType::Point,
            1 => ElementType::Cell(Line2, &[]),
            8 => ElementType::Cell(Line3, &[]),
            2 => ElementType::Cell(Tri3, &[]),
            9 => ElementType::Cell(Tri6, &[]),
            3 => ElementType::Cell(Quad4, &[]),
            16 => ElementType::Cell(Quad8, &[]),
            10 => ElementType::Cell(Quad9, &[]),
            4 => ElementType::Cell(Tet4, &[]),
            11 => ElementType::Cell(Tet10, &TET10),
            5 => ElementType::Cell(Hex8, &[]),
            17 => ElementType::Cell(Hex20, &HEX20),
            12 => ElementType::Cell(Hex27, &HEX27),
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

// Gmsh runs over the edges of a corner after another, VTK around the bottom, the top, then up the sides.
const TET10: [u8; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];
const HEX20: [u8; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];
// Faces: Gmsh z-, y-, x-, x+, y+, z+; VTK x-, x+, y-, y+, z-, z+.
const HEX27: [u8; 27] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26];

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
