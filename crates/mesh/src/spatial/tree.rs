//! A bounding volume hierarchy over boxes: balanced, built by medians, the same for the same input.

use super::V;
use super::interpolation_error::InterpolationError;

const MAX_LEAF_ITEMS: usize = 3;
/// Depth of a balanced tree over at most 2^32 items, with one waiting sibling per level.
const STACK: usize = 64;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub struct Aabb {
    /// The lowest corner.
    pub lo: V,
    /// The highest corner.
    pub hi: V,
}

impl Aabb {
    /// The box of nothing.
    pub const EMPTY: Self = Self {
        lo: V::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        hi: V::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// The box of points.
    #[must_use]
    pub fn around<'a>(points: impl IntoIterator<Item = &'a V>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { lo: b.lo.inf(p), hi: b.hi.sup(p) })
    }

    /// The box of two.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { lo: self.lo.inf(&other.lo), hi: self.hi.sup(&other.hi) }
    }

    /// The box extended by a margin on every side.
    #[must_use]
    pub fn grown(&self, by: f64) -> Self {
        Self { lo: self.lo.add_scalar(-by), hi: self.hi.add_scalar(by) }
    }

    /// The box with all that a deviation may add to it.
    #[must_use]
    pub(super) fn enlarged(&self, deviation: &InterpolationError) -> Self {
        let [x, y, z] = [V::x(), V::y(), V::z()].map(|axis| deviation.extent(&axis));
        Self { lo: self.lo + V::new(x.0, y.0, z.0), hi: self.hi + V::new(x.1, y.1, z.1) }
    }

    /// Whether two have a point in common.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|a| self.lo[a] <= other.hi[a] && other.lo[a] <= self.hi[a])
    }

    /// Whether a point is in it.
    #[must_use]
    pub fn contains(&self, p: &V) -> bool {
        (0..3).all(|a| self.lo[a] <= p[a] && p[a] <= self.hi[a])
    }

    /// Length of its diagonal.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        (self.hi - self.lo).norm()
    }

    fn distance_squared(&self, p: &V) -> f64 {
        let mut sum = 0.0;
        for a in 0..3 {
            let d = (self.lo[a] - p[a]).max(p[a] - self.hi[a]).max(0.0);
            sum += d * d;
        }
        sum
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// Leaf: its first item. Inner node: its first child, the second follows.
    first: u32,
    /// Items of a leaf; zero for an inner node.
    count: u32,
}

/// The hierarchy; items are `0..n` in the order of `order`.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Tree {
    /// Over items with these boxes.
    #[must_use]
    pub fn build(boxes: &[Aabb]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
        if !boxes.is_empty() {
            tree.nodes.push(Node { bounds: Aabb::EMPTY, first: 0, count: 0 });
            tree.fill(0, 0, boxes.len(), boxes);
        }
        tree
    }

    fn fill(&mut self, node: usize, from: usize, to: usize, boxes: &[Aabb]) {
        let items = &mut self.order[from..to];
        let bounds = items.iter().fold(Aabb::EMPTY, |b, &i| b.union(&boxes[i as usize]));
        if items.len() <= MAX_LEAF_ITEMS {
            self.nodes[node] = Node { bounds, first: from as u32, count: items.len() as u32 };
            return;
        }
        let centre = |i: u32| boxes[i as usize].lo + boxes[i as usize].hi;
        let spread = items.iter().fold(Aabb::EMPTY, |b, &i| b.union(&Aabb { lo: centre(i), hi: centre(i) }));
        let axis = (spread.hi - spread.lo).imax();
        let middle = items.len() / 2;
        items.select_nth_unstable_by(middle, |&i, &j| centre(i)[axis].total_cmp(&centre(j)[axis]).then(i.cmp(&j)));
        let first = self.nodes.len();
        self.nodes.extend([Node { bounds, first: 0, count: 0 }; 2]);
        self.nodes[node] = Node { bounds, first: first as u32, count: 0 };
        self.fill(first, from, from + middle, boxes);
        self.fill(first + 1, from + middle, to, boxes);
    }

    /// The box of all.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |n| n.bounds)
    }

    /// Visits items whose boxes are nearer to `p` than the best squared distance so far, which `visit` returns.
    pub fn nearest(&self, p: &V, mut best: f64, mut visit: impl FnMut(usize, f64) -> f64) {
        let mut stack = [(0u32, 0.0f64); STACK];
        let mut top = 0;
        if !self.nodes.is_empty() {
            stack[0] = (0, self.nodes[0].bounds.distance_squared(p));
            top = 1;
        }
        while top > 0 {
            top -= 1;
            let (index, near) = stack[top];
            if near > best {
                continue;
            }
            let node = self.nodes[index as usize];
            if node.count > 0 {
                for &item in &self.order[node.first as usize..][..node.count as usize] {
                    best = visit(item as usize, best);
                }
                continue;
            }
            let near = [0, 1].map(|c| self.nodes[node.first as usize + c].bounds.distance_squared(p));
            let far = usize::from(near[0] <= near[1]);
            for child in [far, 1 - far] {
                if near[child] <= best && top < STACK {
                    stack[top] = (node.first + child as u32, near[child]);
                    top += 1;
                }
            }
        }
    }

    /// Visits all items whose boxes overlap `range`, and others near them, until `visit` says stop by returning true.
    pub fn overlapping(&self, range: &Aabb, mut visit: impl FnMut(usize) -> bool) {
        let mut stack = [0u32; STACK];
        let mut top = usize::from(!self.nodes.is_empty());
        while top > 0 {
            top -= 1;
            let node = self.nodes[stack[top] as usize];
            if !node.bounds.overlaps(range) {
                continue;
            }
            if node.count == 0 {
                if top + 2 <= STACK {
                    stack[top] = node.first + 1;
                    stack[top + 1] = node.first;
                    top += 2;
                }
                continue;
            }
            for &item in &self.order[node.first as usize..][..node.count as usize] {
                if visit(item as usize) {
                    return;
                }
            }
        }
    }
}
