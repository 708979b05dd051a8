//! Problems of Hock and Schittkowski with bounds alone.

use super::more_garbow_hillstrom::{rosenbrock, wood};
use super::{Bounded, point, squares};

const FREE: f64 = f64::INFINITY;

pub fn problems() -> Vec<Bounded> {
    vec![
        Bounded::new("HS 1", rosenbrock, &[-2.0, 1.0], &[-FREE, -1.5], &[FREE; 2], 0.0),
        // The other minimum, (-1.2210, 1.5), is the one on the start's side.
        Bounded::new("HS 2", rosenbrock, &[-2.0, 1.0], &[-FREE, 1.5], &[FREE; 2], 0.050_426_187_9)
            .with_others(&[4.941_229_318]),
        Bounded::new("HS 3", hs3, &[10.0, 1.0], &[-FREE, 0.0], &[FREE; 2], 0.0),
        Bounded::new("HS 4", hs4, &[1.125, 0.125], &[1.0, 0.0], &[FREE; 2], 8.0 / 3.0),
        Bounded::new("HS 5", hs5, &[0.0, 0.0], &[-1.5, -3.0], &[4.0, 3.0], -1.913_222_955),
        // The start is nearly stationary: the derivative there is 1e-6 of the cost.
        Bounded::new("HS 25", hs25, &[100.0, 12.5, 3.0], &[0.1, 0.0, 0.0], &[100.0, 25.6, 5.0], 0.0)
            .with_others(&[32.835]),
        Bounded::new("HS 38", wood, &[-3.0, -1.0, -3.0, -1.0], &[-10.0; 4], &[10.0; 4], 0.0),
        Bounded::new("HS 45", hs45, &[2.0; 5], &[0.0; 5], &[1.0, 2.0, 3.0, 4.0, 5.0], 1.0),
        Bounded::new("HS 110", hs110, &[9.0; 10], &[2.001; 10], &[9.999; 10], -45.778_469_71),
    ]
}

/// x2 + 1e-5 (x2 - x1)^2.
fn hs3(x: &[f64]) -> (f64, Vec<f64>) {
    let gap = x[1] - x[0];
    (x[1] + 1e-5 * gap * gap, vec![-2e-5 * gap, 1.0 + 2e-5 * gap])
}

/// (x1 + 1)^3/3 + x2.
fn hs4(x: &[f64]) -> (f64, Vec<f64>) {
    ((x[0] + 1.0).powi(3) / 3.0 + x[1], vec![(x[0] + 1.0).powi(2), 1.0])
}

/// sin(x1 + x2) + (x1 - x2)^2 - 1.5 x1 + 2.5 x2 + 1.
fn hs5(x: &[f64]) -> (f64, Vec<f64>) {
    let (sin, cos) = (x[0] + x[1]).sin_cos();
    let gap = x[0] - x[1];
    (sin + gap * gap - 1.5 * x[0] + 2.5 * x[1] + 1.0, vec![cos + 2.0 * gap - 1.5, cos - 2.0 * gap + 2.5])
}

/// r_i = exp(-(u_i - x2)^x3/x1) - i/100, u_i = 25 + (-50 ln(i/100))^(2/3), i = 1 .. 99.
fn hs25(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b, c] = point(x);
    squares((1..100).map(|i| {
        let share = f64::from(i) / 100.0;
        let base = 25.0 + (-50.0 * share.ln()).powf(2.0 / 3.0) - b;
        let power = base.powf(c);
        let e = (-power / a).exp();
        (e - share, [e * power / (a * a), e * c * base.powf(c - 1.0) / a, -e * power * base.ln() / a])
    }))
}

/// 2 - x1 x2 x3 x4 x5/120.
fn hs45(x: &[f64]) -> (f64, Vec<f64>) {
    let without = |i: usize| x.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, x)| x).product::<f64>();
    (2.0 - x.iter().product::<f64>() / 120.0, (0..5).map(|i| -without(i) / 120.0).collect())
}

/// sum (ln(x_i - 2)^2 + ln(10 - x_i)^2) - (prod x_i)^0.2.
fn hs110(x: &[f64]) -> (f64, Vec<f64>) {
    let root = x.iter().product::<f64>().powf(0.2);
    let sum: f64 = x.iter().map(|x| (x - 2.0).ln().powi(2) + (10.0 - x).ln().powi(2)).sum();
    let slope = |x: &f64| 2.0 * (x - 2.0).ln() / (x - 2.0) - 2.0 * (10.0 - x).ln() / (10.0 - x) - 0.2 * root / x;
    (sum - root, x.iter().map(slope).collect())
}
