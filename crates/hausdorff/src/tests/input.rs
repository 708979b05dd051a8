//! Input that is refused, and the helpers a caller warns with.

use super::super::{HausdorffError, Pairs};
use super::{Cloud, Evaluation, Phi, Smoothing, Summation, bars, close, smoothing};

#[test]
fn parameters_must_be_positive() {
    let phi = Phi::Exponential { length: 0.1 };
    let error = |phi, a, b, c| Smoothing::new(phi, a, b, c).unwrap_err().to_string();
    assert_eq!(error(phi, 0.0, 1.0, 1.0), "smoothed Hausdorff: alpha = 0 must be positive and finite");
    assert!(error(phi, 1.0, -2.0, 1.0).contains("beta = -2"));
    assert!(error(phi, 1.0, 1.0, f64::NAN).contains("gamma = NaN"));
    assert!(error(Phi::Exponential { length: f64::INFINITY }, 1.0, 1.0, 1.0).contains("length = inf"));
    assert!(error(Phi::Inverse { eps: 0.0 }, 1.0, 1.0, 1.0).contains("eps = 0"));
    assert!(error(Phi::SmoothInverse { eps: -1.0 }, 1.0, 1.0, 1.0).contains("eps = -1"));
}

#[test]
fn clouds_are_checked() {
    let x = [0.0, 1.0, 2.0];
    assert_eq!(Cloud::new(vec![], vec![]).unwrap_err(), HausdorffError::Empty);
    assert!(matches!(
        Cloud::new(vec![x; 2], vec![1.0]).unwrap_err(),
        HausdorffError::Length { found: 1, points: 2, .. }
    ));
    let error = Cloud::new(vec![x, [0.0, f64::NAN, 0.0]], vec![1.0; 2]).unwrap_err();
    assert!(matches!(error, HausdorffError::Point { index: 1, .. }));
    for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Cloud::new(vec![x; 3], vec![1.0, 1.0, weight]).unwrap_err();
        assert!(matches!(error, HausdorffError::Weight { index: 2, .. }));
    }
}

#[test]
fn seeds_and_extremes_are_checked() {
    let (body, target) = bars(10, 12);
    let pairs = Pairs::new(&body, &target, Phi::Inverse { eps: 0.1 }, 2.0, Summation::default()).unwrap();
    let sums = pairs.log_sums();
    assert!(matches!(pairs.vjp(&sums, &[0.0; 12], &[0.0; 9]), Err(HausdorffError::Length { found: 9, .. })));
    let s = smoothing(Phi::Exponential { length: 0.1 }, 1.0, 1.0, 1e-5);
    let error = Evaluation::new(&body, &target, s, Summation::default()).unwrap_err();
    assert!(matches!(error, HausdorffError::Overflow { what: "rho", .. }));
    let tree = Summation::Truncated { tolerance: 0.0 };
    assert!(Pairs::new(&body, &target, Phi::Inverse { eps: 0.1 }, 2.0, tree).is_err());
}

#[test]
fn spacing_of_a_lattice() {
    let mut points = Vec::new();
    for k in 0..400 {
        points.push([(k % 20) as f64 * 0.5, (k / 20) as f64 * 0.25, 0.0]);
    }
    let lattice = Cloud::new(points, vec![1.0; 400]).unwrap();
    close(lattice.spacing(), 0.25, 1e-15);
    close(lattice.diagonal(), 9.5f64.hypot(4.75), 1e-15);
    assert_eq!(Cloud::new(vec![[1.0; 3]], vec![1.0]).unwrap().spacing(), 0.0);
    // Every point twice: neighbours coincide.
    let twice = Cloud::new(vec![[0.0; 3], [0.0; 3]], vec![1.0; 2]).unwrap();
    assert_eq!(twice.spacing(), 0.0);
    close(smoothing(Phi::Exponential { length: 0.1 }, 4.0, 1.0, 1.0).resolution(), 0.025, 1e-15);
}
