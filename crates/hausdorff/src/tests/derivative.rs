//! Partial derivatives against differences, and where they meet kinks.

use super::{Cloud, Evaluation, Phi, Smoothing, Stream, Summation, all_phi, bars, cloud, rho, smoothing};

struct Motion {
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
}

impl Motion {
    fn new(seed: u64, body: &Cloud) -> Self {
        let mut stream = Stream::new(seed);
        let points = (0..body.len()).map(|_| stream.point([-1.0; 3], [2.0; 3])).collect();
        Self { points, weights: body.weights().iter().map(|w| w * (2.0 * stream.next() - 1.0)).collect() }
    }

    fn apply(&self, body: &Cloud, h: f64) -> Cloud {
        let points = body.points().iter().zip(&self.points);
        let points = points.map(|(x, v)| std::array::from_fn(|d| x[d] + h * v[d])).collect();
        let weights = body.weights().iter().zip(&self.weights).map(|(w, v)| w + h * v).collect();
        Cloud::new(points, weights).unwrap()
    }

    fn slope(&self, body: &Cloud, target: &Cloud, smoothing: Smoothing, summation: Summation) -> f64 {
        let partials = Evaluation::new(body, target, smoothing, summation).unwrap().partials().unwrap();
        let by_points = partials.points.iter().zip(&self.points).map(|(p, v)| p[0] * v[0] + p[1] * v[1] + p[2] * v[2]);
        let by_weights = partials.weights.iter().zip(&self.weights).map(|(p, v)| p * v);
        by_points.sum::<f64>() + by_weights.sum::<f64>()
    }
}

/// Central differences, extrapolated once: error O(h^4).
fn difference(body: &Cloud, target: &Cloud, smoothing: Smoothing, motion: &Motion, h: f64) -> f64 {
    let central = |h: f64| {
        (rho(&motion.apply(body, h), target, smoothing) - rho(&motion.apply(body, -h), target, smoothing)) / (2.0 * h)
    };
    (4.0 * central(h / 2.0) - central(h)) / 3.0
}

#[test]
fn partials_agree_with_differences() {
    let (body, target) = bars(130, 170);
    let motion = Motion::new(3, &body);
    for phi in all_phi(0.1) {
        for [alpha, beta, gamma] in [[1.0, 1.0, 1.0], [4.0, 8.0, 2.0], [0.3, 0.5, 5.0], [30.0, 16.0, 1.5]] {
            let s = smoothing(phi, alpha, beta, gamma);
            let h = 2e-3 * phi.length() / alpha.max(1.0);
            let expected = difference(&body, &target, s, &motion, h);
            super::close(motion.slope(&body, &target, s, Summation::Direct), expected, 3e-8);
            super::close(motion.slope(&body, &target, s, Summation::Truncated { tolerance: 1e-12 }), expected, 3e-8);
        }
    }
}

#[test]
fn points_and_weights_alone() {
    let (body, target) = bars(70, 40);
    for phi in all_phi(0.1) {
        let s = smoothing(phi, 3.0, 4.0, 2.0);
        let (mut still, mut heavy) = (Motion::new(5, &body), Motion::new(6, &body));
        still.weights.fill(0.0);
        heavy.points.fill([0.0; 3]);
        for motion in [still, heavy] {
            let expected = difference(&body, &target, s, &motion, 1e-4);
            super::close(motion.slope(&body, &target, s, Summation::Direct), expected, 1e-8);
        }
    }
}

/// alpha r / l about 1e4: values of phi^alpha differ by thousands of orders of magnitude within one leaf.
#[test]
fn partials_at_huge_alpha() {
    let (body, target) = bars(150, 130);
    let motion = Motion::new(4, &body);
    for (phi, alpha) in [
        (Phi::Exponential { length: 0.1 }, 1e3),
        (Phi::Exponential { length: 0.1 }, 1e4),
        (Phi::Inverse { eps: 0.01 }, 3e3),
        (Phi::SmoothInverse { eps: 0.01 }, 3e3),
    ] {
        let s = smoothing(phi, alpha, 20.0, 4.0);
        let expected = difference(&body, &target, s, &motion, 2e-7);
        super::close(motion.slope(&body, &target, s, Summation::Direct), expected, 1e-6);
    }
}

#[test]
fn taylor_remainder_is_of_second_order() {
    let (body, target) = bars(90, 100);
    let motion = Motion::new(7, &body);
    for phi in all_phi(0.2) {
        let s = smoothing(phi, 2.0, 4.0, 2.0);
        let (start, slope) = (rho(&body, &target, s), motion.slope(&body, &target, s, Summation::Direct));
        let remainder = |h: f64| (rho(&motion.apply(&body, h), &target, s) - start - h * slope).abs();
        let order = (remainder(2e-3) / remainder(1e-3)).log2();
        assert!((order - 2.0).abs() < 0.02, "{phi:?}: order {order}");
    }
}

#[test]
fn weights_in_proportion_change_nothing() {
    let (body, target) = bars(100, 120);
    for phi in all_phi(0.1) {
        let e = Evaluation::new(&body, &target, smoothing(phi, 5.0, 3.0, 2.0), Summation::Direct).unwrap();
        let partials = e.partials().unwrap();
        let terms = || partials.weights.iter().zip(body.weights()).map(|(p, w)| p * w);
        assert!(terms().sum::<f64>().abs() < 1e-13 * terms().map(f64::abs).sum::<f64>());
    }
}

#[test]
fn coinciding_points_contribute_nothing() {
    for phi in all_phi(0.1) {
        let s = smoothing(phi, 50.0, 2.0, 2.0);
        let one = Cloud::new(vec![[0.3, -2.0, 1.0]], vec![2.0]).unwrap();
        let e = Evaluation::new(&one, &one, s, Summation::Direct).unwrap();
        assert_eq!(e.distance().rho, 0.0);
        let partials = e.partials().unwrap();
        assert_eq!((partials.points[0], partials.weights[0]), ([0.0; 3], 0.0));
        // Two points on top of their targets: the force on each comes from the other's target alone.
        let two = Cloud::new(vec![[0.0; 3], [0.1, 0.0, 0.0]], vec![1.0; 2]).unwrap();
        let partials = Evaluation::new(&two, &two, s, Summation::Direct).unwrap().partials().unwrap();
        assert!(partials.points[0][0] < 0.0 && partials.points[0][0].is_finite());
        super::close(partials.points[1][0], -partials.points[0][0], 1e-12);
    }
}

#[test]
fn self_distance_is_small_and_falls_with_alpha() {
    let body = cloud(11, 500, [0.0; 3], [1.0, 0.2, 0.2]);
    for phi in all_phi(0.1) {
        let own = |alpha: f64| rho(&body, &body, smoothing(phi, alpha, 4.0, 2.0));
        assert!(own(4.0) > own(40.0) && own(40.0) > own(4000.0), "{phi:?}");
        assert!(own(4e6) < 3e-4);
    }
}
