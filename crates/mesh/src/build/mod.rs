//! From a raw mesh to a checked one, step by step.

mod check;
mod facets;
mod groups;
mod raw;
mod select;
mod winding;

pub(crate) use facets::FacetTable;
pub use raw::{RawBlock, RawMesh};
pub(crate) use winding::orient;

use crate::{Fault, Mesh};

pub(crate) fn build(raw: &RawMesh) -> Result<Mesh, Fault> {
    check::check(raw)?;
    let mut notes = raw.notes.clone();
    let dim = select::dimension(raw).ok_or(Fault::NoCells)?;
    let mut selection = select::select(raw, dim, &mut notes);
    let mut points = select::points(raw, &selection, dim, &mut notes)?;
    let blocks = &mut selection.blocks;
    let mended = orient(blocks, &points, |id| selection.labels[id])?;
    winding::note(&mended, |id| selection.labels[id], &mut notes);
    let table = FacetTable::new(blocks, points.len());
    let (boundary, neighbours) = table.sides(blocks, |id| selection.labels[id])?;
    let groups = groups::name(raw, dim, &selection, &table, &mut notes)?;
    points.shrink_to_fit();
    let mut mesh = Mesh {
        name: raw.name.clone(),
        dim,
        points,
        blocks: selection.blocks,
        regions: groups.regions,
        surfaces: groups.surfaces,
        node_sets: groups.node_sets,
        boundary,
        neighbours,
        node_origin: selection.used,
        cell_origin: selection.origin,
        lost_regions: groups.lost_regions,
        notes,
    };
    if let Some(count @ 2..) = mesh.pieces().into_iter().max().map(|last| last + 1) {
        mesh.notes.push(format!("the body consists of {count} separate pieces: a support holds one of them alone"));
    }
    Ok(mesh)
}
