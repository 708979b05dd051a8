//! Moves on which no sample goes through the other surface, and no edge through another one.

use super::Surfaces;
use super::side::Side;
use super::simplex::distance;
use crate::contact::advance::{Advance, BOUND_TOLERANCE};
use nastic_mesh::spatial::Aabb;
use nastic_tensor::Vec3;
use std::collections::BTreeSet;

/// Least share of a distance that a move leaves.
const MIN_DISTANCE_SHARE: f64 = 0.1;

impl Surfaces {
    /// The longest share of a straight move that leaves every sample on its side: a tenth of its distance is left from every piece, and of the distances of
    /// edges from each other.
    pub(super) fn longest_move(&self, u: &[f64], du: &[f64]) -> f64 {
        if du.iter().all(|du| *du == 0.0) {
            return 1.0;
        }
        let common = self.mean_move(du);
        let own = |(dof, (u, du)): (usize, (&f64, &f64))| u + du - common[dof % self.dim];
        // what both sides do together brings them no nearer
        let end: Vec<f64> = u.iter().zip(du).enumerate().map(own).collect();
        let share = self.sides.iter().map(|side| side.longest_move([u, &end])).fold(1.0, f64::min);
        self.edges.longest_move([u, &end], share)
    }

    /// The mean of a change over the nodes of the surfaces.
    fn mean_move(&self, du: &[f64]) -> [f64; 3] {
        let nodes: BTreeSet<u32> =
            self.sides.iter().flat_map(|side| side.pieces.facets.iter().flatten().copied()).collect();
        let sum = |i: usize| nodes.iter().map(|&node| du[self.dim * node as usize + i]).sum::<f64>();
        std::array::from_fn(|i| if i < self.dim { sum(i) / nodes.len().max(1) as f64 } else { 0.0 })
    }
}

impl Side {
    fn longest_move(&self, [u, end]: [&[f64]; 2]) -> f64 {
        let placed = self.pieces.placed(&[&|node| self.node(u, node), &|node| self.node(end, node)]);
        let mut share = 1.0_f64;
        for sample in 0..self.samples.len() {
            let [x, to] = [u, end].map(|u| self.place(u, sample));
            for piece in placed.overlapping(&Aabb::around(&[x, to])) {
                if self.may_touch(sample, piece) {
                    let corners = self.corners(u, piece);
                    let moves: Vec<Vec3> = self.corners(end, piece).iter().zip(&corners).map(|(b, a)| b - a).collect();
                    share = advance(x, to - x, &corners, &moves, share);
                }
            }
        }
        share
    }
}

/// Additive advancement of a sample and a piece.
fn advance(x: Vec3, dx: Vec3, corners: &[Vec3], moves: &[Vec3], most: f64) -> f64 {
    let mean = (moves.iter().sum::<Vec3>() + dx) / (moves.len() + 1) as f64;
    let speed = (dx - mean).norm() + moves.iter().map(|by| (by - mean).norm()).fold(0.0, f64::max);
    let at = |s: f64| {
        let corners: Vec<Vec3> = corners.iter().zip(moves).map(|(corner, by)| corner + s * by).collect();
        distance(&(x + s * dx), &corners)
    };
    advance_within(at, speed, most)
}

/// How far a distance that changes by no more than `speed` over the whole way may go, `most` at most.
pub(super) fn advance_within(distance: impl Fn(f64) -> f64, speed: f64, most: f64) -> f64 {
    let start = distance(0.0);
    Advance {
        floor: MIN_DISTANCE_SHARE * start,
        nearest: (MIN_DISTANCE_SHARE + BOUND_TOLERANCE) * start,
        reach: speed,
        most,
    }
    .share(distance)
}
