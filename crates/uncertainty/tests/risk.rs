//! The contract of every risk measure, and the values of each against closed forms.

use nastic_uncertainty::risk::{
    CATALOGUE, Cvar, Estimate, Mean, MeanDeviation, Risk, RiskError, WorstCase, by_name, conditional_value_at_risk,
    deviation,
};

const P: [f64; 8] = [0.05, 0.2, 0.1, 0.15, 0.08, 0.22, 0.12, 0.08];
const J: [f64; 8] = [3.1, 1.7, 2.2, 0.4, 5.3, 1.9, 2.25, 4.7];

fn measures() -> Vec<(Box<dyn Risk>, bool)> {
    let mut all: Vec<(Box<dyn Risk>, bool)> = CATALOGUE.iter().map(|row| ((row.make)(), row.monotone)).collect();
    all.push((Box::new(Cvar { level: 0.5, smoothing: 0.3 }), false));
    all.push((Box::new(Cvar { level: 0.97, smoothing: 0.01 }), false));
    all.push((Box::new(WorstCase { smoothing: 1.0 }), false));
    all.push((Box::new(MeanDeviation { lambda: 2.5 }), false));
    all
}

fn close(a: f64, b: f64, relative: f64, what: &str) {
    assert!((a - b).abs() <= relative * a.abs().max(b.abs()).max(1e-3), "{what}: {a:e} and {b:e}");
}

#[test]
fn weights_are_the_derivative_and_sum_to_one() {
    for (risk, _) in measures() {
        // Scaled and shifted costs: no parameter may have a unit.
        for (scale, shift) in [(1.0, 0.0), (1e-9, 0.0), (1e7, 3e8)] {
            let costs: Vec<f64> = J.iter().map(|j| j * scale + shift).collect();
            let weights = risk.weights(&P, &costs);
            close(weights.iter().sum(), 1.0, 1e-12, &format!("{risk:?}: sum of weights"));
            for i in 0..costs.len() {
                let at = |h: f64| {
                    let mut moved = costs.clone();
                    moved[i] += h * scale;
                    risk.value(&P, &moved)
                };
                let h = 1e-3;
                let slope = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h * scale);
                let size = weights[i].abs().max(0.05);
                assert!((slope - weights[i]).abs() < 3e-6 * size, "{risk:?} {i}: {slope:e} and {:e}", weights[i]);
            }
        }
    }
}

#[test]
fn changes_of_weights_are_their_derivative_and_symmetric() {
    let (a, b) = ([0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.6, -0.1], [-0.1, 0.4, 0.2, -0.3, 0.5, 0.1, -0.2, 0.3]);
    for (risk, _) in measures() {
        for (scale, shift) in [(1.0, 0.0), (1e-9, 0.0), (1e7, 1e7)] {
            let along = |d: &[f64; 8], t: f64| -> Vec<f64> {
                J.iter().zip(d).map(|(j, d)| (j + t * d) * scale + shift).collect()
            };
            let costs = along(&a, 0.0);
            let scaled = |d: &[f64; 8]| d.map(|d| d * scale);
            let change = risk.weights_change(&P, &costs, &scaled(&a)).unwrap();
            let at = |t: f64| risk.weights(&P, &along(&a, t));
            let h = 1e-3;
            let largest = change.iter().fold(1e-3, |most: f64, d| most.max(d.abs()));
            for i in 0..P.len() {
                let pair = |n: f64| at(n * h)[i] - at(-n * h)[i];
                let slope = (45.0 * pair(1.0) - 9.0 * pair(2.0) + pair(3.0)) / (60.0 * h);
                assert!((slope - change[i]).abs() < 1e-6 * largest, "{risk:?} {i}: {slope:e} and {:e}", change[i]);
            }
            assert!(change.iter().sum::<f64>().abs() < 1e-10 * largest, "{risk:?}: weights no longer sum to one");
            let other = risk.weights_change(&P, &costs, &scaled(&b)).unwrap();
            let pair = |x: &[f64], y: &[f64; 8]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
            assert!((pair(&change, &b) - pair(&other, &a)).abs() < 1e-11 * largest, "{risk:?}: not symmetric");
        }
        let flat = risk.weights_change(&P, &[2.5; 8], &a);
        match risk.name() {
            "mean" => assert_eq!(flat.unwrap(), [0.0; 8]),
            measure => assert_eq!(flat.unwrap_err(), RiskError::Kink { measure }),
        }
        assert_eq!(risk.weights_change(&[1.0], &[0.7], &[0.1]).unwrap(), [0.0], "one scenario has no kink: {risk:?}");
    }
}

#[test]
fn monotone_where_promised_and_never_far_from_it() {
    for (risk, monotone) in measures() {
        let lowest = risk.weights(&P, &J).into_iter().fold(f64::INFINITY, f64::min);
        let moved = (0..J.len()).map(|i| {
            let mut up = J;
            up[i] += 0.7;
            risk.value(&P, &up) - risk.value(&P, &J)
        });
        let lowest_step = moved.fold(f64::INFINITY, f64::min);
        if monotone {
            assert!(lowest >= 0.0 && lowest_step >= 0.0, "{risk:?}: {lowest:e}, {lowest_step:e}");
        }
        if risk.name() == "cvar" {
            assert!(lowest > -0.05, "{risk:?}: {lowest:e}");
        }
    }
}

#[test]
fn shifts_add_and_factors_multiply() {
    for (risk, _) in measures() {
        let base = risk.value(&P, &J);
        let shifted: Vec<f64> = J.iter().map(|j| j + 17.0).collect();
        close(risk.value(&P, &shifted), base + 17.0, 1e-13, "translation");
        let scaled: Vec<f64> = J.iter().map(|j| j * 1e-12).collect();
        assert!((risk.value(&P, &scaled) / (1e-12 * base) - 1.0).abs() < 1e-12, "{risk:?}");
        assert_eq!(risk.value(&P, &J).to_bits(), risk.value(&P, &J).to_bits());
    }
}

/// Equal costs have one risk, whatever the measure, and a derivative; so does a single scenario.
#[test]
fn equal_costs_have_no_risk() {
    for (risk, _) in measures() {
        close(risk.value(&P, &[2.5; 8]), 2.5, 1e-14, "equal costs");
        assert_eq!(risk.weights(&P, &[2.5; 8]), P.to_vec(), "{risk:?}");
        assert_eq!((risk.value(&[1.0], &[0.7]), risk.weights(&[1.0], &[0.7])), (0.7, vec![1.0]), "{risk:?}");
        assert_eq!(risk.value(&[1.0], &[0.0]), 0.0);
    }
}

#[test]
fn values_against_closed_forms() {
    let (p, j) = ([0.25, 0.75], [5.0, 1.0]);
    assert_eq!(Mean.value(&p, &j), 2.0);
    assert_eq!(deviation(&p, &j), 3f64.sqrt());
    assert_eq!(MeanDeviation { lambda: 2.0 }.value(&p, &j), 2.0 + 2.0 * 3f64.sqrt());
    // The worst half: all of the 5, and a quarter of the 1.
    assert_eq!(conditional_value_at_risk(&p, &j, 0.5), 3.0);
    assert_eq!(conditional_value_at_risk(&p, &j, 1.0), 5.0);
    close(conditional_value_at_risk(&p, &j, 0.0), 2.0, 1e-15, "CVaR at level 0 is the mean");
    // A width of 2 is 2/sqrt(3) deviations.
    let soft = WorstCase { smoothing: 2.0 / 3f64.sqrt() }.value(&p, &j);
    close(soft, 2.0 * (0.25 * 2.5f64.exp() + 0.75 * 0.5f64.exp()).ln(), 1e-14, "log-sum-exp");
}

/// Smoothed values close in on the exact ones from the stated side, within the stated distance.
#[test]
fn smoothing_vanishes_at_the_stated_rate() {
    let spread = deviation(&P, &J);
    for share in [0.3, 0.1, 0.03, 0.01] {
        for level in [0.3, 0.5, 0.9, 0.95] {
            let smooth = Cvar { level, smoothing: share }.value(&P, &J);
            let over = smooth - conditional_value_at_risk(&P, &J, level);
            assert!(over >= -1e-12 && over <= share * spread * 2f64.ln() / (1.0 - level), "{share} {level}: {over:e}");
        }
        let under = 5.3 - WorstCase { smoothing: share }.value(&P, &J);
        assert!(under >= 0.0 && under <= share * spread * (1.0 / 0.08f64).ln() * 1.0001, "{share}: {under:e}");
    }
}

#[test]
fn bad_parameters_and_probabilities_are_refused() {
    let negative = [0.7, -0.2, 0.5];
    assert!(Mean.check(&negative).is_ok());
    for (risk, _) in measures().iter().filter(|(risk, _)| risk.name() != "mean") {
        assert!(matches!(risk.check(&negative), Err(RiskError::Negative { scenario: 1, .. })), "{risk:?}");
        assert!(matches!(risk.check(&[0.4, 0.4]), Err(RiskError::Sum { .. })));
        assert!(matches!(risk.check(&[0.4, f64::NAN]), Err(RiskError::Sum { .. })));
        assert!(risk.check(&P).is_ok());
    }
    assert!(Cvar { level: 1.0, ..Cvar::default() }.check(&P).is_err());
    assert!(WorstCase { smoothing: 0.0 }.check(&P).is_err());
    assert!(MeanDeviation { lambda: -1.0 }.check(&P).is_err());
    let unknown = by_name("cvr").unwrap_err().to_string();
    assert!(unknown.contains("cvr") && unknown.contains("worst_case"), "{unknown}");
}

/// By hand, and against samples of a known law: the error is that of the means of many samples.
#[test]
fn estimates_know_their_sampling_error() {
    let four = Estimate::of(&[1.0, 2.0, 4.0, 5.0]).unwrap_or(Estimate { mean: f64::NAN, error: f64::NAN });
    close(four.mean, 3.0, 1e-15, "mean");
    close(four.error, (10.0f64 / 12.0).sqrt(), 1e-15, "error");
    let mut random = nastic_numeric::Random::new(3);
    let (samples, n) = (2000, 25);
    let (mut within, mut square, mut claimed) = (0, 0.0, 0.0);
    for _ in 0..samples {
        let a: Vec<f64> = (0..n).map(|_| random.unit()).collect();
        // b follows a up to a little: in pairs, the difference of the means is known far better than either.
        let b: Vec<f64> = a.iter().map(|x| x - 0.1 + 0.02 * random.symmetric()).collect();
        let alone = Estimate::of(&a).unwrap_or(four);
        within += usize::from((alone.mean - 0.5).abs() < 2.0 * alone.error);
        square += (alone.mean - 0.5).powi(2) / samples as f64;
        claimed += alone.error.powi(2) / samples as f64;
        let pair = Estimate::paired(&a, &b).unwrap_or(four);
        assert!((pair.mean - 0.1).abs() < 6.0 * pair.error && pair.error < 0.1 * alone.error, "{pair:?}");
    }
    assert!((0.92..0.97).contains(&(within as f64 / samples as f64)), "{within} of {samples}");
    close(square, claimed, 0.1, "variance of the mean");
    assert!(Estimate::of(&[1.0]).is_none() && Estimate::paired(&[1.0, 2.0], &[1.0]).is_none());
}
