//! Geometric nested dissection: cut the longest axis near the median, take the separator from the graph.
//!
//! George, "Nested dissection of a regular finite element mesh", SIAM J. Numer. Anal. 10 (1973).

use super::graph::Graph;

/// Regions of at most this many nodes are ordered by minimum degree.
const MAX_LEAF_NODES: usize = 64;

/// Shares of the nodes left of the cut that are tried on each axis.
const CUT_SHARES: [f64; 5] = [0.5, 0.45, 0.55, 0.4, 0.6];

/// Elimination order of the graph's nodes: both halves first, then what separates them, recursively.
pub(super) fn nested_dissection(graph: &Graph, points: &[[f64; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..graph.nodes() as u32).collect();
    let mut dissector = Dissector { graph, points, side: vec![OUTSIDE; graph.nodes()] };
    let mut regions = Vec::from([(0, order.len())]);
    while let Some((first, end)) = regions.pop() {
        let nodes = &mut order[first..end];
        let split = if nodes.len() > MAX_LEAF_NODES { dissector.split(nodes) } else { None };
        match split {
            Some((left, right)) => regions.extend([(first, first + left), (first + left, first + left + right)]),
            None => minimum_degree(graph, nodes),
        }
    }
    order
}

const OUTSIDE: u8 = 0;
const LEFT: u8 = 1;
const RIGHT: u8 = 2;
const SEPARATOR: u8 = 3;

struct Dissector<'a> {
    graph: &'a Graph,
    points: &'a [[f64; 3]],
    side: Vec<u8>,
}

/// A plane between two neighbouring coordinates, and the side whose boundary layer separates.
struct Cut {
    axis: usize,
    left: usize,
    layer: u8,
    score: f64,
}

impl Dissector<'_> {
    /// Reorders the region into left, right and separator; returns the first two lengths, or nothing if no plane cuts it.
    fn split(&mut self, nodes: &mut [u32]) -> Option<(usize, usize)> {
        let mut best: Option<Cut> = None;
        for axis in self.long_axes(nodes) {
            self.sort(nodes, axis);
            for left in self.cuts(nodes, axis) {
                let cut = self.score(nodes, axis, left);
                if best.as_ref().is_none_or(|best| cut.score < best.score) {
                    best = Some(cut);
                }
            }
        }
        let best = best?;
        self.sort(nodes, best.axis);
        self.mark(nodes, best.left);
        let layer: Vec<u32> = nodes.iter().copied().filter(|&node| self.in_layer(node, best.layer)).collect();
        for &node in &layer {
            self.side[node as usize] = SEPARATOR;
        }
        // A stable sort keeps the coordinate order inside each part.
        nodes.sort_by_key(|&node| self.side[node as usize]);
        let left = nodes.partition_point(|&node| self.side[node as usize] == LEFT);
        self.clear(nodes);
        Some((left, nodes.len() - left - layer.len()))
    }

    /// The axes along which the region is at least two thirds as long as along its longest one.
    fn long_axes(&self, nodes: &[u32]) -> Vec<usize> {
        let mut length = [0.0; 3];
        for (axis, length) in length.iter_mut().enumerate() {
            let of = |node: &u32| self.points[*node as usize][axis];
            let (low, high) = nodes.iter().map(of).fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
            *length = high - low;
        }
        let longest = length.iter().fold(0.0, |a: f64, &b| a.max(b));
        (0..3).filter(|&axis| length[axis] > 0.0 && length[axis] >= longest / 1.5).collect()
    }

    fn sort(&self, nodes: &mut [u32], axis: usize) {
        nodes.sort_unstable_by(|&a, &b| {
            self.points[a as usize][axis].total_cmp(&self.points[b as usize][axis]).then(a.cmp(&b))
        });
    }

    /// Numbers of nodes left of the planes worth trying; nodes with (nearly) one coordinate stay together.
    fn cuts(&self, nodes: &[u32], axis: usize) -> Vec<usize> {
        let at = |k: usize| self.points[nodes[k] as usize][axis];
        let same = 1e-6 * (at(nodes.len() - 1) - at(0));
        let mut cuts = Vec::new();
        for share in CUT_SHARES {
            let wanted = (share * nodes.len() as f64) as usize;
            let mut below = wanted;
            while below > 0 && at(below) - at(below - 1) <= same {
                below -= 1;
            }
            let mut above = wanted;
            while above < nodes.len() && (above == 0 || at(above) - at(above - 1) <= same) {
                above += 1;
            }
            for cut in [below, above] {
                if cut > 0 && cut < nodes.len() && !cuts.contains(&cut) {
                    cuts.push(cut);
                }
            }
        }
        cuts
    }

    fn score(&mut self, nodes: &[u32], axis: usize, left: usize) -> Cut {
        self.mark(nodes, left);
        let of_left = nodes[..left].iter().filter(|&&node| self.in_layer(node, LEFT)).count();
        let of_right = nodes[left..].iter().filter(|&&node| self.in_layer(node, RIGHT)).count();
        self.clear(nodes);
        let right = nodes.len() - left;
        let judge = |layer: u8, size: usize, a: usize, b: usize| {
            let imbalance = a.abs_diff(b) as f64 / nodes.len() as f64;
            Cut { axis, left, layer, score: size as f64 * (1.0 + 0.5 * imbalance) }
        };
        let by_left = judge(LEFT, of_left, left - of_left, right);
        let by_right = judge(RIGHT, of_right, left, right - of_right);
        if by_right.score < by_left.score { by_right } else { by_left }
    }

    fn mark(&mut self, nodes: &[u32], left: usize) {
        for (k, &node) in nodes.iter().enumerate() {
            self.side[node as usize] = if k < left { LEFT } else { RIGHT };
        }
    }

    fn clear(&mut self, nodes: &[u32]) {
        for &node in nodes {
            self.side[node as usize] = OUTSIDE;
        }
    }

    /// Whether the node lies on `layer`'s side and touches the other side.
    fn in_layer(&self, node: u32, layer: u8) -> bool {
        let other = LEFT + RIGHT - layer;
        let touches = |&neighbour: &u32| self.side[neighbour as usize] == other;
        self.side[node as usize] == layer && self.graph.neighbours(node as usize).iter().any(touches)
    }
}

/// Orders a small region by approximate minimum degree of its own graph.
fn minimum_degree(graph: &Graph, nodes: &mut [u32]) {
    nodes.sort_unstable();
    let (mut starts, mut rows) = (vec![0i32], Vec::new());
    for &node in nodes.iter() {
        let inside = graph.neighbours(node as usize).iter().filter_map(|other| nodes.binary_search(other).ok());
        rows.extend(inside.map(|local| local as i32));
        starts.push(rows.len() as i32);
    }
    if let Some(order) = multilevel(&starts, &rows, nodes.len()) {
        let old = nodes.to_vec();
        for (node, at) in nodes.iter_mut().zip(order) {
            *node = old[at as usize];
        }
    }
}

/// Multilevel nested dissection (minimum degree below its own threshold); nothing if it fails.
pub(super) fn multilevel(starts: &[i32], rows: &[i32], nodes: usize) -> Option<Vec<u32>> {
    let pattern = feral_metis::CscPattern::new(nodes, starts, rows)?;
    let options =
        feral_metis::MetisOptions { nd_to_amd_switch: MAX_LEAF_NODES.max(nodes.min(200)) as u32, ..Default::default() };
    let (order, _, _) = feral_metis::metis_order_full(&pattern, &options).ok()?;
    Some(order.into_iter().map(|node| node as u32).collect())
}
