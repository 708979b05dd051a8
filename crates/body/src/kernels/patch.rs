//! [`Patch`]: cells that a formulation takes together.

use crate::discretization::quadrature_points::CellGroup;
use crate::structure::{TangentStructure, map_of_coupled};
use nastic_linear::{Pattern, StructureError};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Cells of one kind whose deformation gradients depend on each other: one cell by itself, or several of [`patches`].
///
/// What has a value per cell (shape gradients, rows, matrices) or per point has those of the cells one after the other.
///
/// [`patches`]: nastic_mesh::Mesh::patches
#[derive(Debug, Clone, Copy)]
pub struct Patch<'a> {
    /// The numbers of the cells in their group.
    pub cells: &'a [u32],
    /// Of several cells: how many distinct nodes there are.
    pub nodes: usize,
    /// Of several cells: the number, among those, of every node of every cell.
    pub local: &'a [u32],
    /// Of several cells: where it is among which.
    of: Option<(&'a Patches, usize)>,
}

impl<'a> Patch<'a> {
    /// A cell by itself.
    pub fn single(cell: &'a u32) -> Self {
        Patch { cells: std::slice::from_ref(cell), nodes: 0, local: &[], of: None }
    }

    /// Of several cells: the scatter map of the distinct nodes in the pattern of the tangent.
    pub fn map(&self, pattern: &Pattern) -> &'a [u32] {
        self.of.map_or(&[], |(patches, k)| patches.maps(pattern).get(k))
    }
}

/// The patches of a group of cells, in the order of their first cells.
#[derive(Debug, Clone, Default)]
pub(crate) struct Patches {
    cells: Lists,
    nodes: Lists,
    local: Lists,
    /// Scatter maps, made with the first tangent.
    maps: OnceLock<Lists>,
}

impl Patches {
    /// Every cell by itself.
    pub fn of_single_cells(group: &CellGroup) -> Self {
        let mut patches = Self::default();
        for c in 0..group.cells.len() as u32 {
            patches.push(&[c], [&[], &[]]);
        }
        patches
    }

    fn push(&mut self, cells: &[u32], [nodes, local]: [&[u32]; 2]) {
        self.cells.push(cells);
        self.nodes.push(nodes);
        self.local.push(local);
    }

    fn maps(&self, pattern: &Pattern) -> &Lists {
        self.maps.get_or_init(|| {
            let mut maps = Lists::default();
            (0..self.len()).for_each(|k| maps.push(&map_of_coupled(pattern, self.nodes.get(k))));
            maps
        })
    }

    /// The cells with the same number in `of_cell` (by cell of the mesh) together; those for which there is none by themselves.
    ///
    /// # Errors
    /// [`StructureError::NotCoupled`]: a structure in which nodes of a patch are not coupled.
    pub fn new(
        group: &CellGroup,
        of_cell: impl Fn(u32) -> Option<u32>,
        structure: &TangentStructure,
    ) -> Result<Self, StructureError> {
        let (mut members, mut known): (Vec<Vec<u32>>, BTreeMap<u32, usize>) = Default::default();
        for (c, &cell) in group.cells.iter().enumerate() {
            let new = members.len();
            let place = of_cell(cell).map_or(new, |patch| *known.entry(patch).or_insert(new));
            match members.get_mut(place) {
                Some(patch) => patch.push(c as u32),
                None => members.push(vec![c as u32]),
            }
        }
        let mut patches = Self::default();
        for cells in members {
            let several = cells.len() > 1;
            let of_cells = || cells.iter().filter(|_| several).flat_map(|&c| group.nodes_of(c as usize));
            let mut nodes: Vec<u32> = of_cells().copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            let local: Vec<u32> = of_cells().map(|node| nodes.partition_point(|n| n < node) as u32).collect();
            structure.check_coupled(&nodes)?;
            patches.push(&cells, [&nodes, &local]);
        }
        Ok(patches)
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// The k-th.
    pub fn get(&self, k: usize) -> Patch<'_> {
        let (cells, nodes) = (self.cells.get(k), self.nodes.get(k).len());
        Patch { cells, nodes, local: self.local.get(k), of: Some((self, k)) }
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = Patch<'_>> {
        (0..self.len()).map(|k| self.get(k))
    }
}

/// Lists of numbers, one after the other.
#[derive(Debug, Clone, Default)]
struct Lists {
    ends: Vec<usize>,
    all: Vec<u32>,
}

impl Lists {
    fn push(&mut self, list: &[u32]) {
        self.all.extend_from_slice(list);
        self.ends.push(self.all.len());
    }

    fn len(&self) -> usize {
        self.ends.len()
    }

    fn get(&self, k: usize) -> &[u32] {
        let first = if k == 0 { 0 } else { self.ends[k - 1] };
        &self.all[first..self.ends[k]]
    }
}
