//! Problems of Moré, Garbow and Hillstrom without data, with Gay's bounds.

use super::{Bounded, point, squares};
use std::f64::consts::PI;

pub fn problems() -> Vec<Bounded> {
    let mut chebyquad_upper = [1.0; 8];
    chebyquad_upper[..3].copy_from_slice(&[0.04, 0.2, 0.3]);
    let chebyquad_start: [f64; 8] = std::array::from_fn(|i| (i + 1) as f64 / 9.0);
    let (mut brown_lower, mut brown_upper) = ([0.0; 10], [100.0; 10]);
    brown_lower[1] = 1.0;
    brown_upper[2] = 0.9;
    let wood_start = [-3.0, -1.0, -3.0, -1.0];
    vec![
        Bounded::new("MGH 1", rosenbrock, &[-1.2, 1.0], &[-50.0, 0.0], &[0.5, 100.0], 0.25),
        Bounded::new("MGH 2", mgh2, &[0.5, -2.0], &[0.0, -30.0], &[20.0, -0.9], 48.985_202),
        Bounded::new("MGH 3", mgh3, &[0.0, 1.0], &[0.0, 1.0], &[1.0, 9.0], 0.151_259_00e-9),
        Bounded::new("MGH 4", mgh4, &[1.0, 1.0], &[0.0, 3e-5], &[1e6, 100.0], 784.0),
        Bounded::new("MGH 5", mgh5, &[1.0, 1.0], &[0.6, 0.5], &[10.0, 100.0], 0.0),
        Bounded::new("MGH 6", mgh6, &[0.3, 0.4], &[0.26, 0.0], &[10.0, 20.0], 2.0 * 62.191_556_458),
        Bounded::new("MGH 7", mgh7, &[-1.0, 0.0, 0.0], &[-100.0, -1.0, -1.0], &[0.8, 1.0, 1.0], 0.990_422_12),
        Bounded::new(
            "MGH 13",
            mgh13,
            &[3.0, -1.0, 0.0, 1.0],
            &[0.1, -20.0, -1.0, -1.0],
            &[100.0, 20.0, 1.0, 50.0],
            2.0 * 9.390_981_5e-5,
        ),
        Bounded::new("MGH 14", wood, &wood_start, &[-100.0; 4], &[0.0, 10.0, 100.0, 100.0], 1.556_700_8),
        Bounded::new(
            "MGH 20, n = 6",
            watson::<6>,
            &[0.0; 6],
            &[-0.015, -10.0, -10.0, -10.0, -10.0, -10.0],
            &[10.0, 100.0, 100.0, 100.0, 100.0, 0.99],
            2.0 * 0.001_144_803_219,
        ),
        Bounded::new(
            "MGH 20, n = 9",
            watson::<9>,
            &[0.0; 9],
            &[-1e-5, 0.0, 0.0, 0.0, 0.0, -3.0, 0.0, -3.0, 0.0],
            &[1e-5, 0.9, 0.1, 1.0, 1.0, 0.0, 4.0, 0.0, 2.0],
            2.0 * 0.018_700_698_897,
        ),
        Bounded::new("MGH 27", mgh27, &[0.5; 10], &brown_lower, &brown_upper, 2.0 * 0.003_046_589_288),
        Bounded::new(
            "MGH 35",
            chebyquad,
            &chebyquad_start,
            &[0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0],
            &chebyquad_upper,
            2.0 * 0.001_796_121_193,
        ),
    ]
}

/// Rosenbrock: 10 (x2 - x1^2), 1 - x1.
pub fn rosenbrock(x: &[f64]) -> (f64, Vec<f64>) {
    squares([(10.0 * (x[1] - x[0] * x[0]), [-20.0 * x[0], 10.0]), (1.0 - x[0], [-1.0, 0.0])])
}

/// Freudenstein and Roth: -13 + x1 + ((5 - x2) x2 - 2) x2, -29 + x1 + ((x2 + 1) x2 - 14) x2.
fn mgh2(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b] = point(x);
    squares([
        (-13.0 + a + ((5.0 - b) * b - 2.0) * b, [1.0, (10.0 - 3.0 * b) * b - 2.0]),
        (-29.0 + a + ((b + 1.0) * b - 14.0) * b, [1.0, (3.0 * b + 2.0) * b - 14.0]),
    ])
}

/// Powell, badly scaled: 1e4 x1 x2 - 1, exp(-x1) + exp(-x2) - 1.0001.
fn mgh3(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b] = point(x);
    let (ea, eb) = ((-a).exp(), (-b).exp());
    squares([(1e4 * a * b - 1.0, [1e4 * b, 1e4 * a]), (ea + eb - 1.0001, [-ea, -eb])])
}

/// Brown, badly scaled: x1 - 1e6, x2 - 2e-6, x1 x2 - 2.
fn mgh4(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b] = point(x);
    squares([(a - 1e6, [1.0, 0.0]), (b - 2e-6, [0.0, 1.0]), (a * b - 2.0, [b, a])])
}

/// Beale: y_i - x1 (1 - x2^i), i = 1, 2, 3.
fn mgh5(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b] = point(x);
    squares([1.5, 2.25, 2.625].into_iter().zip(1..).map(|(y, i)| {
        let power = b.powi(i);
        (y - a * (1.0 - power), [power - 1.0, a * f64::from(i) * b.powi(i - 1)])
    }))
}

/// Jennrich and Sampson: 2 + 2 i - exp(i x1) - exp(i x2), i = 1 .. 10.
fn mgh6(x: &[f64]) -> (f64, Vec<f64>) {
    squares((1..11).map(|i| {
        let i = f64::from(i);
        let (a, b) = ((i * x[0]).exp(), (i * x[1]).exp());
        (2.0 + 2.0 * i - a - b, [-i * a, -i * b])
    }))
}

/// Helical valley: 10 (x3 - 10 theta), 10 (rho - 1), x3, with rho and 2 pi theta the polar coordinates of (x1, x2).
fn mgh7(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b, c] = point(x);
    let rho = a.hypot(b);
    let theta = (b / a).atan() / (2.0 * PI) + if a < 0.0 { 0.5 } else { 0.0 };
    let turn = 100.0 / (2.0 * PI * rho * rho);
    squares([
        (10.0 * (c - 10.0 * theta), [turn * b, -turn * a, 10.0]),
        (10.0 * (rho - 1.0), [10.0 * a / rho, 10.0 * b / rho, 0.0]),
        (c, [0.0, 0.0, 1.0]),
    ])
}

/// Powell, singular: x1 + 10 x2, sqrt(5) (x3 - x4), (x2 - 2 x3)^2, sqrt(10) (x1 - x4)^2.
fn mgh13(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b, c, d] = point(x);
    let (five, ten, inner, outer) = (5f64.sqrt(), 10f64.sqrt(), b - 2.0 * c, a - d);
    squares([
        (a + 10.0 * b, [1.0, 10.0, 0.0, 0.0]),
        (five * (c - d), [0.0, 0.0, five, -five]),
        (inner * inner, [0.0, 2.0 * inner, -4.0 * inner, 0.0]),
        (ten * outer * outer, [2.0 * ten * outer, 0.0, 0.0, -2.0 * ten * outer]),
    ])
}

/// Wood: 10 (x2 - x1^2), 1 - x1, sqrt(90) (x4 - x3^2), 1 - x3, sqrt(10) (x2 + x4 - 2), (x2 - x4)/sqrt(10).
pub fn wood(x: &[f64]) -> (f64, Vec<f64>) {
    let [a, b, c, d] = point(x);
    let (ninety, ten) = (90f64.sqrt(), 10f64.sqrt());
    squares([
        (10.0 * (b - a * a), [-20.0 * a, 10.0, 0.0, 0.0]),
        (1.0 - a, [-1.0, 0.0, 0.0, 0.0]),
        (ninety * (d - c * c), [0.0, 0.0, -2.0 * ninety * c, ninety]),
        (1.0 - c, [0.0, 0.0, -1.0, 0.0]),
        (ten * (b + d - 2.0), [0.0, ten, 0.0, ten]),
        ((b - d) / ten, [0.0, 1.0 / ten, 0.0, -1.0 / ten]),
    ])
}

/// Watson: p'(t_i) - p(t_i)^2 - 1 at t_i = i/29, i = 1 .. 29, with p(t) = sum_j x_j t^j, j = 0 .. n - 1; x_0; x_1 - x_0^2 - 1.
fn watson<const N: usize>(x: &[f64]) -> (f64, Vec<f64>) {
    let rows = (1..30).map(|i| -> (f64, [f64; N]) {
        let t = f64::from(i) / 29.0;
        let power: [f64; N] = std::array::from_fn(|j| t.powi(j as i32));
        let slope: [f64; N] = std::array::from_fn(|j| if j == 0 { 0.0 } else { j as f64 * power[j - 1] });
        let sum = |of: &[f64; N]| x.iter().zip(of).map(|(x, p)| x * p).sum::<f64>();
        let p = sum(&power);
        (sum(&slope) - p * p - 1.0, std::array::from_fn(|j| slope[j] - 2.0 * p * power[j]))
    });
    let unit = |a: f64, b: f64| -> [f64; N] { std::array::from_fn(|j| [a, b].get(j).copied().unwrap_or(0.0)) };
    squares(rows.chain([(x[0], unit(1.0, 0.0)), (x[1] - x[0] * x[0] - 1.0, unit(-2.0 * x[0], 1.0))]))
}

/// Brown, almost linear: x_i + sum_j x_j - 11, i = 1 .. 9; prod_j x_j - 1.
fn mgh27(x: &[f64]) -> (f64, Vec<f64>) {
    let sum: f64 = x.iter().sum();
    let without = |i: usize| x.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, x)| x).product::<f64>();
    let linear = (0..9).map(|i| (x[i] + sum - 11.0, std::array::from_fn(|j| if i == j { 2.0 } else { 1.0 })));
    let last: (f64, [f64; 10]) = (x.iter().product::<f64>() - 1.0, std::array::from_fn(without));
    squares(linear.chain([last]))
}

/// Chebyquad: mean_j T_i(2 x_j - 1) - integral of T_i(2 x - 1) over [0, 1], i = 1 .. 8.
fn chebyquad(x: &[f64]) -> (f64, Vec<f64>) {
    const N: usize = 8;
    let y: [f64; N] = std::array::from_fn(|j| 2.0 * x[j] - 1.0);
    let (mut before, mut now, mut slope_before, mut slope) = ([1.0; N], y, [0.0; N], [2.0; N]);
    let rows = (1..=N).map(|i| {
        let integral = if i % 2 == 0 { -1.0 / (i * i - 1) as f64 } else { 0.0 };
        let row = (now.iter().sum::<f64>() / N as f64 - integral, slope.map(|s| s / N as f64));
        let next = std::array::from_fn(|j| 2.0 * y[j] * now[j] - before[j]);
        let next_slope = std::array::from_fn(|j| 4.0 * now[j] + 2.0 * y[j] * slope[j] - slope_before[j]);
        (before, now, slope_before, slope) = (now, next, slope, next_slope);
        row
    });
    squares(rows)
}
