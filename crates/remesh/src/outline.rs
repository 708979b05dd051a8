//! [`Outline`]: where the pieces of a cut body end, made coarse enough for cells of a size.

use crate::kept_body::BorderFacet;
use crate::vector::{cross, distance, dot, length, minus};
use std::collections::{BTreeMap, BTreeSet};

/// Edges shorter than this share of the size of cells are removed.
const SHORT_EDGE: f64 = 0.6;
/// Longer ones are not made by that, and in space divided.
const LONG_EDGE: f64 = 1.5;
/// A removed point lies within this share of the size of cells from what is left.
pub(crate) const TOLERANCE: f64 = 0.05;
/// Along edges shorter than this share of it patches may end elsewhere and facets turn.
const TINY_EDGE: f64 = 0.1;
/// The cosine of the angle by which no triangle turns: 45 degrees.
const LEAST_COSINE: f64 = 0.7;
/// The cosine of the angle between facets below which one lies on the other: 8 degrees.
const LARGEST_FOLD: f64 = 0.99;
/// No triangle becomes flatter than this height over its longest edge, unless it was.
const LEAST_HEIGHT: f64 = 0.15;
/// Rounds over all edges, at most.
const ROUNDS: usize = 40;

/// A smooth part of the outline: what lies on both sides, and the surfaces that it is of.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Patch {
    /// The piece that it bounds.
    pub inside: u32,
    /// The piece on the other side.
    pub outside: Option<u32>,
    /// The named surfaces that it lies on, by their numbers.
    pub surfaces: Vec<usize>,
}

/// The outline of pieces: edges in the plane, triangles in space, neighbours share points.
#[derive(Clone, Debug)]
pub struct Outline {
    /// 2 or 3.
    pub dim: usize,
    /// Points; those that no facet has are not of it.
    pub points: Vec<[f64; 3]>,
    /// Points of the facets, and the number of their patch.
    pub facets: Vec<(Vec<u32>, usize)>,
    /// The patches.
    pub patches: Vec<Patch>,
    size: f64,
    /// Of every point the facets that have it.
    around: Vec<Vec<usize>>,
    /// Of every point those that were removed for it.
    removed: Vec<Vec<[f64; 3]>>,
    kept: BTreeSet<u32>,
}

impl Outline {
    /// Of the border of pieces, for cells of this size. The points `kept` are not removed.
    #[must_use]
    pub fn new(dim: usize, points: &[[f64; 3]], border: &[BorderFacet], kept: BTreeSet<u32>, size: f64) -> Self {
        let patch = |facet: &BorderFacet| Patch {
            inside: facet.inside,
            outside: facet.outside,
            surfaces: facet.surfaces.clone(),
        };
        let patches: Vec<Patch> = border.iter().map(patch).collect::<BTreeSet<_>>().into_iter().collect();
        let facet =
            |facet: &BorderFacet| (facet.nodes.clone(), patches.binary_search(&patch(facet)).unwrap_or_default());
        let facets: Vec<(Vec<u32>, usize)> = border.iter().map(facet).collect();
        let mut outline = Outline {
            dim,
            points: points.to_vec(),
            facets,
            patches,
            size,
            around: vec![Vec::new(); points.len()],
            removed: vec![Vec::new(); points.len()],
            kept,
        };
        for (k, (nodes, _)) in outline.facets.iter().enumerate() {
            nodes.iter().for_each(|node| outline.around[*node as usize].push(k));
        }
        outline
    }

    /// Removes points of short edges as long as all that were removed lie within a twentieth of the size of what is left, ends of patches stay and no facet
    /// turns over; in space divides long edges. How many were removed.
    pub fn simplify(&mut self) -> usize {
        let mut count = 0;
        for _ in 0..ROUNDS {
            let mut edges: Vec<(f64, [u32; 2])> =
                self.edges().into_keys().map(|[a, b]| (self.distance(a, b), [a, b])).collect();
            edges.retain(|(length, _)| *length < SHORT_EDGE * self.size);
            edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let before = count;
            for (_, [a, b]) in edges {
                count += usize::from(self.remove(b, a) || self.remove(a, b));
            }
            if count == before {
                break;
            }
        }
        if self.dim == 3 {
            self.divide_long_edges();
        }
        self.facets.retain(|(nodes, _)| !nodes.is_empty());
        count
    }

    /// The facets of every edge.
    fn edges(&self) -> BTreeMap<[u32; 2], Vec<usize>> {
        let mut edges: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (k, (nodes, _)) in self.facets.iter().enumerate() {
            for i in 0..nodes.len() {
                for j in 0..i {
                    let (a, b) = (nodes[i].min(nodes[j]), nodes[i].max(nodes[j]));
                    edges.entry([a, b]).or_default().push(k);
                }
            }
        }
        edges
    }

    fn distance(&self, a: u32, b: u32) -> f64 {
        length(minus(self.points[a as usize], self.points[b as usize]))
    }

    fn has(&self, facet: usize, node: u32) -> bool {
        self.facets[facet].0.contains(&node)
    }

    fn neighbours(&self, node: u32) -> BTreeSet<u32> {
        let own = self.around[node as usize].iter().flat_map(|k| self.facets[*k].0.iter().copied());
        own.filter(|other| *other != node).collect()
    }

    /// The other ends of edges of a point at which patches end.
    fn ridges(&self, node: u32) -> Vec<u32> {
        let is_ridge = |other: &u32| {
            let own: Vec<usize> = self.around[node as usize].iter().copied().filter(|k| self.has(*k, *other)).collect();
            own.len() != 2 || self.facets[own[0]].1 != self.facets[own[1]].1
        };
        self.neighbours(node).into_iter().filter(is_ridge).collect()
    }

    /// Whether a point may go to a neighbour without that patches end elsewhere, by more than a tiny edge.
    fn may_go(&self, node: u32, to: u32) -> bool {
        if self.kept.contains(&node) {
            return false;
        }
        if self.distance(node, to) < TINY_EDGE * self.size {
            return true;
        }
        if self.dim == 2 {
            let own = &self.around[node as usize];
            return own.len() == 2 && self.facets[own[0]].1 == self.facets[own[1]].1;
        }
        match self.ridges(node)[..] {
            [] => true,
            // both edges lie between the same patches
            [a, b] => (a == to || b == to) && self.patches_at(node, a) == self.patches_at(node, b),
            _ => false,
        }
    }

    fn patches_at(&self, a: u32, b: u32) -> Vec<usize> {
        let own = self.around[a as usize].iter().filter(|k| self.has(**k, b));
        let mut patches: Vec<usize> = own.map(|k| self.facets[*k].1).collect();
        patches.sort_unstable();
        patches
    }

    /// Moves a point into a neighbour, if it may go.
    fn remove(&mut self, node: u32, to: u32) -> bool {
        let own = self.around[node as usize].clone();
        let (gone, stays): (Vec<usize>, Vec<usize>) = own.iter().partition(|k| self.has(**k, to));
        if gone.is_empty() || !self.may_go(node, to) {
            return false;
        }
        let (of_node, of_to) = (self.neighbours(node), self.neighbours(to));
        // no facet twice, no hole closed: what both have beside each other are the third corners of what goes
        let opposite: BTreeSet<u32> = gone.iter().flat_map(|k| self.facets[*k].0.iter().copied()).collect();
        let is_simple = of_node.intersection(&of_to).all(|common| opposite.contains(common));
        let is_loop = self.dim == 2 && of_node.iter().any(|other| *other != to && of_to.contains(other));
        let made: Vec<Vec<u32>> = stays.iter().map(|k| replaced(&self.facets[*k].0, node, to)).collect();
        if !is_simple || is_loop || self.closes_a_gap(&made, &own) {
            return false;
        }
        let is_short = self.distance(node, to) < TINY_EDGE * self.size;
        let may = |(k, made): (&usize, &Vec<u32>)| {
            let (old, patch) = &self.facets[*k];
            let around = if self.dim == 3 { self.normal_around(*patch, [node, to]) } else { [0.0; 3] };
            self.may_become(old, made, to, around, is_short)
        };
        if !stays.iter().zip(&made).all(may) {
            return false;
        }
        if !self.is_near(node, to, &own, &made, &of_node) {
            return false;
        }
        for k in gone {
            let nodes = std::mem::take(&mut self.facets[k].0);
            nodes.iter().for_each(|other| self.around[*other as usize].retain(|own| *own != k));
        }
        for (k, made) in stays.into_iter().zip(made) {
            self.facets[k].0 = made;
            self.around[to as usize].push(k);
        }
        self.around[node as usize].clear();
        let mut moved = std::mem::take(&mut self.removed[node as usize]);
        moved.push(self.points[node as usize]);
        self.removed[to as usize].extend(moved);
        true
    }

    /// Whether facets that are made lie on others, those that go left out: of the same points, or at an edge turned from them by nearly nothing.
    fn closes_a_gap(&self, made: &[Vec<u32>], gone: &[usize]) -> bool {
        let nodes: BTreeSet<u32> = made.iter().flatten().copied().collect();
        let near: BTreeSet<usize> = nodes.iter().flat_map(|node| self.around[*node as usize].iter().copied()).collect();
        let others = near.iter().filter(|k| !gone.contains(k)).map(|k| &self.facets[*k].0);
        let others: Vec<&Vec<u32>> = others.chain(made).collect();
        made.iter().any(|own| others.iter().any(|other| !std::ptr::eq(*other, own) && self.is_folded(own, other)))
    }

    fn is_folded(&self, own: &[u32], other: &[u32]) -> bool {
        let shared: Vec<u32> = own.iter().copied().filter(|node| other.contains(node)).collect();
        let off = |nodes: &[u32]| nodes.iter().copied().find(|node| !shared.contains(node));
        let (Some(a), Some(b)) = (off(own), off(other)) else { return true };
        let Some(end) = shared.first().filter(|_| shared.len() + 1 == own.len()) else { return false };
        let at = |node: u32| minus(self.points[node as usize], self.points[*end as usize]);
        // of triangles the heights over the edge
        let height = |node: u32| match shared.get(1).map(|second| at(*second)) {
            Some(edge) => {
                let share = dot(at(node), edge) / dot(edge, edge);
                [0, 1, 2].map(|k| at(node)[k] - share * edge[k])
            }
            None => at(node),
        };
        let (a, b) = (height(a), height(b));
        dot(a, b) > LARGEST_FOLD * length(a) * length(b)
    }

    /// Whether a facet may become another: no long edge, not turned from its direction or, of a sliver and where the point moves along a tiny edge, from that around,
    /// and not flat.
    fn may_become(&self, old: &[u32], made: &[u32], to: u32, around: [f64; 3], is_short: bool) -> bool {
        if made.iter().any(|other| self.distance(*other, to) > LONG_EDGE * self.size) {
            return false;
        }
        if self.dim == 2 {
            return true;
        }
        let after = self.normal(made);
        if is_short {
            return dot(around, after) > 0.0;
        }
        let [flat, flatter] = [old, made].map(|nodes| self.height(nodes));
        // a sliver has no direction of its own
        let is_sliver = flat * self.longest(old) < TINY_EDGE * self.size;
        let before = if is_sliver { around } else { self.normal(old) };
        dot(before, after) >= LEAST_COSINE * length(before) * length(after)
            && (flatter >= LEAST_HEIGHT || flatter >= flat)
    }

    /// The sum of the normals of a patch around two points.
    fn normal_around(&self, patch: usize, ends: [u32; 2]) -> [f64; 3] {
        let facets: BTreeSet<usize> =
            ends.iter().flat_map(|node| self.around[*node as usize].iter().copied()).collect();
        let own = facets.into_iter().filter(|k| self.facets[*k].1 == patch);
        own.map(|k| self.normal(&self.facets[k].0)).fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]))
    }

    /// Twice the area, along the normal.
    fn normal(&self, nodes: &[u32]) -> [f64; 3] {
        let at = |k: usize| self.points[nodes[k] as usize];
        cross(minus(at(1), at(0)), minus(at(2), at(0)))
    }

    fn longest(&self, nodes: &[u32]) -> f64 {
        (0..3).map(|k| self.distance(nodes[k], nodes[(k + 1) % 3])).fold(0.0, f64::max)
    }

    /// Of a triangle over its longest edge, as a share of that.
    fn height(&self, nodes: &[u32]) -> f64 {
        let longest = self.longest(nodes);
        if longest > 0.0 { length(self.normal(nodes)) / (longest * longest) } else { 0.0 }
    }

    /// Whether all removed points around lie near what is left.
    fn is_near(&self, node: u32, to: u32, own: &[usize], made: &[Vec<u32>], around: &BTreeSet<u32>) -> bool {
        let limit = TOLERANCE * self.size;
        let simplex = |nodes: &[u32]| nodes.iter().map(|node| self.points[*node as usize]).collect::<Vec<[f64; 3]>>();
        let others = around.iter().chain([&to]).flat_map(|other| self.around[*other as usize].iter());
        let others: BTreeSet<usize> = others.copied().filter(|k| !own.contains(k)).collect();
        let left: Vec<Vec<[f64; 3]>> =
            made.iter().map(|nodes| simplex(nodes)).chain(others.iter().map(|k| simplex(&self.facets[*k].0))).collect();
        let removed = around.iter().chain([&node, &to]).flat_map(|other| self.removed[*other as usize].iter());
        removed.chain([&self.points[node as usize]]).all(|p| left.iter().any(|own| distance(*p, own) <= limit))
    }

    /// Puts points in the middle of edges that are too long for the size, the longest first, until there is none.
    fn divide_long_edges(&mut self) {
        loop {
            let mut edges: Vec<(f64, [u32; 2], Vec<usize>)> =
                self.edges().into_iter().map(|([a, b], own)| (self.distance(a, b), [a, b], own)).collect();
            edges.retain(|(length, ..)| *length > LONG_EDGE * self.size);
            edges.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            if edges.is_empty() {
                return;
            }
            let mut touched = BTreeSet::new();
            for (_, [a, b], own) in edges {
                if own.iter().any(|k| touched.contains(k)) {
                    continue;
                }
                let middle = self.points.len() as u32;
                let (x, y) = (self.points[a as usize], self.points[b as usize]);
                self.points.push([0, 1, 2].map(|k| 0.5 * (x[k] + y[k])));
                for k in own {
                    let (nodes, patch) = self.facets[k].clone();
                    touched.insert(k);
                    self.facets[k].0 = replaced(&nodes, a, middle);
                    self.facets.push((replaced(&nodes, b, middle), patch));
                }
            }
        }
    }

    /// The shortest edge.
    #[must_use]
    pub fn shortest_edge(&self) -> f64 {
        self.edges().into_keys().map(|[a, b]| self.distance(a, b)).fold(f64::INFINITY, f64::min)
    }

    /// Length or area of the facets of a surface.
    #[must_use]
    pub fn measure_of(&self, surface: usize) -> f64 {
        let own = self.facets.iter().filter(|(_, patch)| self.patches[*patch].surfaces.contains(&surface));
        own.map(|(nodes, _)| match self.dim {
            2 => self.distance(nodes[0], nodes[1]),
            _ => 0.5 * length(self.normal(nodes)),
        })
        .fold(0.0, |sum, own| sum + own)
    }
}

fn replaced(nodes: &[u32], old: u32, new: u32) -> Vec<u32> {
    nodes.iter().map(|node| if *node == old { new } else { *node }).collect()
}
