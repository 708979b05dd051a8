//! The part of a simplex in which a linear field is above a level.

use std::collections::BTreeMap;

/// An edge is cut no nearer to its ends than this share of it: what is thinner is no triangle in a file of single precision.
const LEAST_SHARE_OF_EDGE: f64 = 1e-3;

/// A piece of a cell; its bit k of `skin` is set where the side opposite to corner k is skin.
#[derive(Clone, Debug)]
pub(crate) enum Simplex {
    /// The first three corners counter-clockwise seen from outside, the fourth within.
    Tetrahedron { corners: [u32; 4], skin: u8 },
    /// Counter-clockwise.
    Triangle { corners: [u32; 3], skin: u8 },
}

impl Simplex {
    /// The cell with these corners itself; its facets, outward, and whether they are skin.
    pub fn of(corners: &[u32], facets: &[(bool, Vec<u32>)]) -> Option<Self> {
        let (_, first) = facets.first()?;
        let last = *corners.iter().find(|corner| !first.contains(corner))?;
        let mut own = first.clone();
        own.push(last);
        let mut skin = 0;
        for (k, corner) in own.iter().enumerate() {
            let is_skin = facets.iter().any(|(is_skin, facet)| *is_skin && !facet.contains(corner));
            skin |= u8::from(is_skin) << k;
        }
        match own[..] {
            [a, b, c, d] => Some(Simplex::Tetrahedron { corners: [a, b, c, d], skin }),
            [a, b, c] => Some(Simplex::Triangle { corners: [a, b, c], skin }),
            _ => None,
        }
    }

    /// A side, outward, and the point within that it belongs to.
    pub fn around(side: &[u32], within: u32, is_skin: bool) -> Self {
        match *side {
            [a, b, c] => Simplex::Tetrahedron { corners: [a, b, c, within], skin: u8::from(is_skin) << 3 },
            [a, b, ..] => Simplex::Triangle { corners: [a, b, within], skin: u8::from(is_skin) << 2 },
            _ => Simplex::Triangle { corners: [within; 3], skin: 0 },
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
        let out = Clipped { points: Vec::new(), triangles: Vec::new() };
        Clipper { places, values, level, thickness, known: BTreeMap::new(), out }
    }

    pub fn clipped(self) -> Clipped {
        self.out
    }

    /// The sides that are skin where the field is above the level, and the cut between them.
    pub fn tetrahedron(&mut self, corners: &[u32; 4], skin: u8) {
        let [a, b, c, d] = *corners;
        let sides = [[b, d, c], [c, d, a], [a, d, b], [a, b, c]];
        let mut cut = Vec::new();
        for (k, side) in sides.iter().enumerate() {
            let (polygon, through) = self.clip(side);
            cut.extend(through);
            if skin >> k & 1 == 1 {
                self.add_polygon(&polygon, false, false);
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
        self.add_polygon(&polygon, false, false);
    }

    /// A plate: both faces, and walls at the cut and at sides that are skin.
    pub fn triangle(&mut self, corners: &[u32; 3], skin: u8) {
        let (polygon, through) = self.clip(corners);
        self.add_polygon(&polygon, true, false);
        self.add_polygon(&polygon, false, true);
        let [a, b, c] = *corners;
        let mut walls: Vec<(Edge, Edge)> = through.into_iter().collect();
        for (k, side) in [[b, c], [c, a], [a, b]].iter().enumerate() {
            if skin >> k & 1 == 1 {
                walls.extend(self.part_above(*side));
            }
        }
        for (from, to) in walls {
            let [p, q] = [from, to].map(|edge| self.point(edge, false));
            let [r, s] = [from, to].map(|edge| self.point(edge, true));
            self.out.triangles.extend([[p, q, s], [p, s, r]]);
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

    fn add_polygon(&mut self, polygon: &[Edge], is_upper: bool, is_reversed: bool) {
        let points: Vec<u32> = polygon.iter().map(|edge| self.point(*edge, is_upper)).collect();
        for k in 2..points.len() {
            let [a, b, c] = [points[0], points[k - 1], points[k]];
            self.out.triangles.push(if is_reversed { [a, c, b] } else { [a, b, c] });
        }
    }

    fn point(&mut self, edge: Edge, is_upper: bool) -> u32 {
        let next = self.out.points.len() as u32;
        let Edge { low: a, high: b } = edge;
        let index = *self.known.entry((a, b, is_upper)).or_insert(next);
        if index == next {
            let [s, t] = [a, b].map(|point| self.values[point as usize]);
            let share = if a == b {
                0.0
            } else {
                ((self.level - s) / (t - s)).clamp(LEAST_SHARE_OF_EDGE, 1.0 - LEAST_SHARE_OF_EDGE)
            };
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

/// A point on an edge, or an end of one: then both are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    low: u32,
    high: u32,
}

impl Edge {
    fn at(point: u32) -> Self {
        Edge { low: point, high: point }
    }

    fn between(a: u32, b: u32) -> Self {
        Edge { low: a.min(b), high: a.max(b) }
    }
}
