//! Spheres, balls and products of sets.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use crate::common;

use common::{Cost, begin, distance};
use nastic_opt::{
    Admissible, Ball, Best, Bounds, CATALOGUE, Diagonal, Euclidean, InnerProduct, Optimizer, Options, Product,
    SetError, Sphere, Trial,
};

fn every() -> impl Iterator<Item = Box<dyn Optimizer>> {
    let options = Options { tolerance: 1e-6, max_iterations: 3000, stagnation: 0.0, ..Options::default() };
    // Moving asymptotes take bounds alone, and say so: `mma.rs`.
    CATALOGUE.iter().filter(|entry| entry.name != "mma").map(move |entry| (entry.build)(options))
}

fn minimise(
    o: &dyn Optimizer,
    cost: &Cost,
    set: &(impl Admissible + Clone + 'static),
    metric: &(impl InnerProduct + Clone + 'static),
    m: &[f64],
) -> Best<Vec<f64>> {
    let best = begin(o, cost, set, metric, m).unwrap().minimize(&mut ());
    println!("{}: {} {:?} cost {:e}", o.name(), best.stop, best.counts, best.cost);
    assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
    best
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// min m.A m / 2 over |m| = C: the eigenvector of the smallest eigenvalue.
#[test]
fn eigenvector_on_a_sphere() {
    // A = Q diag(1, 3, 10) Q^T with Q built from (1,2,2)/3, (2,1,-2)/3, (2,-2,1)/3.
    let q = [[1.0, 2.0, 2.0], [2.0, 1.0, -2.0], [2.0, -2.0, 1.0]].map(|r: [f64; 3]| r.map(|x| x / 3.0));
    let lambda = [1.0, 3.0, 10.0];
    let apply = move |m: &[f64]| -> Vec<f64> {
        (0..3).map(|i| (0..3).map(|k| lambda[k] * q[k][i] * dot(&q[k], m)).sum()).collect()
    };
    for radius in [0.1, 1.0, 3e5] {
        let set = Sphere::new(3, radius).unwrap();
        let mut start = vec![0.3, -0.9, 0.1];
        set.project(&mut start);
        for o in every() {
            let cost = Cost::new(set.clone(), move |m| 0.5 * dot(m, &apply(m)), apply);
            let best = minimise(o.as_ref(), &cost, &set, &Euclidean::new(3), &start);
            let off: Vec<f64> = best.m.iter().map(|m| m / radius * (best.m[0] / radius).signum()).collect();
            assert!(distance(&off, &q[0]) < 1e-5, "{}: {:?}", o.name(), best.m);
            assert!(best.counts.iterations < 60);
        }
    }
}

/// A chain of unit vectors between two given ends with energy 1/2 sum |m_{i+1} - m_i|^2: the geodesic between them.
fn harmonic(n: usize, set: Sphere, left: [f64; 3], right: [f64; 3], scale: f64) -> Cost {
    let neighbour = move |m: &[f64], p: usize| -> [f64; 6] {
        let mut out = [0.0; 6];
        out[..3].copy_from_slice(if p == 0 { &left } else { &m[3 * p - 3..3 * p] });
        out[3..].copy_from_slice(if p + 1 == n { &right } else { &m[3 * p + 3..3 * p + 6] });
        out
    };
    let value = move |m: &[f64]| {
        let mut sum = 0.0;
        for p in 0..n {
            let b = neighbour(m, p);
            let square = |k: usize| (0..3).map(|i| (m[3 * p + i] - b[k + i]).powi(2)).sum::<f64>();
            sum += 0.5 * square(0) + if p + 1 == n { 0.5 * square(3) } else { 0.0 };
        }
        scale * sum
    };
    let derivative = move |m: &[f64]| {
        let mut out = vec![0.0; 3 * n];
        for p in 0..n {
            let b = neighbour(m, p);
            (0..3).for_each(|i| out[3 * p + i] = scale * (2.0 * m[3 * p + i] - b[i] - b[3 + i]));
        }
        out
    };
    Cost::new(set, value, derivative)
}

#[test]
fn harmonic_map_is_the_geodesic() {
    let (n, angle) = (19, 2.0f64);
    let (left, right) = ([1.0, 0.0, 0.0], [angle.cos(), angle.sin(), 0.0]);
    let set = Sphere::new(3, 1.0).unwrap();
    let mut start: Vec<f64> =
        (0..n).flat_map(|p| [1.0, 0.3 * (p as f64).sin(), 1.0 + 0.2 * (p as f64).cos()]).collect();
    set.project(&mut start);
    let exact = (n + 1) as f64 * (1.0 - (angle / (n + 1) as f64).cos());
    for o in every() {
        for weight in [1.0, 1e-3] {
            let metric = Diagonal::new(vec![weight; 3 * n]).unwrap();
            let best = minimise(o.as_ref(), &harmonic(n, set.clone(), left, right, 1.0), &set, &metric, &start);
            assert!((best.cost - exact).abs() < 1e-8 * exact, "{}: {} {exact}", o.name(), best.cost);
            let step = angle / (n + 1) as f64;
            let geodesic: Vec<f64> =
                (1..=n).flat_map(|k| [(k as f64 * step).cos(), (k as f64 * step).sin(), 0.0]).collect();
            assert!(distance(&best.m, &geodesic) < 1e-3, "{}", o.name());
        }
    }
}

/// A quasi-Newton method must be faster than the plain one, whose lengths are those of Barzilai and Borwein, on the sphere too: its pairs are transported.
#[test]
fn transported_pairs_help() {
    let n = 39;
    let set = Sphere::new(3, 1.0).unwrap();
    let mut start: Vec<f64> =
        (0..n).flat_map(|p| [1.0, 0.3 * (p as f64).sin(), 1.0 + 0.2 * (p as f64).cos()]).collect();
    set.project(&mut start);
    let iterations: Vec<usize> = every()
        .map(|o| {
            let cost = harmonic(n, set.clone(), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1e-7);
            minimise(o.as_ref(), &cost, &set, &Euclidean::new(3 * n), &start).counts.iterations
        })
        .collect();
    assert!(iterations[2] * 2 < iterations[0], "{iterations:?}");
}

/// A smooth (H1) gradient on spheres: the Gram matrix couples points, so the tangential gradient is a solve.
#[test]
fn smooth_gradient_on_spheres() {
    #[derive(Clone, Debug)]
    struct Smooth(common::Tridiagonal);
    impl Smooth {
        fn each(&self, v: &[f64], f: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
            let mut out = vec![0.0; v.len()];
            for i in 0..3 {
                let part: Vec<f64> = v.iter().skip(i).step_by(3).copied().collect();
                f(&part).iter().enumerate().for_each(|(p, x)| out[3 * p + i] = *x);
            }
            out
        }
    }
    impl InnerProduct for Smooth {
        fn len(&self) -> usize {
            3 * self.0.n
        }
        fn apply(&self, v: &[f64]) -> Vec<f64> {
            self.each(v, |part| self.0.apply(part))
        }
        fn riesz(&self, d: &[f64]) -> Vec<f64> {
            self.each(d, |part| self.0.riesz(part))
        }
    }
    let n = 39;
    let set = Sphere::new(3, 1.0).unwrap();
    let mut start: Vec<f64> =
        (0..n).flat_map(|p| [1.0, 0.3 * (p as f64).sin(), 1.0 + 0.2 * (p as f64).cos()]).collect();
    set.project(&mut start);
    let exact = (n + 1) as f64 * (1.0 - (std::f64::consts::FRAC_PI_2 / (n + 1) as f64).cos());
    for o in every() {
        let cost = harmonic(n, set.clone(), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.0);
        let best = minimise(o.as_ref(), &cost, &set, &Smooth(common::Tridiagonal::h1(n, 0.3)), &start);
        assert!((best.cost - exact).abs() < 1e-8 * exact, "{}: {} {exact}", o.name(), best.cost);
        assert!(best.counts.iterations < 60, "{}: {:?}", o.name(), best.counts);
    }
}

/// min (b-c).Q(b-c)/2 over |b| <= C with c outside: Q (b - c) = -mu b with mu > 0 and |b| = C.
#[test]
fn ball_reaches_its_boundary_condition() {
    let (q, c) = ([1.0, 30.0, 5.0], [3.0, -0.5, 1.0]);
    for unit in [1.0, 2e-2, 1e5] {
        let set = Ball::new(3, unit).unwrap();
        for o in every() {
            let value = move |b: &[f64]| (0..3).map(|i| 0.5 * q[i] * (b[i] / unit - c[i]).powi(2)).sum();
            let derivative = move |b: &[f64]| (0..3).map(|i| q[i] * (b[i] / unit - c[i]) / unit).collect();
            let best =
                minimise(o.as_ref(), &Cost::new(set.clone(), value, derivative), &set, &Euclidean::new(3), &[0.0; 3]);
            let b: Vec<f64> = best.m.iter().map(|b| b / unit).collect();
            assert!((dot(&b, &b).sqrt() - 1.0).abs() < 1e-9, "{}: {b:?}", o.name());
            let r: Vec<f64> = (0..3).map(|i| q[i] * (b[i] - c[i])).collect();
            let mu = -dot(&r, &b);
            assert!(mu > 0.0 && (0..3).all(|i| (r[i] + mu * b[i]).abs() < 1e-4), "{}: {r:?} {b:?}", o.name());
            assert_eq!(best.active, 1);
        }
    }
}

/// A design on spheres, a field in a ball, an amplitude in a box: minimised together, each ends where it should.
#[test]
fn product_of_sets() {
    let set = Product::new()
        .block(6, Sphere::new(3, 0.1).unwrap())
        .block(2, Ball::new(2, 0.02).unwrap())
        .block(2, Bounds::new(-3.0, 1.0).unwrap());
    assert_eq!(set.len(), 10);
    let target = [0.0, 0.3, 0.4, -0.5, 0.0, 0.0, 0.04, 0.03, -1.0, 4.0];
    let exact = [0.0, 0.06, 0.08, -0.1, 0.0, 0.0, 0.016, 0.012, -1.0, 1.0];
    let mut start = vec![0.1, 0.02, 0.0, -0.01, 0.1, 0.03, 0.0, 0.0, 0.0, 0.0];
    set.project(&mut start);
    let guard = || {
        Product::new()
            .block(6, Sphere::new(3, 0.1).unwrap())
            .block(2, Ball::new(2, 0.02).unwrap())
            .block(2, Bounds::new(-3.0, 1.0).unwrap())
    };
    // Blocks of different units are made comparable by the metric.
    let metric = Diagonal::new([vec![1e2; 6], vec![2.5e3; 2], vec![0.1; 2]].concat()).unwrap();
    let w = [vec![1e2; 6], vec![2e3; 2], vec![1.0; 2]].concat();
    for o in every() {
        let (w, v) = (w.clone(), w.clone());
        let value = move |m: &[f64]| (0..10).map(|i| 0.5 * w[i] * (m[i] - target[i]).powi(2)).sum();
        let derivative = move |m: &[f64]| (0..10).map(|i| v[i] * (m[i] - target[i])).collect();
        let cost = Cost::new(guard(), value, derivative);
        let mut worst: f64 = 0.0;
        let mut watch = |t: &Trial<'_, Vec<f64>>| {
            let sizes = [&t.m[..3], &t.m[3..6]].map(|v| dot(v, v).sqrt());
            worst = sizes.iter().fold(worst, |w, s| w.max((s - 0.1).abs() / 0.1));
            assert!(dot(&t.m[6..8], &t.m[6..8]).sqrt() <= 0.02);
        };
        let best = begin(o.as_ref(), &cost, &set, &metric, &start).unwrap().minimize(&mut watch);
        println!("{}: {} {:?}", o.name(), best.stop, best.counts);
        assert!(best.stop.is_converged(), "{}: {}", o.name(), best.stop);
        assert!(worst < 1e-14, "{worst:e}");
        assert!(distance(&best.m, &exact) < 1e-5, "{}: {:?}", o.name(), best.m);
    }
    let outside = set.check(&[0.0, 0.06, 0.08, -0.1, 0.0, 0.0, 0.016, 0.03, -1.0, 1.0]).unwrap_err();
    assert!(outside.index == 6 && outside.to_string().contains("no longer than 2e-2"), "{outside}");
    assert!(set.check(&[0.0; 9]).is_err());
}

/// A whole step to a bound ends on it to the bit, though m + (bound - m) rounds.
#[test]
fn bounds_are_reached_exactly() {
    let set = Bounds::new(-0.3, 190000.7).unwrap();
    let mut random = nastic_numeric::Random::new(3);
    let m: Vec<f64> = (0..1000).map(|_| 1e5 * random.unit()).collect();
    let mut d: Vec<f64> = (0..1000).map(|_| 1e6 * random.symmetric()).collect();
    let ends: Vec<f64> = d.iter().zip(&m).map(|(d, m)| (m + d).clamp(-0.3, 190000.7)).collect();
    set.restrict(&m, &mut d);
    assert!(m.iter().zip(&d).zip(&ends).any(|((m, d), e)| m + d != *e), "rounding is at work");
    let mut out = m.clone();
    set.retract(&m, &d, 1.0, &mut out);
    assert!(out.iter().zip(&ends).filter(|(_, e)| **e == -0.3 || **e == 190000.7).all(|(o, e)| o == e));
}

#[test]
fn impossible_sets_are_refused() {
    assert_eq!(Sphere::new(4, 1.0).unwrap_err(), SetError::Dimension(4));
    assert!(matches!(Sphere::new(3, -1.0).unwrap_err(), SetError::Radius(_)));
    assert!(matches!(Ball::new(2, f64::NAN).unwrap_err(), SetError::Radius(_)));
    assert!(Sphere::new(3, 1.0).unwrap().check(&[1.0, 0.0, 0.0, 1.0]).is_err());
}

/// Every set: projections and retractions are admissible whatever the step, restriction is idempotent.
#[test]
fn every_set_keeps_what_it_promises() {
    let sets: Vec<Box<dyn Admissible>> = vec![
        Box::new(Bounds::new(-4e5, 1.9e5).unwrap()),
        Box::new(Bounds::none()),
        Box::new(Sphere::new(3, 0.1).unwrap()),
        Box::new(Sphere::new(2, 7.0).unwrap()),
        Box::new(Ball::new(3, 2e-2).unwrap()),
        Box::new(Product::new().block(6, Sphere::new(3, 0.1).unwrap()).block(6, Ball::new(2, 3.0).unwrap())),
    ];
    let mut random = nastic_numeric::Random::new(7);
    for set in &sets {
        for size in [1e-9, 1e-2, 1.0, 1e6] {
            let mut m: Vec<f64> = (0..12).map(|_| size * random.symmetric()).collect();
            set.project(&mut m);
            set.check(&m).unwrap();
            let mut d: Vec<f64> = (0..12).map(|_| size * random.symmetric()).collect();
            set.restrict(&m, &mut d);
            let mut again = d.clone();
            set.restrict(&m, &mut again);
            assert!(distance(&d, &again) <= 1e-14 * size.max(1e6), "{set:?}");
            let mut out = m.clone();
            for t in [0.0, 1e-12, 0.3, 1.0, 50.0] {
                set.retract(&m, &d, t, &mut out);
                set.check(&out).unwrap_or_else(|e| panic!("{set:?} at t = {t}: {e}"));
            }
            // The retraction begins at m with velocity d.
            let scale = d.iter().map(|d| d.abs()).fold(0.0, f64::max).max(1e-300);
            let extent = set.extent(&m).iter().copied().fold(0.0, f64::max);
            let t = if extent > 0.0 { (1e-5 * extent / scale).min(1e-3) } else { 1e-3 };
            set.retract(&m, &d, t, &mut out);
            let speed: Vec<f64> = out.iter().zip(&m).map(|(o, m)| (o - m) / t).collect();
            let rounding = 1e-15 * m.iter().map(|m| m.abs()).fold(0.0, f64::max) / t;
            assert!(distance(&speed, &d) < 2e-3 * scale + rounding, "{set:?}: {speed:?} {d:?}");
            let mut inward: Vec<f64> = (0..12).map(|_| size * random.symmetric()).collect();
            set.inward(&m, &mut inward);
            set.retract(&m, &inward, 0.5, &mut out);
            set.check(&out).unwrap();
        }
    }
}
