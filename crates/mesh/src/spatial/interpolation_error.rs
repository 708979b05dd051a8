//! Bounds of the error of (multi)linear interpolation between the corners of a curved patch.

use super::V;
use super::patch::{Patch, widths};

/// A convex set that holds x(u) - sum l_i x(u_i) for all u of a piece with corners u_i, where l are the (multi)linear
/// weights of u: the sum of the hulls of 0 with each group of vectors.
///
/// Along one direction of a box, linear interpolation errs by -t (1 - t) / 2 w^2 times a second derivative, which lies
/// in the hull of the second differences of the control points; on a simplex the error is -1/2 sum_{i<j} l_i l_j
/// D2x[e_ij, e_ij], constant derivatives all, and the products sum to at most (1 - 1/n) / 2.
#[derive(Clone, Debug, Default)]
pub(super) struct InterpolationError {
    groups: Vec<Vec<V>>,
}

impl InterpolationError {
    pub fn of(patch: &Patch, corners: &[[f64; 3]]) -> Self {
        let space = patch.space;
        if space.degree == 1 {
            // (Multi)linear: spans its corners.
            return Self::default();
        }
        if space.simplex {
            let factor = -0.25 * (1.0 - 1.0 / corners.len() as f64);
            return Self { groups: vec![patch.edge_seconds(corners).map(|d| d * factor).collect()] };
        }
        let width = widths(corners);
        let group = |a: usize| patch.seconds(a).map(|d| d * (-0.125 * width[a] * width[a])).collect();
        Self { groups: (0..space.dim).map(group).collect() }
    }

    /// Least and largest product of its vectors with an axis.
    pub fn extent(&self, axis: &V) -> (f64, f64) {
        self.groups.iter().fold((0.0, 0.0), |(lo, hi), group| {
            let (least, most) = group.iter().fold((0.0f64, 0.0f64), |(lo, hi), v| {
                let along = v.dot(axis);
                (lo.min(along), hi.max(along))
            });
            (lo + least, hi + most)
        })
    }

    /// Bound on the norm of its vectors.
    pub fn bound(&self) -> f64 {
        self.groups.iter().map(|group| group.iter().map(|v| v.norm()).fold(0.0, f64::max)).sum()
    }
}
