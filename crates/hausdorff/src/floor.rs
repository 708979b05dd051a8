//! Lower bounds of the sums at the points of a side, before any is formed.
//!
//! The sum over the leaf that is nearest on the whole is formed; what the others add is bounded below. All three kernels
//! are convex functions of the squared distance, so that the mean of E over a node is at least E at the root of the mean
//! squared distance, which is the squared distance from the mean plus the variance.

use rayon::prelude::*;

use super::bounds::Bounds;
use super::kernel::{Kernel, with_form};
use super::lanes::{Machine, WIDTH};
use super::mask::Mask;
use super::side::{Side, padded};
use super::tile::{Peaks, Sums};
use super::tree::CHUNK;

/// Where log2 E differs by more than this among what a leaf may see as largest, its points get a scale each.
const WIDE: f64 = 512.0;

/// Parts of a sum below this share of it are left out of its lower bound.
const NEGLIGIBLE: f64 = 1e-3;

/// What is known beforehand of the sums sum_t w_t E_qt at the points q of a side.
#[derive(Debug)]
pub(super) struct Floor {
    /// Per node: log2 of the sums at its points is at least this.
    pub lower: Vec<f64>,
    /// Per chunk of points: the same.
    pub chunks: Vec<f64>,
    /// Per node: some leaf in it has a scale for every point.
    pub wide: Vec<bool>,
    /// Per point, padded: the power of two its sums are counted in. In leaves that are not wide, `lower`.
    pub scale: Vec<f64>,
}

struct LeafFloor {
    lower: f64,
    chunks: Vec<f64>,
    wide: bool,
    scale: Vec<f64>,
}

impl Floor {
    /// Sums at the points of `rows` over those of `columns`.
    pub fn new(rows: &Side, columns: &Side, kernel: &Kernel, machine: Machine) -> Self {
        let leaves = rows.leaves();
        let floors: Vec<LeafFloor> =
            leaves.par_iter().map(|&leaf| LeafFloor::new(rows, leaf, columns, kernel, machine)).collect();
        let nodes = rows.tree().nodes.len();
        let (mut lower, mut wide) = (vec![f64::INFINITY; nodes], vec![false; nodes]);
        let mut scale = Vec::with_capacity(rows.weight.len());
        let mut chunks = Vec::with_capacity(rows.chunks.len());
        for (&leaf, floor) in leaves.iter().zip(&floors) {
            lower[leaf as usize] = floor.lower;
            wide[leaf as usize] = floor.wide;
            scale.extend_from_slice(&floor.scale);
            chunks.extend_from_slice(&floor.chunks);
        }
        scale.resize(rows.weight.len(), scale[scale.len() - 1]);
        for node in (1..nodes).rev() {
            let parent = rows.tree().nodes[node].parent as usize;
            lower[parent] = lower[parent].min(lower[node]);
            wide[parent] |= wide[node];
        }
        Self { lower, chunks, wide, scale }
    }
}

impl LeafFloor {
    fn new(rows: &Side, leaf: u32, columns: &Side, kernel: &Kernel, machine: Machine) -> Self {
        let here = &rows.boxes[leaf as usize];
        let near = Nearest::new(here, columns);
        let lowest = kernel.at(near.reach);
        if kernel.at(near.gap) - lowest > WIDE {
            return Self::wide(rows, leaf, columns, kernel, machine);
        }
        // The sum over the leaf that is nearest on the whole is close to the sum over all.
        let count = rows.node(leaf).count as usize;
        let mut row_sums = vec![0.0; count * WIDTH];
        let mut column_sums = vec![0.0; padded(columns.node(near.leaf)).len()];
        with_form!(kernel, form => machine.run(Sums {
            form,
            rows: rows.rows(leaf),
            columns: columns.columns(near.leaf),
            mask: Mask::ALL,
            shift: lowest,
            row_factor: 1.0,
            column_factor: 0.0,
            row_sums: &mut row_sums,
            column_sums: &mut column_sums,
        }));
        let sums: Vec<f64> = row_sums.chunks_exact(WIDTH).map(|row| row.iter().sum::<f64>()).collect();
        let near_sums: Vec<f64> = sums.chunks(CHUNK).map(min).collect();
        let boxes = &rows.chunks[rows.chunks_of(leaf)];
        let others = others(here, boxes, columns, kernel, near.leaf, lowest, min(&near_sums));
        let both = near_sums.iter().zip(&others);
        let chunks: Vec<f64> = both.map(|(near_sum, others)| lowest + (near_sum + others).log2()).collect();
        let lower = min(&chunks);
        // Tiny weights near by may leave the sums far below what larger ones farther off reach.
        if kernel.at(near.gap) - lower > WIDE {
            return Self::wide(rows, leaf, columns, kernel, machine);
        }
        Self { lower, chunks, wide: false, scale: vec![lower; count] }
    }

    fn wide(rows: &Side, leaf: u32, columns: &Side, kernel: &Kernel, machine: Machine) -> Self {
        let count = rows.node(leaf).count as usize;
        let here = &rows.boxes[leaf as usize];
        let mut spread = vec![f64::NEG_INFINITY; count * WIDTH];
        let mut lowest = f64::NEG_INFINITY;
        nearest_first(here, columns, |gap, node| {
            if kernel.at(gap) <= lowest {
                return false;
            }
            if columns.node(node).is_leaf() {
                let (rows, columns) = (rows.rows(leaf), columns.columns(node));
                with_form!(kernel, form => machine.run(Peaks { form, rows, columns, peaks: &mut spread }));
                lowest = spread.chunks_exact(WIDTH).map(max).fold(f64::INFINITY, f64::min);
            }
            true
        });
        let least = columns.weight[..columns.cloud.len()].iter().copied().fold(f64::INFINITY, f64::min);
        let scale = spread.chunks_exact(WIDTH).map(max).collect();
        let lower = lowest + least.log2();
        Self { lower, chunks: vec![lower; count.div_ceil(CHUNK)], wide: true, scale }
    }
}

/// For every chunk of a leaf a lower bound of the sums over all leaves but one, times 2^(-shift), given that one's sum.
fn others(
    here: &Bounds,
    chunks: &[Bounds],
    columns: &Side,
    kernel: &Kernel,
    but: u32,
    shift: f64,
    near_sum: f64,
) -> Vec<f64> {
    let mut sums = vec![0.0; chunks.len()];
    nearest_first(here, columns, |gap, node| {
        let cluster = &columns.clusters[node as usize];
        let highest = cluster.share * (kernel.at(gap) - shift).exp2();
        if highest < NEGLIGIBLE * near_sum {
            return false;
        }
        if columns.tree().subtree(node).contains(&but) {
            return node != but;
        }
        let mean = |here: &Bounds| {
            let distance = here.reach(&Bounds::point(cluster.mean)).hypot(cluster.variance.sqrt());
            cluster.share * (kernel.at(distance) - shift).exp2()
        };
        let enough = columns.node(node).is_leaf() || mean(here) > 0.5 * highest;
        if enough {
            sums.iter_mut().zip(chunks).for_each(|(sum, chunk)| *sum += mean(chunk));
        }
        !enough
    });
    sums
}

fn min(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn max(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// The leaf of a side that a box reaches with the least largest distance, and the least gap to any leaf.
struct Nearest {
    leaf: u32,
    reach: f64,
    gap: f64,
}

impl Nearest {
    fn new(here: &Bounds, columns: &Side) -> Self {
        let mut best = Self { leaf: 0, reach: f64::INFINITY, gap: f64::INFINITY };
        nearest_first(here, columns, |gap, node| {
            if gap >= best.reach {
                return false;
            }
            if columns.node(node).is_leaf() {
                let reach = here.reach(&columns.boxes[node as usize]);
                best.gap = best.gap.min(gap);
                if reach < best.reach {
                    (best.leaf, best.reach) = (node, reach);
                }
            }
            true
        });
        best
    }
}

/// Visits nodes with their gap from `here`, the nearer child first; `visit` says whether to go on into the node.
fn nearest_first(here: &Bounds, columns: &Side, mut visit: impl FnMut(f64, u32) -> bool) {
    let mut stack = vec![(here.gap(&columns.boxes[0]), 0)];
    while let Some((gap, node)) = stack.pop() {
        if visit(gap, node) && !columns.node(node).is_leaf() {
            let mut next = columns.tree().children(node).map(|child| (here.gap(&columns.boxes[child as usize]), child));
            if next[0].0 < next[1].0 {
                next.swap(0, 1);
            }
            stack.extend(next);
        }
    }
}
