//! [`Side`]: the samples of one surface before the pieces of another.

use super::gap::Gap;
use super::pieces::Pieces;
use super::simplex::{distance, feature};
use crate::contact::samples::{Samples, place};
use nastic_body::discretization::Discretization;
use nastic_body::error::FemError;
use nastic_mesh::spatial::Aabb;
use nastic_mesh::{Facet, GroupNames, Mesh};
use nastic_tensor::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The samples of one surface before the pieces of another.
#[derive(Debug)]
pub(crate) struct Side {
    mesh: Arc<Mesh>,
    pub samples: Samples,
    /// The number of its first sample among those of the contact.
    pub first: usize,
    pub(super) pieces: Pieces,
    /// Of every sample the facets of the other surface that are its neighbours in the body, ascending.
    neighbours: Vec<Vec<u32>>,
    /// Of every sample the other corners of its own facets, by which its surface turns.
    pub rings: Vec<Vec<u32>>,
}

impl Side {
    pub fn new(disc: &Discretization, surface: &GroupNames, refine: usize, facets: &[Facet]) -> Result<Self, FemError> {
        let (mesh, pieces) = (disc.mesh().clone(), Pieces::new(disc, facets));
        let samples = Samples::new(&mesh, surface, |_| refine)?;
        let nodes = |sample| samples.parts(sample).iter().map(|(node, _)| *node).collect();
        let neighbours = pieces.around((0..samples.len()).map(nodes));
        let rings = rings(&mesh, &mesh.facets_of(surface)?, &samples);
        Ok(Side { mesh, samples, first: 0, pieces, neighbours, rings })
    }

    /// Where a node is.
    pub fn node(&self, u: &[f64], node: u32) -> Vec3 {
        place(&self.mesh, u, node)
    }

    /// Where a sample is.
    pub fn place(&self, u: &[f64], sample: usize) -> Vec3 {
        self.samples.parts(sample).iter().map(|&(node, shape)| shape * self.node(u, node)).sum()
    }

    pub fn corners(&self, u: &[f64], piece: usize) -> Vec<Vec3> {
        self.pieces.all[piece].0.iter().map(|&node| self.node(u, node)).collect()
    }

    /// Whether a piece is no neighbour of a sample.
    pub fn may_touch(&self, sample: usize, piece: usize) -> bool {
        self.neighbours[sample].binary_search(&self.pieces.all[piece].1).is_err()
    }

    /// Of every sample the nearest piece of the other surface that is no neighbour, and how far away it is.
    pub fn nearest_pieces(&self, u: &[f64]) -> Vec<Option<(f64, usize)>> {
        let placed = self.pieces.placed(&[&|node| self.node(u, node)]);
        let of_sample = |sample: usize| {
            let x = self.place(u, sample);
            placed.least(&x, |piece| self.may_touch(sample, piece).then(|| distance(&x, &self.corners(u, piece))))
        };
        (0..self.samples.len()).map(of_sample).collect()
    }

    /// The gaps of samples nearer to the other surface than a reach.
    pub fn gaps(&self, u: &[f64], reach: f64, smooth: f64) -> Vec<Gap> {
        let placed = self.pieces.placed(&[&|node| self.node(u, node)]);
        let of_sample = |sample: usize| {
            let x = self.place(u, sample);
            let near = placed.overlapping(&Aabb { lo: x, hi: x }.grown(reach)).into_iter();
            let found = near.filter(|&piece| self.may_touch(sample, piece)).map(|piece| {
                let corners = self.corners(u, piece);
                let between = feature(&x, &corners);
                let nodes = between.iter().map(|&i| self.pieces.all[piece].0[i]).collect();
                (distance(&x, &corners), nodes)
            });
            Gap::of(sample, found.collect(), reach, smooth)
        };
        (0..self.samples.len()).filter_map(of_sample).collect()
    }
}

/// Of every sample the corners of the facets that it is on, itself excepted; ascending.
fn rings(mesh: &Mesh, facets: &[Facet], samples: &Samples) -> Vec<Vec<u32>> {
    let mut of_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let all: Vec<(usize, Vec<u32>)> = facets
        .iter()
        .map(|&facet| {
            let (kind, nodes) = mesh.facet_nodes(facet);
            (kind.corners(), nodes)
        })
        .collect();
    for (facet, (_, nodes)) in all.iter().enumerate() {
        nodes.iter().for_each(|&node| of_node.entry(node).or_default().push(facet));
    }
    let ring = |sample: usize| -> Vec<u32> {
        let own: Vec<u32> = samples.parts(sample).iter().map(|(node, _)| *node).collect();
        let first = own.first().and_then(|node| of_node.get(node)).into_iter().flatten().map(|&facet| &all[facet]);
        let on = first.filter(|(_, nodes)| own.iter().all(|node| nodes.contains(node)));
        let corners: BTreeSet<u32> = on.flat_map(|(corners, nodes)| nodes[..*corners].iter().copied()).collect();
        corners.into_iter().filter(|node| own != [*node]).collect()
    };
    (0..samples.len()).map(ring).collect()
}
