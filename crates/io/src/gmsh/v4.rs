//! Sections of format 4.1. Text and binary hold the same numbers in the same order.

use std::collections::BTreeMap;

use nastic_mesh::RawMesh;

use super::content::{NodeTags, element_type, node, point, push};
use super::cursor::Cursor;
use crate::error::ReadError;

/// Physical tags of the geometric entities, by dimension and tag.
pub(super) type Entities = BTreeMap<(i32, i32), Vec<i32>>;

/// `$Entities` and `$PartitionedEntities`.
pub(super) fn entities(cursor: &mut Cursor, partitioned: bool, entities: &mut Entities) -> Result<(), ReadError> {
    if partitioned {
        let _partitions = cursor.size()?;
        let ghosts = cursor.count("ghost entities", 2)?;
        for _ in 0..2 * ghosts {
            cursor.int()?;
        }
    }
    let mut counts = [0; 4];
    for (count, of) in counts.iter_mut().zip(["points", "curves", "surfaces", "volumes"]) {
        *count = cursor.count(of, 5)?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let tag = cursor.int()?;
            if partitioned {
                cursor.int()?;
                cursor.int()?;
                skip_ints(cursor, "partitions of an entity")?;
            }
            // A point has its place, everything else its bounding box.
            cursor.skip_reals(if dimension == 0 { 3 } else { 6 })?;
            let many = cursor.count("physical groups of an entity", 1)?;
            let mut groups = Vec::with_capacity(many);
            for _ in 0..many {
                groups.push(cursor.int()?.saturating_abs());
            }
            groups.sort_unstable();
            groups.dedup();
            if dimension > 0 {
                skip_ints(cursor, "bounding entities")?;
            }
            entities.insert((dimension as i32, tag), groups);
        }
    }
    Ok(())
}

fn skip_ints(cursor: &mut Cursor, of: &str) -> Result<(), ReadError> {
    let many = cursor.count(of, 1)?;
    (0..many).try_for_each(|_| cursor.int().map(|_| ()))
}

/// `$Nodes`.
pub(super) fn nodes(cursor: &mut Cursor, scale: f64, mesh: &mut RawMesh, tags: &mut NodeTags) -> Result<(), ReadError> {
    let blocks = cursor.count("blocks of nodes", 4)?;
    let count = cursor.count("nodes", 4)?;
    cursor.size()?;
    cursor.size()?;
    mesh.points.reserve(count);
    tags.reserve(count);
    for _ in 0..blocks {
        let dimension = cursor.int()?;
        let _entity = cursor.int()?;
        let parametric = cursor.int()? != 0;
        let many = cursor.count("nodes in a block", 4)?;
        check_left(cursor, many, count - mesh.points.len(), "nodes")?;
        let mut block = Vec::with_capacity(many);
        for _ in 0..many {
            block.push(cursor.size()?);
        }
        for tag in block {
            tags.push(tag);
            mesh.points.push(point(cursor, scale, tag)?);
            if parametric {
                cursor.skip_reals(dimension.clamp(0, 3) as usize)?;
            }
        }
    }
    check_all(cursor, mesh.points.len(), count, "nodes")?;
    tags.index(cursor)
}

/// `$Elements`.
pub(super) fn elements(
    cursor: &mut Cursor,
    entities: &Entities,
    mesh: &mut RawMesh,
    tags: &NodeTags,
) -> Result<(), ReadError> {
    let blocks = cursor.count("blocks of elements", 4)?;
    let count = cursor.count("elements", 2)?;
    cursor.size()?;
    cursor.size()?;
    let mut read = 0;
    for _ in 0..blocks {
        let dimension = cursor.int()?;
        let entity = cursor.int()?;
        // Other programs leave entities out: their elements lie in no group, and named groups that are empty for it
        // are noted when the mesh is built.
        let groups = entities.get(&(dimension, entity)).map_or(&[][..], Vec::as_slice);
        let number = cursor.int()?;
        let many = cursor.count("elements in a block", 2)?;
        check_left(cursor, many, count - read, "elements")?;
        read += many;
        // Empty blocks of foreign types do no harm.
        if many == 0 {
            continue;
        }
        let element = element_type(cursor, i64::from(number))?;
        let mut nodes = [0; 27];
        let nodes = &mut nodes[..element.nodes()];
        for _ in 0..many {
            let tag = cursor.size()?;
            for entry in nodes.iter_mut() {
                let named = cursor.size()?;
                *entry = node(cursor, tags, tag, named)?;
            }
            push(mesh, element, groups, nodes, tag);
        }
    }
    check_all(cursor, read, count, "elements")
}

fn check_left(cursor: &Cursor, many: usize, left: usize, of: &str) -> Result<(), ReadError> {
    if many > left {
        return Err(cursor.malformed(
            format!("a block claims {many} {of}, but only {left} of the section's are left"),
            "the file is truncated or corrupt: write it again from Gmsh",
        ));
    }
    Ok(())
}

fn check_all(cursor: &Cursor, read: usize, count: usize, of: &str) -> Result<(), ReadError> {
    if read != count {
        return Err(cursor.malformed(
            format!("the section claims {count} {of}, its blocks hold {read}"),
            "the file is truncated or corrupt: write it again from Gmsh",
        ));
    }
    Ok(())
}
