//! Frequencies of beams.

use std::f64::consts::PI;

/// The k-th (from 1) `b = w L^2 sqrt(rho A / E I)` of a clamped and free Timoshenko beam, `r^2 = I/(A L^2)`, `s^2 = E
/// I/(kappa G A L^2)`, below the cut-off `b r s = 1`. T. C. Huang, J. Appl. Mech. 28 (1961), table 1.
pub fn timoshenko(r2: f64, s2: f64, k: usize) -> f64 {
    let equation = |b: f64| {
        let root = ((r2 - s2) * (r2 - s2) + 4.0 / (b * b)).sqrt();
        let (alpha, beta) = ((0.5 * (root - r2 - s2)).sqrt(), (0.5 * (root + r2 + s2)).sqrt());
        let (x, y) = (b * alpha, b * beta);
        2.0 + (b * b * (r2 - s2) * (r2 - s2) + 2.0) * x.cosh() * y.cos()
            - b * (r2 + s2) / (1.0 - b * b * r2 * s2).sqrt() * x.sinh() * y.sin()
    };
    // from below: shear and rotation lower the roots of the slender beam, which are near ((k - 1/2) pi)^2
    nth_root(equation, 0.05, ((k as f64 - 0.4) * PI).powi(2), k)
}

/// The lowest `w^2 L^4 rho A/(E I)` of a clamped and free Euler beam under the dead end force of so many times its
/// buckling load, positive in compression: `w = A (cosh a x - cos b x) + B (sinh a x - a/b sin b x)`, no moment and no
/// shear at the end. Below buckling.
pub fn loaded_cantilever(multiple: f64) -> f64 {
    let p = multiple * PI * PI / 4.0;
    let determinant = |square: f64| {
        let root = (0.25 * p * p + square).sqrt();
        let (a, b) = ((root - 0.5 * p).sqrt(), (root + 0.5 * p).sqrt());
        let (ch, sh, c, s) = (a.cosh(), a.sinh(), b.cos(), b.sin());
        let moment = [a * a * ch + b * b * c, a * a * sh + a * b * s];
        let shear = [a * b * b * sh - b * a * a * s, a * b * b * ch + a * a * a * c];
        moment[0] * shear[1] - moment[1] * shear[0]
    };
    nth_root(determinant, 1e-6, 200.0 * (1.0 - p).max(1.0), 1)
}

/// The n-th change of sign between two numbers, NaN where there are fewer.
fn nth_root(f: impl Fn(f64) -> f64, from: f64, to: f64, n: usize) -> f64 {
    const PARTS: usize = 2000;
    let at = |part: usize| from + (to - from) * part as f64 / PARTS as f64;
    let changes = (0..PARTS).filter(|&part| f(at(part)) * f(at(part + 1)) < 0.0);
    let Some(part) = changes.take(n).nth(n - 1) else { return f64::NAN };
    let (mut low, mut high) = (at(part), at(part + 1));
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if f(low) * f(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}
