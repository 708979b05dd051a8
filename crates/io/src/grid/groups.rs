//! Named groups of a grid: field-data arrays whose names begin so, or an integer cell array of tags.

use nastic_mesh::RawMesh;

use super::{Grid, GridArray};
use crate::error::ReadError;

/// `region:NAME`: cells.
pub(crate) const REGION: &str = "region:";
/// `surface:NAME`: pairs of cell and face, as in [`CellKind::faces`](nastic_mesh::CellKind::faces).
pub(crate) const SURFACE: &str = "surface:";
/// `nodes:NAME`: nodes.
pub(crate) const NODES: &str = "nodes:";
/// Cell arrays that number groups, in files of other programs: those of meshio, and that of Gmsh, which has physical tags in spite of its name.
pub(crate) const TAGS: [&str; 6] = ["region", "gmsh:physical", "medit:ref", "nastran:ref", "su2:tag", ENTITIES];
/// What Gmsh calls the physical tags in VTK files; -1 is no group.
const ENTITIES: &str = "CellEntityIds";
/// VTK's array of cells that are not the file's own.
pub(crate) const GHOSTS: &str = "vtkGhostType";
/// Bits of [`GHOSTS`] by which a cell does not belong to the body: a copy of a cell of another part, a cell that was refined, a hidden one.
const NO_CELL: i32 = 1 | 8 | 32;

/// Whether a field array names a group.
pub(crate) fn is_group(name: &str) -> bool {
    [REGION, SURFACE, NODES].iter().any(|prefix| name.starts_with(prefix))
}

/// Which cells are left out; empty without ghosts.
pub(super) fn ghosts(grid: &Grid) -> Result<Vec<bool>, ReadError> {
    let Some(array) = &grid.ghosts else { return Ok(Vec::new()) };
    let marks = array.tags(&grid.source, grid.cells.len())?;
    Ok(marks.into_iter().map(|mark| mark & NO_CELL != 0).collect())
}

/// The tags of every cell, and the names of those tags.
pub(super) fn region_tags(grid: &Grid, mesh: &mut RawMesh) -> Result<Vec<Vec<i32>>, ReadError> {
    let cells = &grid.cells;
    let mut tags = vec![Vec::new(); cells.len()];
    for (tag, (name, array)) in (1..).zip(named(grid, REGION)) {
        for [cell] in array.rows(&grid.source, [cells.len()])? {
            tags[cell].push(tag);
            mesh.names.insert((cells[cell].dimension(), tag), name.to_owned());
        }
    }
    if named(grid, REGION).next().is_some() {
        return Ok(tags);
    }
    let Some(array) = &grid.tags else { return Ok(tags) };
    let values = array.tags(&grid.source, cells.len())?;
    let none = |tag: i32| array.name == ENTITIES && tag < 0;
    for (tags, tag) in tags.iter_mut().zip(values) {
        tags.push(if none(tag) { 0 } else { tag });
    }
    Ok(tags)
}

/// Surfaces and node sets.
pub(super) fn surfaces_and_nodes(grid: &Grid, ghosts: &[bool], mesh: &mut RawMesh) -> Result<(), ReadError> {
    let cells = &grid.cells;
    // Above every tag that cells of lower dimension may bear.
    let free = mesh.blocks.iter().flat_map(|block| block.tags.iter().copied()).max().unwrap_or(0).max(0);
    let next = |count: usize| i32::try_from(count).ok().and_then(|count| free.checked_add(count)).unwrap_or(i32::MAX);
    for (count, (name, array)) in (1..).zip(named(grid, SURFACE)) {
        for [cell, face] in array.rows(&grid.source, [cells.len(), usize::MAX])? {
            let Some((kind, nodes)) = cells[cell].face(face) else {
                return Err(array.malformed(&grid.source, format!("cell {cell} has no face {face}")));
            };
            mesh.name_group(kind.dim(), next(count), name);
            if ghosts.get(cell) != Some(&true) {
                mesh.push(kind, &nodes, &[next(count)]);
            }
        }
    }
    for (count, (name, array)) in (1..).zip(named(grid, NODES)) {
        mesh.name_group(0, next(count), name);
        for [node] in array.rows(&grid.source, [mesh.points.len()])? {
            mesh.vertices.push((node as u32, next(count)));
        }
    }
    Ok(())
}

fn named<'s>(grid: &'s Grid, prefix: &'s str) -> impl Iterator<Item = (&'s str, &'s GridArray)> {
    grid.groups.iter().filter_map(move |array| Some((array.name.strip_prefix(prefix)?, array)))
}
