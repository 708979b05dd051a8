//! Second derivatives against differences of partials.

use super::{Cloud, Evaluation, Motion, Partials, Phi, Smoothing, Stream, Summation, all_phi, bars, smoothing};

fn motion(seed: u64, body: &Cloud) -> Motion {
    let mut stream = Stream::new(seed);
    let points = (0..body.len()).map(|_| stream.point([-1.0; 3], [2.0; 3])).collect();
    Motion { points, weights: body.weights().iter().map(|w| w * (2.0 * stream.next() - 1.0)).collect() }
}

fn moved(body: &Cloud, motion: &Motion, h: f64) -> Cloud {
    let points = body.points().iter().zip(&motion.points);
    let points = points.map(|(x, v)| std::array::from_fn(|d| x[d] + h * v[d])).collect();
    let weights = body.weights().iter().zip(&motion.weights).map(|(w, v)| w + h * v).collect();
    Cloud::new(points, weights).unwrap()
}

fn numbers(partials: &Partials, weights: &[f64]) -> Vec<f64> {
    // by weights in proportion, so that both have the unit of rho
    partials.points.iter().flatten().copied().chain(partials.weights.iter().zip(weights).map(|(p, w)| p * w)).collect()
}

fn partials(body: &Cloud, target: &Cloud, s: Smoothing, weights: &[f64]) -> Vec<f64> {
    numbers(&Evaluation::new(body, target, s, Summation::Direct).unwrap().partials().unwrap(), weights)
}

/// Sixth-order differences of the partials along a motion against what is found.
fn check(body: &Cloud, target: &Cloud, s: Smoothing, h: f64, tolerance: f64) {
    let along = motion(3, body);
    let at = |k: f64| partials(&moved(body, &along, k * h), target, s, body.weights());
    let all = [1.0, 2.0, 3.0].map(|k| (at(k), at(-k)));
    let expected: Vec<f64> = (0..all[0].0.len())
        .map(|i| {
            let pair = |k: usize| all[k].0[i] - all[k].1[i];
            (45.0 * pair(0) - 9.0 * pair(1) + pair(2)) / (60.0 * h)
        })
        .collect();
    let largest = |v: &[f64]| v.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    for summation in [Summation::Direct, Summation::Truncated { tolerance: 1e-12 }] {
        let evaluation = Evaluation::new(body, target, s, summation).unwrap();
        let found = evaluation.partials_change(&along).unwrap();
        let change = numbers(&found.change, body.weights());
        let error = largest(&change.iter().zip(&expected).map(|(a, b)| a - b).collect::<Vec<_>>());
        assert!(error < tolerance * largest(&expected), "{s:?}: {error:e} of {:e}", largest(&expected));
        let first = evaluation.partials().unwrap().weights;
        let error = largest(&found.weights.iter().zip(&first).map(|(a, b)| a - b).collect::<Vec<_>>());
        assert!(error < 1e-11 * largest(&first), "{s:?}: first derivatives by weights differ by {error:e}");
    }
}

#[test]
fn changes_of_partials_agree_with_differences() {
    let (body, target) = bars(130, 170);
    for phi in all_phi(0.1) {
        for [alpha, beta, gamma] in [[1.0, 1.0, 1.0], [4.0, 8.0, 2.0], [0.3, 0.5, 5.0], [30.0, 16.0, 1.5]] {
            check(&body, &target, smoothing(phi, alpha, beta, gamma), 1e-3 * phi.length() / alpha.max(1.0), 1e-6);
        }
    }
}

/// Scales that differ by thousands of orders of magnitude within one leaf.
#[test]
fn at_huge_alpha() {
    let (body, target) = bars(90, 80);
    for (phi, alpha) in [(Phi::Exponential { length: 0.1 }, 1e3), (Phi::SmoothInverse { eps: 0.01 }, 3e3)] {
        check(&body, &target, smoothing(phi, alpha, 20.0, 4.0), 3e-7, 1e-5);
    }
}

#[test]
fn second_derivatives_are_symmetric() {
    let (body, target) = bars(300, 250);
    for phi in all_phi(0.1) {
        let s = smoothing(phi, 4.0, 8.0, 3.0);
        let evaluation = Evaluation::new(&body, &target, s, Summation::Direct).unwrap();
        let (a, b) = (motion(5, &body), motion(8, &body));
        let pair = |partials: &Partials, motion: &Motion| -> f64 {
            let by_points = partials.points.iter().flatten().zip(motion.points.iter().flatten()).map(|(p, v)| p * v);
            by_points.sum::<f64>() + partials.weights.iter().zip(&motion.weights).map(|(p, v)| p * v).sum::<f64>()
        };
        let of = |motion: &Motion| evaluation.partials_change(motion).unwrap().change;
        let (of_a, of_b) = (of(&a), of(&b));
        let size = (pair(&of_a, &a) * pair(&of_b, &b)).abs().sqrt();
        assert!((pair(&of_a, &b) - pair(&of_b, &a)).abs() < 1e-12 * size, "{phi:?}");
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        assert_eq!(alone.install(|| of(&a)), of_a, "the bits depend on the number of threads");
    }
}

/// A kink where points meet contributes zero; a cloud on its own is finite.
#[test]
fn coinciding_points_and_motions_that_do_not_fit() {
    for phi in all_phi(0.1) {
        let s = smoothing(phi, 5.0, 2.0, 2.0);
        let body = super::cloud(11, 60, [0.0; 3], [1.0, 0.2, 0.2]);
        let evaluation = Evaluation::new(&body, &body, s, Summation::Direct).unwrap();
        let found = evaluation.partials_change(&motion(2, &body)).unwrap();
        assert!(found.change.points.iter().flatten().chain(&found.change.weights).all(|d| d.is_finite()), "{phi:?}");
        let one = Cloud::new(vec![[0.3, -2.0, 1.0]], vec![2.0]).unwrap();
        let alone = Evaluation::new(&one, &one, s, Summation::Direct).unwrap();
        assert!(alone.partials_change(&motion(2, &one)).unwrap().change.points[0].iter().all(|d| d.is_finite()));
        assert!(evaluation.partials_change(&motion(2, &one)).is_err());
    }
}
