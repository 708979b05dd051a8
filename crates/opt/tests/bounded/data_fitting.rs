//! Problems of Moré, Garbow and Hillstrom that fit data, with Gay's bounds.

use super::{Bounded, point, squares};

pub fn problems() -> Vec<Bounded> {
    vec![
        // The other value is where x2 and x3 are at their upper bounds.
        Bounded::new("MGH 8", mgh8, &[1.0; 3], &[0.1, 0.0, 0.0], &[50.0, 100.0, 50.0], 2.0 * 0.004_791_142_36)
            .with_others(&[1.514_543_090]),
        Bounded::new("MGH 9", mgh9, &[0.4, 1.0, 0.0], &[0.398, 1.0, -0.5], &[4.2, 2.0, 0.1], 1.127_93e-8),
        Bounded::new("MGH 12", mgh12, &[0.0, 10.0, 20.0], &[0.0, 5.0, 0.0], &[2.0, 9.5, 20.0], 2.0 * 5.717_409e-5),
        Bounded::new(
            "MGH 15",
            mgh15,
            &[0.25, 0.39, 0.415, 0.39],
            &[0.0, -1.0, 0.13, 0.12],
            &[10.0, 12.0, 13.0, 12.0],
            2.0 * 1.539_153_617e-4,
        ),
        Bounded::new(
            "MGH 16",
            mgh16,
            &[25.0, 5.0, -5.0, -1.0],
            &[-10.0, 0.0, -100.0, -20.0],
            &[100.0, 15.0, 0.0, 0.2],
            88_860.479,
        ),
        Bounded::new(
            "MGH 17",
            mgh17,
            &[0.5, 1.5, -1.0, 0.01, 0.02],
            &[0.0, 0.0, -50.0, 0.0, 0.0],
            &[50.0, 1.9, -0.1, 10.0, 10.0],
            2.0 * 2.735_141_671_7e-5,
        ),
        Bounded::new(
            "MGH 18",
            mgh18,
            &[1.0, 2.0, 1.0, 1.0, 1.0, 1.0],
            &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            &[2.0, 8.0, 1.0, 7.0, 5.0, 5.0],
            5.320_986_5e-4,
        ),
        Bounded::new(
            "MGH 19",
            mgh19,
            &[1.3, 0.65, 0.65, 0.7, 0.6, 3.0, 5.0, 7.0, 2.0, 4.5, 5.5],
            &[1.0, 0.5, 0.0, 0.6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            &[150.0, 100.0, 100.0, 100.0, 100.0, 500.0, 500.0, 500.0, 100.0, 10.0, 0.0],
            2.0 * 0.255_191_627_06,
        )
        .with_others(&[0.596_067_116]),
    ]
}

/// Bard: y_i - x1 - u_i/(v_i x2 + w_i x3), u_i = i, v_i = 16 - i, w_i = min(u_i, v_i), i = 1 .. 15.
fn mgh8(x: &[f64]) -> (f64, Vec<f64>) {
    const Y: [f64; 15] = [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39];
    let [a, b, c] = point(x);
    squares(Y.iter().zip(1..).map(|(y, i)| {
        let (u, v) = (f64::from(i), f64::from(16 - i));
        let w = u.min(v);
        let below = v * b + w * c;
        (y - a - u / below, [-1.0, u * v / (below * below), u * w / (below * below)])
    }))
}

/// Gaussian: x1 exp(-x2 (t_i - x3)^2/2) - y_i, t_i = (8 - i)/2, i = 1 .. 15.
fn mgh9(x: &[f64]) -> (f64, Vec<f64>) {
    const HALF: [f64; 8] = [0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989];
    let [a, b, c] = point(x);
    squares((1..16).map(|i: usize| {
        let off = (8.0 - i as f64) / 2.0 - c;
        let e = (-b * off * off / 2.0).exp();
        (a * e - HALF[i.min(16 - i) - 1], [e, -a * e * off * off / 2.0, a * e * b * off])
    }))
}

/// Box, three-dimensional: exp(-t_i x1) - exp(-t_i x2) - x3 (exp(-t_i) - exp(-10 t_i)), t_i = i/10, i = 1 .. 10.
fn mgh12(x: &[f64]) -> (f64, Vec<f64>) {
    squares((1..11).map(|i| {
        let t = f64::from(i) / 10.0;
        let (a, b, c) = ((-t * x[0]).exp(), (-t * x[1]).exp(), (-t).exp() - (-10.0 * t).exp());
        (a - b - x[2] * c, [-t * a, t * b, -c])
    }))
}

/// Kowalik and Osborne: y_i - x1 (u_i^2 + u_i x2)/(u_i^2 + u_i x3 + x4).
fn mgh15(x: &[f64]) -> (f64, Vec<f64>) {
    const Y: [f64; 11] = [0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246];
    const U: [f64; 11] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625];
    let [a, b, c, d] = point(x);
    squares(Y.iter().zip(U).map(|(y, u)| {
        let (above, below) = (u * u + u * b, u * u + u * c + d);
        let ratio = above / below;
        (y - a * ratio, [-ratio, -a * u / below, a * ratio * u / below, a * ratio / below])
    }))
}

/// Brown and Dennis: (x1 + t_i x2 - exp t_i)^2 + (x3 + x4 sin t_i - cos t_i)^2, t_i = i/5, i = 1 .. 20.
fn mgh16(x: &[f64]) -> (f64, Vec<f64>) {
    squares((1..21).map(|i| {
        let t = f64::from(i) / 5.0;
        let (a, b) = (x[0] + t * x[1] - t.exp(), x[2] + x[3] * t.sin() - t.cos());
        (a * a + b * b, [2.0 * a, 2.0 * a * t, 2.0 * b, 2.0 * b * t.sin()])
    }))
}

/// Osborne 1: y_i - x1 - x2 exp(-t_i x4) - x3 exp(-t_i x5), t_i = 10 (i - 1), i = 1 .. 33.
fn mgh17(x: &[f64]) -> (f64, Vec<f64>) {
    const Y: [f64; 33] = [
        0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603,
        0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431, 0.424, 0.420, 0.414, 0.411,
        0.406,
    ];
    squares(Y.iter().zip(0..).map(|(y, i)| {
        let t = 10.0 * f64::from(i);
        let (a, b) = ((-t * x[3]).exp(), (-t * x[4]).exp());
        (y - x[0] - x[1] * a - x[2] * b, [-1.0, -a, -b, t * x[1] * a, t * x[2] * b])
    }))
}

/// Biggs EXP6: x3 exp(-t_i x1) - x4 exp(-t_i x2) + x6 exp(-t_i x5) - y_i, y_i = exp(-t_i) - 5 exp(-10 t_i) + 3 exp(-4 t_i),
/// t_i = i/10, i = 1 .. 13.
fn mgh18(x: &[f64]) -> (f64, Vec<f64>) {
    squares((1..14).map(|i| {
        let t = f64::from(i) / 10.0;
        let y = (-t).exp() - 5.0 * (-10.0 * t).exp() + 3.0 * (-4.0 * t).exp();
        let (a, b, c) = ((-t * x[0]).exp(), (-t * x[1]).exp(), (-t * x[4]).exp());
        (x[2] * a - x[3] * b + x[5] * c - y, [-t * x[2] * a, t * x[3] * b, a, -b, -t * x[5] * c, c])
    }))
}

/// Osborne 2: y_i - x1 exp(-t_i x5) - sum_k x_{k+1} exp(-(t_i - x_{k+8})^2 x_{k+5}), k = 1, 2, 3, t_i = (i - 1)/10, i = 1 .. 65.
fn mgh19(x: &[f64]) -> (f64, Vec<f64>) {
    const Y: [f64; 65] = [
        1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746, 0.679, 0.608, 0.655, 0.616, 0.606,
        0.602, 0.626, 0.651, 0.724, 0.649, 0.649, 0.694, 0.644, 0.624, 0.661, 0.612, 0.558, 0.533, 0.495, 0.500, 0.423,
        0.395, 0.375, 0.372, 0.391, 0.396, 0.405, 0.428, 0.429, 0.523, 0.562, 0.607, 0.653, 0.672, 0.708, 0.633, 0.668,
        0.645, 0.632, 0.591, 0.559, 0.597, 0.625, 0.739, 0.710, 0.729, 0.720, 0.636, 0.581, 0.428, 0.292, 0.162, 0.098,
        0.054,
    ];
    squares(Y.iter().zip(0..).map(|(y, i)| {
        let t = f64::from(i) / 10.0;
        let e = (-t * x[4]).exp();
        let (mut r, mut row) = (y - x[0] * e, [0.0; 11]);
        (row[0], row[4]) = (-e, t * x[0] * e);
        for k in 1..4 {
            let off = t - x[k + 7];
            let hump = (-off * off * x[k + 4]).exp();
            r -= x[k] * hump;
            row[k] = -hump;
            row[k + 4] = x[k] * off * off * hump;
            row[k + 7] = -2.0 * x[k] * off * x[k + 4] * hump;
        }
        (r, row)
    }))
}
