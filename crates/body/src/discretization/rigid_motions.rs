//! [`FreeMotion`]: a rigid motion that nothing resists to.

use super::Discretization;
use super::supports::Supports;
use crate::error::FemError;
use nalgebra::DMatrix;
use nastic_mesh::Mesh;
use nastic_numeric::DisjointSets;
use std::collections::{BTreeMap, BTreeSet};

/// Least share of a motion that counts as free, and share of the largest one of those that are named.
const SEEN: f64 = 1e-6;
const ALMOST: f64 = 0.9;

/// Rigid motions of a connected part of the body, or of several that hold each other, which nothing resists to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FreeMotion {
    /// How many.
    pub count: usize,
    /// The connected parts of the body that have some of these.
    pub what: String,
    /// Those of the first part, as far as they are along an axis, in words.
    pub example: String,
}

impl Supports {
    /// Whether the supports exclude every rigid motion of every connected part of the body (small rotations about the
    /// part's centre; rank of the motions restricted to the prescribed components and to what springs resist to). Parts that springs or
    /// contacts hold to each other are looked at together: two that hold each other alone are free.
    pub fn check(&self, disc: &Discretization, springs: &[&Vec<(u32, f64)>]) -> Result<(), FemError> {
        match self.free(disc, None, springs) {
            Some(FreeMotion { count, what, example }) => Err(FemError::RigidMotion { free: count, what, example }),
            None => Ok(()),
        }
    }

    /// The first rigid motions that are free, of the displaced body if a displacement is given.
    pub fn free(&self, disc: &Discretization, u: Option<&[f64]>, springs: &[&Vec<(u32, f64)>]) -> Option<FreeMotion> {
        let mesh = disc.mesh();
        let places = Places { mesh, u, block: self.block };
        let (parts, extents) = connected_parts(disc, &places);
        let mut part_of = vec![0; mesh.points().len()];
        for (p, nodes) in parts.iter().enumerate() {
            nodes.iter().for_each(|&node| part_of[node as usize] = p);
        }
        let of = |terms: &Vec<(u32, f64)>| terms.iter().map(|(dof, _)| part_of[*dof as usize / self.dim]).collect();
        let between: Vec<Vec<usize>> = springs.iter().map(|terms| of(terms)).collect();
        let mut sets = DisjointSets::new(parts.len());
        for row in &between {
            row.iter().for_each(|&p| sets.union(row[0] as u32, p as u32));
        }
        if let Some(parted) = disc.parted().filter(|_| parts.len() > 1) {
            // a spring is on one rank, and all have to look at the same parts together; where messages fail, so do the sums of motions
            let pairs = between.iter().flat_map(|row| row.iter().flat_map(|&p| [row[0] as f64, p as f64]));
            let all = parted.share.gather(&pairs.collect::<Vec<f64>>()).unwrap_or_default();
            let pairs = all.iter().flat_map(|told| told.as_chunks::<2>().0);
            pairs.for_each(|&[one, other]| sets.union(one as u32, other as u32));
        }
        let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        (0..parts.len()).for_each(|p| groups.entry(sets.find(p as u32)).or_default().push(p));
        for together in groups.values() {
            let own = springs.iter().zip(&between).filter(|(_, row)| row.first().is_some_and(|q| together.contains(q)));
            let own: Vec<&Vec<(u32, f64)>> = own.map(|(terms, _)| *terms).collect();
            let nodes: Vec<(&[u32], Extent)> = together.iter().map(|&q| (parts[q].as_slice(), extents[q])).collect();
            if let Some((count, example, which)) = self.free_motions(disc, &places, &nodes, &own) {
                let named = |&which: &usize| {
                    let first = nodes[which].0.first().copied();
                    match (first.and_then(|node| self.body_of(node)), first, parts.len()) {
                        (Some(body), ..) => format!("the rigid body \"{body}\""),
                        (None, _, 1) => "the body".to_owned(),
                        (None, Some(node), n) => {
                            format!("connected part {} of {n} (it has node {node})", together[which] + 1)
                        }
                        (None, None, n) => format!("connected part {} of {n}", together[which] + 1),
                    }
                };
                let what = which.iter().map(named).collect::<Vec<_>>().join(" and ");
                return Some(FreeMotion { count, what, example });
            }
        }
        None
    }

    /// How many rigid motions of parts, of which these are the nodes, stay free; in words those of the first part that has some, and which parts have.
    fn free_motions(
        &self,
        disc: &Discretization,
        places: &Places,
        parts: &[(&[u32], Extent)],
        springs: &[&Vec<(u32, f64)>],
    ) -> Option<(usize, String, Vec<usize>)> {
        let each = if self.dim == 2 { 3 } else { 6 };
        let modes = each * parts.len();
        let mut gram = DMatrix::<f64>::zeros(modes, modes);
        let component = |dof: usize| {
            let node = (dof / self.dim) as u32;
            let x = places.of(node);
            let p = parts.iter().position(|(nodes, _)| nodes.binary_search(&node).is_ok())?;
            let (centre, radius) = parts[p].1;
            let r: Vec<f64> = (0..3).map(|k| (x[k] - centre[k]) / radius).collect();
            Some((each * p, motion_component(self.dim, dof % self.dim, &r)))
        };
        let mut add = |row: &[(usize, f64)]| {
            for (i, a) in row {
                row.iter().for_each(|(j, b)| gram[(*i, *j)] += a * b);
            }
        };
        let row_of = |terms: &[(u32, f64)]| {
            let mut row = vec![0.0; modes];
            for (dof, weight) in terms {
                if let Some((first, motion)) = component(*dof as usize) {
                    row[first..].iter_mut().zip(motion).for_each(|(row, value)| *row += weight * value);
                }
            }
            row.into_iter().enumerate().filter(|(_, value)| *value != 0.0).collect::<Vec<_>>()
        };
        for &node in parts.iter().flat_map(|(nodes, _)| *nodes) {
            let held = (0..self.dim).filter(|c| self.fixed()[node as usize * self.block + c]);
            held.for_each(|c| add(&row_of(&[((node as usize * self.dim + c) as u32, 1.0)])));
        }
        springs.iter().for_each(|terms| add(&row_of(terms)));
        if let Some(parted) = disc.parted() {
            // what several ranks hold counts several times, which changes no rank
            parted.share.sum(gram.as_mut_slice());
        }
        let eigen = gram.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let free: Vec<usize> = (0..modes).filter(|&k| eigen.eigenvalues[k] <= 1e-9 * largest.max(1e-300)).collect();
        // which share of every motion is free, and of which parts there are some
        let share = |at: usize| free.iter().map(|&k| eigen.eigenvectors[(at, k)].powi(2)).sum::<f64>();
        let whose: Vec<usize> =
            (0..parts.len()).filter(|&p| (0..each).any(|motion| share(each * p + motion) > SEEN)).collect();
        let first = each * *whose.first()?;
        let most = (first..first + each).map(share).fold(0.0, f64::max);
        let wholly = (0..each).filter(|motion| share(first + motion) > ALMOST * most);
        let names: Vec<&str> = wholly.map(|motion| motion_name(self.dim, motion)).collect();
        Some((free.len(), names.join(", "), whose))
    }
}

/// A rigid motion in words.
fn motion_name(dim: usize, motion: usize) -> &'static str {
    match dim {
        2 => ["shift along x", "shift along y", "rotation in the plane"][motion],
        _ => [
            "shift along x",
            "shift along y",
            "shift along z",
            "rotation about x",
            "rotation about y",
            "rotation about z",
        ][motion],
    }
}

/// Where nodes are.
struct Places<'a> {
    mesh: &'a Mesh,
    u: Option<&'a [f64]>,
    /// Unknowns of a node.
    block: usize,
}

impl Places<'_> {
    fn of(&self, node: u32) -> [f64; 3] {
        let (x, first) = (self.mesh.points()[node as usize], self.block * node as usize);
        let moved = |i: usize| self.u.filter(|_| i < self.mesh.dim()).map_or(0.0, |u| u[first + i]);
        std::array::from_fn(|i| x[i] + moved(i))
    }
}

/// The c-th component of every rigid motion at relative position r: shifts, then rotations.
fn motion_component(dim: usize, c: usize, r: &[f64]) -> Vec<f64> {
    let mut row = vec![0.0; if dim == 2 { 3 } else { 6 }];
    row[c] = 1.0;
    if dim == 2 {
        row[2] = if c == 0 { -r[1] } else { r[0] };
    } else {
        // e_k x r, component c
        for k in 0..3 {
            row[3 + k] = match (3 + c - k) % 3 {
                1 => -r[(k + 2) % 3],
                2 => r[(k + 1) % 3],
                _ => 0.0,
            };
        }
    }
    row
}

/// Centre of a bounding box, and half of its diagonal.
type Extent = ([f64; 3], f64);

fn extent((low, high): ([f64; 3], [f64; 3])) -> Extent {
    let centre = [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]));
    let radius = (0..3).map(|k| (high[k] - low[k]).powi(2)).sum::<f64>().sqrt() / 2.0;
    (centre, radius.max(f64::MIN_POSITIVE))
}

fn bounds(places: &Places, nodes: &[u32]) -> ([f64; 3], [f64; 3]) {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &node in nodes {
        for (k, x) in places.of(node).iter().enumerate() {
            low[k] = low[k].min(*x);
            high[k] = high[k].max(*x);
        }
    }
    (low, high)
}

/// Node sets of the parts of the body that hang together, and the extent of each; on one of several ranks the nodes that it has of each.
fn connected_parts(disc: &Discretization, places: &Places) -> (Vec<Vec<u32>>, Vec<Extent>) {
    let mesh = disc.mesh();
    if let Some(parted) = disc.parted() {
        let mut nodes = vec![BTreeSet::new(); parted.part.piece_bounds().len()];
        for (cell, &piece) in parted.part.pieces().iter().enumerate() {
            nodes[piece as usize].extend(mesh.cell(cell).nodes);
        }
        for &(node, piece) in parted.part.further_nodes() {
            nodes[piece as usize].insert(node);
        }
        let nodes = nodes.into_iter().map(|nodes| nodes.into_iter().collect()).collect();
        return (nodes, parted.part.piece_bounds().iter().map(|bounds| extent(*bounds)).collect());
    }
    let n = mesh.points().len();
    let mut sets = DisjointSets::new(n);
    for block in mesh.blocks() {
        for cell in block.nodes.chunks_exact(block.kind.nodes()) {
            cell[1..].iter().for_each(|&node| sets.union(cell[0], node));
        }
    }
    let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for node in 0..n as u32 {
        parts.entry(sets.find(node)).or_default().push(node);
    }
    let parts: Vec<Vec<u32>> = parts.into_values().collect();
    let extents = parts.iter().map(|nodes| extent(bounds(places, nodes))).collect();
    (parts, extents)
}
