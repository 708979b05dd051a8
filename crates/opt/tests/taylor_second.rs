//! The Taylor test of second derivatives.
#![allow(clippy::unwrap_used)] // helpers of tests

use crate::common;

use common::Cost;
use nastic_opt::{
    Admissible, Ball, Bounds, Failed, NoSecondDerivatives, Objective, Product, Request, Sphere, Taylor, TaylorError,
    Verdict,
};

const SECOND: Taylor = Taylor {
    directions: 3,
    seed: 1,
    length: 0.1,
    size: None,
    components: None,
    accuracy: 1e-12,
    stage: 0,
    order: 1.95,
    second: true,
};

/// `sum_i sin(k_i m_i) + m_0 m_1 m_2`, its second derivative off by a share.
fn smooth(guard: impl Admissible + 'static, error: f64) -> Cost {
    let rate = |i: usize| 1.0 + 0.1 * i as f64;
    let value =
        move |m: &[f64]| m.iter().enumerate().map(|(i, m)| (m * rate(i)).sin()).sum::<f64>() + m[0] * m[1] * m[2];
    let derivative = move |m: &[f64]| {
        let mut d: Vec<f64> = m.iter().enumerate().map(|(i, m)| rate(i) * (m * rate(i)).cos()).collect();
        (0..3).for_each(|i| d[i] += m[(i + 1) % 3] * m[(i + 2) % 3]);
        d
    };
    let hessian = move |m: &[f64], v: &[f64]| {
        let entry = |(i, m): (usize, &f64)| -rate(i).powi(2) * (m * rate(i)).sin() * v[i];
        let mut h: Vec<f64> = m.iter().enumerate().map(entry).collect();
        (0..3).for_each(|i| h[i] += v[(i + 1) % 3] * m[(i + 2) % 3] + m[(i + 1) % 3] * v[(i + 2) % 3]);
        h.iter_mut().for_each(|h| *h *= 1.0 + error);
        h
    };
    Cost::new(guard, value, derivative).with_hessian(hessian)
}

#[test]
fn right_second_derivatives_pass_and_wrong_ones_do_not() {
    let m: Vec<f64> = (0..7).map(|i| 0.3 + 0.2 * i as f64).collect();
    for seed in 0..20 {
        let test = Taylor { seed, ..SECOND };
        let report = test.test(&smooth(Bounds::none(), 0.0), &Bounds::none(), &m).unwrap();
        assert!(report.passed(), "{report}");
        for d in &report.directions {
            let second = d.second.as_ref().unwrap();
            assert!(second.order > 2.95 && second.order < 3.4 && second.used.len() >= 3, "{report}");
        }
        for error in [1.0, -2.0, 0.05] {
            let report = test.test(&smooth(Bounds::none(), error), &Bounds::none(), &m).unwrap();
            assert_eq!(report.second_verdict(), Some(Verdict::Wrong), "error {error}: {report}");
            assert_eq!(report.verdict(), Verdict::Right);
            assert!(!report.passed() && report.to_string().contains("second derivative: d.Hd"), "{report}");
        }
    }
}

/// The paths are curved there: their curvature belongs to the first derivative.
#[test]
fn along_spheres_in_balls_and_at_bounds() {
    let m = [0.06, 0.08, 0.0, 0.0, 0.0, -0.1, 0.0, 0.012, 0.016];
    let product = || Product::new().block(6, Sphere::new(3, 0.1).unwrap()).block(3, Ball::new(3, 0.02).unwrap());
    let test = Taylor { length: 1.0, ..SECOND };
    for (error, right) in [(0.0, true), (1.0, false)] {
        let report = test.test(&smooth(product(), error), &product(), &m).unwrap();
        assert_eq!(report.passed(), right, "{report}");
    }
    let bounds = || Bounds::new(0.3, 0.9).unwrap();
    let m = [0.3, 0.9, 0.5, 0.3, 0.9];
    let report = test.test(&smooth(bounds(), 0.0), &bounds(), &m).unwrap();
    assert!(report.passed(), "{report}");
}

#[test]
fn quadratic_costs_leave_no_remainder() {
    let cost = |error: f64| {
        let hessian = move |_: &[f64], v: &[f64]| vec![2.0 * v[0] + v[1], v[0] + (6.0 + error) * v[1]];
        let value = |m: &[f64]| m[0] * m[0] + m[0] * m[1] + 3.0 * m[1] * m[1];
        Cost::new(Bounds::none(), value, |m| vec![2.0 * m[0] + m[1], m[0] + 6.0 * m[1]]).with_hessian(hessian)
    };
    let verdict = |error: f64| SECOND.test(&cost(error), &Bounds::none(), &[0.4, -0.7]).unwrap().second_verdict();
    assert_eq!(verdict(0.0), Some(Verdict::Quadratic));
    assert_eq!(verdict(0.1), Some(Verdict::Wrong));
}

#[test]
fn objectives_without_second_derivatives_refuse_with_a_type() {
    struct Plain;
    impl Objective for Plain {
        type Point = f64;
        type Workspace = ();
        fn evaluate(&self, m: &[f64], _: &Request<'_, f64>, (): &mut ()) -> Result<f64, Failed> {
            Ok(m[0])
        }
        fn value(&self, m: &f64) -> f64 {
            m.sin()
        }
        fn derivative(&self, m: &mut f64, (): &mut ()) -> Result<Vec<f64>, Failed> {
            Ok(vec![m.cos()])
        }
        fn restage(&self, _: usize, m: &f64) -> Result<f64, Failed> {
            Ok(*m)
        }
    }
    assert!(Taylor::default().test(&Plain, &Bounds::none(), &[0.3]).unwrap().second_verdict().is_none());
    for refused in [SECOND.test(&Plain, &Bounds::none(), &[0.3]), SECOND.test(&&Plain, &Bounds::none(), &[0.3])] {
        let Err(TaylorError::Base(failed)) = refused else { unreachable!("it is refused") };
        assert!(failed.downcast_ref::<NoSecondDerivatives>().is_some(), "{failed}");
        assert!(
            failed.to_string().contains("gives no second derivatives") && failed.to_string().contains("Plain"),
            "{failed}"
        );
    }
}

/// Remainders that fall faster than those of a smooth function are no evidence, unless the order is the same between all steps.
#[test]
fn an_order_that_differs_between_steps_is_not_right() {
    // k ((m - 0.3)^4 + c (m - 0.3)^6) + m^2 along m: the third derivative vanishes
    let of = |k: f64, c: f64| {
        let value = move |m: &[f64]| k * ((m[0] - 0.3).powi(4) + c * (m[0] - 0.3).powi(6)) + m[0] * m[0];
        let slope =
            move |m: &[f64]| vec![k * (4.0 * (m[0] - 0.3).powi(3) + 6.0 * c * (m[0] - 0.3).powi(5)) + 2.0 * m[0]];
        let curvature = move |m: f64| k * (12.0 * (m - 0.3).powi(2) + 30.0 * c * (m - 0.3).powi(4)) + 2.0;
        let cost = Cost::new(Bounds::none(), value, slope).with_hessian(move |m, v| vec![curvature(m[0]) * v[0]]);
        SECOND.test(&cost, &Bounds::none(), &[0.3]).unwrap()
    };
    let plain = of(1.0, 0.0).to_string();
    assert!(plain.contains("order 4.000: right") && !plain.contains("undecided"), "{plain}");
    // the sixth power takes over from the fourth within the steps: five of them have an order of 4.6 to 4.9, three at an end nearly 4
    let mixed = of(1e3, 1e6).to_string();
    let orders: Vec<f64> = mixed
        .lines()
        .filter_map(|line| {
            line.strip_prefix("second derivative: ")?.split_once("order ")?.1.split(':').next()?.parse().ok()
        })
        .collect();
    assert!(orders.len() == 3 && orders.iter().all(|order| (order - order.round()).abs() < 0.2), "{mixed}");
}
