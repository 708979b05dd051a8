//! Which elements are cells, which nodes they use, and in which order both are numbered.

use super::RawMesh;
use super::raw::Element;
use crate::mesh::CellBlock;
use crate::{CellKind, Fault};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The cells and used nodes of a raw mesh under their new numbers.
pub(super) struct Selection {
    pub blocks: Vec<CellBlock>,
    /// Cells of each group of the mesh's dimension, ascending.
    pub groups: BTreeMap<i32, Vec<u32>>,
    /// Position among the raw elements, by cell.
    pub origin: Vec<u32>,
    /// Number in the file, by cell.
    pub labels: Vec<u64>,
    /// Raw index, by node.
    pub used: Vec<u32>,
    /// Node by raw index; `UNUSED` where no cell needs it.
    pub renumbered: Vec<u32>,
}

/// Marks a raw node that no cell uses.
pub(super) const UNUSED: u32 = u32::MAX;

/// The dimension of the body: that of the highest elements, if they are volume or plane cells.
pub(super) fn dimension(raw: &RawMesh) -> Option<usize> {
    raw.blocks.iter().filter(|b| !b.nodes.is_empty()).map(|b| b.kind.dim()).max().filter(|dim| *dim >= 2)
}

pub(super) fn select(raw: &RawMesh, dim: usize, notes: &mut Vec<String>) -> Selection {
    let cells: Vec<Element> = raw.elements().filter(|element| element.kind.dim() == dim).collect();
    let first_of = first_of_its_kind(&cells);
    let order = by_kind(&cells, &first_of);
    let mut number = vec![0u32; cells.len()];
    for (id, &k) in order.iter().enumerate() {
        number[k] = id as u32;
    }
    let repeated = cells.len() - order.len();
    if repeated > 0 {
        notes.push(format!("{repeated} cells were listed more than once; merged, with the groups of all copies"));
    }
    let mut groups = BTreeMap::<i32, Vec<u32>>::new();
    for (k, cell) in cells.iter().enumerate() {
        for &tag in cell.tags.iter().filter(|tag| **tag != 0) {
            groups.entry(tag).or_default().push(number[first_of[k]]);
        }
    }
    for members in groups.values_mut() {
        members.sort_unstable();
        members.dedup();
    }
    let (used, renumbered) = used_nodes(raw, &cells, notes);
    Selection {
        blocks: blocks(&cells, &order, &renumbered),
        groups,
        origin: order.iter().map(|&k| cells[k].position).collect(),
        labels: order.iter().map(|&k| cells[k].label).collect(),
        used,
        renumbered,
    }
}

/// For each cell the first one with the same kind and the same set of nodes (usually itself). Gmsh 2.2 lists a cell
/// once per physical group.
fn first_of_its_kind(cells: &[Element]) -> Vec<usize> {
    let mut keys: Vec<(u64, usize)> = cells.iter().enumerate().map(|(k, cell)| (fingerprint(cell), k)).collect();
    keys.sort_unstable();
    let mut first: Vec<usize> = (0..cells.len()).collect();
    for run in keys.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        for (i, &(_, k)) in run.iter().enumerate().skip(1) {
            let twin = run[..i].iter().find(|&&(_, j)| same(&cells[j], &cells[k]));
            first[k] = twin.map_or(k, |&(_, j)| first[j]);
        }
    }
    first
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

/// Equal for equal sets of nodes; `DefaultHasher::new` has fixed keys, and only equality matters here.
fn fingerprint(cell: &Element) -> u64 {
    let mut hasher = DefaultHasher::new();
    sorted(cell.nodes).hash(&mut hasher);
    hasher.finish()
}

fn same(a: &Element, b: &Element) -> bool {
    a.kind == b.kind && sorted(a.nodes) == sorted(b.nodes)
}

/// Cells grouped by kind in order of first appearance, without repetitions.
fn by_kind(cells: &[Element], first_of: &[usize]) -> Vec<usize> {
    let mut rank = [usize::MAX; CellKind::ALL.len()];
    let mut kinds = 0;
    for cell in cells {
        let rank = &mut rank[cell.kind as usize];
        if *rank == usize::MAX {
            *rank = kinds;
            kinds += 1;
        }
    }
    let mut order: Vec<usize> = (0..cells.len()).filter(|&k| first_of[k] == k).collect();
    order.sort_by_key(|&k| rank[cells[k].kind as usize]);
    order
}

fn used_nodes(raw: &RawMesh, cells: &[Element], notes: &mut Vec<String>) -> (Vec<u32>, Vec<u32>) {
    let mut renumbered = vec![UNUSED; raw.points.len()];
    for &node in cells.iter().flat_map(|cell| cell.nodes) {
        renumbered[node as usize] = 0;
    }
    let used: Vec<u32> = (0..raw.points.len() as u32).filter(|&node| renumbered[node as usize] == 0).collect();
    for (new, &old) in used.iter().enumerate() {
        renumbered[old as usize] = new as u32;
    }
    let dropped = raw.points.len() - used.len();
    if dropped > 0 {
        notes.push(format!("{dropped} nodes belong to no cell; dropped"));
    }
    (used, renumbered)
}

fn blocks(cells: &[Element], order: &[usize], renumbered: &[u32]) -> Vec<CellBlock> {
    let mut blocks: Vec<CellBlock> = Vec::new();
    for (id, &k) in order.iter().enumerate() {
        let cell = &cells[k];
        if blocks.last().is_none_or(|block| block.kind != cell.kind) {
            blocks.push(CellBlock { kind: cell.kind, first: id, nodes: Vec::new() });
        }
        if let Some(block) = blocks.last_mut() {
            block.nodes.extend(cell.nodes.iter().map(|&node| renumbered[node as usize]));
        }
    }
    blocks
}

/// Positions of the used nodes; a plane body is moved to z = 0.
pub(super) fn points(
    raw: &RawMesh,
    selection: &Selection,
    dim: usize,
    notes: &mut Vec<String>,
) -> Result<Vec<[f64; 3]>, Fault> {
    let mut points: Vec<[f64; 3]> = selection.used.iter().map(|&node| raw.points[node as usize]).collect();
    if dim == 3 {
        return Ok(points);
    }
    let (low, high) = crate::geometry::bounds(&points);
    let extent = (high[0] - low[0]).max(high[1] - low[1]);
    let z = points.first().map_or(0.0, |point| point[2]);
    let label = |k: usize| raw.node_label(selection.used[k]);
    if let Some(k) = points.iter().position(|point| (point[2] - z).abs() > 1e-9 * extent) {
        return Err(Fault::Membrane { node: label(0), z, other: label(k), other_z: points[k][2] });
    }
    if points.iter().any(|point| point[2] != 0.0) {
        notes.push(format!("plane mesh at z = {z:e} moved to z = 0"));
        points.iter_mut().for_each(|point| point[2] = 0.0);
    }
    Ok(points)
}
