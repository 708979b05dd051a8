//! What must not matter: units, place, order of points, number of threads.

use super::super::pairs::Pairs;
use super::{Cloud, Evaluation, Phi, Summation, all_phi, bars, close, rho, smoothing};

fn mapped(cloud: &Cloud, f: impl Fn([f64; 3]) -> [f64; 3], weight: f64) -> Cloud {
    let weights = cloud.weights().iter().map(|w| w * weight).collect();
    Cloud::new(cloud.points().iter().map(|&x| f(x)).collect(), weights).unwrap()
}

fn scaled(phi: Phi, s: f64) -> Phi {
    match phi {
        Phi::Exponential { length } => Phi::Exponential { length: s * length },
        Phi::Inverse { eps } => Phi::Inverse { eps: s * eps },
        Phi::SmoothInverse { eps } => Phi::SmoothInverse { eps: s * eps },
    }
}

#[test]
fn units_do_not_matter() {
    let (body, target) = bars(150, 160);
    for phi in all_phi(0.1) {
        for alpha in [2.0, 40.0, 2e4] {
            let here = rho(&body, &target, smoothing(phi, alpha, 8.0, 2.0));
            for unit in [1e3f64, 1e-6, 1e9] {
                let there = |cloud: &Cloud| mapped(cloud, |x| x.map(|c| unit * c), unit.powi(3));
                let s = smoothing(scaled(phi, unit), alpha, 8.0, 2.0);
                close(rho(&there(&body), &there(&target), s), unit * here, 1e-12);
            }
        }
    }
}

#[test]
fn place_and_direction_do_not_matter() {
    let (body, target) = bars(150, 160);
    let (sin, cos) = 0.7f64.sin_cos();
    let turn = |x: [f64; 3]| [cos * x[0] - sin * x[2] + 3.0, x[1] - 1.0, sin * x[0] + cos * x[2] + 2.0];
    for phi in all_phi(0.1) {
        let s = smoothing(phi, 40.0, 8.0, 2.0);
        close(rho(&mapped(&body, turn, 1.0), &mapped(&target, turn, 1.0), s), rho(&body, &target, s), 1e-12);
    }
}

#[test]
fn body_and_target_may_be_exchanged() {
    let (body, target) = bars(150, 160);
    for phi in all_phi(0.1) {
        let s = smoothing(phi, 40.0, 8.0, 2.0);
        close(rho(&body, &target, s), rho(&target, &body, s), 1e-13);
    }
}

#[test]
fn order_of_points_does_not_matter() {
    let (body, target) = bars(200, 90);
    let turned = |k: usize| (7 * k + 13) % 200;
    let points = (0..200).map(|k| body.points()[turned(k)]).collect();
    let shuffled = Cloud::new(points, (0..200).map(|k| body.weights()[turned(k)]).collect()).unwrap();
    let s = smoothing(Phi::Inverse { eps: 0.05 }, 9.0, 3.0, 2.0);
    let partials = |body: &Cloud| Evaluation::new(body, &target, s, Summation::default()).unwrap().partials().unwrap();
    let (a, b) = (partials(&body), partials(&shuffled));
    for k in 0..200 {
        for d in 0..3 {
            assert!((b.points[k][d] - a.points[turned(k)][d]).abs() < 1e-15);
        }
        assert!((b.weights[k] - a.weights[turned(k)]).abs() < 1e-15);
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

#[test]
fn same_bits_for_any_number_of_threads() {
    let (body, target) = bars(1500, 1300);
    for (phi, alpha) in [(Phi::Exponential { length: 0.1 }, 6.0), (Phi::SmoothInverse { eps: 0.01 }, 800.0)] {
        for summation in [Summation::Direct, Summation::default(), Summation::Truncated { tolerance: 1e-6 }] {
            let run = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let body = Cloud::new(body.points().to_vec(), body.weights().to_vec()).unwrap();
                    let pairs = Pairs::new(&body, &target, phi, alpha, summation).unwrap();
                    let sums = pairs.log_sums();
                    let vjp = pairs.vjp(&sums, target.weights(), body.weights()).unwrap();
                    let e = Evaluation::new(&body, &target, smoothing(phi, alpha, 4.0, 2.0), summation).unwrap();
                    let points: Vec<f64> = vjp.points.into_iter().flatten().collect();
                    let rho = [e.distance().rho, e.partials().unwrap().weights[3]];
                    [sums.target, sums.body, points, vjp.weights, rho.to_vec()].map(|v| bits(&v))
                })
            };
            let one = run(1);
            assert_eq!(one, run(2));
            assert_eq!(one, run(5));
        }
    }
}
