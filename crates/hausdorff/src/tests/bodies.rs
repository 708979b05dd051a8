//! Bodies to sum over, and the sums with their vector-Jacobian product.

use super::super::pairs::{LogSums, Pairs, Vjp};
use super::{Cloud, Phi, Stream, Summation};

/// Points on the faces of a bar, bent by `angle`.
pub(super) fn skin(seed: u64, n: usize, angle: f64) -> Cloud {
    let mut stream = Stream::new(seed);
    let mut point = || {
        let mut x = stream.point([0.0; 3], [1.0, 0.2, 0.2]);
        let face = (4.0 * stream.next()) as usize;
        x[1 + face / 2] = if face.is_multiple_of(2) { 0.0 } else { 0.2 };
        let r = 1.0 / angle;
        [(r - x[2]) * (angle * x[0]).sin(), x[1], r - (r - x[2]) * (angle * x[0]).cos()]
    };
    let points = (0..n).map(|_| point()).collect();
    Cloud::new(points, (0..n).map(|_| 0.5 + stream.next()).collect()).unwrap()
}

pub(super) fn run(body: &Cloud, target: &Cloud, phi: Phi, alpha: f64, summation: Summation) -> (Pairs, LogSums, Vjp) {
    let pairs = Pairs::new(body, target, phi, alpha, summation).unwrap();
    let sums = pairs.log_sums();
    // Seeds of both signs, as no functional of ours has them.
    let mut stream = Stream::new(99);
    let mut seeds = |n: usize| (0..n).map(|_| 2.0 * stream.next() - 1.0).collect::<Vec<_>>();
    let (by_target, by_body) = (seeds(target.len()), seeds(body.len()));
    let vjp = pairs.vjp(&sums, &by_target, &by_body).unwrap();
    (pairs, sums, vjp)
}

/// Points along a curve that winds around the x axis.
pub(super) fn strand(seed: u64, n: usize, radius: f64) -> Cloud {
    let mut stream = Stream::new(seed);
    let mut point = |_| {
        let t = stream.next();
        [t, radius * (4.0 * t).cos(), radius * (4.0 * t).sin()]
    };
    let points = (0..n).map(&mut point).collect();
    Cloud::new(points, (0..n).map(|k| 1.0 + (k % 5) as f64).collect()).unwrap()
}
