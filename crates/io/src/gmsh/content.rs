//! Contents common to both formats: nodes by tag, elements by type.

use nastic_mesh::RawMesh;

use super::cursor::Cursor;
use super::element::ElementType;
use crate::error::ReadError;

/// Adds one element to the mesh; `nodes` in Gmsh's order, groups by their physical tags.
pub(super) fn push(mesh: &mut RawMesh, element: ElementType, groups: &[i32], nodes: &[u32], label: u64) {
    match element {
        ElementType::Point => mesh.vertices.extend(groups.iter().map(|group| (nodes[0], *group))),
        ElementType::Cell(kind, []) => mesh.push_labelled(kind, nodes, groups, label),
        ElementType::Cell(kind, order) => {
            let mut permuted = [0; 27];
            for (entry, from) in permuted.iter_mut().zip(order) {
                *entry = nodes[usize::from(*from)];
            }
            mesh.push_labelled(kind, &permuted[..kind.nodes()], groups, label);
        }
        ElementType::Foreign(_) => {}
    }
}

/// Where each node tag went: tags may be sparse and come in any order.
#[derive(Default)]
pub(super) struct NodeTags {
    tags: Vec<u64>,
    /// `dense[tag - first]` is the index plus one, zero when there is no such node.
    dense: Vec<u32>,
    first: u64,
    /// Used when tags are too sparse for a table: sorted pairs of tag and index.
    sorted: Vec<(u64, u32)>,
}

impl NodeTags {
    pub fn reserve(&mut self, more: usize) {
        self.tags.reserve(more);
    }

    pub fn push(&mut self, tag: u64) {
        self.tags.push(tag);
    }

    /// Builds the table once all nodes are known.
    pub fn index(&mut self, cursor: &Cursor) -> Result<(), ReadError> {
        let count = self.tags.len();
        if u32::try_from(count).is_err() {
            return Err(cursor.unsupported(format!("a mesh of {count} nodes"), "use at most 4,294,967,295 nodes"));
        }
        self.first = self.tags.iter().copied().min().unwrap_or(0);
        let span = self.tags.iter().map(|tag| tag - self.first).max().unwrap_or(0);
        let twice =
            if span < 4 * count as u64 + 1024 { self.index_dense(span as usize + 1) } else { self.index_sorted() };
        match twice {
            Some(tag) => Err(cursor.malformed(
                format!("node {tag} is defined twice"),
                "give every node a tag of its own, or write the file again from Gmsh",
            )),
            None => Ok(()),
        }
    }

    fn index_dense(&mut self, span: usize) -> Option<u64> {
        self.dense = vec![0; span];
        for (index, tag) in self.tags.iter().enumerate() {
            let slot = &mut self.dense[(tag - self.first) as usize];
            if *slot != 0 {
                return Some(*tag);
            }
            *slot = index as u32 + 1;
        }
        None
    }

    fn index_sorted(&mut self) -> Option<u64> {
        self.sorted = self.tags.iter().enumerate().map(|(index, tag)| (*tag, index as u32)).collect();
        self.sorted.sort_unstable();
        self.sorted.windows(2).find(|pair| pair[0].0 == pair[1].0).map(|pair| pair[0].0)
    }

    /// Tags in the order of the points.
    pub fn into_labels(self) -> Vec<u64> {
        self.tags
    }

    /// The index of a node by its tag.
    pub fn find(&self, tag: u64) -> Option<u32> {
        if self.sorted.is_empty() {
            let slot = tag.checked_sub(self.first).and_then(|at| self.dense.get(usize::try_from(at).ok()?))?;
            return slot.checked_sub(1);
        }
        let at = self.sorted.binary_search_by_key(&tag, |pair| pair.0).ok()?;
        Some(self.sorted[at].1)
    }
}

/// The element type by its number, or the error that names it.
pub(super) fn element_type(cursor: &Cursor, number: i64) -> Result<ElementType, ReadError> {
    match ElementType::of(number) {
        Some(ElementType::Foreign(name)) => Err(cursor.unsupported(
            format!("{name} (Gmsh element type {number})"),
            "mesh with triangles, quadrangles, tetrahedra or hexahedra of first or second order",
        )),
        Some(element) => Ok(element),
        None => Err(cursor.malformed(
            format!("there is no Gmsh element type {number}"),
            "the file is truncated or corrupt: write it again from Gmsh",
        )),
    }
}

/// A point, scaled; refuses what is not finite.
pub(super) fn point(cursor: &mut Cursor, scale: f64, node: u64) -> Result<[f64; 3], ReadError> {
    let mut point = [0.0; 3];
    for (entry, axis) in point.iter_mut().zip(["x", "y", "z"]) {
        let value = cursor.real()?;
        *entry = value * scale;
        if !entry.is_finite() {
            let at = if node == 0 { "a node".to_owned() } else { format!("node {node}") };
            return Err(cursor.malformed(
                format!("{axis} of {at} is {value}"),
                "coordinates must be finite: check the geometry, and write the file again from Gmsh",
            ));
        }
    }
    Ok(point)
}

/// The index of a node that an element names.
pub(super) fn node(cursor: &Cursor, tags: &NodeTags, element: u64, tag: u64) -> Result<u32, ReadError> {
    tags.find(tag).ok_or_else(|| {
        cursor.malformed(
            format!("element {element} names node {tag}, which the file does not define"),
            "check the element's node list, or write the file again from Gmsh",
        )
    })
}
