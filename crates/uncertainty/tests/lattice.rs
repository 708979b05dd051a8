//! The embedded lattice: its worst-case error, prefixes, integrals.

use nastic_uncertainty::{Beta, Law, MOST_LATTICE_NUMBERS, Normal, Sample};
use std::f64::consts::PI;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// The worst-case error in the weighted Korobov space of order 2 by its definition, over all pairs of points: no shift enters.
fn worst_case(sample: &Sample, dimensions: usize) -> f64 {
    let kernel = |x: f64| 2.0 * PI * PI * (x * x - x + 1.0 / 6.0);
    let n = sample.len() as f64;
    let pair = |x: &[f64], y: &[f64]| -> f64 {
        (0..dimensions).map(|k| 1.0 + kernel((x[k] - y[k]).rem_euclid(1.0)) / ((k + 1) as f64).powi(2)).product()
    };
    let sum: f64 = sample.nodes.iter().map(|x| sample.nodes.iter().map(|y| pair(x, y)).sum::<f64>()).sum();
    (sum / (n * n) - 1.0).sqrt()
}

/// Against values that `scripts/lattice.py`'s formula gives with other code; in one dimension `sqrt(pi^2/3)/N` is the least there is.
#[test]
fn the_worst_case_errors_are_those_of_the_construction() -> Outcome {
    let uniform = Beta::new(1.0, 1.0)?;
    let laws: [&dyn Law; 16] = [&uniform; 16];
    for (count, dimensions, expected) in [
        (16, 1, (PI * PI / 3.0).sqrt() / 16.0),
        (16, 16, 0.92539),
        (256, 1, (PI * PI / 3.0).sqrt() / 256.0),
        (256, 4, 0.0878108),
        (256, 16, 0.169359),
        (1024, 4, 0.0256118),
        (1024, 16, 0.0661694),
    ] {
        let found = worst_case(&Sample::lattice(&laws, count, 4)?, dimensions);
        assert!((found / expected - 1.0).abs() < 1e-4, "{count} points, {dimensions} numbers: {found}, not {expected}");
        let halton = worst_case(&Sample::quasi_monte_carlo(&laws, count, 4)?, dimensions);
        assert!(found < halton, "{count} points, {dimensions} numbers: {found}, Halton {halton}");
    }
    Ok(())
}

/// Far more numbers than points of any other rule: `E prod (1 + g_k/k^2)` is 1, `E exp(sum g_k/k^2)` is known, too.
#[test]
fn expectations_of_256_numbers() -> Outcome {
    let laws: [&dyn Law; MOST_LATTICE_NUMBERS] = [&Normal::STANDARD; MOST_LATTICE_NUMBERS];
    let share = |k: usize| 0.5 / ((k + 1) as f64).powi(2);
    let exact = (0..laws.len()).map(|k| 0.5 * share(k) * share(k)).sum::<f64>().exp();
    let f = |x: &[f64]| x.iter().enumerate().map(|(k, x)| share(k) * x).sum::<f64>().exp();
    let mut last = f64::INFINITY;
    for count in [64, 512, 4096] {
        let errors: Vec<f64> = (0..4)
            .map(|seed| Ok((Sample::lattice(&laws, count, seed)?.expectation(f) / exact - 1.0).abs()))
            .collect::<Result<_, nastic_uncertainty::StochasticError>>()?;
        let error = errors.iter().sum::<f64>() / 4.0;
        assert!(error < 0.5 * last, "{count} points: {errors:?}");
        last = error;
    }
    assert!(last < 1e-3, "{last}");
    Ok(())
}

/// A sample of twice as many points begins with it; it is a function of its seed.
#[test]
fn samples_grow_without_changing() -> Outcome {
    let laws: [&dyn Law; 3] = [&Normal::STANDARD; 3];
    let small = Sample::lattice(&laws, 64, 5)?;
    assert_eq!(Sample::lattice(&laws, 128, 5)?.nodes[..64], small.nodes[..]);
    assert_ne!(Sample::lattice(&laws, 64, 6)?.nodes, small.nodes);
    for (count, numbers, what) in
        [(100, 3, "128"), (0, 3, "power of two"), (1 << 17, 3, "65536"), (16, 257, "257 random numbers")]
    {
        let laws: Vec<&dyn Law> = vec![&Normal::STANDARD; numbers];
        let text = Sample::lattice(&laws, count, 0).unwrap_err().to_string();
        assert!(text.contains(what), "{text}");
    }
    Ok(())
}
