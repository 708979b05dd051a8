//! The part of a simplex in which a linear field is above a level.

use std::collections::BTreeMap;

/// An edge is cut no nearer to its ends than this share of it: what is thinner is no triangle in a file of single precision.
const LEAST_SHARE_OF_EDGE: f64 = 1e-3;

/// What lies beyond a side of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallKind {
    /// Another piece of the same body.
    Within,
    /// Nothing: the skin of the mesh, or what was cut off before.
    Skin,
    /// Cells of the mesh that are not of the body.
    Joint,
    /// What is below the level.
    Cut,
    /// Of a plate above and below it.
    Face,
}

/// A piece of a cell, and what lies beyond the side opposite to each corner.
#[derive(Clone, Debug)]
pub(crate) enum Simplex {
    /// The first three corners counter-clockwise seen from outside, the fourth within.
    Tetrahedron { corners: [u32; 4], sides: [WallKind; 4] },
    /// Counter-clockwise.
    Triangle { corners: [u32; 3], sides: [WallKind; 3] },
}

impl Simplex {
    /// The cell with these corners itself; its facets, outward, and what lies beyond.
    pub fn of(corners: &[u32], facets: &[(WallKind, Vec<u32>)]) -> Option<Self> {
        let (_, first) = facets.first()?;
        let last = *corners.iter().find(|corner| !first.contains(corner))?;
        let mut own = first.clone();
        own.push(last);
        let beyond = |corner: &u32| {
            facets.iter().find(|(_, facet)| !facet.contains(corner)).map_or(WallKind::Within, |(side, _)| *side)
        };
        match own[..] {
            [a, b, c, d] => {
                let corners = [a, b, c, d];
                Some(Simplex::Tetrahedron { corners, sides: corners.map(|corner| beyond(&corner)) })
            }
            [a, b, c] => {
                let corners = [a, b, c];
                Some(Simplex::Triangle { corners, sides: corners.map(|corner| beyond(&corner)) })
            }
            _ => None,
        }
    }

    /// A side, outward, and the point within that it belongs to.
    pub fn around(side: &[u32], within: u32, beyond: WallKind) -> Self {
        use WallKind::Within;
        match *side {
            [a, b, c] => Simplex::Tetrahedron { corners: [a, b, c, within], sides: [Within, Within, Within, beyond] },
            [a, b, ..] => Simplex::Triangle { corners: [a, b, within], sides: [Within, Within, beyond] },
            _ => Simplex::Triangle { corners: [within; 3], sides: [Within; 3] },
        }
    }

    pub fn corners(&self) -> impl Iterator<Item = &u32> {
        match self {
            Simplex::Tetrahedron { corners, .. } => corners.iter(),
            Simplex::Triangle { corners, .. } => corners.iter(),
        }
    }
}

/// A point of the surface: on an edge between two points, or one of these; below or above in a plate.
type Key = (u32, u32, bool);

/// What has been cut.
pub(crate) struct Clipped {
    pub points: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// What lies beyond each of them.
    pub beyond: Vec<WallKind>,
}

/// Cuts simplices and joins what is cut.
pub(crate) struct Clipper<'a> {
    places: &'a [[f64; 3]],
    values: &'a [f64],
    level: f64,
    thickness: Option<f64>,
    known: BTreeMap<Key, u32>,
    out: Clipped,
}

impl<'a> Clipper<'a> {
    pub fn new(places: &'a [[f64; 3]], values: &'a [f64], level: f64, thickness: Option<f64>) -> Self {
        let out = Clipped { points: Vec::new(), triangles: Vec::new(), beyond: Vec::new() };
        Clipper { places, values, level, thickness, known: BTreeMap::new(), out }
    }

    pub fn clipped(self) -> Clipped {
        self.out
    }

    /// The sides without a neighbour where the field is above the level, and the cut between them.
    pub fn tetrahedron(&mut self, corners: &[u32; 4], beyond: &[WallKind; 4]) {
        let [a, b, c, d] = *corners;
        let sides = [[b, d, c], [c, d, a], [a, d, b], [a, b, c]];
        let mut cut = Vec::new();
        for (side, beyond) in sides.iter().zip(beyond) {
            let (polygon, through) = self.clip(side);
            cut.extend(through);
            if *beyond != WallKind::Within {
                self.add_polygon(&polygon, *beyond, [false, false]);
            }
        }
        // the cut has the edges of the sides, the other way round
        let Some((mut at, first)) = cut.first().copied() else { return };
        let mut polygon = vec![first, at];
        while let Some((_, to)) = cut.iter().find(|(_, to)| *to == at).map(|(from, to)| (to, from)) {
            at = *to;
            if at == first {
                break;
            }
            polygon.push(at);
        }
        self.add_polygon(&polygon, WallKind::Cut, [false, false]);
    }

    /// A plate: both faces, and walls at the cut and at sides without a neighbour.
    pub fn triangle(&mut self, corners: &[u32; 3], beyond: &[WallKind; 3]) {
        let (polygon, through) = self.clip(corners);
        self.add_polygon(&polygon, WallKind::Face, [true, false]);
        self.add_polygon(&polygon, WallKind::Face, [false, true]);
        let [a, b, c] = *corners;
        let mut walls: Vec<(Edge, Edge, WallKind)> =
            through.into_iter().map(|(from, to)| (from, to, WallKind::Cut)).collect();
        for (side, beyond) in [[b, c], [c, a], [a, b]].iter().zip(beyond) {
            if *beyond != WallKind::Within {
                walls.extend(self.part_above(*side).map(|(from, to)| (from, to, *beyond)));
            }
        }
        for (from, to, beyond) in walls {
            let [p, q] = [from, to].map(|edge| self.point(edge, false));
            let [r, s] = [from, to].map(|edge| self.point(edge, true));
            self.out.triangles.extend([[p, q, s], [p, s, r]]);
            self.out.beyond.extend([beyond; 2]);
        }
    }

    fn is_above(&self, point: u32) -> bool {
        self.values[point as usize] >= self.level
    }

    /// The part of an edge where the field is above the level.
    fn part_above(&self, [a, b]: [u32; 2]) -> Option<(Edge, Edge)> {
        match (self.is_above(a), self.is_above(b)) {
            (true, true) => Some((Edge::at(a), Edge::at(b))),
            (true, false) => Some((Edge::at(a), Edge::between(a, b))),
            (false, true) => Some((Edge::between(a, b), Edge::at(b))),
            (false, false) => None,
        }
    }

    /// The part of a triangle above the level, counter-clockwise as it is, and where the cut goes through: from, to.
    fn clip(&self, corners: &[u32; 3]) -> (Vec<Edge>, Option<(Edge, Edge)>) {
        let (mut polygon, mut leaves, mut enters) = (Vec::with_capacity(4), None, None);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            if self.is_above(a) {
                polygon.push(Edge::at(a));
            }
            if self.is_above(a) != self.is_above(b) {
                let edge = Edge::between(a, b);
                polygon.push(edge);
                *if self.is_above(a) { &mut leaves } else { &mut enters } = Some(edge);
            }
        }
        (polygon, leaves.zip(enters))
    }

    fn add_polygon(&mut self, polygon: &[Edge], beyond: WallKind, [is_upper, is_reversed]: [bool; 2]) {
        let points: Vec<u32> = polygon.iter().map(|edge| self.point(*edge, is_upper)).collect();
        for k in 2..points.len() {
            let [a, b, c] = [points[0], points[k - 1], points[k]];
            self.out.triangles.push(if is_reversed { [a, c, b] } else { [a, b, c] });
            self.out.beyond.push(beyond);
        }
    }

    fn point(&mut self, edge: Edge, is_upper: bool) -> u32 {
        let next = self.out.points.len() as u32;
        let Edge { low: a, high: b } = edge;
        let index = *self.known.entry((a, b, is_upper)).or_insert(next);
        if index == next {
            let [s, t] = [a, b].map(|point| self.values[point as usize]);
            let share = if a == b { 0.0 } else { share_of_edge(self.level, [s, t]) };
            let [x, y] = [a, b].map(|point| self.places[point as usize]);
            let mut place = [0, 1, 2].map(|k| x[k] + share * (y[k] - x[k]));
            if is_upper {
                place[2] += self.thickness.unwrap_or_default();
            }
            self.out.points.push(place);
        }
        index
    }
}

/// Where between its ends, of these values, an edge is cut.
pub(crate) fn share_of_edge(level: f64, [s, t]: [f64; 2]) -> f64 {
    ((level - s) / (t - s)).clamp(LEAST_SHARE_OF_EDGE, 1.0 - LEAST_SHARE_OF_EDGE)
}

/// A point on an edge, or an end of one: then both are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    pub low: u32,
    pub high: u32,
}

impl Edge {
    pub fn at(point: u32) -> Self {
        Edge { low: point, high: point }
    }

    pub fn between(a: u32, b: u32) -> Self {
        Edge { low: a.min(b), high: a.max(b) }
    }
}
