//! Laws, the rules made of them, and random materials.

use nastic_energy::MaterialPoint;
use nastic_numeric::Random;
use nastic_uncertainty::{
    Beta, CATALOGUE, Gamma, Inadmissible, Law, Normal, Sample, StochasticError, StochasticMooneyRivlin, gauss_rule,
};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Laws of every kind, in and out of the range where densities are bounded.
fn laws() -> Outcome<Vec<Box<dyn Law>>> {
    let mut all: Vec<Box<dyn Law>> = Vec::new();
    for row in CATALOGUE {
        let law = (row.from_mean_variance)(row.example.0, row.example.1)?;
        assert_eq!(law.name(), row.name);
        assert!((law.mean() - row.example.0).abs() <= 1e-14 * row.example.0.abs());
        assert!((law.variance() / row.example.1 - 1.0).abs() < 1e-13);
        all.push(law);
    }
    for (shape, scale) in [(0.4, 2.0), (1.0, 1.0), (3.7, 1e-6), (400.0, 0.5)] {
        all.push(Box::new(Gamma::new(shape, scale)?));
    }
    for (alpha, beta) in [(0.5, 0.5), (1.0, 1.0), (0.3, 2.5), (12.0, 4.0), (0.5, 1.5), (1.2, 0.8)] {
        all.push(Box::new(Beta::new(alpha, beta)?));
    }
    all.push(Box::new(Normal::from_mean_variance(-3.0, 4.0)?));
    Ok(all)
}

fn gamma_moment(shape: f64, scale: f64, k: usize) -> f64 {
    (0..k).map(|i| scale * (shape + i as f64)).product()
}

fn beta_moment(alpha: f64, beta: f64, k: usize) -> f64 {
    (0..k).map(|i| (alpha + i as f64) / (alpha + beta + i as f64)).product()
}

fn assert_moments(law: &dyn Law, exact: impl Fn(usize) -> f64) -> Outcome {
    for n in 1..=10 {
        let (nodes, weights) = gauss_rule(law, n)?;
        assert!(weights.iter().all(|w| *w > 0.0));
        assert!(nodes.windows(2).all(|pair| pair[0] < pair[1]));
        for k in 0..2 * n {
            let moment: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * x.powi(k as i32)).sum();
            assert!((moment / exact(k) - 1.0).abs() < 1e-12, "{law:?}, {n} nodes, moment {k}: {moment:e}");
        }
        // One degree further the rule must be wrong, and too small.
        let moment: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * x.powi(2 * n as i32)).sum();
        assert!(moment < exact(2 * n), "{law:?}, {n} nodes");
    }
    Ok(())
}

#[test]
fn gauss_rules_reproduce_the_moments_of_gamma_laws() -> Outcome {
    for (shape, scale) in [(0.5, 1.0), (1.0, 2.0), (4.0, 2.5e4), (11.1, 1e-3), (100.0, 1e3)] {
        assert_moments(&Gamma::new(shape, scale)?, |k| gamma_moment(shape, scale, k))?;
    }
    Ok(())
}

#[test]
fn gauss_rules_reproduce_the_moments_of_beta_laws() -> Outcome {
    for (alpha, beta) in [(0.5, 0.5), (1.0, 1.0), (2.0, 5.0), (0.5, 1.5), (7.0, 3.0)] {
        assert_moments(&Beta::new(alpha, beta)?, |k| beta_moment(alpha, beta, k))?;
    }
    Ok(())
}

#[test]
fn gauss_rules_of_the_normal_law() -> Outcome {
    for n in 1..=8 {
        let (nodes, weights) = gauss_rule(&Normal::STANDARD, n)?;
        for k in 0..2 * n {
            let exact: f64 = if k % 2 == 1 { 0.0 } else { (1..k).step_by(2).map(|i| i as f64).product() };
            let moment: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * x.powi(k as i32)).sum();
            assert!((moment - exact).abs() < 1e-11 * exact.max(1.0), "{n} nodes, moment {k}: {moment:e}");
        }
    }
    Ok(())
}

/// The contract of a law: quantile inverts cumulative, whose integral gives mean and variance, which samples have too.
#[test]
fn recurrence_quantiles_and_samples_belong_to_one_law() -> Outcome {
    for law in laws()? {
        for p in [1e-6, 0.01, 0.2, 0.5, 0.77, 0.99, 1.0 - 1e-6] {
            let back = law.cumulative(law.quantile(p));
            assert!((back / p - 1.0).abs() < 1e-9, "{law:?}: {p} comes back as {back}");
        }
        assert!(law.quantile(0.3) < law.quantile(0.3001));
        // Mean and variance by the midpoint rule over probabilities.
        let n = 4000;
        let x: Vec<f64> = (0..n).map(|i| law.quantile((i as f64 + 0.5) / n as f64)).collect();
        let mean = x.iter().sum::<f64>() / n as f64;
        let variance = x.iter().map(|x| (x - law.mean()).powi(2)).sum::<f64>() / n as f64;
        let deviation = law.variance().sqrt();
        assert!((mean - law.mean()).abs() < 2e-3 * deviation, "{law:?}: mean {mean:e}");
        assert!((variance / law.variance() - 1.0).abs() < 1e-2, "{law:?}: variance {variance:e}");
        // Kolmogorov's distance of a sample; 1.95/sqrt(n) is exceeded with probability 0.001.
        let mut random = Random::new(7);
        let mut drawn: Vec<f64> = (0..n).map(|_| law.draw(&mut random)).collect();
        drawn.sort_by(f64::total_cmp);
        let gap = |(i, x): (usize, &f64)| (law.cumulative(*x) - (i as f64 + 0.5) / n as f64).abs();
        let distance = drawn.iter().enumerate().map(gap).fold(0.0, f64::max);
        assert!(distance < 1.95 / (n as f64).sqrt(), "{law:?}: Kolmogorov distance {distance}");
        let (nodes, weights) = gauss_rule(law.as_ref(), 2)?;
        let second: f64 = nodes.iter().zip(&weights).map(|(x, w)| w * (x - law.mean()).powi(2)).sum();
        assert!((second / law.variance() - 1.0).abs() < 1e-12, "{law:?}");
    }
    Ok(())
}

/// Tabulated values (NIST DLMF; R's pgamma, pbeta, qnorm).
#[test]
fn special_values() -> Outcome {
    let normal = Normal::STANDARD;
    assert!((normal.quantile(0.975) - 1.959963984540054).abs() < 1e-12);
    assert!((normal.cumulative(-6.0) / 9.865876450377e-10 - 1.0).abs() < 1e-11);
    let exponential = Gamma::new(1.0, 2.0)?;
    assert!((exponential.cumulative(3.0) - (1.0 - (-1.5f64).exp())).abs() < 1e-14);
    assert!((Gamma::new(2.0, 1.0)?.cumulative(1.0) - (1.0 - 2.0 * (-1.0f64).exp())).abs() < 1e-14);
    // I_x(2, 3) = 6x^2 - 8x^3 + 3x^4; the arcsine law.
    let x: f64 = 0.37;
    assert!((Beta::new(2.0, 3.0)?.cumulative(x) - (6.0 * x * x - 8.0 * x.powi(3) + 3.0 * x.powi(4))).abs() < 1e-14);
    let arcsine = Beta::new(0.5, 0.5)?;
    assert!((arcsine.quantile(0.2) - (0.1 * std::f64::consts::PI).sin().powi(2)).abs() < 1e-13);
    Ok(())
}

fn material() -> Outcome<StochasticMooneyRivlin> {
    Ok(StochasticMooneyRivlin {
        shear: Gamma::from_mean_variation(1e5, 0.15)?,
        bulk: Gamma::from_mean_variation(6e5, 0.1)?,
        share: Beta::from_mean_variance(0.7, 0.01)?,
    })
}

#[test]
fn rules_agree_on_what_they_are_exact_for() -> Outcome {
    let model = material()?;
    let laws = model.laws();
    let tensor = Sample::tensor(&laws, &[4, 4, 3])?;
    assert_eq!(tensor.len(), 48);
    let sparse = Sample::sparse(&laws, 3)?;
    assert!(sparse.weights.iter().any(|w| *w < 0.0));
    // Total degree 6 at most.
    let f = |x: &[f64]| {
        let y = [x[0] / 1e5, x[1] / 6e5, x[2]];
        1.0 + y[0].powi(3) * y[1] * y[2].powi(2) + 2.0 * y[0] * y[1] * y[2] - y[1].powi(4)
    };
    for sample in [&tensor, &sparse] {
        assert!((sample.weights.iter().sum::<f64>() - 1.0).abs() < 1e-13);
    }
    let (a, b) = (tensor.expectation(f), sparse.expectation(f));
    assert!((a / b - 1.0).abs() < 1e-11, "{a} and {b}");
    let many = Sample::quasi_monte_carlo(&laws, 4096, 3)?.expectation(f);
    assert!((many / a - 1.0).abs() < 2e-3, "{many} and {a}");
    let random = Sample::monte_carlo(&laws, 4096, 3)?.expectation(f);
    assert!((random / a - 1.0).abs() < 5e-2, "{random} and {a}");
    Ok(())
}

/// A sparse rule of level q is exact to total degree 2q + 1, not for tensor products beyond, and grows slowly.
#[test]
fn sparse_rules_are_exact_to_their_degree() -> Outcome {
    let uniform = Beta::new(1.0, 1.0)?;
    let laws: [&dyn Law; 4] = [&uniform; 4];
    for level in 0..=3usize {
        let rule = Sample::sparse(&laws, level)?;
        let degree = 2 * level + 1;
        for a in 0..=degree {
            for b in 0..=degree - a {
                let c = degree - a - b;
                let value = rule.expectation(|x| x[0].powi(a as i32) * x[3].powi(b as i32) * x[1].powi(c as i32));
                let exact = 1.0 / ((a + 1) * (b + 1) * (c + 1)) as f64;
                assert!((value - exact).abs() < 1e-13, "level {level}: {a} {b} {c}");
            }
        }
    }
    assert_eq!(Sample::sparse(&laws, 1)?.len(), 9);
    let nodes = Sample::sparse(&laws, 2)?.len();
    assert!(nodes < 81, "{nodes}");
    Ok(())
}

#[test]
fn samples_are_functions_of_their_seed() -> Outcome {
    let model = material()?;
    let laws = model.laws();
    for rule in [Sample::monte_carlo, Sample::quasi_monte_carlo] {
        let sample = rule(&laws, 20, 5)?;
        assert_eq!(sample, rule(&laws, 20, 5)?);
        assert_ne!(sample.nodes, rule(&laws, 20, 6)?.nodes);
        // A longer sample begins with the shorter one.
        assert_eq!(rule(&laws, 30, 5)?.nodes[..20], sample.nodes[..]);
    }
    assert!(Sample::monte_carlo(&laws, 0, 1).is_err());
    assert!(Sample::tensor(&laws, &[3, 3]).is_err());
    assert!(Sample::tensor(&laws, &[3, 0, 3]).is_err());
    assert!(Sample::sparse(&[], 1).is_err());
    Ok(())
}

/// E[mu1 + mu2] = E[mu]/2, and the materials are those of the engineering constructor.
#[test]
fn materials_keep_half_the_shear_modulus() -> Outcome {
    let model = material()?;
    for rule in [Sample::tensor(&model.laws(), &[3, 3, 2])?, Sample::sparse(&model.laws(), 2)?] {
        let set = model.scenarios(&rule, Inadmissible::Refuse)?;
        assert_eq!((set.scenarios.len(), set.lost), (rule.len(), 0.0));
        let mean: f64 = set
            .scenarios
            .iter()
            .map(|s| {
                let moduli = nastic_energy::ConvexDensity::small_strain(&s.law, MaterialPoint { cell: 0, point: 0 });
                // Small strain: mu = 2 (mu1 + mu2).
                s.probability * 0.5 * moduli.map_or(f64::NAN, |m| m.mu_t)
            })
            .sum();
        assert!((mean / 0.5e5 - 1.0).abs() < 1e-13, "{mean:e}");
    }
    Ok(())
}

/// nu near 0.33 leaves part of the laws without mu3 > 0.
#[test]
fn inadmissible_nodes_are_named_or_truncated() -> Outcome {
    let soft = StochasticMooneyRivlin { bulk: Gamma::from_mean_variation(2.2e5, 0.3)?, ..material()? };
    let rule = Sample::tensor(&soft.laws(), &[3, 3, 2])?;
    let bad: Vec<usize> = (0..rule.len())
        .filter(|i| {
            let x = &rule.nodes[*i];
            x[1] + x[0] * (2.0 * x[2] - 8.0 / 3.0) <= 0.0
        })
        .collect();
    assert!(!bad.is_empty() && bad.len() < rule.len());
    match soft.scenarios(&rule, Inadmissible::Refuse) {
        Err(error @ StochasticError::Inadmissible { node, .. }) => {
            assert_eq!(node, bad[0]);
            let text = error.to_string();
            assert!(text.contains(&format!("node {node} of 18")) && text.contains("truncate"), "{text}");
        }
        other => panic!("{other:?}"),
    }
    let set = soft.scenarios(&rule, Inadmissible::Truncate)?;
    assert_eq!(set.left_out, bad);
    let lost: f64 = bad.iter().map(|i| rule.weights[*i]).sum();
    assert!((set.lost - lost).abs() < 1e-15);
    assert!((set.scenarios.iter().map(|s| s.probability).sum::<f64>() - 1.0).abs() < 1e-14);
    for s in &set.scenarios {
        assert!((s.probability * (1.0 - lost) / rule.weights[s.node] - 1.0).abs() < 1e-13);
    }
    let hopeless = StochasticMooneyRivlin { bulk: Gamma::from_mean_variation(1e3, 0.3)?, ..material()? };
    let none = hopeless.scenarios(&rule_of(&hopeless)?, Inadmissible::Truncate);
    assert!(matches!(none, Err(StochasticError::NothingLeft { nodes: 18 })));
    Ok(())
}

fn rule_of(model: &StochasticMooneyRivlin) -> Outcome<Sample> {
    Ok(Sample::tensor(&model.laws(), &[3, 3, 2])?)
}

#[test]
fn laws_refuse_what_is_no_law() {
    assert!(Gamma::new(0.0, 1.0).is_err());
    assert!(Gamma::from_mean_variance(1.0, f64::NAN).is_err());
    assert!(Beta::from_mean_variance(0.5, 0.25).is_err());
    assert!(Beta::from_mean_variance(1.0, 0.1).is_err());
    assert!(Normal::from_mean_variance(0.0, 0.0).is_err());
    let text = Gamma::from_mean_variance(-2.0, 1.0).unwrap_err().to_string();
    assert!(text.contains("gamma") && text.contains("mean") && text.contains("-2"), "{text}");
}
