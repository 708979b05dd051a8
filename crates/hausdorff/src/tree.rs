//! A balanced tree of boxes over a cloud: every leaf is a full tile of points.
//!
//! The tree decides speed alone. The error bound holds for any partition.

use rayon::join;

/// Points in a leaf: the rows or columns of a tile of pairs. All leaves but the last are full.
pub(super) const POINTS_PER_LEAF: usize = 64;

/// Points from which a subtree is built by several threads.
const MIN_PARALLEL_POINTS: usize = 1 << 13;

/// A node and the points it holds: `order[first .. first + count]`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub first: u32,
    pub count: u32,
    /// Number of the right child; the left one follows its parent directly. 0 marks a leaf.
    pub right: u32,
    pub parent: u32,
}

impl Node {
    pub fn is_leaf(&self) -> bool {
        self.right == 0
    }

    pub fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// Split at the median along the longest side, down to leaves of `POINTS_PER_LEAF` points; nodes in preorder, the root first.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    /// order[k] = number in the cloud of the k-th point in tree order.
    pub order: Vec<u32>,
    pub nodes: Vec<Node>,
}

impl Tree {
    pub fn new(points: &[[f64; 3]]) -> Self {
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        let mut nodes = vec![Node::default(); 2 * leaves(points.len()) - 1];
        build(points, &mut order, &mut nodes, Node { first: 0, count: points.len() as u32, right: 0, parent: 0 }, 0);
        Self { order, nodes }
    }

    /// The children of a node that is not a leaf.
    pub fn children(&self, node: u32) -> [u32; 2] {
        [node + 1, self.nodes[node as usize].right]
    }
}

/// Leaves that n points need.
fn leaves(n: usize) -> usize {
    n.div_ceil(POINTS_PER_LEAF)
}

fn build(points: &[[f64; 3]], order: &mut [u32], nodes: &mut [Node], mut root: Node, id: u32) {
    let all = leaves(order.len());
    if all > 1 {
        let half = all.div_ceil(2);
        let at = half * POINTS_PER_LEAF;
        let (left, right) = split(points, order, at);
        root.right = id + 2 * half as u32;
        let (first, second) = nodes[1..].split_at_mut(2 * half - 1);
        let on_left = Node { first: root.first, count: at as u32, right: 0, parent: id };
        let on_right = Node { first: root.first + at as u32, count: right.len() as u32, right: 0, parent: id };
        if right.len() > MIN_PARALLEL_POINTS {
            join(|| build(points, left, first, on_left, id + 1), || build(points, right, second, on_right, root.right));
        } else {
            build(points, left, first, on_left, id + 1);
            build(points, right, second, on_right, root.right);
        }
    } else {
        order.sort_unstable();
    }
    nodes[0] = root;
}

/// The `at` points that lie lowest along the longest side, and the others.
fn split<'a>(points: &[[f64; 3]], order: &'a mut [u32], at: usize) -> (&'a mut [u32], &'a mut [u32]) {
    let axis = longest_axis(points, order);
    let key = |&i: &u32| (points[i as usize][axis], i);
    order.select_nth_unstable_by(at, |a, b| {
        let ((x, i), (y, j)) = (key(a), key(b));
        x.total_cmp(&y).then(i.cmp(&j))
    });
    order.split_at_mut(at)
}

fn longest_axis(points: &[[f64; 3]], order: &[u32]) -> usize {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &i in order {
        for d in 0..3 {
            lo[d] = lo[d].min(points[i as usize][d]);
            hi[d] = hi[d].max(points[i as usize][d]);
        }
    }
    let side = |d: usize| hi[d] - lo[d];
    let longer = if side(1) > side(0) { 1 } else { 0 };
    if side(2) > side(longer) { 2 } else { longer }
}
