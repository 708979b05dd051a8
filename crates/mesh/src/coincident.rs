//! Coincident nodes: usually parts of a mesh that should be connected and are not.

use crate::Mesh;
use crate::geometry::{bounds, minus, norm};

/// Distance up to which two nodes coincide, as a share of the body's diagonal. Pairs on both sides of a multiple of it are
/// missed; a seam has many others.
const COINCIDENCE_TOLERANCE: f64 = 1e-9;

impl Mesh {
    /// How many nodes lie where another one is: the body comes apart there.
    pub fn coincident_nodes(&self) -> usize {
        let (low, high) = bounds(&self.points);
        let unit = COINCIDENCE_TOLERANCE * norm(&minus(&high, &low));
        let place = |point: &[f64; 3]| minus(point, &low).map(|x| (x / unit).round() as i64);
        let mut places: Vec<[i64; 3]> = self.points.iter().map(place).collect();
        places.sort_unstable();
        places.windows(2).filter(|pair| pair[0] == pair[1]).count()
    }
}
