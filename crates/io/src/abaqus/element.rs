//! Types of elements by their names, with the order of nodes and faces.
//!
//! Source: Abaqus 2023, Elements guide, "Node ordering and face numbering on elements"; CalculiX numbers them alike.

use nastic_mesh::CellKind;

/// What a type is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    Solid,
    PlaneStrain,
    PlaneStress,
    /// Shells, membranes, surface elements.
    Shell,
    /// Trusses and beams.
    Line,
}

/// How a type is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ElementType {
    Cell(CellKind, Family),
    /// A body of it cannot be taken.
    Foreign,
    /// Masses, springs, rigid surfaces: no part of the mesh.
    PassedOver,
}

/// Centre and faces of the 27-node brick: Abaqus the centre, then z-, z+, y-, x+, y+, x-; ours x-, x+, y-, y+, z-, z+, then the centre.
const HEX27: [usize; 27] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 26, 24, 23, 25, 21, 22, 20];

/// By its name in capitals: letters of the family, number of nodes, letters of the formulation.
pub(super) fn element_type(name: &str) -> ElementType {
    let (family, rest) = if let Some(rest) = name.strip_prefix("C3D") {
        (Family::Solid, rest)
    } else if let Some(rest) = name.strip_prefix("CPE") {
        (Family::PlaneStrain, rest)
    } else if let Some(rest) = name.strip_prefix("CPS") {
        (Family::PlaneStress, rest)
    } else if let Some(rest) = ["SFM3D", "M3D", "STRI", "S"].iter().find_map(|prefix| name.strip_prefix(prefix)) {
        (Family::Shell, rest)
    } else if let Some(rest) = ["T2D", "T3D", "B2", "B3"].iter().find_map(|prefix| name.strip_prefix(prefix)) {
        (Family::Line, rest)
    } else {
        let is_body =
            ["CAX", "CGAX", "CCL", "DC", "AC", "COH", "SC", "CIN"].iter().any(|prefix| name.starts_with(prefix));
        return if is_body { ElementType::Foreign } else { ElementType::PassedOver };
    };
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    let kind = match (family, &rest[..digits]) {
        (Family::Solid, "4") => CellKind::Tet4,
        (Family::Solid, "8") => CellKind::Hex8,
        (Family::Solid, "10") => CellKind::Tet10,
        (Family::Solid, "20") => CellKind::Hex20,
        (Family::Solid, "27") => CellKind::Hex27,
        // beams have their order there: B31 has two nodes; STRI65 six
        (Family::Line, "1") if name.starts_with('B') => CellKind::Line2,
        (Family::Line, "2") if name.starts_with('B') => CellKind::Line3,
        (Family::Line, "2") => CellKind::Line2,
        (Family::Line, "3") if name.starts_with('T') => CellKind::Line3,
        (Family::Shell, "65") => CellKind::Tri6,
        (Family::PlaneStrain | Family::PlaneStress | Family::Shell, number) => match number {
            "3" => CellKind::Tri3,
            "4" => CellKind::Quad4,
            "6" => CellKind::Tri6,
            "8" => CellKind::Quad8,
            "9" if family == Family::Shell => CellKind::Quad9,
            _ if family == Family::Shell => return ElementType::PassedOver,
            _ => return ElementType::Foreign,
        },
        (Family::Line, _) => return ElementType::PassedOver,
        _ => return ElementType::Foreign,
    };
    ElementType::Cell(kind, family)
}

/// Nodes in our order.
pub(super) fn ordered(kind: CellKind, nodes: &[u32], points: &[[f64; 3]]) -> Vec<u32> {
    match kind {
        CellKind::Hex27 => HEX27.iter().map(|from| nodes[*from]).collect(),
        // Abaqus has the middle second, others last
        CellKind::Line3 => {
            let off = |middle: usize| {
                let [a, b, m] = [(middle + 1) % 3, (middle + 2) % 3, middle].map(|k| points[nodes[k] as usize]);
                (0..3).map(|i| (a[i] + b[i] - 2.0 * m[i]).powi(2)).sum::<f64>()
            };
            if off(1) < off(2) { vec![nodes[0], nodes[2], nodes[1]] } else { nodes.to_vec() }
        }
        _ => nodes.to_vec(),
    }
}

/// The face of a label `S1`, as one of [`CellKind::faces`].
pub(super) fn face(kind: CellKind, label: &str) -> Option<usize> {
    let faces: &[&[usize]] = match kind.corner_kind() {
        CellKind::Tet4 => &[&[0, 1, 2], &[0, 1, 3], &[1, 2, 3], &[0, 2, 3]],
        CellKind::Hex8 => &[&[0, 1, 2, 3], &[4, 5, 6, 7], &[0, 1, 4, 5], &[1, 2, 5, 6], &[2, 3, 6, 7], &[0, 3, 4, 7]],
        CellKind::Tri3 => &[&[0, 1], &[1, 2], &[0, 2]],
        CellKind::Quad4 => &[&[0, 1], &[1, 2], &[2, 3], &[0, 3]],
        _ => return None,
    };
    let number: usize = label.strip_prefix(['S', 's'])?.parse().ok()?;
    let corners = faces.get(number.checked_sub(1)?)?;
    kind.faces().iter().position(|(face, nodes)| {
        let mut own = nodes[..face.corners()].to_vec();
        own.sort_unstable();
        own == *corners
    })
}
