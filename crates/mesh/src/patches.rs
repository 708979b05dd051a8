//! Patches of linear simplices: cells that share one mean dilatation.

use crate::{CellKind, Mesh, MeshError};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

impl Mesh {
    /// The patch of every cell, named by the first of its cells. Patches are sets of linear simplices (tri3, tet4) that are connected by
    /// facets; cells of other kinds are by themselves.
    ///
    /// Most patches are stars: all cells at a node. One star after the other is cut, of the cells at a node that have no patch and are connected: the one of
    /// the most cells, of several the one with the most facets to earlier patches, of those the one of the first node. A star has at
    /// least three quarters of the cells that there are at its nodes on average. Cells that are left are joined to patches beside them, the smallest of which takes
    /// the next one. Patches end where regions do: laws act on whole patches.
    ///
    /// Why stars, and why close to each other: in a regular mesh most nodes between stars belong to d + 1 of them. Such a node moves volume from any of
    /// these to any other, so that displacements determine all pressures (the macroelement condition). Smaller patches, or stars in the order of
    /// nodes, have inf-sup values that fall with the mesh (docs/development/verification.md).
    ///
    /// Sources: de Souza Neto, Andrade Pires, Owen, "F-bar-based linear triangles and tetrahedra for finite strain analysis of nearly incompressible
    /// solids", IJNME 62 (2005): patches, there of two triangles or eight tetrahedra. Stenberg, "Analysis of mixed finite element methods for the
    /// Stokes problem: a unified approach", Math. Comp. 42 (1984): the condition.
    pub fn patches(&self) -> Vec<u32> {
        let mut division = Division::of(self);
        for (class, cells) in classes(self).values().enumerate() {
            cells.iter().for_each(|&cell| division.class[cell as usize] = class as u32);
            division.cut_stars(self, class as u32, cells);
            division.join(cells);
        }
        division.by_first_cell()
    }

    /// The part of every cell where no [patch](Self::patches) is cut: each goes to the part that has most of its cells, of several the lowest. A part
    /// that has the most of none takes, of the patches that it has cells of, the one with most of these from a part that has others.
    ///
    /// # Errors
    /// [`MeshError::Part`]: not one owner per cell.
    pub fn with_whole_patches(&self, owners: &[u32]) -> Result<Vec<u32>, MeshError> {
        self.check_owners(owners, 0)?;
        let patches = self.patches();
        let mut of_patch: BTreeMap<u32, BTreeMap<u32, usize>> = BTreeMap::new();
        for (&patch, &owner) in patches.iter().zip(owners) {
            *of_patch.entry(patch).or_default().entry(owner).or_default() += 1;
        }
        let most = |counts: &BTreeMap<u32, usize>| {
            counts.iter().max_by_key(|(owner, count)| (**count, Reverse(**owner))).map(|(owner, _)| *owner)
        };
        let mut whole: BTreeMap<u32, u32> =
            of_patch.iter().filter_map(|(patch, counts)| Some((*patch, most(counts)?))).collect();
        let mut held: BTreeMap<u32, usize> = owners.iter().map(|owner| (*owner, 0)).collect();
        whole.values().for_each(|owner| *held.entry(*owner).or_default() += 1);
        let without: Vec<u32> = held.iter().filter(|(_, count)| **count == 0).map(|(owner, _)| *owner).collect();
        for owner in without {
            let taken = of_patch.iter().filter_map(|(patch, counts)| {
                let (count, holder) = (counts.get(&owner)?, whole.get(patch)?);
                (held.get(holder)? > &1).then_some((*count, Reverse(*patch), *holder))
            });
            if let Some((_, Reverse(patch), holder)) = taken.max() {
                whole.insert(patch, owner);
                *held.entry(holder).or_default() -= 1;
                *held.entry(owner).or_default() += 1;
            }
        }
        Ok(patches.iter().zip(owners).map(|(patch, own)| whole.get(patch).copied().unwrap_or(*own)).collect())
    }

    /// Whether some of its cells may be in a [patch](Self::patches) with others.
    pub(crate) fn may_have_patches(&self) -> bool {
        self.blocks().iter().any(|block| in_patches(block.kind))
    }
}

fn in_patches(kind: CellKind) -> bool {
    matches!(kind, CellKind::Tri3 | CellKind::Tet4)
}

/// The linear simplices by the block and the regions they are in.
fn classes(mesh: &Mesh) -> BTreeMap<(usize, Vec<usize>), Vec<u32>> {
    let mut regions = vec![Vec::new(); mesh.cells()];
    for (region, cells) in mesh.regions().values().enumerate() {
        cells.iter().for_each(|&cell| regions[cell as usize].push(region));
    }
    let mut classes: BTreeMap<_, Vec<u32>> = BTreeMap::new();
    let blocks = mesh.blocks().iter().enumerate();
    let of_cells = blocks.flat_map(|(number, block)| block.iter().map(move |_| (number, block.kind)));
    for (cell, ((block, kind), regions)) in of_cells.zip(regions).enumerate() {
        if in_patches(kind) {
            classes.entry((block, regions)).or_default().push(cell as u32);
        }
    }
    classes
}

/// No patch yet, no class.
const NONE: u32 = u32::MAX;

/// Cells at a node that could be a patch, ranked.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Star {
    cells: usize,
    /// Towards patches.
    facets: usize,
    node: Reverse<u32>,
}

struct Division {
    /// By cell: a number of its patch.
    patch: Vec<u32>,
    /// By cell: which cells may be in one patch.
    class: Vec<u32>,
    /// Cells beyond the facets of each cell.
    neighbours: Vec<Vec<u32>>,
    /// Cells at each node, ascending.
    around: Vec<Vec<u32>>,
}

impl Division {
    fn of(mesh: &Mesh) -> Self {
        let mut neighbours = vec![Vec::new(); mesh.cells()];
        for (one, other) in mesh.neighbours() {
            neighbours[one.cell as usize].push(other.cell);
            neighbours[other.cell as usize].push(one.cell);
        }
        let mut around = vec![Vec::new(); mesh.points().len()];
        for cell in 0..mesh.cells() {
            mesh.cell(cell).nodes.iter().for_each(|&node| around[node as usize].push(cell as u32));
        }
        Self { patch: vec![NONE; mesh.cells()], class: vec![NONE; mesh.cells()], neighbours, around }
    }

    /// Cuts stars out of the cells of a class.
    fn cut_stars(&mut self, mesh: &Mesh, class: u32, cells: &[u32]) {
        let mut stars: BinaryHeap<Star> = BinaryHeap::new();
        let mut changed = mesh.nodes_of_cells(cells);
        loop {
            let looked_at = changed.iter().map(|&node| self.star(node, class).0);
            stars.extend(looked_at.filter(|star| star.cells > 0 && self.is_large(mesh, star, class)));
            // those that have lost cells since are in the queue again with their present size
            let current = |best: Star| Some(self.star(best.node.0, class)).filter(|(star, _)| *star == best);
            let Some((_, cells)) = std::iter::from_fn(|| stars.pop()).find_map(current) else { return };
            cells.iter().for_each(|&cell| self.patch[cell as usize] = cells[0]);
            let beside = cells.iter().flat_map(|&cell| &self.neighbours[cell as usize]);
            changed = mesh.nodes_of_cells(&beside.chain(&cells).copied().collect::<Vec<u32>>());
        }
    }

    /// Whether a star has three quarters of the cells that there are at its nodes on average.
    fn is_large(&self, mesh: &Mesh, star: &Star, class: u32) -> bool {
        let at_node = |node: u32| {
            let around = self.around[node as usize].iter().copied();
            around.filter(|&cell| self.class[cell as usize] == class).collect::<Vec<u32>>()
        };
        let nodes = mesh.nodes_of_cells(&at_node(star.node.0));
        let sum: usize = nodes.iter().map(|&node| at_node(node).len()).sum();
        4 * star.cells * nodes.len() >= 3 * sum
    }

    /// The cells of a class at a node that have no patch and are connected by facets: the most of them.
    fn star(&self, node: u32, class: u32) -> (Star, Vec<u32>) {
        let free = |cell: &u32| self.class[*cell as usize] == class && self.patch[*cell as usize] == NONE;
        let mut left: Vec<u32> = self.around[node as usize].iter().copied().filter(free).collect();
        let mut largest = Vec::new();
        while let Some(&first) = left.first() {
            let mut part = vec![first];
            let mut next = 0;
            while let Some(&cell) = part.get(next) {
                let beyond = self.neighbours[cell as usize].iter().filter(|cell| left.contains(cell));
                let new: Vec<u32> = beyond.copied().filter(|cell| !part.contains(cell)).collect();
                part.extend(new);
                next += 1;
            }
            left.retain(|cell| !part.contains(cell));
            if part.len() > largest.len() {
                largest = part;
            }
        }
        largest.sort_unstable();
        let beyond = largest.iter().flat_map(|&cell| &self.neighbours[cell as usize]);
        let facets =
            beyond.filter(|&&cell| self.class[cell as usize] == class && self.patch[cell as usize] != NONE).count();
        (Star { cells: largest.len(), facets, node: Reverse(node) }, largest)
    }

    /// Gives the cells of a class without a patch to those beside them, the smallest patch first; where none is beside them one of them
    /// becomes a patch.
    fn join(&mut self, cells: &[u32]) {
        let mut patches: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut left: BTreeSet<u32> = BTreeSet::new();
        for &cell in cells {
            match self.patch[cell as usize] {
                NONE => drop(left.insert(cell)),
                patch => patches.entry(patch).or_default().push(cell),
            }
        }
        let mut smallest: BTreeSet<(usize, u32)> = patches.iter().map(|(patch, cells)| (cells.len(), *patch)).collect();
        while let Some(&first) = left.first() {
            let (patch, cell) = match smallest.pop_first() {
                Some((_, patch)) => match self.beside(patches.get(&patch).map_or(&[], Vec::as_slice), &left) {
                    Some(cell) => (patch, cell),
                    None => continue,
                },
                None => (first, first),
            };
            left.remove(&cell);
            self.patch[cell as usize] = patch;
            let cells = patches.entry(patch).or_default();
            cells.push(cell);
            smallest.insert((cells.len(), patch));
        }
    }

    /// The cell of a set that shares most facets with a patch, of several the first.
    fn beside(&self, patch: &[u32], left: &BTreeSet<u32>) -> Option<u32> {
        let mut facets: BTreeMap<u32, usize> = BTreeMap::new();
        let beyond = patch.iter().flat_map(|&cell| &self.neighbours[cell as usize]);
        beyond.filter(|cell| left.contains(cell)).for_each(|&cell| *facets.entry(cell).or_default() += 1);
        facets.into_iter().max_by_key(|(cell, count)| (*count, Reverse(*cell))).map(|(cell, _)| cell)
    }

    /// Patches by the first of their cells.
    fn by_first_cell(self) -> Vec<u32> {
        let mut first: BTreeMap<u32, u32> = BTreeMap::new();
        let each = self.patch.into_iter().enumerate();
        each.map(|(cell, patch)| if patch == NONE { cell as u32 } else { *first.entry(patch).or_insert(cell as u32) })
            .collect()
    }
}
