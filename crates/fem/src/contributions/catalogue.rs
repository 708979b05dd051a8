//! The catalogue of contributions: a row each, with an example that the contract test holds to [`check_contribution`].

use crate::contributions::cavity::Cavity;
use crate::error::FemError;
use crate::solid::Solid;
use nastic_energy::{FiberTension, NeoHooke};
use nastic_mesh::{CellKind, Mesh, RawMesh, box_mesh};
use nastic_tensor::Vec3;

/// A row of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// What the contribution is called in messages.
    pub name: &'static str,
    /// A body that has it under that name.
    pub example: fn() -> Result<Solid, FemError>,
}

/// Every contribution of this crate.
pub const CATALOGUE: &[Entry] = &[
    Entry { name: "body energy", example: block },
    Entry { name: "dead load", example: || block()?.traction("x+", Vec3::new(3.0, -2.0, 1.0)) },
    Entry { name: "cavity", example: || block()?.cavity(Cavity::new("cavity", "inside").lid()) },
];

/// A cup that is held at one side and pulled along its fibres.
fn block() -> Result<Solid, FemError> {
    Solid::new(pocket()?)?
        .material("body", NeoHooke::new(1e5, 2e5)?)?
        .actuate("body", "fibre", FiberTension::along(Vec3::x())?)?
        .clamp("x-")
}

/// A box of 3 x 3 x 2 hexahedra whose upper middle one is missing: a cup with the surfaces "x-", "x+" and "inside".
fn pocket() -> Result<Mesh, FemError> {
    let full = box_mesh([3.0, 3.0, 2.0], [3, 3, 2], CellKind::Hex8)?;
    let mut raw = RawMesh::new("cup");
    raw.points = full.points().to_vec();
    for (tag, name) in [(1, "x-"), (2, "x+"), (3, "inside")] {
        raw.names.insert((2, tag), name.to_owned());
    }
    raw.names.insert((3, 4), "body".to_owned());
    let missing = |cell: usize| {
        let c = full.cell_centre(cell);
        (c[0] - 1.5).abs() < 0.1 && (c[1] - 1.5).abs() < 0.1 && c[2] > 1.0
    };
    for cell in (0..full.cells()).filter(|&cell| !missing(cell)) {
        raw.push(CellKind::Hex8, full.cell(cell).nodes, &[4]);
    }
    let hole = (0..full.cells()).find(|&cell| missing(cell)).unwrap_or_default();
    for (kind, local) in CellKind::Hex8.faces() {
        let nodes: Vec<u32> = local.iter().map(|&a| full.cell(hole).nodes[a]).collect();
        if nodes.iter().any(|&node| full.points()[node as usize][2] < 1.5) {
            raw.push(*kind, &nodes, &[3]);
        }
    }
    for (tag, name) in [(1, "x-"), (2, "x+")] {
        for &facet in full.surface(name)? {
            let (kind, nodes) = full.facet_nodes(facet);
            raw.push(kind, &nodes, &[tag]);
        }
    }
    Ok(Mesh::build(raw)?)
}
