//! Names: groups of cells become regions, groups of surface elements surfaces, the rest node sets.

use super::RawMesh;
use super::facets::{FacetTable, facet_nodes, same_set};
use super::raw::Element;
use super::select::{Selection, UNUSED};
use crate::Fault;
use crate::mesh::Facet;
use std::collections::BTreeMap;

pub(super) struct Groups {
    pub regions: BTreeMap<String, Vec<u32>>,
    pub surfaces: BTreeMap<String, Vec<Facet>>,
    pub node_sets: BTreeMap<String, Vec<u32>>,
    /// See [`Mesh::lost_regions`](crate::Mesh::lost_regions).
    pub lost_regions: Vec<String>,
}

/// The region of all cells when the file names none.
const BODY: &str = "body";
/// That region where the file lists the name `body` for a group that no cell bears.
const UNGROUPED: &str = "ungrouped";

pub(super) fn name(
    raw: &RawMesh,
    dim: usize,
    selection: &Selection,
    table: &FacetTable,
    notes: &mut Vec<String>,
) -> Result<Groups, Fault> {
    let lost_regions = lost_regions(raw, dim, selection);
    let groups = Groups {
        regions: regions(raw, dim, selection, &lost_regions, notes),
        surfaces: surfaces(raw, dim, selection, table, notes)?,
        node_sets: node_sets(raw, dim, selection, notes),
        lost_regions,
    };
    note_empty_names(raw, dim, &groups, notes);
    Ok(groups)
}

/// The names listed for regions, if no cell bears any of them.
fn lost_regions(raw: &RawMesh, dim: usize, selection: &Selection) -> Vec<String> {
    let listed = || raw.names.iter().filter(|((group, _), name)| *group == dim && !name.trim().is_empty());
    if listed().any(|((_, tag), _)| selection.groups.contains_key(tag)) {
        return Vec::new();
    }
    listed().map(|(_, name)| name.clone()).collect()
}

fn regions(
    raw: &RawMesh,
    dim: usize,
    selection: &Selection,
    lost: &[String],
    notes: &mut Vec<String>,
) -> BTreeMap<String, Vec<u32>> {
    let cells = selection.origin.len();
    if selection.groups.is_empty() {
        let name = if lost.iter().any(|name| name == BODY) { UNGROUPED } else { BODY };
        if !lost.is_empty() {
            notes.push(format!("no cell bears a group: all are the region \"{name}\""));
        }
        return BTreeMap::from([(name.to_owned(), (0..cells as u32).collect())]);
    }
    let mut regions = BTreeMap::<String, Vec<u32>>::new();
    let mut grouped = vec![false; cells];
    for (&tag, members) in &selection.groups {
        members.iter().for_each(|&cell| grouped[cell as usize] = true);
        regions.entry(raw.group_name(dim, tag)).or_default().extend(members);
    }
    let loose = grouped.iter().filter(|grouped| !**grouped).count();
    if loose > 0 {
        notes.push(format!("{loose} of {cells} cells belong to no group, hence to no region"));
    }
    tidy(&mut regions);
    regions
}

fn surfaces(
    raw: &RawMesh,
    dim: usize,
    selection: &Selection,
    table: &FacetTable,
    notes: &mut Vec<String>,
) -> Result<BTreeMap<String, Vec<Facet>>, Fault> {
    let mut surfaces = BTreeMap::<String, Vec<Facet>>::new();
    let mut inside = BTreeMap::<String, usize>::new();
    let tagged = |tags: &[i32]| tags.iter().any(|tag| *tag != 0);
    for element in raw.elements().filter(|e| e.kind.dim() + 1 == dim && tagged(e.tags)) {
        let found = facet(&element, selection, table);
        for &tag in element.tags.iter().filter(|tag| **tag != 0) {
            let surface = raw.group_name(dim - 1, tag);
            let Some((facet, sides)) = found else {
                return Err(Fault::Dangling { surface, element: element.label, kind: element.kind });
            };
            if sides == 2 {
                *inside.entry(surface.clone()).or_default() += 1;
            }
            surfaces.entry(surface).or_default().push(facet);
        }
    }
    for (surface, count) in inside {
        notes.push(format!(
            "surface \"{surface}\": {count} facets lie between two cells; the lower-numbered cell's is used"
        ));
    }
    tidy(&mut surfaces);
    Ok(surfaces)
}

/// The facet of a surface element, and how many cells have it. A first-order element may be the facet
/// of a second-order cell, and the other way round, but nodes of the same kind of facet must agree.
fn facet(element: &Element, selection: &Selection, table: &FacetTable) -> Option<(Facet, usize)> {
    let nodes: Vec<u32> = element.nodes.iter().map(|&node| selection.renumbered[node as usize]).collect();
    let corners = &nodes[..element.kind.corners()];
    if corners.contains(&UNUSED) {
        return None;
    }
    let sides = table.find(corners.iter().copied());
    let side = sides.first()?;
    let (kind, own) = facet_nodes(&selection.blocks, side.facet);
    let agree = kind.corner_kind() == element.kind.corner_kind() && (kind != element.kind || same_set(&own, &nodes));
    agree.then_some((side.facet, sides.len()))
}

fn node_sets(raw: &RawMesh, dim: usize, selection: &Selection, notes: &mut Vec<String>) -> BTreeMap<String, Vec<u32>> {
    let vertices = raw.vertices.iter().map(|&(node, tag)| (0, tag, node));
    let curves = raw
        .elements()
        .filter(|e| e.kind.dim() + 1 < dim)
        .flat_map(|e| e.tags.iter().flat_map(move |&tag| e.nodes.iter().map(move |&node| (e.kind.dim(), tag, node))));
    let mut sets = BTreeMap::<(usize, i32), Vec<u32>>::new();
    for (group_dim, tag, node) in vertices.chain(curves).filter(|(_, tag, _)| *tag != 0) {
        sets.entry((group_dim, tag)).or_default().push(selection.renumbered[node as usize]);
    }
    let mut node_sets = BTreeMap::<String, Vec<u32>>::new();
    for ((group_dim, tag), mut nodes) in sets {
        let name = raw.group_name(group_dim, tag);
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.last() == Some(&UNUSED) {
            nodes.pop();
            notes.push(format!("node set \"{name}\" has nodes that belong to no cell; dropped"));
        }
        if !nodes.is_empty() {
            node_sets.entry(name).or_default().extend(nodes);
        }
    }
    tidy(&mut node_sets);
    node_sets
}

fn tidy<T: Ord>(map: &mut BTreeMap<String, Vec<T>>) {
    for members in map.values_mut() {
        members.sort_unstable();
        members.dedup();
    }
}

/// A named group without elements is most often one that was not saved.
fn note_empty_names(raw: &RawMesh, dim: usize, groups: &Groups, notes: &mut Vec<String>) {
    for ((group_dim, _), name) in &raw.names {
        let present = match dim.checked_sub(*group_dim) {
            Some(0) => groups.regions.contains_key(name),
            Some(1) => groups.surfaces.contains_key(name),
            Some(_) => groups.node_sets.contains_key(name),
            None => false,
        };
        if !present {
            notes.push(format!("group \"{name}\" (dimension {group_dim}) has no elements"));
        }
    }
}
