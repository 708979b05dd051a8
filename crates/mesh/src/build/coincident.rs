//! Coincident nodes: usually parts of a mesh that should be connected and are not.

use crate::geometry::{bounds, minus, norm};

/// Share of the body's diagonal within which two nodes are taken to be at one place. Pairs that straddle a multiple of
/// it are missed; a seam has many.
const NEAR: f64 = 1e-9;

pub(super) fn note(points: &[[f64; 3]], notes: &mut Vec<String>) {
    let (low, high) = bounds(points);
    let unit = NEAR * norm(&minus(&high, &low));
    let place = |point: &[f64; 3]| minus(point, &low).map(|x| (x / unit).round() as i64);
    let mut places: Vec<[i64; 3]> = points.iter().map(place).collect();
    places.sort_unstable();
    let twins = places.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if twins > 0 {
        notes.push(format!(
            "{twins} nodes lie on others; the body comes apart there (in Gmsh: fragment the parts, or Coherence)"
        ));
    }
}
