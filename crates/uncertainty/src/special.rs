//! Logarithm of the gamma function, incomplete gamma and beta functions, error function.
//!
//! Source: Abramowitz & Stegun, chapters 6, 7 and 26; continued fractions by the modified Lentz method (Thompson &
//! Barnett 1986).

const MAX_TERMS: usize = 10_000;
const TINY: f64 = 1e-300;

/// `log Gamma(x)`, x > 0: Stirling's series after shifting the argument above 15.
pub(super) fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut product) = (x, 1.0);
    while x < 15.0 {
        product *= x;
        x += 1.0;
    }
    const SERIES: [f64; 7] =
        [1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0, 1.0 / 1188.0, -691.0 / 360_360.0, 1.0 / 156.0];
    let square = 1.0 / (x * x);
    let correction = SERIES.iter().rev().fold(0.0, |sum, c| sum * square + c) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + correction - f64::ln(product)
}

/// `(P, Q)`: regularised lower and upper incomplete gamma function of order a > 0.
pub(super) fn incomplete_gamma(a: f64, x: f64) -> (f64, f64) {
    if x <= 0.0 {
        return (0.0, 1.0);
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..MAX_TERMS {
            term *= x / (a + n as f64);
            sum += term;
            if term < sum * f64::EPSILON {
                break;
            }
        }
        let p = front * sum;
        return (p, 1.0 - p);
    }
    let term = |n: usize| {
        let n = n as f64;
        (-n * (n - a), x + 2.0 * n + 1.0 - a)
    };
    let q = front / continued_fraction(x + 1.0 - a, term);
    (1.0 - q, q)
}

/// `I_x(a, b)`: regularised incomplete beta function.
pub(super) fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { 0.0 } else { 1.0 };
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(b, a, 1.0 - x);
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p()).exp() / a;
    let term = |n: usize| {
        let m = (n / 2) as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        (if n.is_multiple_of(2) { even } else { odd }, 1.0)
    };
    front / continued_fraction(1.0, term)
}

/// `first + c_1/(d_1 + c_2/(d_2 + ..))`, `term(n) = (c_n, d_n)`, n from 1.
fn continued_fraction(first: f64, term: impl Fn(usize) -> (f64, f64)) -> f64 {
    let away = |x: f64| if x.abs() < TINY { TINY } else { x };
    let mut value = away(first);
    let (mut c, mut d) = (value, 0.0);
    for n in 1..MAX_TERMS {
        let (top, bottom) = term(n);
        d = 1.0 / away(bottom + top * d);
        c = away(bottom + top / c);
        value *= c * d;
        if (c * d - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    value
}

/// The standard normal probability of a value up to x, accurate in both tails.
pub(super) fn normal_cumulative(x: f64) -> f64 {
    let (below, above) = incomplete_gamma(0.5, 0.5 * x * x);
    if x < 0.0 { 0.5 * above } else { 0.5 + 0.5 * below }
}
