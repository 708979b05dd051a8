//! The boundary of a solid: its exterior faces as patches, cut into nearly flat facets in a tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::patch::{Patch, SecondBounds};
use super::patch_space::{Conversion, PatchSpace};
use super::tree::{Aabb, Tree};
use super::{V, simplex};

/// A flat triangle (a segment in the plane, with its last two corners equal) over part of a face's parameters.
/// The curved face over the same parameters stays within `sag` of it, and it within `sag` of the face.
#[derive(Clone, Debug)]
pub(super) struct Facet {
    pub corners: [V; 3],
    /// Outward unit normal; 0 if the facet is degenerate.
    pub normal: V,
    pub param: [[f64; 2]; 3],
    pub face: u32,
    pub sag: f64,
}

impl Facet {
    /// Is the closest point found so far on this facet or next to it, on the same face? Then the iteration that found it would
    /// end there again.
    fn is_near(&self, best: &Near) -> bool {
        best.face == self.face
            && (0..2).all(|a| {
                let [u, v, w] = self.param.map(|u| u[a]);
                let (lo, hi) = (u.min(v).min(w), u.max(v).max(w));
                best.param[a] >= 1.5 * lo - 0.5 * hi && best.param[a] <= 1.5 * hi - 0.5 * lo
            })
    }
}

/// A nearest point of the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub point: V,
    pub squared: f64,
    pub facet: u32,
    face: u32,
    param: [f64; 2],
}

/// Exterior faces, their facets, and the tree over these.
#[derive(Clone, Debug)]
pub(super) struct Boundary {
    /// Plane solid: faces are lines.
    pub plane: bool,
    pub facets: Vec<Facet>,
    pub tree: Tree,
    pub(super) second_bounds: Vec<SecondBounds>,
    spaces: Vec<PatchSpace>,
    starts: Vec<u32>,
    control: Vec<V>,
}

/// Cuts of a face in one direction; a piece that is not flat then is cut further where a search needs it.
const MAX_CUTS: usize = 8;

impl Boundary {
    /// An empty boundary, to be filled by `push` and closed by `finish`.
    pub fn new(plane: bool) -> Self {
        Self {
            plane,
            facets: Vec::new(),
            tree: Tree::default(),
            second_bounds: Vec::new(),
            spaces: Vec::new(),
            starts: Vec::new(),
            control: Vec::new(),
        }
    }

    /// Adds a face, cut until its facets sag no more than `flatness` (or 8 times per direction).
    pub fn push(&mut self, conversion: &Conversion, nodes: &[V], flatness: f64) {
        let face = self.spaces.len() as u32;
        self.starts.push(self.control.len() as u32);
        self.spaces.push(conversion.space);
        conversion.append(nodes, &mut self.control);
        self.second_bounds.push(self.patch(face).second_bounds());
        let [nu, nv] = self.cuts(face, flatness);
        let at = |i: usize, j: usize| [i as f64 / nu as f64, j as f64 / nv as f64];
        for i in 0..nu {
            if self.plane {
                self.facets.push(self.facet(face, [at(i, 0), at(i + 1, 0), at(i + 1, 0)]));
                continue;
            }
            let rows = if conversion.space.simplex { nu - i } else { nv };
            for j in 0..rows {
                if conversion.space.simplex {
                    self.facets.push(self.facet(face, [at(i, j), at(i + 1, j), at(i, j + 1)]));
                    if j + 1 < rows {
                        self.facets.push(self.facet(face, [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]));
                    }
                } else {
                    self.facets.push(self.facet(face, [at(i, j), at(i + 1, j), at(i + 1, j + 1)]));
                    self.facets.push(self.facet(face, [at(i, j), at(i + 1, j + 1), at(i, j + 1)]));
                }
            }
        }
    }

    /// Cuts per direction.
    fn cuts(&self, face: u32, flatness: f64) -> [usize; 2] {
        let (space, m) = (self.spaces[face as usize], &self.second_bounds[face as usize]);
        let mut n = [1usize; 2];
        loop {
            let w = n.map(|n| 1.0 / n as f64);
            let part = [m[0][0] * w[0] * w[0], 2.0 * m[0][1] * w[0] * w[1], m[1][1] * w[1] * w[1]];
            if 0.125 * part.iter().sum::<f64>() <= flatness || n.iter().any(|&n| n >= MAX_CUTS) {
                return n;
            }
            if space.simplex {
                n = [n[0] + 1; 2];
            } else if part[0] + 0.5 * part[1] * w[0] >= part[2] + 0.5 * part[1] * w[1] {
                n[0] += 1;
            } else {
                n[1] += 1;
            }
        }
    }

    pub fn finish(&mut self) {
        let boxes: Vec<Aabb> = self.facets.iter().map(|f| Aabb::around(&f.corners).grown(f.sag)).collect();
        self.tree = Tree::build(&boxes);
    }

    pub fn patch(&self, face: u32) -> Patch<'_> {
        let face = face as usize;
        let space = self.spaces[face];
        Patch { space, control: &self.control[self.starts[face] as usize..][..space.controls()] }
    }

    /// Nearest point, looking first at facet `hint`. `None` only when there is no boundary at all.
    pub fn nearest(&self, p: &V, hint: Option<u32>) -> Option<Near> {
        let mut best: Option<Near> = None;
        let mut look = |facet: usize, limit: f64| {
            if let Some(near) = self.closest_on_face(facet, p, limit, &best) {
                best = Some(near);
                return near.squared;
            }
            limit
        };
        let limit = hint.map_or(f64::INFINITY, |h| look(h as usize, f64::INFINITY));
        self.tree.nearest(p, limit, &mut look);
        best
    }

    /// Nearest point of the face under a facet, if it may beat `limit` (a squared distance), the best so far.
    fn closest_on_face(&self, index: usize, p: &V, limit: f64, best: &Option<Near>) -> Option<Near> {
        let facet = self.facets.get(index)?;
        let (weights, x) = simplex::nearest(&facet.corners, p);
        let squared = (x - p).norm_squared();
        let start = std::array::from_fn(|a| (0..3).map(|i| weights[i] * facet.param[i][a]).sum());
        let near = |point, squared, param| Near { point, squared, facet: index as u32, face: facet.face, param };
        if facet.sag == 0.0 {
            return (squared < limit).then(|| near(x, squared, start));
        }
        let least = (squared.sqrt() - facet.sag).max(0.0);
        if least * least >= limit || best.is_some_and(|best| facet.is_near(&best)) {
            return None;
        }
        let (point, squared, param) = super::closest_point::project(&self.patch(facet.face), p, start);
        (squared < limit).then(|| near(point, squared, param))
    }

    /// A proven lower bound of the distance from `p` to the boundary, within `tolerance` of `distance`, the distance
    /// found, if that is the true one and `budget` facets suffice.
    pub fn proven(&self, p: &V, distance: f64, tolerance: f64, budget: usize) -> f64 {
        let mut heap = BinaryHeap::new();
        let mut seen = 0;
        let mut add = |facet: &Facet, heap: &mut BinaryHeap<Bound>| {
            let least = ((simplex::nearest(&facet.corners, p).1 - p).norm() - facet.sag).max(0.0);
            seen += 1;
            if least < distance {
                heap.push(Bound { least, seen, facet: facet.clone() });
            }
            seen
        };
        self.tree.nearest(p, distance * distance, |facet, limit| {
            add(&self.facets[facet], &mut heap);
            limit
        });
        while let Some(Bound { least, seen, facet }) = heap.pop() {
            if least >= distance - tolerance || facet.sag <= tolerance || seen > budget {
                return least;
            }
            self.split(&facet, |part| {
                add(part, &mut heap);
                false
            });
        }
        distance
    }
}

/// A facet to be subdivided, least distance first.
struct Bound {
    least: f64,
    seen: usize,
    facet: Facet,
}

impl Ord for Bound {
    fn cmp(&self, other: &Self) -> Ordering {
        other.least.total_cmp(&self.least).then(other.seen.cmp(&self.seen))
    }
}

impl PartialOrd for Bound {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Bound {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Bound {}
