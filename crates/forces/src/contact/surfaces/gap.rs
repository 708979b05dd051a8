//! [`Gap`]: the smooth least distance of a sample from pieces of a surface.

use super::simplex::{Nearest, nearest};
use nastic_tensor::Scalar;

/// Distance of a piece beyond the nearest one, in units of e, above which it does not enter the smooth least distance.
const MAX_GAP_DIFFERENCE: f64 = 30.0;

/// A sample near a surface: its nearest pieces.
#[derive(Debug, Clone)]
pub(crate) struct Gap {
    pub sample: usize,
    /// Least distance of a piece.
    pub least: f64,
    /// Smooth least distance.
    pub smoothed: f64,
    /// The nodes of the pieces, each once.
    pub nodes: Vec<u32>,
    /// Of every piece the nodes between which its nearest point is, by their places among `nodes`.
    between: Vec<Vec<usize>>,
    /// e
    smooth: f64,
}

/// The nearest point of a piece, and the part that it has in the least distance.
pub(super) struct Foot<'a, T> {
    pub nearest: Nearest<T>,
    /// The nodes that its shares belong to, by their places among [`Gap::nodes`].
    pub between: &'a [usize],
    /// Parts add up to 1.
    pub part: T,
}

impl Gap {
    /// By distances from pieces and the nodes between which their nearest points are; `None` where none is within reach.
    pub fn of(sample: usize, pieces: Vec<(f64, Vec<u32>)>, reach: f64, smooth: f64) -> Option<Self> {
        let least = pieces.iter().map(|(d, _)| *d).fold(f64::INFINITY, f64::min);
        if least > reach {
            return None;
        }
        let near = || pieces.iter().filter(|(d, _)| d - least < MAX_GAP_DIFFERENCE * smooth).map(|(_, nodes)| nodes);
        let mut nodes: Vec<u32> = near().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |node: &u32| nodes.partition_point(|known| known < node);
        // an edge or corner that several pieces have counts for each of them: else the sum would jump where one of them takes over
        let between = near().map(|of| of.iter().map(place).collect()).collect();
        let weight: f64 = pieces.iter().map(|(d, _)| ((least - d) / smooth).exp()).sum();
        Some(Gap { sample, least, smoothed: least - smooth * weight.ln(), nodes, between, smooth })
    }

    /// The smooth least distance, and the pieces that have a part in it.
    pub(super) fn near<T: Scalar>(&self, x: [T; 3], nodes: &[[T; 3]]) -> (T, Vec<Foot<'_, T>>) {
        let corners = |of: &Vec<usize>| of.iter().map(|&i| nodes[i]).collect::<Vec<_>>();
        let found: Vec<_> = self.between.iter().map(|of| nearest(x, &corners(of))).collect();
        let (least, e) = (T::of(self.least), T::of(self.smooth));
        let weights: Vec<T> = found.iter().map(|near| ((least - near.distance) / e).exp()).collect();
        let sum = weights.iter().fold(T::of(0.0), |sum, weight| sum + *weight);
        let feet = found.into_iter().zip(&self.between).zip(weights);
        let feet = feet.map(|((nearest, between), weight)| Foot { nearest, between, part: weight / sum }).collect();
        (least - e * sum.ln(), feet)
    }

    /// The derivatives of that by the place of the sample and by those of the nodes.
    pub(super) fn gradient<T: Scalar>(&self, feet: &[Foot<'_, T>]) -> Vec<[T; 3]> {
        let mut by = vec![[T::of(0.0); 3]; self.nodes.len() + 1];
        for Foot { nearest, between, part } in feet {
            let mut add = |slot: usize, share: T| {
                by[slot].iter_mut().zip(nearest.normal).for_each(|(by, n)| *by = *by + share * *part * n);
            };
            add(0, T::of(1.0));
            between.iter().zip(nearest.shares).for_each(|(&node, share)| add(node + 1, T::of(0.0) - share));
        }
        by
    }
}
