//! [`Distances`]: from the points of a shape to another one.

use super::side::Side;

/// Mean, root mean square and largest distance of points from a shape.
pub(super) struct Distances {
    pub mean: f64,
    pub rms: f64,
    pub largest: f64,
    pub from: [f64; 3],
    pub to: [f64; 3],
}

impl Distances {
    /// From the points of one shape to the nearest points of another.
    pub fn between(of: &Side, to: &Side) -> Self {
        let mut out = Self { mean: 0.0, rms: 0.0, largest: -1.0, from: [0.0; 3], to: [0.0; 3] };
        for &point in &of.points {
            let (nearest, distance) = to.nearest(point);
            out.mean += distance;
            out.rms += distance * distance;
            if distance > out.largest {
                (out.largest, out.from, out.to) = (distance, point, nearest);
            }
        }
        let count = of.points.len() as f64;
        out.mean /= count;
        out.rms = (out.rms / count).sqrt();
        out
    }
}

/// The distance of two points.
pub(super) fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
