//! The mesh: nodes, blocks of cells, named regions, surfaces and node sets. Immutable once built.

use crate::build::{self, RawMesh};
use crate::{CellKind, MeshError, geometry, names};
use std::collections::BTreeMap;

/// The surface of all outer facets.
const SKIN: &str = "skin";

/// The cells of one kind, numbered consecutively.
#[derive(Clone, Debug, PartialEq)]
pub struct CellBlock {
    /// Kind of all its cells.
    pub kind: CellKind,
    /// Number of its first cell in the mesh.
    pub first: usize,
    /// Nodes of all cells, one cell after the other.
    pub nodes: Vec<u32>,
}

impl CellBlock {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.nodes.len() / self.kind.nodes()
    }

    /// Whether it has no cells; a built mesh holds no such block.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Node lists of the cells in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.nodes.chunks_exact(self.kind.nodes())
    }
}

/// One cell: its kind and its nodes in VTK's order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<'a> {
    /// Its kind.
    pub kind: CellKind,
    /// Its nodes.
    pub nodes: &'a [u32],
}

/// A face of a cell (an edge, in the plane).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// The cell.
    pub cell: u32,
    /// Which of [`CellKind::faces`].
    pub face: u8,
}

/// A checked mesh. Cells have positive volume, regions and surfaces refer to them by number, every node is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub(crate) name: String,
    pub(crate) dim: usize,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) blocks: Vec<CellBlock>,
    pub(crate) regions: BTreeMap<String, Vec<u32>>,
    pub(crate) surfaces: BTreeMap<String, Vec<Facet>>,
    pub(crate) node_sets: BTreeMap<String, Vec<u32>>,
    pub(crate) boundary: Vec<Facet>,
    pub(crate) neighbours: Vec<(Facet, Facet)>,
    pub(crate) node_origin: Vec<u32>,
    pub(crate) cell_origin: Vec<u32>,
    pub(crate) lost_regions: Vec<String>,
    pub(crate) notes: Vec<String>,
}

impl Mesh {
    /// Checks a raw mesh and makes it usable: cells of negative volume are renumbered, unused nodes dropped, repeated
    /// cells merged, surface elements matched to facets; [`Mesh::notes`] shows what was done.
    ///
    /// Cells are grouped by kind in order of appearance and keep their order otherwise. The mesh is plane if there are
    /// no volume cells. Cells, surfaces and node sets are named by `raw.names`; a bare tag 7 is called "7", tag 0 means
    /// no group. Without any group of cells, all of them form the region "body" ("ungrouped" where `raw.names` has a "body"
    /// that no cell bears, see [`Mesh::lost_regions`]).
    ///
    /// # Errors
    /// [`MeshError::Faulty`] with the [`Fault`](crate::Fault) found first.
    pub fn build(raw: RawMesh) -> Result<Mesh, MeshError> {
        build::build(&raw).map_err(|fault| MeshError::Faulty { mesh: raw.name.clone(), fault: Box::new(fault) })
    }

    /// The same mesh with another surface; one of that name is replaced. Facets that are no faces of cells are left out.
    #[must_use]
    pub fn with_surface(mut self, name: impl Into<String>, mut facets: Vec<Facet>) -> Mesh {
        let cells = self.cells();
        facets.retain(|facet| {
            let cell = facet.cell as usize;
            cell < cells && usize::from(facet.face) < self.cell(cell).kind.faces().len()
        });
        facets.sort_unstable();
        facets.dedup();
        self.surfaces.insert(name.into(), facets);
        self
    }

    /// The same mesh with another region; one of that name is replaced. Numbers that are no cells are left out.
    #[must_use]
    pub fn with_region(mut self, name: impl Into<String>, mut cells: Vec<u32>) -> Mesh {
        let all = self.cells();
        cells.retain(|cell| (*cell as usize) < all);
        cells.sort_unstable();
        cells.dedup();
        self.regions.insert(name.into(), cells);
        self
    }

    /// Its file, or "box" or "rectangle".
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The same mesh under another name.
    pub fn named(mut self, name: impl Into<String>) -> Mesh {
        self.name = name.into();
        self
    }

    /// 2 (plane, z = 0) or 3.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Reference positions of the nodes.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// Cells by kind.
    pub fn blocks(&self) -> &[CellBlock] {
        &self.blocks
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.blocks.iter().map(CellBlock::len).sum()
    }

    /// Cell number `id`.
    ///
    /// # Panics
    /// If there is no such cell, as slices do.
    pub fn cell(&self, id: usize) -> Cell<'_> {
        let block = &self.blocks[self.blocks.partition_point(|block| block.first <= id) - 1];
        let n = block.kind.nodes();
        let at = (id - block.first) * n;
        Cell { kind: block.kind, nodes: &block.nodes[at..at + n] }
    }

    /// Cells of a region, ascending.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`].
    pub fn region(&self, name: &str) -> Result<&[u32], MeshError> {
        self.look_up("region", &self.regions, name)
    }

    /// All regions. There is at least one.
    pub fn regions(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.regions
    }

    /// Facets of a surface, ascending; `skin`, where the mesh gives no other this name, are those that belong to one cell only.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`].
    pub fn surface(&self, name: &str) -> Result<&[Facet], MeshError> {
        match self.look_up("surface", &self.surfaces, name) {
            Err(_) if name == SKIN => Ok(&self.boundary),
            found => found,
        }
    }

    /// All surfaces. In the plane these are the named curves.
    pub fn surfaces(&self) -> &BTreeMap<String, Vec<Facet>> {
        &self.surfaces
    }

    /// Nodes of a node set (a named vertex, or a named curve in space), ascending.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`].
    pub fn node_set(&self, name: &str) -> Result<&[u32], MeshError> {
        self.look_up("node set", &self.node_sets, name)
    }

    /// All node sets.
    pub fn node_sets(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.node_sets
    }

    fn look_up<'a, T>(
        &self,
        what: &'static str,
        map: &'a BTreeMap<String, Vec<T>>,
        name: &str,
    ) -> Result<&'a [T], MeshError> {
        map.get(name).map(Vec::as_slice).ok_or_else(|| MeshError::UnknownName {
            what,
            name: name.to_owned(),
            mesh: self.name.clone(),
            known: map.keys().cloned().collect(),
            nearest: names::nearest(name, map.keys().map(String::as_str)).map(str::to_owned),
        })
    }

    /// Facets that belong to one cell only, ascending: the skin of the body.
    pub fn boundary(&self) -> &[Facet] {
        &self.boundary
    }

    /// The two sides of every inner facet, each pair and the list ascending.
    pub fn neighbours(&self) -> &[(Facet, Facet)] {
        &self.neighbours
    }

    /// Kind and nodes of a facet, with outward orientation.
    ///
    /// # Panics
    /// If there is no such facet, as slices do.
    pub fn facet_nodes(&self, facet: Facet) -> (CellKind, Vec<u32>) {
        let cell = self.cell(facet.cell as usize);
        let (kind, local) = cell.kind.faces()[facet.face as usize];
        (kind, local.iter().map(|&a| cell.nodes[a]).collect())
    }

    /// Nodes that lie on any of the facets, ascending.
    pub fn nodes_of_facets(&self, facets: &[Facet]) -> Vec<u32> {
        distinct(facets.iter().flat_map(|&facet| self.facet_nodes(facet).1))
    }

    /// Nodes of any of the cells, ascending.
    pub fn nodes_of_cells(&self, cells: &[u32]) -> Vec<u32> {
        distinct(cells.iter().flat_map(|&id| self.cell(id as usize).nodes.iter().copied()))
    }

    /// Nodes that are a corner of some cell, ascending.
    pub fn corner_nodes(&self) -> Vec<u32> {
        let corners = |block: &CellBlock| block.kind.corners();
        distinct(
            self.blocks.iter().flat_map(|block| block.iter().flat_map(|nodes| nodes[..corners(block)].iter().copied())),
        )
    }

    /// Positions of a cell's nodes, taken from `positions` (reference or deformed, one entry per node of the mesh).
    pub fn gather(&self, positions: &[[f64; 3]], nodes: &[u32]) -> Vec<[f64; 3]> {
        nodes.iter().map(|&node| positions[node as usize]).collect()
    }

    /// Lowest and highest corner of the bounding box.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        geometry::bounds(&self.points)
    }

    /// Extent along each axis; z is 0 in the plane.
    pub fn size(&self) -> [f64; 3] {
        let (low, high) = self.bounds();
        geometry::minus(&high, &low)
    }

    /// Diagonal of the bounding box.
    pub fn diagonal(&self) -> f64 {
        geometry::norm(&self.size())
    }

    /// Where each node stood in the [`RawMesh`] (nodal arrays of the same file are in that order).
    pub fn node_origin(&self) -> &[u32] {
        &self.node_origin
    }

    /// Where each cell stood among all elements of the [`RawMesh`], blocks one after the other, elements of every
    /// dimension counted.
    pub fn cell_origin(&self) -> &[u32] {
        &self.cell_origin
    }

    /// Names that the file lists for regions, where no cell bears any of them: its writer lost the groups of elements.
    pub fn lost_regions(&self) -> &[String] {
        &self.lost_regions
    }

    /// What was mended or looked odd when the mesh was built.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

fn distinct(nodes: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut nodes: Vec<u32> = nodes.collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
