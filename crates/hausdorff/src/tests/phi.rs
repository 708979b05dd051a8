//! The contract of phi, over every row of the catalogue, and of the kernel that the sums use in its place.

use super::super::CATALOGUE;
use super::super::kernel::Kernel;
use super::{Phi, close};

/// Distances from next to nothing to far, in lengths of phi.
const DISTANCES: [f64; 8] = [1e-3, 0.02, 0.3, 1.0, 2.0, 7.0, 50.0, 400.0];

fn each(mut check: impl FnMut(Phi, f64)) {
    for row in CATALOGUE {
        for length in [1e-3, 0.3, 20.0] {
            let phi = (row.make)(length);
            assert_eq!(phi.length(), length, "{}", row.name);
            check(phi, length);
        }
    }
}

#[test]
fn positive_and_strictly_decreasing() {
    each(|phi, length| {
        let mut last = (phi.value(0.0), phi.log(0.0));
        assert!(last.0 > 0.0 && last.0.is_finite(), "{phi:?}");
        for r in DISTANCES.map(|r| r * length) {
            let (value, log) = (phi.value(r), phi.log(r));
            assert!(value < last.0 && value > 0.0, "{phi:?} at {r}: {value}");
            assert!(log < last.1, "{phi:?} at {r}");
            close(log, value.ln(), 1e-12);
            last = (value, log);
        }
    });
}

#[test]
fn the_inverse_leads_back() {
    each(|phi, length| {
        for r in DISTANCES {
            // Near zero a smooth phi is flat, and no better to invert than its rounding.
            close(phi.inverse_of_log(phi.log(r * length)), r * length, if r < 0.1 { 1e-8 } else { 1e-12 });
        }
        assert_eq!(phi.inverse_of_log(phi.log(0.0)), 0.0, "{phi:?}");
        assert_eq!(phi.inverse_of_log(phi.log(0.0) + 1e-12), 0.0, "{phi:?}");
    });
}

#[test]
fn derivatives_agree_with_differences() {
    each(|phi, length| {
        for r in DISTANCES.map(|r| r * length) {
            let h = 1e-3 * r.min(length);
            let central = |f: &dyn Fn(f64) -> f64, h: f64| (f(r + h) - f(r - h)) / (2.0 * h);
            let slope = |f: &dyn Fn(f64) -> f64| (4.0 * central(f, h / 2.0) - central(f, h)) / 3.0;
            let near = |found: f64, f: &dyn Fn(f64) -> f64| {
                let rounding = 1e-15 * f(r).abs() / h;
                let expected = slope(f);
                assert!(
                    (found - expected).abs() < 1e-9 * found.abs() + 4.0 * rounding,
                    "{phi:?} at {r}: {found} {expected}"
                );
            };
            near(phi.derivative(r), &|r| phi.value(r));
            near(phi.log_derivative(r), &|r| phi.log(r));
        }
    });
}

#[test]
fn the_kernel_is_a_power_of_phi() {
    each(|phi, length| {
        for alpha in [0.5, 3.0, 60.0] {
            let kernel = Kernel::new(phi, alpha);
            for r in DISTANCES.map(|r| r * length) {
                let log = std::f64::consts::LN_2 * kernel.at(r / kernel.unit) + kernel.log_at_zero;
                let scale = kernel.log_at_zero.abs().max(log.abs());
                assert!((log - alpha * phi.log(r)).abs() < 1e-13 * scale, "{phi:?}, alpha {alpha}, at {r}");
            }
        }
    });
}
