//! Lower bounds of the sums at the points of a set, before any is formed: the sum over the leaf that is nearest on the whole.

use rayon::prelude::*;

use super::bounding_box::BoundingBox;
use super::kernel::{Kernel, with_form};
use super::lanes::{InstructionSet, WIDTH};
use super::point_set::{PointSet, padded};
use super::sum_tiles::{MaxTile, SumTile};

/// Largest difference of log2 E among the candidates of a leaf for the largest term, above which every point of the leaf has a scale of its own.
const MAX_LOG2_SPREAD: f64 = 512.0;

/// What is known beforehand of the sums sum_t w_t E_qt at the points q of a set.
#[derive(Debug)]
pub(super) struct LowerBounds {
    /// Per node: log2 of the sums at its points is at least this.
    pub lower: Vec<f64>,
    /// Per leaf: it has a scale for every point.
    pub wide: Vec<bool>,
    /// Per point, padded: the power of two its sums are counted in. In leaves that are not wide, `lower`.
    pub scale: Vec<f64>,
}

/// A point set and the lower bounds of the sums at its points.
#[derive(Debug)]
pub(super) struct BoundedSet {
    pub points: PointSet,
    pub bounds: LowerBounds,
}

struct LeafBounds {
    lower: f64,
    wide: bool,
    scale: Vec<f64>,
}

impl LowerBounds {
    /// Sums at the points of `rows` over those of `columns`.
    pub fn new(rows: &PointSet, columns: &PointSet, kernel: &Kernel, instructions: InstructionSet) -> Self {
        let leaves = rows.leaves();
        let of_leaf = |&leaf: &u32| LeafBounds::new(rows, leaf, columns, kernel, instructions);
        let bounds: Vec<LeafBounds> = leaves.par_iter().map(of_leaf).collect();
        let nodes = rows.tree().nodes.len();
        let (mut lower, mut wide) = (vec![f64::INFINITY; nodes], vec![false; nodes]);
        let mut scale = Vec::with_capacity(rows.weight.len());
        for (&leaf, bounds) in leaves.iter().zip(&bounds) {
            lower[leaf as usize] = bounds.lower;
            wide[leaf as usize] = bounds.wide;
            scale.extend_from_slice(&bounds.scale);
        }
        scale.resize(rows.weight.len(), scale[scale.len() - 1]);
        for node in (1..nodes).rev() {
            let parent = rows.tree().nodes[node].parent as usize;
            lower[parent] = lower[parent].min(lower[node]);
        }
        Self { lower, wide, scale }
    }
}

impl LeafBounds {
    fn new(rows: &PointSet, leaf: u32, columns: &PointSet, kernel: &Kernel, instructions: InstructionSet) -> Self {
        let near = Nearest::new(&rows.boxes[leaf as usize], columns);
        let lowest = kernel.at(near.reach);
        let count = rows.node(leaf).count as usize;
        let mut row_sums = vec![0.0; count * WIDTH];
        let mut column_sums = vec![0.0; padded(columns.node(near.leaf)).len()];
        if kernel.at(near.gap) - lowest <= MAX_LOG2_SPREAD {
            with_form!(kernel, form => instructions.run(SumTile {
                form,
                rows: rows.rows(leaf),
                columns: columns.columns(near.leaf),
                shift: lowest,
                row_factor: 1.0,
                column_factor: 0.0,
                row_sums: &mut row_sums,
                column_sums: &mut column_sums,
            }));
            let sums = row_sums.chunks_exact(WIDTH).map(|row| row.iter().sum::<f64>());
            let lower = lowest + sums.fold(f64::INFINITY, f64::min).log2();
            // Tiny weights near by may leave the sums far below what larger ones farther off reach.
            if kernel.at(near.gap) - lower <= MAX_LOG2_SPREAD {
                return Self { lower, wide: false, scale: vec![lower; count] };
            }
        }
        Self::wide(rows, leaf, columns, kernel, instructions)
    }

    fn wide(rows: &PointSet, leaf: u32, columns: &PointSet, kernel: &Kernel, instructions: InstructionSet) -> Self {
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
                with_form!(kernel, form => instructions.run(MaxTile { form, rows, columns, largest: &mut spread }));
                lowest = spread.chunks_exact(WIDTH).map(max).fold(f64::INFINITY, f64::min);
            }
            true
        });
        let least = columns.weight[..columns.cloud.len()].iter().copied().fold(f64::INFINITY, f64::min);
        let scale = spread.chunks_exact(WIDTH).map(max).collect();
        let lower = lowest + least.log2();
        Self { lower, wide: true, scale }
    }
}

fn max(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// The leaf of a set that a box reaches with the least largest distance, and the least gap to any leaf.
struct Nearest {
    leaf: u32,
    reach: f64,
    gap: f64,
}

impl Nearest {
    fn new(here: &BoundingBox, columns: &PointSet) -> Self {
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

/// Visits nodes with their gap from `here`, the nearer child first; `visit` says whether to descend into the node.
fn nearest_first(here: &BoundingBox, columns: &PointSet, mut visit: impl FnMut(f64, u32) -> bool) {
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
