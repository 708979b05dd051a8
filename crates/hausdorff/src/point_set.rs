//! A cloud as the pair sums see it: in units of the kernel, in tree order.

use super::aligned::Aligned;
use super::bounding_box::BoundingBox;
use super::cloud::{Cloud, fit};
use super::lanes::WIDTH;
use super::sum_tiles::Slab;
use super::tree::{Node, POINTS_PER_LEAF, Tree};

/// The points in units, tree order, padded to a multiple of `WIDTH` by copies of the last one with weight zero.
#[derive(Debug)]
pub(super) struct PointSet {
    pub cloud: Cloud,
    pub x: [Aligned; 3],
    /// Weights divided by the measure.
    pub weight: Aligned,
    /// Per node.
    pub boxes: Vec<BoundingBox>,
}

impl PointSet {
    pub fn new(cloud: &Cloud, origin: [f64; 3], unit: f64) -> Self {
        let order = &cloud.tree().order;
        let padded = order.len().next_multiple_of(WIDTH);
        let at = |k: usize| cloud.points()[order[k.min(order.len() - 1)] as usize];
        let x: [Aligned; 3] = std::array::from_fn(|d| (0..padded).map(|k| (at(k)[d] - origin[d]) / unit).collect());
        let weight: Aligned = in_tree_order(cloud, cloud.weights()).iter().map(|w| w / cloud.measure()).collect();
        let boxes = fit(cloud.tree(), |k| [x[0][k], x[1][k], x[2][k]]);
        Self { cloud: cloud.clone(), x, weight, boxes }
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

    /// The points of a leaf alone.
    pub fn rows(&self, leaf: u32) -> Slab<'_> {
        self.slab(self.node(leaf).range())
    }

    fn slab(&self, range: std::ops::Range<usize>) -> Slab<'_> {
        Slab { x: std::array::from_fn(|d| &self.x[d][range.clone()]), weight: &self.weight[range] }
    }

    pub fn leaves(&self) -> Vec<u32> {
        (0..self.tree().nodes.len() as u32).filter(|&node| self.node(node).is_leaf()).collect()
    }
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

const _: () = assert!(POINTS_PER_LEAF.is_multiple_of(WIDTH), "a full leaf is a tile without padding");
