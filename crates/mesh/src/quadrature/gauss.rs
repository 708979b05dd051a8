//! Gauss rules for the weight (1 - x)^alpha on [-1,1], computed by Newton's method on the Jacobi polynomial.

use std::f64::consts::PI;

/// Nodes (ascending) and weights of the n-point Gauss-Legendre rule on [-1,1]; exact to degree 2n - 1.
pub fn gauss_legendre(n: usize) -> (Vec<f64>, Vec<f64>) {
    gauss_jacobi(n, 0)
}

/// Nodes (ascending) and weights of the n-point Gauss rule for the weight (1 - x)^alpha on [-1,1]; exact to degree
/// 2n - 1. The weights sum to 2^(alpha+1)/(alpha+1).
///
/// With P = P_n^(alpha,0), w_i = 2^(alpha+1) / ((1 - x_i^2) P'(x_i)^2), since the Gamma factors cancel for beta = 0.
pub fn gauss_jacobi(n: usize, alpha: u32) -> (Vec<f64>, Vec<f64>) {
    let a = f64::from(alpha);
    let scale = f64::from(2u32.saturating_pow(alpha + 1));
    let mut nodes: Vec<f64> = Vec::with_capacity(n);
    let mut weights = Vec::with_capacity(n);
    for i in 0..n {
        // From the left; the guess is the asymptotic position of the zero.
        let theta = PI * (0.75 + (n - 1 - i) as f64 + 0.5 * a) / (n as f64 + 0.5 * (a + 1.0));
        let x = root(n, a, theta.cos(), &nodes);
        let slope = jacobi(n, a, x).1;
        nodes.push(x);
        weights.push(scale / ((1.0 - x * x) * slope * slope));
    }
    if alpha == 0 {
        symmetrise(&mut nodes, &mut weights);
    }
    (nodes, weights)
}

/// Newton's method on P / prod (x - x_k), so that no zero is found twice.
fn root(n: usize, a: f64, guess: f64, found: &[f64]) -> f64 {
    let mut x = guess;
    for _ in 0..100 {
        let (p, slope) = jacobi(n, a, x);
        let deflation: f64 = found.iter().map(|z| 1.0 / (x - z)).sum();
        let step = p / (slope - p * deflation);
        x -= step;
        if step.abs() <= 4.0 * f64::EPSILON {
            break;
        }
    }
    x
}

/// Value and slope of P_n^(a,0) by the three-term recurrence.
fn jacobi(n: usize, a: f64, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, 0.5 * (a + (a + 2.0) * x));
    if n == 0 {
        return (1.0, 0.0);
    }
    for k in 2..=n {
        let k = k as f64;
        let s = 2.0 * k + a;
        let c1 = 2.0 * k * (k + a) * (s - 2.0);
        let c2 = (s - 1.0) * (s * (s - 2.0) * x + a * a);
        let c3 = 2.0 * (k + a - 1.0) * (k - 1.0) * s;
        (before, p) = (p, (c2 * p - c3 * before) / c1);
    }
    let n = n as f64;
    let s = 2.0 * n + a;
    (p, (n * (a - s * x) * p + 2.0 * (n + a) * n * before) / (s * (1.0 - x * x)))
}

/// Legendre rules are symmetric; make them so to the last bit.
fn symmetrise(nodes: &mut [f64], weights: &mut [f64]) {
    let n = nodes.len();
    for i in 0..n / 2 {
        let (x, w) = (0.5 * (nodes[n - 1 - i] - nodes[i]), 0.5 * (weights[i] + weights[n - 1 - i]));
        (nodes[i], nodes[n - 1 - i]) = (-x, x);
        (weights[i], weights[n - 1 - i]) = (w, w);
    }
    if n % 2 == 1 {
        nodes[n / 2] = 0.0;
    }
}
