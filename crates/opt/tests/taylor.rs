//! The Taylor test distinguishes right from wrong, and knows when it cannot decide.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

use crate::common;

use std::sync::Arc;

use common::{Cost, rosenbrock};
use nastic_opt::{
    Ball, Base, Bounds, Certificate, Euclidean, Failed, Lbfgs, Objective, Product, Request, Run, Sphere, Taylor,
    TaylorError, Verdict,
};

fn smooth(guard: impl nastic_opt::Admissible + 'static, error: f64, offset: f64) -> Cost {
    let value =
        move |m: &[f64]| offset + m.iter().enumerate().map(|(i, m)| (m * (1.0 + 0.1 * i as f64)).sin()).sum::<f64>();
    let derivative = move |m: &[f64]| {
        let slope = |(i, m): (usize, &f64)| (1.0 + 0.1 * i as f64) * (m * (1.0 + 0.1 * i as f64)).cos() * (1.0 + error);
        m.iter().enumerate().map(slope).collect()
    };
    Cost::new(guard, value, derivative)
}

#[test]
fn right_derivatives_pass() {
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    for seed in 0..20 {
        let test = Taylor { seed, ..Taylor::default() };
        for offset in [0.0, 1.0, 1e3] {
            let report = test.test(&smooth(Bounds::none(), 0.0, offset), &Bounds::none(), &m).unwrap();
            assert!(report.passed(), "{report}");
            for d in &report.directions {
                assert!(d.order1 > 1.95 && d.order1 < 2.2, "{report}");
                assert!((d.observed - d.slope).abs() < 1e-4 * d.slope.abs().max(0.1), "{report}");
            }
        }
    }
}

#[test]
fn wrong_derivatives_do_not() {
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    for seed in 0..20 {
        for error in [1.0, -2.0, 1e-2, 1e-4] {
            let test = Taylor { seed, ..Taylor::default() };
            let report = test.test(&smooth(Bounds::none(), error, 1.0), &Bounds::none(), &m).unwrap();
            assert_eq!(report.verdict(), Verdict::Wrong, "error {error}: {report}");
            assert!(!report.passed());
        }
    }
}

#[test]
fn noise_is_not_judged() {
    // j rounded to 1e-6: most remainders are noise; what is left must neither pass nor fail by accident.
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    for seed in 0..20 {
        for quantum in [1e-10, 1e-8, 1e-6, 1e-3] {
            let exact = smooth(Bounds::none(), 0.0, 1.0);
            let value = move |m: &[f64]| ((exact.value)(m) / quantum).round() * quantum;
            let right = smooth(Bounds::none(), 0.0, 1.0).derivative;
            let report = Taylor { seed, ..Taylor::default() }
                .test(&Cost::new(Bounds::none(), value, right), &Bounds::none(), &m)
                .unwrap();
            for d in &report.directions {
                assert_ne!(d.verdict, Verdict::Wrong, "quantum {quantum}: {d}");
            }
        }
    }
}

/// A solver that returns its warm start when little has changed: j does not answer small steps at all.
#[test]
fn a_cost_deaf_to_small_steps_is_not_called_wrong() {
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    for seed in 0..20 {
        for deaf in [1e-8, 1e-6, 1e-4] {
            let (base, exact) = (m.clone(), smooth(Bounds::none(), 0.0, 1.0));
            let value = move |m: &[f64]| (exact.value)(if common::distance(m, &base) < deaf { &base } else { m });
            let right = smooth(Bounds::none(), 0.0, 1.0).derivative;
            let cost = Cost::new(Bounds::none(), value, right);
            let report = Taylor { seed, ..Taylor::default() }.test(&cost, &Bounds::none(), &m).unwrap();
            assert!(deaf > 1e-5 || report.passed(), "{report}");
            assert_ne!(report.verdict(), Verdict::Wrong, "{report}");
        }
    }
}

/// Beyond a short way the cost is linear, as where a contact begins, and on that way its remainders are noise: no error of the derivative shows there.
#[test]
fn what_begins_on_the_way_is_no_error_of_the_derivative() {
    let noise = |m: f64| 2e-6 * ((m.to_bits().wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64);
    let value = move |m: &[f64]| 1.0 + m[0].hypot(1e-3) + noise(m[0]);
    let set = Bounds::new(-1.0, 1.0).unwrap();
    for seed in 0..20 {
        let cost = Cost::new(Bounds::new(-1.0, 1.0).unwrap(), value, |_| vec![0.0]);
        let report = Taylor { seed, ..Taylor::default() }.test(&cost, &set, &[0.0]).unwrap();
        assert_ne!(report.verdict(), Verdict::Wrong, "{report}");
    }
}

#[test]
fn linear_and_constant_costs() {
    let linear = Cost::new(Bounds::none(), |m| 3.0 * m[0] - m[1], |_| vec![3.0, -1.0]);
    let report = Taylor::default().test(&linear, &Bounds::none(), &[1.0, 2.0]).unwrap();
    assert_eq!(report.verdict(), Verdict::Linear);
    assert!(report.passed());
    let wrong = Cost::new(Bounds::none(), |m| 3.0 * m[0] - m[1], |_| vec![3.0, 1.0]);
    assert_eq!(Taylor::default().test(&wrong, &Bounds::none(), &[1.0, 2.0]).unwrap().verdict(), Verdict::Wrong);
    let constant = Cost::new(Bounds::none(), |_| 5.0, |_| vec![0.0, 0.0]);
    let report = Taylor::default().test(&constant, &Bounds::none(), &[1.0, 2.0]).unwrap();
    assert_eq!(report.verdict(), Verdict::Undecided);
    assert!(!report.passed() && report.to_string().contains("round-off"));
}

#[test]
fn at_a_bound_it_goes_inward() {
    // The guard panics outside; every component is at a bound, one is fixed.
    let set = Bounds::new(vec![0.3, 0.0, -1.0, 0.7], vec![0.5, 0.4, 1.0, 0.7]).unwrap();
    let m = [0.3, 0.4, 0.2, 0.7];
    for seed in 0..20 {
        let report = Taylor { seed, ..Taylor::default() }.test(&smooth(set.clone(), 0.0, 0.0), &set, &m).unwrap();
        assert!(report.passed(), "{report}");
        let d = &report.directions[0].direction;
        assert!(d[0] > 0.0 && d[1] < 0.0 && d[2] != 0.0 && d[3] == 0.0, "{d:?}");
    }
}

#[test]
fn along_spheres_and_in_balls() {
    let product = || Product::new().block(6, Sphere::new(3, 0.1).unwrap()).block(3, Ball::new(3, 0.02).unwrap());
    let m = [0.06, 0.08, 0.0, 0.0, 0.0, -0.1, 0.0, 0.012, 0.016];
    for seed in 0..20 {
        let test = Taylor { seed, ..Taylor::default() };
        let right = |m: &[f64]| m.iter().map(|m| (30.0 * m).sin() + 1e3 * m * m).sum::<f64>();
        let slope = |m: &[f64]| m.iter().map(|m| 30.0 * (30.0 * m).cos() + 2e3 * m).collect();
        let report = test.test(&Cost::new(product(), right, slope), &product(), &m).unwrap();
        assert!(report.passed(), "{report}");
        let wrong = |m: &[f64]| m.iter().map(|m| 31.0 * (30.0 * m).cos() + 2e3 * m).collect();
        let report = test.test(&Cost::new(product(), right, wrong), &product(), &m).unwrap();
        assert_eq!(report.verdict(), Verdict::Wrong, "{report}");
        let block = Taylor { components: Some(6..9), ..test };
        let report = block.test(&Cost::new(product(), right, slope), &product(), &m).unwrap();
        assert!(report.passed() && report.directions[0].direction[..6].iter().all(|d| *d == 0.0), "{report}");
    }
}

#[test]
fn long_steps_may_fail() {
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    let base = m.clone();
    let far = move |x: &[f64]| x.iter().zip(&base).any(|(x, b)| (x - b).abs() > 1e-3);
    let report = Taylor::default().test(&smooth(Bounds::none(), 0.0, 0.0).failing(far), &Bounds::none(), &m).unwrap();
    assert!(report.passed(), "{report}");
    assert!(report.directions[0].rows[0].cost.is_none());
    assert!(report.to_string().contains("failed"));
}

#[test]
fn units_do_not_matter() {
    let passes = |unit: f64, value_unit: f64| {
        let set = Bounds::new(-2.0 * unit, 2.0 * unit).unwrap();
        let cost = Cost::new(
            set.clone(),
            move |m| value_unit * m.iter().map(|m| (m / unit).exp()).sum::<f64>(),
            move |m| m.iter().map(|m| value_unit * (m / unit).exp() / unit).collect(),
        );
        Taylor::default().test(&cost, &set, &[0.0; 5]).unwrap()
    };
    for (unit, value_unit) in [(1.0, 1.0), (1e5, 1e-3), (1e-9, 1e12)] {
        let report = passes(unit, value_unit);
        assert!(report.passed(), "{report}");
    }
}

#[test]
fn what_cannot_be_tested_is_said() {
    let set = Bounds::new(0.0, 1.0).unwrap();
    let outside = Taylor::default().test(&rosenbrock(set.clone()), &set, &[2.0, 0.0]).unwrap_err();
    assert!(matches!(outside, TaylorError::Outside(_)));
    let nowhere = Taylor::default().test(&rosenbrock(Bounds::none()), &Bounds::none(), &[0.0, 0.0]).unwrap_err();
    assert!(nowhere.to_string().contains("give a size"));
    let sized = Taylor { size: Some(1.0), ..Taylor::default() };
    assert!(sized.test(&rosenbrock(Bounds::none()), &Bounds::none(), &[0.0, 0.0]).unwrap().passed());
    let beyond = Taylor { components: Some(1..3), ..Taylor::default() };
    assert!(matches!(beyond.test(&rosenbrock(set.clone()), &set, &[0.5, 0.5]), Err(TaylorError::Components { .. })));
    let failing = rosenbrock(set.clone()).failing(|_| true);
    assert!(matches!(Taylor::default().test(&failing, &set, &[0.5, 0.5]), Err(TaylorError::Base(_))));
}

/// The short check vouches for a right derivative after few evaluations, leaves a wrong one to the full test, and is a
/// method of every run.
#[test]
fn certificates_of_runs_and_of_points() {
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    let (set, metric) = (Bounds::new(-2.0, 2.0).unwrap(), Euclidean::new(7));
    let optimizer = Lbfgs::default();
    for seed in 0..20 {
        let cost = smooth(set.clone(), 0.0, 1.0);
        let mut run = Run::start(&optimizer, &cost, Arc::new(set.clone()), Arc::new(metric.clone()), &m[..]).unwrap();
        let certificate = run.certify(None, seed).unwrap();
        assert_eq!(certificate.verdict, Verdict::Right, "{certificate}");
        assert!(certificate.trials <= 4 && certificate.full.is_none() && certificate.mismatch < 1e-3);
        run.step(&mut ());
        assert_ne!(run.certify(None, seed).unwrap().verdict, Verdict::Wrong);
        let cost = smooth(set.clone(), 0.02, 1.0);
        let derivative = (cost.derivative)(&m);
        let base = Base { m: &m, point: &m, derivative: &derivative, stage: 0 };
        let certificate = Certificate::of(&cost, &set, &base, &mut (), None, seed).unwrap();
        assert_eq!(certificate.verdict, Verdict::Wrong, "{certificate}");
        assert!(certificate.full.is_some());
    }
    let cost = smooth(Bounds::none(), 0.0, 1.0);
    let base = Base { m: &[0.0], point: &vec![0.0], derivative: &[1.0], stage: 0 };
    assert_eq!(Certificate::of(&cost, &Bounds::none(), &base, &mut (), None, 1), Err(TaylorError::NoDirection));
}

/// A smooth cost with rounding noise of some size, whose derivative may be wrong by a factor.
struct Noisy {
    /// Of the three terms: curvature and third derivative against the slope.
    shape: [f64; 3],
    noise: f64,
    error: f64,
}

impl Objective for Noisy {
    type Point = Vec<f64>;
    type Workspace = ();

    fn evaluate(&self, m: &[f64], _: &Request<'_, Vec<f64>>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        Ok(m.to_vec())
    }

    fn value(&self, m: &Vec<f64>) -> f64 {
        let [slope, curvature, third] = self.shape;
        let smooth = m.iter().map(|m| slope * m + curvature * m * m + third * m.powi(3)).sum::<f64>();
        // Rounding as an iterative solver leaves it: anything between -noise and noise, the same for the same control.
        let bits = m.iter().fold(0x9e37_79b9_7f4a_7c15_u64, |hash, m| {
            (hash ^ m.to_bits()).wrapping_mul(0x2545_f491_4f6c_dd1d).rotate_left(31)
        });
        1.0 + smooth + self.noise * ((bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0)
    }

    fn derivative(&self, m: &mut Vec<f64>, (): &mut ()) -> Result<Vec<f64>, Failed> {
        let [slope, curvature, third] = self.shape;
        Ok(m.iter().map(|m| (1.0 + self.error) * (slope + 2.0 * curvature * m + 3.0 * third * m * m)).collect())
    }

    fn restage(&self, _: usize, m: &Vec<f64>) -> Result<Vec<f64>, Failed> {
        Ok(m.clone())
    }
}

/// The verdict on a right derivative is never "wrong", on one that is off by a thousandth never "right".
#[test]
fn verdicts_on_many_noisy_costs() {
    let mut random = nastic_numeric::Random::new(11);
    let set = Bounds::new(-2.0, 2.0).unwrap();
    let (mut alarms, mut missed, mut undecided) = (0, 0, 0);
    for case in 0..2000 {
        let power = |random: &mut nastic_numeric::Random, low: f64, high: f64| {
            10f64.powf(low + (high - low) * 0.5 * (1.0 + random.symmetric()))
        };
        let shape = [power(&mut random, -3.0, 0.0), power(&mut random, -4.0, 1.0), power(&mut random, -5.0, 1.0)];
        let noise = power(&mut random, -16.0, -9.0);
        let taylor = Taylor { directions: 1, seed: case, ..Taylor::default() };
        let m = [0.3 * random.symmetric(), 0.5, -0.7];
        let verdict = |error: f64| taylor.test(&Noisy { shape, noise, error }, &set, &m).unwrap().verdict();
        match verdict(0.0) {
            Verdict::Wrong => alarms += 1,
            Verdict::Undecided => undecided += 1,
            _ => {}
        }
        missed += usize::from(verdict(1e-2) == Verdict::Right);
    }
    assert_eq!((alarms, missed), (0, 0), "false alarms, errors missed; {undecided} undecided");
    assert!(undecided < 200, "{undecided} undecided");
}
