//! The directed Hausdorff distance: sup over the points of one solid of the distance to another, by branch and bound.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::V;
use super::cell_piece::CellPiece;
use super::shape::{ClosestPoint, Hint, Shape};

/// Pieces that are cut; the gap reports the remaining error.
const MAX_CUTS: usize = 15_000;
/// Facets that are examined to prove the distance of the farthest point.
const MAX_FACETS: usize = 50_000;

/// The true value lies in [lower, upper]; `from` has about that distance from its nearest point `to`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Directed {
    pub lower: f64,
    pub upper: f64,
    pub from: V,
    pub to: V,
}

/// sup over x in `of` of d(x, `on`).
pub(super) fn directed(of: &Shape, on: &Shape, tolerance: f64) -> Directed {
    let mut search = Search {
        best: (-1.0, V::zeros(), V::zeros()),
        tolerance: 0.9 * tolerance,
        ceiling: 0.0,
        queue: BinaryHeap::new(),
        pieces: Vec::new(),
    };
    let closest = on.closest_points_of_corners(of);
    for (x, closest) in closest.iter().flatten() {
        search.record(x, closest);
    }
    for cell in 0..of.cells.len() {
        // The very same cell is in the other solid: of a shape and itself nothing is left to search.
        if on.cells.same_as(&of.cells.patch(cell)) {
            continue;
        }
        if let Some(piece) = CellPiece::whole(of, cell, |node| closest.get(node as usize).copied().flatten()) {
            let bound = piece.bound();
            search.push(piece, bound, None);
        }
    }
    search.run(of, on);
    let (distance, from, to) = search.best;
    let lower = if distance > 0.0 { on.boundary.proven(&from, distance, 0.05 * tolerance, MAX_FACETS) } else { 0.0 };
    Directed { lower, upper: search.ceiling.max(distance), from, to }
}

struct Search {
    /// Largest distance met, with its ends.
    best: (f64, V, V),
    tolerance: f64,
    /// Largest bound among the pieces dismissed.
    ceiling: f64,
    queue: BinaryHeap<Candidate>,
    pieces: Vec<Option<CellPiece>>,
}

impl Search {
    fn record(&mut self, x: &V, closest: &ClosestPoint) {
        if closest.distance > self.best.0 {
            self.best = (closest.distance, *x, closest.point);
        }
    }

    /// Keeps the piece, or dismisses it if its bound is near enough to the best.
    fn push(&mut self, piece: CellPiece, bound: f64, slot: Option<usize>) {
        if bound <= self.best.0 + self.tolerance {
            self.ceiling = self.ceiling.max(bound);
            return;
        }
        let slot = slot.unwrap_or_else(|| {
            self.pieces.push(None);
            self.pieces.len() - 1
        });
        self.pieces[slot] = Some(piece);
        self.queue.push(Candidate { bound, slot });
    }

    fn run(&mut self, of: &Shape, on: &Shape) {
        let mut hint = Hint::default();
        let mut cuts = 0;
        while let Some(Candidate { bound, slot }) = self.queue.pop() {
            let goal = self.best.0 + self.tolerance;
            if bound <= goal {
                self.ceiling = self.ceiling.max(bound);
                return;
            }
            let Some(piece) = self.pieces[slot].take() else { continue };
            if let Some(proven) = piece.proven_bound(of, on, goal) {
                self.ceiling = self.ceiling.max(proven);
                continue;
            }
            if cuts == MAX_CUTS {
                self.ceiling = self.ceiling.max(piece.relaxed_bound(of, on, goal, self.tolerance, bound));
                continue;
            }
            cuts += 1;
            let halves = piece.halves(of, on, &mut hint);
            for half in &halves {
                for (x, closest) in half.corners() {
                    self.record(x, closest);
                }
            }
            for (half, slot) in halves.into_iter().zip([Some(slot), None]) {
                let least = half.bound().min(bound);
                self.push(half, least, slot);
            }
        }
    }
}

/// A piece to be examined, largest bound first.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    bound: f64,
    slot: usize,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(other.slot.cmp(&self.slot))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}
