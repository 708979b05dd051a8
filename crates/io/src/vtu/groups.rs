//! Named groups in a VTU file: field-data arrays whose names begin so, or an integer cell array of region tags.

use nastic_mesh::RawMesh;

use super::array::{Expect, Numbers, Storage, describe};
use super::read::{Grid, ListedCell};
use crate::error::ReadError;

/// `region:NAME`: cells.
pub(super) const REGION: &str = "region:";
/// `surface:NAME`: pairs of cell and face, as in [`CellKind::faces`](nastic_mesh::CellKind::faces).
pub(super) const SURFACE: &str = "surface:";
/// `nodes:NAME`: nodes.
pub(super) const NODES: &str = "nodes:";
/// Cell arrays that number regions, in files of other programs.
const TAGS: [&str; 2] = ["region", "gmsh:physical"];

/// Whether the file names its regions itself, so that the cell array `region` says nothing new.
pub(super) fn names_regions(grid: &Grid) -> bool {
    named(grid, REGION).next().is_some()
}

/// Whether a cell array says again what the groups say: `region`, `region:NAME`, `surface:NAME`.
pub(super) fn repeats_group(grid: &Grid, array: &super::xml::Element<'_>) -> bool {
    let name = array.attribute("Name").unwrap_or("");
    let is_mark = [REGION, SURFACE].iter().any(|prefix| name.starts_with(prefix));
    name == "region" && names_regions(grid)
        || is_mark && grid.field_arrays().any(|group| group.attribute("Name") == Some(name))
}

/// The tags of every cell, and the names of those tags.
pub(super) fn region_tags(grid: &Grid, cells: &[ListedCell], mesh: &mut RawMesh) -> Result<Vec<Vec<i32>>, ReadError> {
    let mut tags = vec![Vec::new(); cells.len()];
    for (tag, (name, element)) in (1..).zip(named(grid, REGION)) {
        for [cell] in tuples::<1>(grid, element, &[cells.len()])? {
            tags[cell].push(tag);
            mesh.names.insert((cells[cell].dimension(), tag), name.to_owned());
        }
    }
    if names_regions(grid) {
        return Ok(tags);
    }
    let Some(element) = grid.cell_arrays().find(|array| array.attribute("Name").is_some_and(|n| TAGS.contains(&n)))
    else {
        return Ok(tags);
    };
    let malformed = |what: String| grid.storage.malformed(element, what);
    if grid.storage.components(element)? != 1 {
        return Err(malformed("region tags must have one component".to_owned()));
    }
    let values = grid.storage.read(element, Expect::Tuples(cells.len() as u64))?.into_reals();
    for (cell, value) in values.into_iter().enumerate() {
        let tag = value as i32;
        if f64::from(tag) != value {
            return Err(malformed(format!("the region tag of cell {cell} is {value}, which is no 32-bit integer")));
        }
        tags[cell].push(tag);
    }
    Ok(tags)
}

/// Surfaces and node sets.
pub(super) fn surfaces_and_nodes(grid: &Grid, cells: &[ListedCell], mesh: &mut RawMesh) -> Result<(), ReadError> {
    // Above every tag that cells of lower dimension may bear.
    let free = mesh.blocks.iter().flat_map(|block| block.tags.iter().copied()).max().unwrap_or(0).max(0);
    let next = |count: usize| i32::try_from(count).ok().and_then(|count| free.checked_add(count)).unwrap_or(i32::MAX);
    for (count, (name, element)) in (1..).zip(named(grid, SURFACE)) {
        for [cell, face] in tuples::<2>(grid, element, &[cells.len(), usize::MAX])? {
            let Some((kind, nodes)) = cells[cell].face(face) else {
                return Err(grid.storage.malformed(element, format!("cell {cell} has no face {face}")));
            };
            mesh.name_group(kind.dim(), next(count), name);
            mesh.push(kind, &nodes, &[next(count)]);
        }
    }
    for (count, (name, element)) in (1..).zip(named(grid, NODES)) {
        mesh.name_group(0, next(count), name);
        for [node] in tuples::<1>(grid, element, &[mesh.points.len()])? {
            mesh.vertices.push((node as u32, next(count)));
        }
    }
    Ok(())
}

fn named<'s, 'a>(grid: &'s Grid<'a>, prefix: &'s str) -> impl Iterator<Item = (&'s str, &'s super::xml::Element<'a>)> {
    grid.field_arrays().filter_map(move |array| Some((array.attribute("Name")?.strip_prefix(prefix)?, array)))
}

/// The rows of a field array, each entry below its limit.
fn tuples<const N: usize>(
    grid: &Grid,
    element: &super::xml::Element<'_>,
    limits: &[usize; N],
) -> Result<Vec<[usize; N]>, ReadError> {
    let storage: &Storage = grid.storage;
    let wrong = |what: String| storage.malformed(element, what);
    let Numbers::Integers(values) = storage.read(element, Expect::Any)? else {
        return Err(wrong("group members must be integers".to_owned()));
    };
    if storage.components(element)? != N || values.len() % N != 0 {
        return Err(wrong(format!("{} needs rows of {N}", describe(element))));
    }
    let row = |row: &[i64]| {
        let mut out = [0; N];
        for ((entry, value), limit) in out.iter_mut().zip(row).zip(limits) {
            *entry = usize::try_from(*value)
                .ok()
                .filter(|value| value < limit)
                .ok_or_else(|| wrong(format!("the entry {value} is out of range (below {limit} is needed)")))?;
        }
        Ok(out)
    };
    values.chunks_exact(N).map(row).collect()
}
