//! The part of a body above a level as a body of its own.

use crate::LevelBody;
use crate::level_piece::{Edge, Simplex, WallKind, share_of_edge};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Even permutations of four corners: none turns a tetrahedron inside out.
const EVEN: [[usize; 4]; 12] = [
    [0, 1, 2, 3],
    [0, 2, 3, 1],
    [0, 3, 1, 2],
    [1, 0, 3, 2],
    [1, 2, 0, 3],
    [1, 3, 2, 0],
    [2, 0, 1, 3],
    [2, 1, 3, 0],
    [2, 3, 0, 1],
    [3, 0, 2, 1],
    [3, 1, 0, 2],
    [3, 2, 1, 0],
];

impl LevelBody {
    /// The part where the field is above the level, which other fields cut once more ([`with_values`](Self::with_values)). What was cut off is beyond its skin.
    ///
    /// Sides that two pieces share are divided alike, by the numbers of their points, and so is the cut itself, seen from above and from below: parts of one body have
    /// no gaps, and none overlap.
    #[must_use]
    pub fn above(&self, level: f64) -> LevelBody {
        let out = LevelBody { simplices: Arc::default(), owners: Arc::default(), ..self.clone() };
        let mut cutter = Cutter { body: self, level, known: BTreeMap::new(), out };
        for (simplex, owner) in self.simplices.iter().zip(self.owners.iter()) {
            let owned = cutter.out.simplices.len();
            match simplex {
                Simplex::Tetrahedron { corners, sides } => cutter.tetrahedron(corners, sides),
                Simplex::Triangle { corners, sides } => cutter.triangle(*corners, *sides),
            }
            let more = cutter.out.simplices.len() - owned;
            Arc::make_mut(&mut cutter.out.owners).extend(std::iter::repeat_n(*owner, more));
        }
        cutter.out
    }
}

struct Cutter<'a> {
    body: &'a LevelBody,
    level: f64,
    known: BTreeMap<Edge, u32>,
    out: LevelBody,
}

impl Cutter<'_> {
    fn is_above(&self, point: u32) -> bool {
        self.body.values[point as usize] >= self.level
    }

    fn tetrahedron(&mut self, corners: &[u32; 4], sides: &[WallKind; 4]) {
        let is_above = corners.map(|corner| self.is_above(corner));
        // those above come first
        let sorted = |order: &&[usize; 4]| order.windows(2).all(|pair| is_above[pair[0]] >= is_above[pair[1]]);
        let Some(order) = EVEN.iter().find(sorted) else { return };
        self.number_cuts(corners, &is_above);
        let parent = (order.map(|k| corners[k]), order.map(|k| sides[k]));
        let [a, b, c, d] = parent.0;
        let (at, cut) = (Edge::at, Edge::between);
        match is_above.iter().filter(|is_above| **is_above).count() {
            4 => {
                Arc::make_mut(&mut self.out.simplices).push(Simplex::Tetrahedron { corners: parent.0, sides: parent.1 })
            }
            3 => self.prism([at(a), at(b), at(c)], [cut(a, d), cut(b, d), cut(c, d)], &parent),
            2 => self.prism([at(a), cut(a, c), cut(a, d)], [at(b), cut(b, c), cut(b, d)], &parent),
            1 => self.push([at(a), cut(a, b), cut(a, c), cut(a, d)], &parent),
            _ => {}
        }
    }

    /// Numbers the points of the cut in the order of their edges: the same on both sides of it, whose facets are divided by these numbers.
    fn number_cuts(&mut self, corners: &[u32; 4], is_above: &[bool; 4]) {
        let pairs = (0..4).flat_map(|i| (0..i).map(move |j| (i, j)));
        let cut = pairs.filter(|(i, j)| is_above[*i] != is_above[*j]);
        let mut edges: Vec<Edge> = cut.map(|(i, j)| Edge::between(corners[i], corners[j])).collect();
        edges.sort_unstable();
        edges.into_iter().for_each(|edge| {
            self.point(edge);
        });
    }

    /// Three tetrahedra; each of the sides with four corners is divided from the corner of the smallest number (J. Dompierre, P. Labbe, M.-G. Vallet, R. Camarero,
    /// How to subdivide pyramids, prisms and hexahedra into tetrahedra, 8th International Meshing Roundtable, 1999).
    fn prism(&mut self, low: [Edge; 3], high: [Edge; 3], parent: &([u32; 4], [WallKind; 4])) {
        let number = |cutter: &mut Self, edges: [Edge; 3]| edges.map(|edge| cutter.point(edge));
        let (below, above) = (number(self, low), number(self, high));
        let first = |ids: &[u32; 3]| (0..3).min_by_key(|k| ids[*k]).unwrap_or(0);
        let (i, j) = (first(&below), first(&above));
        // the first corner is the one of the smallest number; seen from the other end the triangle turns the other way
        let [p, q] = if below[i] < above[j] {
            [low, high].map(|own| [own[i], own[(i + 1) % 3], own[(i + 2) % 3]])
        } else {
            [high, low].map(|own| [own[j], own[(j + 2) % 3], own[(j + 1) % 3]])
        };
        let least = |cutter: &mut Self, [a, b]: [Edge; 2]| cutter.point(a).min(cutter.point(b));
        if least(self, [p[1], q[2]]) < least(self, [p[2], q[1]]) {
            self.push([p[0], p[1], p[2], q[2]], parent);
            self.push([p[0], p[1], q[2], q[1]], parent);
        } else {
            self.push([p[0], p[1], p[2], q[1]], parent);
            self.push([p[0], q[1], p[2], q[2]], parent);
        }
        self.push([p[0], q[1], q[2], q[0]], parent);
    }

    fn push(&mut self, own: [Edge; 4], (corners, sides): &([u32; 4], [WallKind; 4])) {
        let beyond =
            [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].map(|side| beyond(&side.map(|k| own[k]), corners, sides));
        let corners = own.map(|edge| self.point(edge));
        Arc::make_mut(&mut self.out.simplices).push(Simplex::Tetrahedron { corners, sides: beyond });
    }

    fn triangle(&mut self, corners: [u32; 3], sides: [WallKind; 3]) {
        let mut polygon = Vec::with_capacity(4);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if self.is_above(a) {
                polygon.push(Edge::at(a));
            }
            if self.is_above(a) != self.is_above(b) {
                polygon.push(Edge::between(a, b));
            }
        }
        for k in 2..polygon.len() {
            let own = [polygon[0], polygon[k - 1], polygon[k]];
            let beyond = [[1, 2], [0, 2], [0, 1]].map(|side| beyond(&side.map(|k| own[k]), &corners, &sides));
            let corners = own.map(|edge| self.point(edge));
            Arc::make_mut(&mut self.out.simplices).push(Simplex::Triangle { corners, sides: beyond });
        }
    }

    fn point(&mut self, edge: Edge) -> u32 {
        let Edge { low: a, high: b } = edge;
        if a == b {
            return a;
        }
        let next = (self.out.nodes + self.out.points.len()) as u32;
        let index = *self.known.entry(edge).or_insert(next);
        if index == next {
            let [s, t] = [a, b].map(|point| self.body.values[point as usize]);
            let share = share_of_edge(self.level, [s, t]);
            let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
            for (point, share) in [(a, 1.0 - share), (b, share)] {
                match (point as usize).checked_sub(self.body.nodes) {
                    None => *sum.entry(point).or_default() += share,
                    Some(k) => {
                        self.body.points[k]
                            .iter()
                            .for_each(|(node, own)| *sum.entry(*node).or_default() += share * own);
                    }
                }
            }
            Arc::make_mut(&mut self.out.points).push(sum.into_iter().collect());
            self.out.values.push(s + share * (t - s));
        }
        index
    }
}

/// What lies beyond a side of a part: what was cut off, or what lies beyond the side of the whole that it is on.
fn beyond(side: &[Edge], corners: &[u32], sides: &[WallKind]) -> WallKind {
    if side.iter().all(|edge| edge.low != edge.high) {
        return WallKind::Skin;
    }
    let is_off = |corner: &u32| side.iter().all(|edge| edge.low != *corner && edge.high != *corner);
    corners.iter().position(is_off).map_or(WallKind::Within, |k| sides[k])
}
