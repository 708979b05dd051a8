//! The stated error of the sums over bodies of all kinds, drawn at random: what is left out against all pairs.

use super::bodies::{run, skin, strand};
use super::{Cloud, Phi, Stream, Summation, cloud, distance};

fn weighted(points: Vec<[f64; 3]>, stream: &mut Stream, decades: f64) -> Cloud {
    let weights = points.iter().map(|_| 10f64.powf(-decades * stream.next())).collect();
    Cloud::new(points, weights).unwrap()
}

fn moved(cloud: &Cloud, scale: f64, by: [f64; 3]) -> Cloud {
    let points = cloud.points().iter().map(|x| std::array::from_fn(|d| scale * x[d] + by[d])).collect();
    Cloud::new(points, cloud.weights().to_vec()).unwrap()
}

/// Points in heaps of very different density.
fn heaps(stream: &mut Stream, n: usize) -> Vec<[f64; 3]> {
    let centres: Vec<[f64; 3]> = (0..6).map(|_| stream.point([0.0; 3], [1.0, 0.4, 0.4])).collect();
    let mut point = |k: usize| {
        let size = 10f64.powf(-4.0 * stream.next());
        let by = stream.point([-0.1; 3], [0.2; 3]);
        std::array::from_fn(|d| centres[k % 6][d] + size * by[d])
    };
    (0..n).map(&mut point).collect()
}

const KINDS: [&str; 8] =
    ["separated", "touching skins", "coinciding", "threads", "planes", "heaps", "sizes", "weights over 30 decades"];

fn bodies(kind: &str, stream: &mut Stream) -> (Cloud, Cloud) {
    let seed = (1e6 * stream.next()) as u64;
    let (m, n) = (900 + (200.0 * stream.next()) as usize, 900 + (200.0 * stream.next()) as usize);
    match kind {
        "separated" => (
            cloud(seed, m, [0.0; 3], [1.0, 0.2, 0.2]),
            cloud(seed + 1, n, [1.0 + 3.0 * stream.next(), 0.0, 0.1], [1.0, 0.3, 0.2]),
        ),
        "touching skins" => (skin(seed, m, 0.1 + stream.next()), skin(seed + 1, n, 1e-6)),
        "coinciding" => {
            let body = skin(seed, m, 0.5);
            (body.clone(), body)
        }
        "threads" => (strand(seed, m, 0.2 * stream.next()), strand(seed + 1, n, 0.2 * stream.next())),
        "planes" => (
            cloud(seed, m, [0.0; 3], [1.0, 0.5, 0.0]),
            cloud(seed + 1, n, [0.1, 0.0, 0.3 * stream.next()], [1.0, 0.5, 0.0]),
        ),
        "heaps" => {
            let (body, target) = (heaps(stream, m), heaps(stream, n));
            (weighted(body, stream, 2.0), weighted(target, stream, 2.0))
        }
        "sizes" => {
            let small = moved(&skin(seed, m, 0.6), 10f64.powf(-3.0 * stream.next()), [0.5, 0.2 * stream.next(), 0.3]);
            (small, skin(seed + 1, n, 0.2))
        }
        _ => {
            let mut point = |_| stream.point([0.0; 3], [1.0, 0.2, 0.2]);
            let (body, target) = ((0..m).map(&mut point).collect(), (0..n).map(&mut point).collect());
            (weighted(body, stream, 30.0), weighted(target, stream, 30.0))
        }
    }
}

fn phi(stream: &mut Stream) -> Phi {
    let length = 0.05 * 20f64.powf(stream.next());
    match (3.0 * stream.next()) as usize {
        0 => Phi::Exponential { length },
        1 => Phi::Inverse { eps: length },
        _ => Phi::SmoothInverse { eps: length },
    }
}

/// log A and log B by adding up all pairs, in order.
fn plain(body: &Cloud, target: &Cloud, phi: Phi, alpha: f64) -> [Vec<f64>; 2] {
    let sums = |from: &Cloud, to: &Cloud| -> Vec<f64> {
        let at = |&y: &[f64; 3]| {
            let logs: Vec<f64> = to.points().iter().map(|&x| alpha * phi.log(distance(x, y))).collect();
            let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let sum: f64 = logs.iter().zip(to.weights()).map(|(log, w)| w * (log - top).exp()).sum();
            top + (sum / to.measure()).ln()
        };
        from.points().iter().map(at).collect()
    };
    [sums(target, body), sums(body, target)]
}

#[test]
fn sums_and_derivatives_within_the_bound() {
    let mut stream = Stream::new(2024);
    let mut worst = [(0.0, String::new()), (0.0, String::new()), (0.0, String::new())];
    let mut truncated = 0;
    for round in 0..8 * 12 {
        let kind = KINDS[round % 8];
        let (body, target) = bodies(kind, &mut stream);
        let (phi, alpha) = (phi(&mut stream), 1000f64.powf(stream.next()));
        let tolerance = 10f64.powf(-2.0 - 8.0 * stream.next());
        let (_, exact, vjp_exact) = run(&body, &target, phi, alpha, Summation::Direct);
        let (pairs, sums, vjp) = run(&body, &target, phi, alpha, Summation::Truncated { tolerance });
        let counts = pairs.counts();
        truncated += usize::from(counts.summed < 0.9 * counts.all);
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let logs = apart(&sums.target, &exact.target).max(apart(&sums.body, &exact.body));
        // The seeds are at most one; what they are bounded by is stated on `Summation`.
        let seeds = (body.len() + target.len()) as f64;
        let slope = alpha * phi.log_derivative(phi.length()).abs().max(phi.log_derivative(0.0).abs());
        let points = (0..3).map(|d| {
            let off = |(a, b): (&[f64; 3], &[f64; 3])| (a[d] - b[d]).abs();
            vjp.points.iter().zip(&vjp_exact.points).map(off).sum::<f64>()
        });
        let points = points.fold(0.0, f64::max) / (seeds * slope);
        let off = |((a, b), w): ((&f64, &f64), &f64)| (a - b).abs() * w;
        let weights: f64 = vjp.weights.iter().zip(&vjp_exact.weights).zip(body.weights()).map(off).sum();
        for (worst, error) in worst.iter_mut().zip([logs, points, weights / target.len() as f64]) {
            let ratio = error / tolerance;
            if ratio > worst.0 {
                *worst = (ratio, format!("{kind}, {phi:?}, alpha {alpha:.1}, {tolerance:.1e}, {:?}", counts));
            }
            assert!(ratio < 1.0, "{kind}, {phi:?}, alpha {alpha}, {tolerance:.1e}: error / bound {ratio:.3}");
        }
        if round % 8 == round / 8 {
            let [by_target, by_body] = plain(&body, &target, phi, alpha);
            let rounding = 3e-15 * alpha * phi.log(5.0).abs().max(phi.log(0.0).abs()) + 1e-14;
            assert!(apart(&exact.target, &by_target).max(apart(&exact.body, &by_body)) < rounding, "{kind} {phi:?}");
        }
    }
    eprintln!("{truncated} truncated, largest error / bound of logs, points, weights: {worst:#?}");
    assert!(truncated > 25, "only {truncated} of the sums were truncated");
}

#[test]
fn weights_beyond_the_range_of_one_leaf() {
    // Next to the target points of next to no weight, farther off the bulk: the sums lie far below what they reach.
    let mut stream = Stream::new(5);
    let points: Vec<[f64; 3]> = (0..256).map(|k| stream.point([(k / 128) as f64, 0.0, 0.0], [0.3; 3])).collect();
    let weights = (0..256).map(|k| if k < 128 { 1e-200 } else { 1.0 }).collect();
    let (body, target) = (Cloud::new(points, weights).unwrap(), cloud(8, 100, [0.0; 3], [0.3; 3]));
    for alpha in [1.0, 60.0, 600.0] {
        let phi = Phi::Exponential { length: 1.0 };
        let (_, sums, vjp) = run(&body, &target, phi, alpha, Summation::Truncated { tolerance: 1e-9 });
        let [by_target, by_body] = plain(&body, &target, phi, alpha);
        for (found, exact) in sums.target.iter().zip(&by_target).chain(sums.body.iter().zip(&by_body)) {
            assert!((found - exact).abs() < 1e-9, "{alpha}: {found} against {exact}");
        }
        assert!(vjp.points.iter().flatten().all(|x| x.is_finite()));
    }
}
