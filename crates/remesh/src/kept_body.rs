//! [`KeptBody`]: the simplices of a cut body, welded, in connected pieces.

use crate::vector::{cross, distance, dot, mean, minus};
use nastic_mesh::{Facet, Mesh};
use nastic_numeric::DisjointSets;
use nastic_result::made_body::MadePart;
use std::collections::{BTreeMap, BTreeSet};

/// Points nearer than this share of the body's size are one.
const SAME_POINT: f64 = 1e-9;
/// A facet of a piece lies on a facet of the mesh within this share of the body's size.
const ON_FACET: f64 = 1e-7;

/// A connected piece of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The part of the body that it belongs to.
    pub part: usize,
    /// Area or volume.
    pub volume: f64,
}

/// A piece's facet on its border: an edge in the plane, a triangle in space, seen from outside of `inside` counter-clockwise.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BorderFacet {
    /// Its points.
    pub nodes: Vec<u32>,
    /// The piece that it bounds.
    pub inside: u32,
    /// The piece on the other side.
    pub outside: Option<u32>,
    /// The surfaces of the mesh that it lies on, by their numbers.
    pub surfaces: Vec<usize>,
}

/// The simplices of a cut body: pieces share points where they touch.
#[derive(Clone, Debug)]
pub struct KeptBody {
    /// 2 or 3.
    pub dim: usize,
    /// Where the points are.
    pub points: Vec<[f64; 3]>,
    /// The node of the mesh that a point is.
    pub nodes: Vec<Option<u32>>,
    /// The connected pieces.
    pub pieces: Vec<Piece>,
    simplices: Vec<Simplex>,
    tolerance: f64,
}

#[derive(Clone, Debug)]
struct Simplex {
    corners: Vec<u32>,
    owner: u32,
    piece: u32,
}

/// A facet of a simplex: the simplex, and the corner opposite.
#[derive(Clone, Copy)]
struct Side {
    simplex: usize,
    corner: usize,
}

impl KeptBody {
    /// Welds the parts of a body on a mesh.
    #[must_use]
    pub fn of(mesh: &Mesh, parts: &[MadePart]) -> Self {
        let size = mesh.diagonal();
        let mut body = KeptBody {
            dim: mesh.dim(),
            points: Vec::new(),
            nodes: Vec::new(),
            pieces: Vec::new(),
            simplices: Vec::new(),
            tolerance: ON_FACET * size,
        };
        let mut weld = Weld { tolerance: SAME_POINT * size, known: BTreeMap::new() };
        for (number, part) in parts.iter().enumerate() {
            let own = &part.simplices;
            let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
            for (corners, owner) in own.corners.iter().zip(&own.owners) {
                let corners = corners.iter().map(|corner| {
                    let node = ((*corner as usize) < mesh.points().len()).then_some(*corner);
                    *numbers.entry(*corner).or_insert_with(|| weld.point(&mut body, own.points[*corner as usize], node))
                });
                let corners = corners.collect();
                body.simplices.push(Simplex { corners, owner: *owner, piece: number as u32 });
            }
        }
        body.number_pieces();
        body
    }

    /// From the numbers of parts to those of connected pieces of them.
    fn number_pieces(&mut self) {
        let mut sets = DisjointSets::new(self.simplices.len());
        for sides in self.sides().values() {
            if let [a, b] = sides[..]
                && self.simplices[a.simplex].piece == self.simplices[b.simplex].piece
            {
                sets.union(a.simplex as u32, b.simplex as u32);
            }
        }
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        for k in 0..self.simplices.len() {
            let next = numbers.len() as u32;
            let number = *numbers.entry(sets.find(k as u32)).or_insert(next);
            let (part, volume) = (self.simplices[k].piece as usize, self.volume(k));
            if number == next && self.pieces.len() == next as usize {
                self.pieces.push(Piece { part, volume: 0.0 });
            }
            self.pieces[number as usize].volume += volume;
            self.simplices[k].piece = number;
        }
    }

    fn volume(&self, simplex: usize) -> f64 {
        let at = |k: usize| self.points[self.simplices[simplex].corners[k] as usize];
        let edge = |k: usize| minus(at(k), at(0));
        match self.dim {
            2 => 0.5 * cross(edge(1), edge(2))[2].abs(),
            _ => dot(cross(edge(1), edge(2)), edge(3)).abs() / 6.0,
        }
    }

    /// Area or volume of all pieces.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.volume).sum()
    }

    fn sides(&self) -> BTreeMap<Vec<u32>, Vec<Side>> {
        let mut sides: BTreeMap<Vec<u32>, Vec<Side>> = BTreeMap::new();
        for (k, simplex) in self.simplices.iter().enumerate() {
            for corner in 0..simplex.corners.len() {
                let mut key: Vec<u32> = simplex.corners.clone();
                key.remove(corner);
                key.sort_unstable();
                sides.entry(key).or_default().push(Side { simplex: k, corner });
            }
        }
        sides
    }

    /// Removes what is not connected, over pieces that touch along facets, with anything that is held: with a node of `held`, or where nothing of a body of the
    /// mesh is held, with the largest of it. The volumes of what was removed.
    pub fn drop_islands(&mut self, mesh: &Mesh, held: &BTreeSet<u32>) -> Vec<f64> {
        let mut sets = DisjointSets::new(self.pieces.len());
        for sides in self.sides().values() {
            if let [a, b] = sides[..] {
                sets.union(self.simplices[a.simplex].piece, self.simplices[b.simplex].piece);
            }
        }
        let bodies = mesh.pieces();
        let mut islands: BTreeMap<u32, Island> = BTreeMap::new();
        for (k, simplex) in self.simplices.iter().enumerate() {
            let own = islands.entry(sets.find(simplex.piece)).or_default();
            own.volume += self.volume(k);
            own.body = bodies[simplex.owner as usize];
            let is_held = |point: &u32| self.nodes[*point as usize].is_some_and(|node| held.contains(&node));
            own.is_held |= simplex.corners.iter().any(is_held);
        }
        let is_kept = |island: &Island| {
            let of_body = || islands.values().filter(|other| other.body == island.body);
            island.is_held
                || of_body().all(|other| !other.is_held) && of_body().all(|other| other.volume <= island.volume)
        };
        let gone: BTreeMap<u32, f64> =
            islands.iter().filter(|(_, own)| !is_kept(own)).map(|(set, own)| (*set, own.volume)).collect();
        let mut numbers = BTreeMap::new();
        let pieces = std::mem::take(&mut self.pieces);
        for (number, piece) in pieces.into_iter().enumerate() {
            if !gone.contains_key(&sets.find(number as u32)) {
                numbers.insert(number as u32, self.pieces.len() as u32);
                self.pieces.push(piece);
            }
        }
        self.simplices.retain_mut(|simplex| {
            let number = numbers.get(&simplex.piece);
            simplex.piece = number.copied().unwrap_or_default();
            number.is_some()
        });
        gone.into_values().collect()
    }

    /// The facets on which pieces end, with the named surfaces of the mesh that they lie on: `surfaces[k]` are the facets of the k-th.
    #[must_use]
    pub fn border(&self, mesh: &Mesh, surfaces: &[&[Facet]]) -> Vec<BorderFacet> {
        let mut named: BTreeMap<u32, BTreeMap<u8, Vec<usize>>> = BTreeMap::new();
        for (number, facets) in surfaces.iter().enumerate() {
            for facet in *facets {
                named.entry(facet.cell).or_default().entry(facet.face).or_default().push(number);
            }
        }
        let mut border = Vec::new();
        for sides in self.sides().values() {
            let piece = |side: &Side| self.simplices[side.simplex].piece;
            let (inside, outside) = match sides[..] {
                [a] => (a, None),
                [a, b] if piece(&a) < piece(&b) => (a, Some(piece(&b))),
                [a, b] if piece(&b) < piece(&a) => (b, Some(piece(&a))),
                _ => continue,
            };
            let nodes = self.outward(inside);
            let owner = self.simplices[inside.simplex].owner;
            let of_cell = named.get(&owner).filter(|_| outside.is_none());
            let surfaces = of_cell.map_or_else(Vec::new, |faces| self.surfaces_at(mesh, owner, faces, &nodes));
            border.push(BorderFacet { nodes, inside: piece(&inside), outside, surfaces });
        }
        border
    }

    /// The points of a facet, counter-clockwise seen from outside.
    fn outward(&self, side: Side) -> Vec<u32> {
        let simplex = &self.simplices[side.simplex];
        let mut nodes = simplex.corners.clone();
        let off = self.points[nodes.remove(side.corner) as usize];
        let at = |k: usize| self.points[nodes[k] as usize];
        let height = match self.dim {
            2 => -cross(minus(at(1), at(0)), minus(off, at(0)))[2],
            _ => dot(cross(minus(at(1), at(0)), minus(at(2), at(0))), minus(off, at(0))),
        };
        if height > 0.0 {
            nodes.swap(0, 1);
        }
        nodes
    }

    /// The surfaces of the faces of a cell that a facet lies on.
    fn surfaces_at(&self, mesh: &Mesh, cell: u32, faces: &BTreeMap<u8, Vec<usize>>, nodes: &[u32]) -> Vec<usize> {
        let corners: Vec<[f64; 3]> = nodes.iter().map(|node| self.points[*node as usize]).collect();
        let middle = mean(&corners);
        let mut found = BTreeSet::new();
        for (face, numbers) in faces {
            let (kind, nodes) = mesh.facet_nodes(Facet { cell, face: *face });
            let own: Vec<[f64; 3]> = nodes[..kind.corners()].iter().map(|node| mesh.points()[*node as usize]).collect();
            let centre = mean(&own);
            let is_on = match own[..] {
                [a, b] => distance(middle, &[a, b]) <= self.tolerance,
                [a, b, c] => distance(middle, &[a, b, c]) <= self.tolerance,
                _ => (0..own.len())
                    .any(|k| distance(middle, &[own[k], own[(k + 1) % own.len()], centre]) <= self.tolerance),
            };
            if is_on {
                found.extend(numbers.iter().copied());
            }
        }
        found.into_iter().collect()
    }
}

#[derive(Default)]
struct Island {
    volume: f64,
    body: u32,
    is_held: bool,
}

/// Numbers of points, equal for those at one place.
struct Weld {
    tolerance: f64,
    known: BTreeMap<[i64; 3], u32>,
}

impl Weld {
    fn point(&mut self, body: &mut KeptBody, place: [f64; 3], node: Option<u32>) -> u32 {
        let key = place.map(|x| (x / self.tolerance).round() as i64);
        let around = |k: usize| [0, 1, 2].map(|i| key[i] + (k / [1, 3, 9][i] % 3) as i64 - 1);
        let found = (0..27).find_map(|k| self.known.get(&around(k)).copied());
        let number = found.unwrap_or_else(|| {
            body.points.push(place);
            body.nodes.push(None);
            body.points.len() as u32 - 1
        });
        self.known.entry(key).or_insert(number);
        body.nodes[number as usize] = body.nodes[number as usize].or(node);
        number
    }
}
