//! The nodes that all others of a rigid body follow, and affine functions by their values there.

use nalgebra::DMatrix;
use nastic_tensor::Vec3;

/// Largest slope of an affine function on a simplex, per size of it, that is not flat.
const MAX_SLOPE: f64 = 1e8;
/// Least distance of a node from the point, line or plane of the nodes before, as a share of the largest distance.
const MIN_DISTANCE_RATIO: f64 = 1e-3;

/// The nodes of a simplex that is about as large as a body: the node farthest from their middle, then each time the one farthest from the point, line or plane
/// of those before; of several the lowest. Those that supports hold in most components come first, so that what they hold is held at corners.
pub(super) fn simplex(nodes: &[u32], dim: usize, place: impl Fn(u32) -> Vec3, held: impl Fn(u32) -> usize) -> Vec<u32> {
    let middle = nodes.iter().map(|&node| place(node)).sum::<Vec3>() / nodes.len() as f64;
    let farthest = |distance: &dyn Fn(Vec3) -> f64| {
        let most = nodes.iter().map(|&node| distance(place(node))).fold(0.0, f64::max);
        let apart = nodes.iter().filter(|node| distance(place(**node)) > MIN_DISTANCE_RATIO * most);
        let rank = apart.clone().map(|&node| held(node)).max().unwrap_or(0);
        let mut found = (f64::NEG_INFINITY, nodes[0]);
        for &node in apart.filter(|node| held(**node) == rank) {
            let d = distance(place(node));
            // rounding decides nothing
            if d > found.0 * (1.0 + 1e-9) {
                found = (d, node);
            }
        }
        found.1
    };
    let mut chosen = vec![farthest(&|x| (x - middle).norm())];
    let (mut origin, mut axes) = (place(chosen[0]), Vec::<Vec3>::new());
    for _ in 0..dim {
        let across = |x: Vec3| axes.iter().fold(x - origin, |r, axis| r - axis * axis.dot(&r));
        let next = farthest(&|x| across(x).norm());
        let axis = across(place(next)).normalize();
        chosen.push(next);
        axes.push(axis);
        origin = place(chosen[0]);
    }
    chosen
}

/// Affine functions that are one at a corner of a simplex and zero at the others.
pub(super) struct Affine {
    origin: Vec3,
    values: Vec<f64>,
    pub gradients: Vec<Vec3>,
}

impl Affine {
    /// `None` of corners in a plane, or in space on a line.
    pub fn of(corners: &[Vec3], dim: usize) -> Option<Self> {
        let origin = corners[0];
        let size = corners.iter().map(|x| (x - origin).norm()).fold(0.0, f64::max);
        let row = |i: usize, j: usize| if j == 0 { 1.0 } else { (corners[i][j - 1] - origin[j - 1]) / size };
        let inverse = DMatrix::from_fn(dim + 1, dim + 1, row).try_inverse()?;
        if !inverse.iter().all(|entry| entry.abs() < MAX_SLOPE) {
            return None;
        }
        let gradient = |m: usize| Vec3::from_fn(|j, _| if j < dim { inverse[(j + 1, m)] / size } else { 0.0 });
        Some(Affine {
            origin,
            values: (0..=dim).map(|m| inverse[(0, m)]).collect(),
            gradients: (0..=dim).map(gradient).collect(),
        })
    }

    /// Of all corners, at a place.
    pub fn at(&self, x: &Vec3) -> Vec<f64> {
        self.values.iter().zip(&self.gradients).map(|(value, g)| value + g.dot(&(x - self.origin))).collect()
    }
}
