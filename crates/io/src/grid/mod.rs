//! Unstructured grids of VTK: what its XML and its legacy format have in common.

mod array;
mod cells;
mod groups;

use nastic_mesh::RawMesh;

use crate::error::ReadError;
use crate::source::Source;

pub(crate) use array::{GridArray, Numbers};
pub(crate) use cells::{LagrangeOrder, ListedCell, Refused, cell};
pub(crate) use groups::{GHOSTS, NODES, REGION, SURFACE, TAGS, is_group};

/// What to do with a file that breaks its format.
pub(crate) const CORRUPT: &str = "the file is truncated or corrupt: write it again";
/// What to do with cells that are not taken.
pub(crate) const OTHER_CELLS: &str = "use triangles, quadrangles, tetrahedra or hexahedra of first or second order";

/// A grid as a file has it.
pub(crate) struct Grid<'a> {
    pub source: Source<'a>,
    pub points: Vec<[f64; 3]>,
    pub cells: Vec<ListedCell>,
    /// Field arrays that name groups, see [`is_group`].
    pub groups: Vec<GridArray>,
    /// The cell array that numbers groups: one of [`TAGS`].
    pub tags: Option<GridArray>,
    /// The cell array [`GHOSTS`].
    pub ghosts: Option<GridArray>,
}

/// A mesh, with what its elements are in the file.
pub(crate) struct GridMesh {
    pub raw: RawMesh,
    /// The cell of the file, by element.
    pub file_cells: Vec<u32>,
}

impl Grid<'_> {
    /// The mesh with its groups, without ghosts.
    pub fn mesh(mut self) -> Result<GridMesh, ReadError> {
        let ghosts = groups::ghosts(&self)?;
        let mut raw = RawMesh { points: std::mem::take(&mut self.points), ..RawMesh::default() };
        let tags = groups::region_tags(&self, &mut raw)?;
        let mut file_cells = Vec::with_capacity(self.cells.len());
        for (k, (cell, tags)) in self.cells.iter().zip(&tags).enumerate() {
            match cell.kind {
                _ if ghosts.get(k) == Some(&true) => {}
                Some(kind) => {
                    raw.push_labelled(kind, &cell.nodes, tags, k as u64);
                    file_cells.push(k as u32);
                }
                None => raw.vertices.extend(tags.iter().map(|tag| (cell.nodes[0], *tag))),
            }
        }
        groups::surfaces_and_nodes(&self, &ghosts, &mut raw)?;
        let left_out = ghosts.iter().filter(|ghost| **ghost).count();
        if left_out > 0 {
            raw.notes.push(format!(
                "{left_out} ghost cells (array \"{GHOSTS}\": copies of other parts, or hidden) left out"
            ));
        }
        Ok(GridMesh { raw, file_cells })
    }
}
