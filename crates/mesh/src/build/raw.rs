//! What readers and generators produce: elements as a file lists them, unchecked.

use crate::CellKind;
use std::collections::BTreeMap;

/// Elements of one kind that bear the same tags.
#[derive(Clone, Debug, PartialEq)]
pub struct RawBlock {
    /// Kind of all its elements.
    pub kind: CellKind,
    /// The groups every element of the block belongs to (Gmsh: physical groups); may be empty. 0 means no group;
    /// a negative tag is a group of its own (Gmsh's minus sign, a reversed orientation, is the reader's to drop).
    pub tags: Vec<i32>,
    /// Nodes of all elements in VTK's order, as indices into [`RawMesh::points`].
    pub nodes: Vec<u32>,
    /// Numbers of the elements in the file, for messages; empty to count elements from 0 through all blocks.
    pub labels: Vec<u64>,
}

/// A mesh as read: volume cells, surface elements, curves and vertices with group tags, and names for those.
///
/// Cells are the elements of the highest dimension present (3 or 2); those of one dimension less are parts of surfaces,
/// the rest and the vertices make node sets.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// File name, for messages.
    pub name: String,
    /// Node positions.
    pub points: Vec<[f64; 3]>,
    /// Numbers of the nodes in the file, for messages; empty to count from 0.
    pub node_labels: Vec<u64>,
    /// Elements of every dimension.
    pub blocks: Vec<RawBlock>,
    /// Single nodes with the tag of their group of dimension 0.
    pub vertices: Vec<(u32, i32)>,
    /// Names of groups by (dimension, tag). A group without a name is called by its tag.
    pub names: BTreeMap<(usize, i32), String>,
    /// What the reader left out or mended: the first of [`Mesh::notes`](crate::Mesh::notes).
    pub notes: Vec<String>,
}

impl RawMesh {
    /// An empty raw mesh.
    pub fn new(name: impl Into<String>) -> RawMesh {
        RawMesh { name: name.into(), ..RawMesh::default() }
    }

    /// Adds an element to the last block if that has the same kind and tags and no labels, else to a new block.
    pub fn push(&mut self, kind: CellKind, nodes: &[u32], tags: &[i32]) {
        self.block(kind, tags, false).nodes.extend_from_slice(nodes);
    }

    /// Adds an element that bears a number in its file. Either all elements have one or none should.
    pub fn push_labelled(&mut self, kind: CellKind, nodes: &[u32], tags: &[i32], label: u64) {
        let block = self.block(kind, tags, true);
        block.nodes.extend_from_slice(nodes);
        block.labels.push(label);
    }

    /// Names a group.
    pub fn name_group(&mut self, dim: usize, tag: i32, name: impl Into<String>) {
        self.names.insert((dim, tag), name.into());
    }

    /// Multiplies all coordinates, for instance by 1e-3 for a drawing in millimetres.
    pub fn scale(&mut self, factor: f64) {
        self.points.iter_mut().flatten().for_each(|x| *x *= factor);
    }

    fn block(&mut self, kind: CellKind, tags: &[i32], labelled: bool) -> &mut RawBlock {
        let fits = |b: &RawBlock| b.kind == kind && b.tags == tags && b.labels.is_empty() != labelled;
        if !self.blocks.last().is_some_and(fits) {
            self.blocks.push(RawBlock { kind, tags: tags.to_vec(), nodes: Vec::new(), labels: Vec::new() });
        }
        let last = self.blocks.len() - 1;
        &mut self.blocks[last]
    }

    /// Every element in file order.
    pub(super) fn elements(&self) -> impl Iterator<Item = Element<'_>> {
        let mut position = 0;
        self.blocks.iter().flat_map(move |block| {
            let first = position;
            position += (block.nodes.len() / block.kind.nodes()) as u32;
            block.nodes.chunks_exact(block.kind.nodes()).enumerate().map(move |(k, nodes)| {
                let position = first + k as u32;
                let label = block.labels.get(k).copied().unwrap_or(u64::from(position));
                Element { kind: block.kind, nodes, tags: &block.tags, position, label }
            })
        })
    }

    /// The number of a node in the file.
    pub(super) fn node_label(&self, node: u32) -> u64 {
        self.node_labels.get(node as usize).copied().unwrap_or(u64::from(node))
    }

    /// What a group is called: its name, else its tag.
    pub(super) fn group_name(&self, dim: usize, tag: i32) -> String {
        match self.names.get(&(dim, tag)) {
            Some(name) if !name.trim().is_empty() => name.clone(),
            _ => tag.to_string(),
        }
    }
}

/// One element of a raw mesh.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    pub kind: CellKind,
    pub nodes: &'a [u32],
    pub tags: &'a [i32],
    /// Position among all elements.
    pub position: u32,
    /// Number in the file.
    pub label: u64,
}
