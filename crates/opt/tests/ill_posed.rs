//! L-BFGS on a cost whose curvatures fall over many orders of magnitude, as those of tracking problems do.
#![allow(clippy::unwrap_used)]

use crate::common;

use common::{Cost, begin};
use nastic_opt::{Bounds, Euclidean, Lbfgs, Options};

/// `1/2 sum_i 10^(-i/8) (m_i - 1)^2`.
#[test]
fn few_iterations_reach_directions_of_small_curvature() {
    const N: usize = 64;
    let curvature = |i: usize| 10f64.powf(-(i as f64) / 8.0);
    let cost = Cost::new(
        Bounds::none(),
        move |m| 0.5 * m.iter().enumerate().map(|(i, x)| curvature(i) * (x - 1.0).powi(2)).sum::<f64>(),
        move |m| m.iter().enumerate().map(|(i, x)| curvature(i) * (x - 1.0)).collect(),
    );
    let options = Options { tolerance: 1e-12, max_iterations: 20, ..Options::default() };
    let optimizer = Lbfgs { options, ..Lbfgs::default() };
    let run = begin(&optimizer, &cost, &Bounds::none(), &Euclidean::new(N), &[0.0; N]).unwrap();
    let best = run.minimize(&mut ());
    // 1.9e-3; beginning with the largest curvature met it is 2.5e-3.
    assert!(best.cost < 2.2e-3, "{:e} after {} trials", best.cost, best.counts.trials);
}
