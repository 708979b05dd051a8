//! A cloud as the pair sums see it: in units of the kernel, in tree order.

use super::aligned::Aligned;
use super::bounds::{Bounds, norm};
use super::brief::Centred;
use super::cloud::{Cloud, fit};
use super::lanes::WIDTH;
use super::single::{Local, Rounded};
use super::tile::Slab;
use super::tree::{CHUNK, LEAF, Node, Tree};

/// The points in units, tree order, padded to a multiple of `WIDTH` by copies of the last one with weight zero.
#[derive(Debug)]
pub(super) struct Side {
    pub cloud: Cloud,
    pub x: [Aligned; 3],
    /// Weights divided by the measure.
    pub weight: Aligned,
    /// Per node.
    pub boxes: Vec<Bounds>,
    /// Per chunk of points: its box, the sum of its weights.
    pub chunks: Vec<Bounds>,
    pub chunk_share: Vec<f64>,
    /// Coordinates for tiles in brief.
    pub centred: Centred,
    /// In single precision.
    pub local: Local,
    pub rounded_weight: Rounded,
    /// Per node.
    pub clusters: Vec<Cluster>,
}

impl Side {
    pub fn new(cloud: &Cloud, origin: [f64; 3], unit: f64) -> Self {
        let order = &cloud.tree().order;
        let padded = order.len().next_multiple_of(WIDTH);
        let at = |k: usize| cloud.points()[order[k.min(order.len() - 1)] as usize];
        let x: [Aligned; 3] = std::array::from_fn(|d| (0..padded).map(|k| (at(k)[d] - origin[d]) / unit).collect());
        let weight: Aligned = in_tree_order(cloud, cloud.weights()).iter().map(|w| w / cloud.measure()).collect();
        let boxes = fit(cloud.tree(), |k| [x[0][k], x[1][k], x[2][k]]);
        let clusters = clusters(cloud.tree(), &weight, [&x[0], &x[1], &x[2]]);
        let point = |k: usize| Bounds::point([x[0][k], x[1][k], x[2][k]]);
        let chunk = |k: usize| (k..order.len().min(k + CHUNK)).fold(Bounds::EMPTY, |all, k| all.join(&point(k)));
        let chunks = (0..order.len()).step_by(CHUNK).map(chunk).collect();
        let chunk_share = weight[..order.len()].chunks(CHUNK).map(|chunk| chunk.iter().sum()).collect();
        let local = Local::new(cloud.tree(), &boxes, [&x[0], &x[1], &x[2]]);
        let centred = Centred::new(cloud.tree(), &boxes, [&x[0], &x[1], &x[2]]);
        let rounded_weight = Rounded::new(&weight[..order.len()]);
        Self { cloud: cloud.clone(), x, weight, boxes, chunks, chunk_share, centred, local, rounded_weight, clusters }
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

    /// The number of a node's first point.
    pub fn first(&self, node: u32) -> usize {
        self.node(node).first as usize
    }

    /// The numbers of a node's chunks.
    pub fn chunks_of(&self, node: u32) -> std::ops::Range<usize> {
        let range = self.node(node).range();
        range.start / CHUNK..range.end.div_ceil(CHUNK)
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

/// The points of a node as one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cluster {
    /// Sum of the weights.
    pub share: f64,
    pub mean: [f64; 3],
    /// Mean squared distance from the mean.
    pub variance: f64,
}

impl Cluster {
    fn join(&self, other: &Self) -> Self {
        let share = self.share + other.share;
        if share == 0.0 {
            return *self;
        }
        let part = other.share / share;
        let apart: [f64; 3] = std::array::from_fn(|d| other.mean[d] - self.mean[d]);
        let mean = std::array::from_fn(|d| self.mean[d] + part * apart[d]);
        let within = (1.0 - part) * self.variance + part * other.variance;
        Self { share, mean, variance: within + part * (1.0 - part) * norm(apart).powi(2) }
    }
}

fn clusters(tree: &Tree, weight: &[f64], x: [&[f64]; 3]) -> Vec<Cluster> {
    let point = |k: usize| Cluster { share: weight[k], mean: [x[0][k], x[1][k], x[2][k]], variance: 0.0 };
    let mut clusters = vec![Cluster::default(); tree.nodes.len()];
    for node in (0..tree.nodes.len()).rev() {
        let it = &tree.nodes[node];
        clusters[node] = if it.is_leaf() {
            let first = point(it.first as usize);
            it.range().skip(1).fold(first, |all, k| all.join(&point(k)))
        } else {
            let [left, right] = tree.children(node as u32);
            clusters[left as usize].join(&clusters[right as usize])
        };
    }
    clusters
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

const _: () = assert!(LEAF.is_multiple_of(WIDTH), "a full leaf is a tile without padding");
