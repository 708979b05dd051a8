//! Sections of format 2.2.

use nastic_mesh::RawMesh;

use super::content::{NodeTags, element_type, node, point, push};
use super::cursor::Cursor;
use crate::error::ReadError;

/// `$Nodes`, and `$ParametricNodes` with the parameters dropped.
pub(super) fn nodes(
    cursor: &mut Cursor,
    parametric: bool,
    scale: f64,
    mesh: &mut RawMesh,
    tags: &mut NodeTags,
) -> Result<(), ReadError> {
    let count = cursor.text_count("nodes", if cursor.is_binary() { 4 + 3 * 8 } else { 8 })?;
    mesh.points.reserve(count);
    tags.reserve(count);
    for _ in 0..count {
        let tag = cursor.tag("node tag")?;
        tags.push(tag);
        mesh.points.push(point(cursor, scale, tag)?);
        if parametric {
            let dimension = cursor.int()?;
            let _entity = cursor.int()?;
            // A point has no parameter, a volume keeps none.
            cursor.skip_reals(if (1..=2).contains(&dimension) { dimension as usize } else { 0 })?;
        }
    }
    tags.index(cursor)
}

/// `$Elements`.
pub(super) fn elements(cursor: &mut Cursor, mesh: &mut RawMesh, tags: &NodeTags) -> Result<(), ReadError> {
    let count = cursor.text_count("elements", 8)?;
    if !cursor.is_binary() {
        for _ in 0..count {
            let tag = cursor.tag("element tag")?;
            let number = cursor.int()?;
            let attributes = attributes(cursor)?;
            element(cursor, tag, number, attributes, mesh, tags)?;
        }
        return Ok(());
    }
    let mut read = 0;
    while read < count {
        let number = cursor.int()?;
        let many = cursor.tag("number of elements in a block")? as usize;
        let attributes = attributes(cursor)?;
        if many == 0 || many > count - read {
            return Err(cursor.malformed(
                format!("a block claims {many} elements where {} of {count} are left", count - read),
                "the file is truncated or corrupt: write it again from Gmsh",
            ));
        }
        for _ in 0..many {
            let tag = cursor.tag("element tag")?;
            element(cursor, tag, number, attributes, mesh, tags)?;
        }
        read += many;
    }
    Ok(())
}

/// Number of integers between an element's tag and type and its nodes.
fn attributes(cursor: &mut Cursor) -> Result<usize, ReadError> {
    /// Physical group, entity, partitions: more than this is not a mesh.
    const MOST: i32 = 1 << 16;
    let attributes = cursor.int()?;
    if !(0..=MOST).contains(&attributes) {
        return Err(cursor.malformed(
            format!("an element claims {attributes} tags"),
            "the file is truncated or corrupt: write it again from Gmsh",
        ));
    }
    Ok(attributes as usize)
}

fn element(
    cursor: &mut Cursor,
    tag: u64,
    number: i32,
    attributes: usize,
    mesh: &mut RawMesh,
    tags: &NodeTags,
) -> Result<(), ReadError> {
    let element = element_type(cursor, i64::from(number))?;
    let mut group = 0;
    for at in 0..attributes {
        let attribute = cursor.int()?;
        if at == 0 {
            // The sign shows the orientation of the geometry, which the nodes show too.
            group = attribute.saturating_abs();
        }
    }
    let mut nodes = [0; 27];
    let nodes = &mut nodes[..element.nodes()];
    for entry in nodes.iter_mut() {
        let named = cursor.tag("node tag")?;
        *entry = node(cursor, tags, tag, named)?;
    }
    let groups = if group == 0 { &[][..] } else { &[group][..] };
    push(mesh, element, groups, nodes, tag);
    Ok(())
}
