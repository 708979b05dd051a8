//! Cells by VTK's numbers of types.

use nastic_mesh::CellKind;

/// A cell as a file lists it, its nodes in the order of its kind.
pub(crate) struct ListedCell {
    /// `None` for a vertex.
    pub kind: Option<CellKind>,
    pub nodes: Vec<u32>,
}

impl ListedCell {
    pub fn dimension(&self) -> usize {
        self.kind.map_or(0, CellKind::dim)
    }

    /// Kind and nodes of a face.
    pub fn face(&self, face: usize) -> Option<(CellKind, Vec<u32>)> {
        let (kind, local) = self.kind?.faces().get(face)?;
        Some((*kind, local.iter().map(|at| self.nodes[*at]).collect()))
    }
}

/// In which order a file has the nodes of Lagrange hexahedra: VTK exchanged the middles of two edges.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum LagrangeOrder {
    /// Files of version 2.1 and later (VTU), 5.1 and later (legacy): that of the triquadratic hexahedron.
    Present,
    /// Files of earlier versions: nodes 18 and 19 exchanged.
    Former,
}

/// Why a cell is not taken.
pub(crate) enum Refused {
    /// A type that has no kind here, by its name.
    Type(&'static str),
    /// Another number of nodes than its type has.
    Nodes {
        /// So many are needed.
        wanted: usize,
    },
}

const QUADRATIC_HEXAHEDRON: [(usize, usize); 1] = [(18, 19)];
const PIXEL: [(usize, usize); 1] = [(2, 3)];
const VOXEL: [(usize, usize); 2] = [(2, 3), (6, 7)];

/// The cell of a type of VTK with these nodes.
pub(crate) fn cell(number: i64, mut nodes: Vec<u32>, order: LagrangeOrder) -> Result<ListedCell, Refused> {
    let count = nodes.len();
    let second = |first: usize, kinds: [CellKind; 2]| if count == first { kinds[0] } else { kinds[1] };
    let (kind, exchanged): (CellKind, &[(usize, usize)]) = match number {
        1 if count == 1 => return Ok(ListedCell { kind: None, nodes }),
        1 => return Err(Refused::Nodes { wanted: 1 }),
        8 => (CellKind::Quad4, &PIXEL),
        11 => (CellKind::Hex8, &VOXEL),
        68..=72 if of_higher_order(number, count) => {
            return Err(Refused::Type("a Lagrange cell of third or higher order"));
        }
        68 => (second(2, [CellKind::Line2, CellKind::Line3]), &[]),
        69 => (second(3, [CellKind::Tri3, CellKind::Tri6]), &[]),
        70 => (second(4, [CellKind::Quad4, CellKind::Quad9]), &[]),
        71 => (second(4, [CellKind::Tet4, CellKind::Tet10]), &[]),
        72 if count == 27 && order == LagrangeOrder::Former => (CellKind::Hex27, &QUADRATIC_HEXAHEDRON),
        72 => (second(8, [CellKind::Hex8, CellKind::Hex27]), &[]),
        _ => match u8::try_from(number).ok().and_then(CellKind::from_vtk) {
            Some(kind) => (kind, &[]),
            None => return Err(Refused::Type(name(number))),
        },
    };
    if count != kind.nodes() {
        return Err(Refused::Nodes { wanted: kind.nodes() });
    }
    exchanged.iter().for_each(|(a, b)| nodes.swap(*a, *b));
    Ok(ListedCell { kind: Some(kind), nodes })
}

/// Whether a Lagrange cell has more nodes than one of second order.
fn of_higher_order(number: i64, count: usize) -> bool {
    let second = match number {
        68 => 3,
        69 => 6,
        70 => 9,
        71 => 10,
        _ => 27,
    };
    count > second
}

/// What VTK calls a type that is not taken.
fn name(number: i64) -> &'static str {
    match number {
        2 => "several vertices as one cell",
        4 => "the polyline",
        6 => "the triangle strip",
        13 => "the wedge",
        14 => "the pyramid",
        26 | 31 | 32 => "the second-order wedge",
        27 | 37 => "the second-order pyramid",
        7 | 36 => "the polygon",
        42 => "the polyhedron",
        35 => "the third-order line",
        73 => "the Lagrange wedge",
        74 => "the Lagrange pyramid",
        75..=81 => "the Bezier cell",
        _ => "a cell",
    }
}
