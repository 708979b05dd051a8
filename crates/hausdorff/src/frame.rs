//! The box of a node in axes of its own: thin on a skin, whichever way the skin lies.

use super::bounds::{Bounds, norm};
use super::side::Side;
use rayon::prelude::*;

/// A box around `centre` with orthonormal `axes` and half sides `half` along them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub centre: [f64; 3],
    pub axes: [[f64; 3]; 3],
    pub half: [f64; 3],
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Frame {
    /// Distance from the centre to a corner.
    pub fn radius(&self) -> f64 {
        norm(self.half)
    }

    /// Half the width seen along a unit vector.
    pub fn support(&self, direction: [f64; 3]) -> f64 {
        (0..3).map(|d| self.half[d] * dot(self.axes[d], direction).abs()).sum()
    }

    /// Around points, along given axes.
    fn around(points: impl Iterator<Item = [f64; 3]>, axes: [[f64; 3]; 3]) -> Self {
        let local = |x: [f64; 3]| axes.map(|axis| dot(axis, x));
        let all = points.fold(Bounds::EMPTY, |all, x| all.join(&Bounds::point(local(x))));
        let c = all.centre();
        let centre = std::array::from_fn(|i| (0..3).map(|d| c[d] * axes[d][i]).sum());
        // The least bit wider: the way back from the axes rounds.
        let rounding = 4.0 * f64::EPSILON * norm(c);
        let half = all.half_sides().map(|a| if a > 0.0 { a + rounding } else { a });
        Self { centre, axes, half }
    }

    /// What a grid on the box is large in proportion to, about.
    fn volume(&self) -> f64 {
        let largest = self.half.iter().copied().fold(0.0, f64::max);
        self.half.iter().map(|a| a.max(0.05 * largest)).product()
    }
}

/// For every node of a side the smaller of the boxes along the coordinates and along the principal axes.
pub(super) fn frames(side: &Side) -> Vec<Frame> {
    let spreads = spreads(side);
    let frame = |node: usize| {
        let points = || side.tree().nodes[node].range().map(|k| [side.x[0][k], side.x[1][k], side.x[2][k]]);
        let straight = Frame::around(points(), IDENTITY);
        let turned = Frame::around(points(), principal_axes(spreads[node].covariance()));
        if turned.volume() < 0.8 * straight.volume() { turned } else { straight }
    };
    (0..spreads.len()).into_par_iter().map(frame).collect()
}

/// Number, mean and sum of squared deviations of points.
#[derive(Clone, Copy)]
struct Spread {
    count: f64,
    mean: [f64; 3],
    squares: [[f64; 3]; 3],
}

impl Spread {
    const NONE: Self = Self { count: 0.0, mean: [0.0; 3], squares: [[0.0; 3]; 3] };

    fn join(&self, other: &Self) -> Self {
        let count = self.count + other.count;
        let apart: [f64; 3] = std::array::from_fn(|d| other.mean[d] - self.mean[d]);
        let mean = std::array::from_fn(|d| self.mean[d] + apart[d] * other.count / count);
        let weight = self.count * other.count / count;
        let entry = |i: usize, j: usize| self.squares[i][j] + other.squares[i][j] + weight * apart[i] * apart[j];
        Self { count, mean, squares: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))) }
    }

    fn covariance(&self) -> [[f64; 3]; 3] {
        self.squares.map(|row| row.map(|entry| entry / self.count))
    }
}

fn spreads(side: &Side) -> Vec<Spread> {
    let tree = side.tree();
    let point = |k: usize| Spread { count: 1.0, mean: [side.x[0][k], side.x[1][k], side.x[2][k]], ..Spread::NONE };
    let mut spreads = vec![Spread::NONE; tree.nodes.len()];
    for node in (0..tree.nodes.len()).rev() {
        let it = &tree.nodes[node];
        spreads[node] = if it.is_leaf() {
            let mut points = it.range().map(point);
            let first = points.next().unwrap_or(Spread::NONE);
            points.fold(first, |all, one| all.join(&one))
        } else {
            let [left, right] = tree.children(node as u32);
            spreads[left as usize].join(&spreads[right as usize])
        };
    }
    spreads
}

/// Eigenvectors of a symmetric matrix by Jacobi's rotations.
fn principal_axes(mut a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut axes = IDENTITY;
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for k in 0..3 {
                (a[k][p], a[k][q]) = (c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
            }
            for k in 0..3 {
                (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                (axes[p][k], axes[q][k]) = (c * axes[p][k] - s * axes[q][k], s * axes[p][k] + c * axes[q][k]);
            }
        }
    }
    axes
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
