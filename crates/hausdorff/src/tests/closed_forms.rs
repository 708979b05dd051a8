//! Configurations whose distance is known in closed form, and limits.

use super::{Cloud, Evaluation, Phi, Summation, all_phi, bars, close, distance, rho, smoothing};

#[test]
fn two_points() {
    let at = |x: [f64; 3]| Cloud::new(vec![x], vec![0.7]).unwrap();
    let (a, b) = (at([1.0, 2.0, 3.0]), at([1.0, 2.0, 3.5]));
    for phi in all_phi(0.1) {
        for [alpha, beta, gamma] in [[1.0, 1.0, 1.0], [300.0, 20.0, 4.0], [0.1, 0.2, 0.5]] {
            let e = Evaluation::new(&a, &b, smoothing(phi, alpha, beta, gamma), Summation::Direct).unwrap();
            close(e.distance().body_to_target, 0.5, 1e-13);
            close(e.distance().target_to_body, 0.5, 1e-13);
            close(e.distance().rho, 0.5 * 2f64.powf(0.5 / gamma), 1e-13);
            // Moving the body away lengthens the distance at unit rate.
            close(e.partials().unwrap().points[0][2], -(2f64.powf(0.5 / gamma)), 1e-12);
        }
    }
}

/// A ball of radius R and its centre: only the radii matter, so a ray with weights r^2 dr is the ball.
#[test]
fn ball_and_its_centre() {
    let (n, radius) = (20_000, 0.7);
    let r = |k: usize| radius * (k as f64 + 0.5) / n as f64;
    let ball = Cloud::new((0..n).map(|k| [0.0, r(k), 0.0]).collect(), (0..n).map(|k| r(k).powi(2)).collect()).unwrap();
    let centre = Cloud::new(vec![[0.0; 3]], vec![1.0]).unwrap();
    let (alpha, beta, length) = (3.0, 5.0, 0.2);
    let s = smoothing(Phi::Exponential { length }, alpha, beta, 2.0);
    let found = Evaluation::new(&ball, &centre, s, Summation::Direct).unwrap().distance();
    // Every body point is at its own radius: D2 = (3/(3+beta))^(1/beta) R.
    close(found.body_to_target, radius * (3.0f64 / (3.0 + beta)).powf(1.0 / beta), 1e-7);
    // A = 3/R^3 int_0^R r^2 exp(-k r) dr
    let k = alpha / length;
    let kr = k * radius;
    let a = 3.0 / kr.powi(3) * (2.0 - (-kr).exp() * (kr * kr + 2.0 * kr + 2.0));
    close(found.target_to_body, -a.ln() / k, 1e-7);
}

/// A segment [0, L] and a point at distance a beyond its end.
#[test]
fn segment_and_a_point() {
    let (n, size, a) = (20_000, 2.0, 0.3);
    let x = |k: usize| size * (k as f64 + 0.5) / n as f64;
    let segment = Cloud::new((0..n).map(|k| [x(k), 1.0, 0.0]).collect(), vec![size / n as f64; n]).unwrap();
    let point = Cloud::new(vec![[-a, 1.0, 0.0]], vec![1.0]).unwrap();
    let (alpha, beta) = (6.0, 3.0);
    let d = |phi| {
        Evaluation::new(&segment, &point, smoothing(phi, alpha, beta, 2.0), Summation::Direct).unwrap().distance()
    };
    let d2 = (((a + size).powf(beta + 1.0) - a.powf(beta + 1.0)) / ((beta + 1.0) * size)).powf(1.0 / beta);
    let exponential = d(Phi::Exponential { length: 0.5 });
    close(exponential.body_to_target, d2, 1e-7);
    let k = alpha / 0.5;
    close(exponential.target_to_body, a - ((1.0 - (-k * size).exp()) / (k * size)).ln() / k, 1e-7);
    let inverse = d(Phi::Inverse { eps: 0.1 });
    close(inverse.body_to_target, d2, 1e-7);
    let primitive = |r: f64| (r + 0.1).powf(1.0 - alpha) / (1.0 - alpha);
    let mean = (primitive(a + size) - primitive(a)) / size;
    close(inverse.target_to_body, mean.powf(-1.0 / alpha) - 0.1, 1e-7);
}

/// As alpha, beta and gamma grow: the Hausdorff distance of the two sets of points.
#[test]
fn limit_is_the_hausdorff_distance() {
    let (body, target) = bars(300, 200);
    let directed = |from: &Cloud, to: &Cloud| {
        let nearest = |&y: &[f64; 3]| to.points().iter().map(|&x| distance(x, y)).fold(f64::INFINITY, f64::min);
        from.points().iter().map(nearest).fold(0.0, f64::max)
    };
    let (d1, d2) = (directed(&target, &body), directed(&body, &target));
    for phi in all_phi(0.1) {
        let found = |alpha: f64, beta: f64, gamma: f64| {
            Evaluation::new(&body, &target, smoothing(phi, alpha, beta, gamma), Summation::Direct).unwrap().distance()
        };
        let sharp = found(1e8, 1e6, 1e6);
        close(sharp.target_to_body, d1, 2e-5);
        close(sharp.body_to_target, d2, 2e-5);
        close(sharp.rho, d1.max(d2), 2e-5);
        // The factor 1/sqrt 2 of the larger directed distance, and gamma as it is.
        let joined = found(1e8, 1e6, 3.0);
        close(joined.rho, ((d1.powi(3) + d2.powi(3)) / 2f64.sqrt()).cbrt(), 2e-5);
        // From far off the exponential soft minimum errs by at most (l / alpha) log(number of points / their share).
        let coarse = found(1e3, 1e6, 1e6);
        assert!(coarse.rho > sharp.rho && coarse.rho < sharp.rho + 0.05);
    }
}

#[test]
fn one_side_alone() {
    // The body is a part of the target, point for point: D2 vanishes as alpha grows, D1 does not.
    let target = Cloud::new(vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![1.0; 2]).unwrap();
    let body = Cloud::new(vec![[0.0; 3]], vec![1.0]).unwrap();
    let s = smoothing(Phi::Exponential { length: 1.0 }, 1e9, 1e9, 4.0);
    close(rho(&body, &target, s), 2f64.powf(-0.125), 1e-8);
}
