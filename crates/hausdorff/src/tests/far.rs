//! Chebyshev grids against all pairs: the stated bound holds, and the grids are in use.

use super::super::pairs::{LogSums, Pairs, Vjp};
use super::{Cloud, Method, Phi, Stream, cloud};

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

pub(super) fn run(body: &Cloud, target: &Cloud, phi: Phi, alpha: f64, method: Method) -> (Pairs, LogSums, Vjp) {
    let pairs = Pairs::new(body, target, phi, alpha, method).unwrap();
    let sums = pairs.log_sums();
    // Seeds of both signs, as no functional of ours has them.
    let mut stream = Stream::new(99);
    let mut seeds = |n: usize| (0..n).map(|_| 2.0 * stream.next() - 1.0).collect::<Vec<_>>();
    let (by_target, by_body) = (seeds(target.len()), seeds(body.len()));
    let pulled = pairs.vjp(&sums, &by_target, &by_body).unwrap();
    (pairs, sums, pulled)
}

fn largest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The largest error of the log sums, the summed error of the points' derivative and the largest error of the
/// weights' one, each over what its bound is stated in.
fn errors(body: &Cloud, target: &Cloud, phi: Phi, alpha: f64, tolerance: f64) -> [f64; 3] {
    let (exact_pairs, exact, pulled_exact) = run(body, target, phi, alpha, Method::Direct);
    let (pairs, sums, pulled) = run(body, target, phi, alpha, Method::Tree { tolerance });
    let (all, some) = (exact_pairs.counts(), pairs.counts());
    assert_eq!(all.far, 0.0);
    assert!(some.far > 0.005 * some.all && some.grid < some.far, "{phi:?}: too few far pairs: {some:?}");
    let logs = largest(&exact.target, &sums.target).max(largest(&exact.body, &sums.body));
    let seeds = (target.len() + body.len()) as f64;
    let slope = alpha * phi.log_derivative(phi.length()).abs().max(phi.log_derivative(0.0).abs());
    let points: f64 =
        pulled.points.iter().flatten().zip(pulled_exact.points.iter().flatten()).map(|(a, b)| (a - b).abs()).sum();
    let weights = largest(&pulled.weights, &pulled_exact.weights) * body.measure();
    [logs, points / (seeds * slope), weights / seeds]
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

#[test]
fn strands_within_the_bound() {
    let (body, target) = (strand(1, 2900, 0.1), strand(2, 3000, 0.13));
    for (phi, alpha) in [
        (Phi::Exponential { length: 0.5 }, 1.0),
        (Phi::Exponential { length: 0.5 }, 40.0),
        (Phi::Inverse { eps: 0.2 }, 2.0),
        (Phi::Inverse { eps: 0.1 }, 20.0),
        (Phi::SmoothInverse { eps: 0.5 }, 1.0),
        (Phi::SmoothInverse { eps: 0.1 }, 10.0),
    ] {
        for tolerance in [1e-4, 1e-7, 1e-9] {
            for (error, what) in errors(&body, &target, phi, alpha, tolerance).iter().zip(["log", "points", "weights"])
            {
                assert!(*error < tolerance, "{phi:?} {tolerance} {what}: {error:.1e}");
            }
        }
    }
}

#[test]
fn skins_in_contact_within_the_bound() {
    let (body, target) = (skin(1, 4000, 0.6), skin(2, 4100, 1e-6));
    for (phi, alpha, tolerance) in [
        (Phi::Exponential { length: 1.0 }, 4.0, 1e-3),
        (Phi::Exponential { length: 1.0 }, 30.0, 1e-4),
        (Phi::Inverse { eps: 0.1 }, 3.0, 1e-3),
        (Phi::SmoothInverse { eps: 0.5 }, 8.0, 1e-3),
    ] {
        for (error, what) in errors(&body, &target, phi, alpha, tolerance).iter().zip(["log", "points", "weights"]) {
            assert!(*error < tolerance, "{phi:?} {alpha} {tolerance} {what}: {error:.1e}");
        }
    }
}

#[test]
fn far_bodies_decay_beyond_the_range_of_numbers() {
    // Every phi^alpha between the two is below 1e-400.
    let (body, target) = (strand(1, 700, 0.1), strand(2, 600, 0.1));
    let points = target.points().iter().map(|x| [x[0] + 100.0, x[1], x[2]]).collect();
    let target = Cloud::new(points, target.weights().to_vec()).unwrap();
    let phi = Phi::Exponential { length: 0.1 };
    for (error, what) in errors(&body, &target, phi, 1.0, 1e-7).iter().zip(["log", "points", "weights"]) {
        assert!(*error < 1e-7, "{what}: {error:.1e}");
    }
}

#[test]
fn coinciding_points_do_not_disturb_the_grids() {
    // All points of a leaf in one place, a plane, a line: boxes without extent.
    let mut points = vec![[0.25, 0.5, 0.5]; 200];
    points.extend((0..300).map(|k| [k as f64 / 300.0, 0.0, 0.0]));
    points.extend((0..300).map(|k| [(k % 17) as f64 / 17.0, (k / 17) as f64 / 17.0, 1.0]));
    let target = Cloud::new(points, vec![1.0; 800]).unwrap();
    let body = cloud(5, 700, [2.0, 0.0, 0.0], [0.5, 1.0, 0.0]);
    for phi in [Phi::Exponential { length: 0.5 }, Phi::Inverse { eps: 0.3 }, Phi::SmoothInverse { eps: 0.5 }] {
        let worst = errors(&body, &target, phi, 2.0, 1e-9).into_iter().fold(0.0, f64::max);
        assert!(worst < 1e-9, "{phi:?}: {worst:.1e}");
    }
}
