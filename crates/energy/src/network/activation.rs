//! The softplus function.

use crate::formula::Number;

/// `s(t) = log(1 + e^t)`, without overflow.
pub fn softplus<T: Number>(t: T) -> T {
    t.apply(|t| t.max(0.0) + (-t.abs()).exp().ln_1p(), |t, _| logistic(t))
}

/// `s'(t) = 1 / (1 + e^-t)`.
pub fn slope<T: Number>(t: T) -> T {
    t.apply(
        |t| logistic(t)[0],
        |t, s| {
            let [_, second] = logistic(t);
            [second, second * (1.0 - 2.0 * s)]
        },
    )
}

/// `s'` and `s'' = s' (1 - s')`.
pub fn logistic(t: f64) -> [f64; 2] {
    let e = (-t.abs()).exp();
    let p = 1.0 / (1.0 + e);
    [if t >= 0.0 { p } else { e * p }, e * p * p]
}
