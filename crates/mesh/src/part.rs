//! [`Part`]: some cells of a mesh as a mesh of its own.

use crate::{CellBlock, Facet, Mesh, MeshError, geometry};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// One of several parts into which the cells of a mesh are divided, `Omega = union_p Omega_p`: every cell is in one part, nodes between parts are in each
/// of these, and belong to the lowest of them.
///
/// Its mesh has all names of the whole, some of them of nothing; its skin is the share of the whole's skin. Nodes that belong to it come first, both
/// these and the others in the order of the whole; cells stay in theirs. What it cannot know by its cells alone, it keeps of the whole.
///
/// It may have [further nodes](Mesh::part_reaching) without cells of its own, which belong to parts with cells there.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    mesh: Arc<Mesh>,
    nodes: Vec<u32>,
    cells: Vec<u32>,
    owned: usize,
    sharers: Vec<(usize, Vec<u32>)>,
    surface_nodes: BTreeMap<String, Vec<u32>>,
    bounds: ([f64; 3], [f64; 3]),
    pieces: Vec<u32>,
    piece_bounds: Vec<([f64; 3], [f64; 3])>,
    further: Vec<(u32, u32)>,
    outer_faces: Vec<(Facet, u32)>,
    patches: Vec<u32>,
    /// Patches that are cut, each with another part that has some of its cells.
    cut_patches: BTreeMap<u32, u32>,
}

impl Part {
    /// Its cells as a mesh.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// The number of every node in the whole.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// The number of every cell in the whole, ascending.
    pub fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// How many nodes belong to it: the first ones.
    pub fn owned(&self) -> usize {
        self.owned
    }

    /// The parts that have nodes of it, ascending, each with these in the order of the whole: both sides of a pair see the same ones.
    pub fn sharers(&self) -> &[(usize, Vec<u32>)] {
        &self.sharers
    }

    /// Its nodes on a surface of the whole, ascending: also those whose facets are all in other parts.
    ///
    /// # Errors
    /// [`MeshError::UnknownName`].
    pub fn nodes_of_surface(&self, name: &str) -> Result<&[u32], MeshError> {
        self.mesh.surface(name)?;
        Ok(self.surface_nodes.get(name).map_or(&[], Vec::as_slice))
    }

    /// Diagonal of the bounding box of the whole.
    pub fn diagonal(&self) -> f64 {
        geometry::norm(&geometry::minus(&self.bounds.1, &self.bounds.0))
    }

    /// Faces of its cells to cells of higher parts, each with the number in the whole of the cell behind it: with the
    /// [`neighbours`](Mesh::neighbours) of all parts every inner face of the whole once.
    pub fn outer_faces(&self) -> &[(Facet, u32)] {
        &self.outer_faces
    }

    /// For every cell the number of the connected piece of the whole that it belongs to: [`Mesh::pieces`].
    pub fn pieces(&self) -> &[u32] {
        &self.pieces
    }

    /// Lowest and highest corner of the bounding box of every connected piece of the whole.
    pub fn piece_bounds(&self) -> &[([f64; 3], [f64; 3])] {
        &self.piece_bounds
    }

    /// Nodes of which it has no cell, each with the connected piece of the whole that it is in.
    pub fn further_nodes(&self) -> &[(u32, u32)] {
        &self.further
    }

    /// The [patch](Mesh::patches) of the whole that every cell is in, named by the first of its cells in this part.
    pub fn patches(&self) -> &[u32] {
        &self.patches
    }

    /// Another part that has cells of the patch that a cell is in; none where the whole patch is here, as after [`Mesh::with_whole_patches`].
    pub fn cuts_patch_of(&self, cell: u32) -> Option<u32> {
        self.cut_patches.get(self.patches.get(cell as usize)?).copied()
    }
}

/// Numbers of the whole as those of a part; `NONE` of what is elsewhere.
struct Numbers(Vec<u32>);

const NONE: u32 = u32::MAX;

impl Numbers {
    fn new(whole: usize, kept: &[u32]) -> Self {
        let mut numbers = vec![NONE; whole];
        kept.iter().zip(0..).for_each(|(&old, new)| numbers[old as usize] = new);
        Numbers(numbers)
    }

    fn of(&self, old: u32) -> Option<u32> {
        Some(self.0[old as usize]).filter(|new| *new != NONE)
    }

    /// Of those that it has, ascending.
    fn of_all(&self, old: &[u32]) -> Vec<u32> {
        let mut new: Vec<u32> = old.iter().filter_map(|&old| self.of(old)).collect();
        new.sort_unstable();
        new
    }

    fn of_facet(&self, facet: &Facet) -> Option<Facet> {
        self.of(facet.cell).map(|cell| Facet { cell, ..*facet })
    }
}

/// What nodes a part has.
struct Division {
    /// Those that belong to it first.
    nodes: Vec<u32>,
    owned: usize,
    /// Every other part that has one, node by node.
    shared: Vec<(u32, u32)>,
    /// Those without cells of it, ascending.
    further: Vec<u32>,
}

impl Mesh {
    /// The cells that `owners`, the part of every cell, puts into one part.
    ///
    /// # Errors
    /// [`MeshError::Part`]: not one owner per cell; no cell at all.
    pub fn part(&self, owners: &[u32], number: u32) -> Result<Part, MeshError> {
        self.part_reaching(owners, number, &[])
    }

    /// The same where some sets of nodes have to be in one part each, whatever part their cells are in: each goes to the lowest part that has a cell at
    /// its first node, as further nodes, which the parts with cells there have too. For what acts on nodes of several parts, as a spring between two of
    /// them does. All parts are given the same sets.
    ///
    /// # Errors
    /// As [`part`](Self::part); a set without nodes, or with some that the mesh does not have.
    pub fn part_reaching(&self, owners: &[u32], number: u32, sets: &[Vec<u32>]) -> Result<Part, MeshError> {
        self.check_owners(owners, number)?;
        let cells: Vec<u32> = (0..owners.len() as u32).filter(|&cell| owners[cell as usize] == number).collect();
        if cells.is_empty() {
            return Err(self.no_part(number, "it has no cells; take fewer parts".to_owned()));
        }
        let receivers = self.receivers(owners, sets).map_err(|why| self.no_part(number, why))?;
        let sets: Vec<(u32, &[u32])> = receivers.into_iter().zip(sets.iter().map(Vec::as_slice)).collect();
        let Division { nodes, owned, shared, further } = self.divided(owners, number, &cells, &sets);
        let (node_numbers, cell_numbers) =
            (Numbers::new(self.points.len(), &nodes), Numbers::new(owners.len(), &cells));
        let mut sharers: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
        for (node, other) in shared {
            sharers.entry(other as usize).or_default().extend(node_numbers.of(node));
        }
        let skin = ("skin".to_owned(), self.boundary.clone());
        let surfaces = std::iter::once(skin).chain(self.surfaces.clone());
        let on_surface =
            |(name, facets): (String, Vec<Facet>)| (name, node_numbers.of_all(&self.nodes_of_facets(&facets)));
        let outer = |(own, other): (&Facet, &Facet)| {
            let behind = owners[other.cell as usize] > number;
            cell_numbers.of_facet(own).filter(|_| behind).map(|own| (own, other.cell))
        };
        let outer_faces = self.neighbours.iter().filter_map(|(a, b)| outer((a, b)).or_else(|| outer((b, a)))).collect();
        let all_pieces = self.pieces();
        let (patches, cut_patches) = self.patches_of_part(owners, number, &cells);
        Ok(Part {
            mesh: Arc::new(self.restricted(&nodes, &cells, &node_numbers, &cell_numbers)),
            owned,
            sharers: sharers.into_iter().collect(),
            surface_nodes: surfaces.map(on_surface).collect(),
            bounds: self.bounds(),
            pieces: cells.iter().map(|&cell| all_pieces[cell as usize]).collect(),
            piece_bounds: self.piece_bounds(&all_pieces),
            further: self.pieces_of(&further, &all_pieces, &node_numbers),
            nodes,
            cells,
            outer_faces,
            patches,
            cut_patches,
        })
    }

    pub(crate) fn check_owners(&self, owners: &[u32], part: u32) -> Result<(), MeshError> {
        if owners.len() == self.cells() {
            return Ok(());
        }
        let why = format!("{} cells have {} owners; give one to each", self.cells(), owners.len());
        Err(self.no_part(part, why))
    }

    fn no_part(&self, part: u32, why: String) -> MeshError {
        MeshError::Part { mesh: self.name.clone(), part, why }
    }

    /// For every set of nodes the lowest part with a cell at its first node; otherwise what is wrong.
    fn receivers(&self, owners: &[u32], sets: &[Vec<u32>]) -> Result<Vec<u32>, String> {
        let mut lowest: BTreeMap<u32, u32> = BTreeMap::new();
        for set in sets {
            let Some(first) = set.first() else {
                return Err("a set of nodes that it may have to reach has none; leave it out".to_owned());
            };
            if let Some(node) = set.iter().find(|node| **node as usize >= self.points.len()) {
                return Err(format!(
                    "it has to reach node {node} of {}; number nodes as the whole mesh does",
                    self.points.len()
                ));
            }
            lowest.insert(*first, NONE);
        }
        if sets.is_empty() {
            return Ok(Vec::new());
        }
        for (nodes, &owner) in self.blocks.iter().flat_map(CellBlock::iter).zip(owners) {
            for node in nodes {
                lowest.entry(*node).and_modify(|lowest| *lowest = owner.min(*lowest));
            }
        }
        Ok(sets.iter().filter_map(|set| lowest.get(set.first()?).copied()).collect())
    }

    /// Nodes in the numbers of a part, each with the connected piece that it is in.
    fn pieces_of(&self, nodes: &[u32], pieces: &[u32], numbers: &Numbers) -> Vec<(u32, u32)> {
        let mut found = BTreeMap::new();
        if !nodes.is_empty() {
            for (of_cell, &piece) in self.blocks.iter().flat_map(CellBlock::iter).zip(pieces) {
                let own = of_cell.iter().filter(|node| nodes.binary_search(node).is_ok());
                found.extend(own.filter_map(|&node| Some((numbers.of(node)?, piece))));
            }
        }
        found.into_iter().collect()
    }

    /// The patches of the cells of a part, and those that are cut.
    fn patches_of_part(&self, owners: &[u32], number: u32, cells: &[u32]) -> (Vec<u32>, BTreeMap<u32, u32>) {
        if !self.may_have_patches() {
            return ((0..cells.len() as u32).collect(), BTreeMap::new());
        }
        let (all, mut first) = (self.patches(), BTreeMap::new());
        let own = |(cell, local): (&u32, u32)| *first.entry(all[*cell as usize]).or_insert(local);
        let patches = cells.iter().zip(0..).map(own).collect();
        let others = all.iter().zip(owners).filter(|(_, owner)| **owner != number);
        let cut = others.filter_map(|(patch, owner)| first.get(patch).map(|local| (*local, *owner))).collect();
        (patches, cut)
    }

    /// The nodes of a part, with sets that parts are to have whole.
    fn divided(&self, owners: &[u32], number: u32, cells: &[u32], sets: &[(u32, &[u32])]) -> Division {
        let of_cells = self.nodes_of_cells(cells);
        let reached = sets.iter().filter(|(receiver, _)| *receiver == number).flat_map(|(_, nodes)| *nodes);
        let reached: BTreeSet<u32> = reached.copied().collect();
        let further: Vec<u32> = reached.into_iter().filter(|node| of_cells.binary_search(node).is_err()).collect();
        let mut nodes = [of_cells, further.clone()].concat();
        nodes.sort_unstable();
        let own = Numbers::new(self.points.len(), &nodes);
        let at_own = |nodes: &[u32], other: u32| -> Vec<(u32, u32)> {
            nodes.iter().filter(|&&node| own.of(node).is_some()).map(|&node| (node, other)).collect()
        };
        let others = self.blocks.iter().flat_map(CellBlock::iter).zip(owners).filter(|(_, owner)| **owner != number);
        let mut shared: Vec<(u32, u32)> = others.flat_map(|(nodes, &owner)| at_own(nodes, owner)).collect();
        // of nodes without cells it is no owner
        let lower = shared.iter().filter(|(_, other)| *other < number).map(|(node, _)| node).chain(&further);
        let lower: BTreeSet<u32> = lower.copied().collect();
        let others = sets.iter().filter(|(receiver, _)| *receiver != number);
        shared.extend(others.flat_map(|(receiver, nodes)| at_own(nodes, *receiver)));
        shared.sort_unstable();
        shared.dedup();
        let (others, mut first): (Vec<u32>, Vec<u32>) = nodes.into_iter().partition(|node| lower.contains(node));
        let owned = first.len();
        first.extend(others);
        Division { nodes: first, owned, shared, further }
    }

    /// Some of its nodes and cells, with all names.
    fn restricted(&self, nodes: &[u32], cells: &[u32], of_node: &Numbers, of_cell: &Numbers) -> Mesh {
        let (mut blocks, mut first) = (Vec::new(), 0);
        for block in &self.blocks {
            let kept = block.iter().zip(block.first as u32..).filter(|(_, cell)| of_cell.of(*cell).is_some());
            let nodes: Vec<u32> =
                kept.flat_map(|(nodes, _)| nodes.iter().filter_map(|&node| of_node.of(node))).collect();
            let block = CellBlock { kind: block.kind, first, nodes };
            first += block.len();
            blocks.extend(Some(block).filter(|block| !block.is_empty()));
        }
        let facets = |all: &[Facet]| all.iter().filter_map(|facet| of_cell.of_facet(facet)).collect::<Vec<_>>();
        let sides = |(a, b): &(Facet, Facet)| of_cell.of_facet(a).zip(of_cell.of_facet(b));
        let groups = |groups: &BTreeMap<String, Vec<u32>>, numbers: &Numbers| {
            groups.iter().map(|(name, own)| (name.clone(), numbers.of_all(own))).collect()
        };
        Mesh {
            name: self.name.clone(),
            dim: self.dim,
            points: nodes.iter().map(|&node| self.points[node as usize]).collect(),
            blocks,
            regions: groups(&self.regions, of_cell),
            surfaces: self.surfaces.iter().map(|(name, own)| (name.clone(), facets(own))).collect(),
            node_sets: groups(&self.node_sets, of_node),
            boundary: facets(&self.boundary),
            neighbours: self.neighbours.iter().filter_map(sides).collect(),
            node_origin: nodes.iter().map(|&node| self.node_origin[node as usize]).collect(),
            cell_origin: cells.iter().map(|&cell| self.cell_origin[cell as usize]).collect(),
            lost_regions: self.lost_regions.clone(),
            notes: self.notes.clone(),
        }
    }

    fn piece_bounds(&self, pieces: &[u32]) -> Vec<([f64; 3], [f64; 3])> {
        let count = pieces.iter().max().map_or(0, |last| *last as usize + 1);
        let mut bounds = vec![([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]); count];
        for (nodes, &piece) in self.blocks.iter().flat_map(CellBlock::iter).zip(pieces) {
            let (low, high) = &mut bounds[piece as usize];
            for x in nodes.iter().map(|&node| &self.points[node as usize]) {
                for k in 0..3 {
                    (low[k], high[k]) = (low[k].min(x[k]), high[k].max(x[k]));
                }
            }
        }
        bounds
    }
}
