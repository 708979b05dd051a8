//! A cloud as the pair sums see it: in units of the kernel, in tree order, with bounds on the sums at its points.

use rayon::prelude::*;

use super::aligned::Aligned;
use super::bounds::Bounds;
use super::cloud::{Cloud, fit};
use super::kernel::{Kernel, with_form};
use super::lanes::{Machine, WIDTH};
use super::tile::{Peaks, Slab, Sums};
use super::tree::{LEAF, Node, Tree};

/// Where log2 E differs by more than this among what a leaf may see as largest, its points get a scale each.
const WIDE: f64 = 512.0;

/// Parts of a sum below this share of it are left out of its lower bound.
const NEGLIGIBLE: f64 = 1e-3;

/// The points in units, tree order, padded to a multiple of `WIDTH` by copies of the last one with weight zero.
#[derive(Debug)]
pub(super) struct Side {
    pub cloud: Cloud,
    pub x: [Aligned; 3],
    /// Weights divided by the measure.
    pub weight: Aligned,
    /// Per node.
    pub boxes: Vec<Bounds>,
    /// Per node: sum of the weights.
    pub share: Vec<f64>,
}

impl Side {
    pub fn new(cloud: &Cloud, origin: [f64; 3], unit: f64) -> Self {
        let order = &cloud.tree().order;
        let padded = order.len().next_multiple_of(WIDTH);
        let at = |k: usize| cloud.points()[order[k.min(order.len() - 1)] as usize];
        let x: [Aligned; 3] = std::array::from_fn(|d| (0..padded).map(|k| (at(k)[d] - origin[d]) / unit).collect());
        let weight: Aligned = in_tree_order(cloud, cloud.weights()).iter().map(|w| w / cloud.measure()).collect();
        let boxes = fit(cloud.tree(), |k| [x[0][k], x[1][k], x[2][k]]);
        let share = shares(cloud.tree(), &weight);
        Self { cloud: cloud.clone(), x, weight, boxes, share }
    }

    pub fn tree(&self) -> &Tree {
        self.cloud.tree()
    }

    pub fn node(&self, node: u32) -> &Node {
        &self.tree().nodes[node as usize]
    }

    /// A leaf's points with their padding: the whole tile as columns.
    pub fn columns(&self, leaf: u32) -> Slab<'_> {
        self.slab(padded(self.node(leaf)))
    }

    /// The points of a node alone.
    pub fn rows(&self, node: u32) -> Slab<'_> {
        self.slab(self.node(node).range())
    }

    fn slab(&self, range: std::ops::Range<usize>) -> Slab<'_> {
        Slab { x: std::array::from_fn(|d| &self.x[d][range.clone()]), weight: &self.weight[range] }
    }

    pub fn leaves(&self) -> Vec<u32> {
        (0..self.tree().nodes.len() as u32).filter(|&node| self.node(node).is_leaf()).collect()
    }
}

fn shares(tree: &Tree, weight: &[f64]) -> Vec<f64> {
    let mut share = vec![0.0; tree.nodes.len()];
    for node in (0..tree.nodes.len()).rev() {
        let it = &tree.nodes[node];
        share[node] = if it.is_leaf() {
            weight[it.range()].iter().sum()
        } else {
            tree.children(node as u32).iter().map(|&child| share[child as usize]).sum()
        };
    }
    share
}

/// The range of a leaf in arrays padded to a multiple of `WIDTH`.
pub(super) fn padded(leaf: &Node) -> std::ops::Range<usize> {
    let range = leaf.range();
    range.start..range.end.next_multiple_of(WIDTH)
}

/// Values of a cloud's points in tree order, padded by zeros.
pub(super) fn in_tree_order(cloud: &Cloud, values: &[f64]) -> Aligned {
    let mut sorted = Aligned::zeros(values.len().next_multiple_of(WIDTH));
    cloud.tree().order.iter().zip(sorted.iter_mut()).for_each(|(&i, value)| *value = values[i as usize]);
    sorted
}

/// Values in tree order put back in the cloud's own.
pub(super) fn in_cloud_order<T: Copy + Default>(cloud: &Cloud, values: &[T]) -> Vec<T> {
    let mut back = vec![T::default(); cloud.len()];
    for (&i, &value) in cloud.tree().order.iter().zip(values) {
        back[i as usize] = value;
    }
    back
}

/// What is known beforehand of the sums sum_t w_t E_qt at the points q of a side.
#[derive(Debug)]
pub(super) struct Floor {
    /// Per node: log2 of the sums at its points is at least this.
    pub lower: Vec<f64>,
    /// Per node: some leaf in it has a scale for every point.
    pub wide: Vec<bool>,
    /// Per point, padded: the power of two its sums are counted in. In leaves that are not wide, `lower`.
    pub scale: Vec<f64>,
}

struct LeafFloor {
    lower: f64,
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
        for (&leaf, floor) in leaves.iter().zip(&floors) {
            lower[leaf as usize] = floor.lower;
            wide[leaf as usize] = floor.wide;
            scale.extend_from_slice(&floor.scale);
        }
        scale.resize(rows.weight.len(), scale[scale.len() - 1]);
        for node in (1..nodes).rev() {
            let parent = rows.tree().nodes[node].parent as usize;
            lower[parent] = lower[parent].min(lower[node]);
            wide[parent] |= wide[node];
        }
        Self { lower, wide, scale }
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
            shift: lowest,
            row_factor: 1.0,
            column_factor: 0.0,
            row_sums: &mut row_sums,
            column_sums: &mut column_sums,
        }));
        let sums = row_sums.chunks_exact(WIDTH).map(|row| row.iter().sum::<f64>());
        let near_sum = sums.fold(f64::INFINITY, f64::min);
        let lower = lowest + (near_sum + others(here, columns, kernel, near.leaf, lowest, near_sum)).log2();
        // Tiny weights near by may leave the sums far below what larger ones farther off reach.
        if kernel.at(near.gap) - lower > WIDE {
            return Self::wide(rows, leaf, columns, kernel, machine);
        }
        Self { lower, wide: false, scale: vec![lower; count] }
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
        Self { lower: lowest + least.log2(), wide: true, scale }
    }
}

/// A lower bound of the sum over all leaves but one, times 2^(-shift), given that one's sum.
fn others(here: &Bounds, columns: &Side, kernel: &Kernel, but: u32, shift: f64, near_sum: f64) -> f64 {
    let mut sum = 0.0;
    nearest_first(here, columns, |gap, node| {
        let share = columns.share[node as usize];
        let highest = share * (kernel.at(gap) - shift).exp2();
        if highest < NEGLIGIBLE * near_sum {
            return false;
        }
        if columns.tree().subtree(node).contains(&but) {
            return node != but;
        }
        let lowest = share * (kernel.at(here.reach(&columns.boxes[node as usize])) - shift).exp2();
        if columns.node(node).is_leaf() || lowest > 0.5 * highest {
            sum += lowest;
            return false;
        }
        true
    });
    sum
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

const _: () = assert!(LEAF.is_multiple_of(WIDTH), "a full leaf is a tile without padding");
