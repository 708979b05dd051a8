//! Tests of the smoothed Hausdorff distance.

mod bodies;
mod closed_forms;
mod derivative;
mod input;
mod invariance;
mod lanes;
mod phi;
mod reference;
mod second;
mod sweep;
mod truncation;

use super::{Cloud, Evaluation, Motion, Partials, Phi, Smoothing, Summation};

/// A repeatable stream of numbers in [0, 1).
pub(super) struct Stream(u64);

impl Stream {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn point(&mut self, origin: [f64; 3], size: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|d| origin[d] + size[d] * self.next())
    }
}

/// `n` random points in a box, with random weights.
pub(super) fn cloud(seed: u64, n: usize, origin: [f64; 3], size: [f64; 3]) -> Cloud {
    let mut stream = Stream::new(seed);
    let points = (0..n).map(|_| stream.point(origin, size)).collect();
    let weights = (0..n).map(|_| 0.1 + stream.next()).collect();
    Cloud::new(points, weights).unwrap()
}

/// A bar of length 1 and one that is shifted and half as long again.
pub(super) fn bars(m: usize, n: usize) -> (Cloud, Cloud) {
    (cloud(1, m, [0.0; 3], [1.0, 0.2, 0.2]), cloud(2, n, [0.05, 0.1, 0.02], [1.5, 0.2, 0.2]))
}

pub(super) fn smoothing(phi: Phi, alpha: f64, beta: f64, gamma: f64) -> Smoothing {
    Smoothing::new(phi, alpha, beta, gamma).unwrap()
}

pub(super) fn rho(body: &Cloud, target: &Cloud, smoothing: Smoothing) -> f64 {
    Evaluation::new(body, target, smoothing, Summation::Direct).unwrap().distance().rho
}

pub(super) fn distance(x: [f64; 3], y: [f64; 3]) -> f64 {
    (0..3).map(|d| (x[d] - y[d]).powi(2)).sum::<f64>().sqrt()
}

/// |a - b| <= tolerance |b|
#[track_caller]
pub(super) fn close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{a} against {b}: relative error {:.1e}", ((a - b) / b).abs());
}

/// Every phi of the catalogue, with this length.
pub(super) fn all_phi(length: f64) -> impl Iterator<Item = Phi> {
    super::CATALOGUE.iter().map(move |row| (row.make)(length))
}
