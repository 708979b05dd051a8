use nastic_tensor::HyperDual;
use std::ops::{Add, Mul, Neg, Sub};

/// A number a tape can be evaluated in.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// One that does not change.
    fn constant(x: f64) -> Self;
    /// A function of the value with its first two derivatives there: `f(x)`, `[f', f'']` from x and f.
    fn apply(self, f: impl Fn(f64) -> f64, slopes: impl Fn(f64, f64) -> [f64; 2]) -> Self;
    /// `yes` where the values of the two compare so, else `no`.
    fn select(self, other: Self, compare: impl Fn(f64, f64) -> bool, yes: Self, no: Self) -> Self;
    /// The power of an exponent that may change too.
    fn power(self, exponent: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn apply(self, f: impl Fn(f64) -> f64, _slopes: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        f(self)
    }

    #[inline(always)]
    fn select(self, other: Self, compare: impl Fn(f64, f64) -> bool, yes: Self, no: Self) -> Self {
        if compare(self, other) { yes } else { no }
    }

    fn power(self, exponent: Self) -> Self {
        self.powf(exponent)
    }
}

impl Number for HyperDual {
    fn constant(x: f64) -> Self {
        HyperDual::constant(x)
    }

    fn apply(self, f: impl Fn(f64) -> f64, slopes: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        let value = f(self.real());
        let [first, second] = slopes(self.real(), value);
        self.chain([value, first, second])
    }

    fn select(self, other: Self, compare: impl Fn(f64, f64) -> bool, yes: Self, no: Self) -> Self {
        if compare(self.real(), other.real()) { yes } else { no }
    }

    /// `a^b = exp(b log a)`, of a constant exponent for every base that has the power.
    fn power(self, exponent: Self) -> Self {
        let y = exponent.real();
        let by_base = self.apply(|x| x.powf(y), |x, _| [y * x.powf(y - 1.0), y * (y - 1.0) * x.powf(y - 2.0)]);
        if self.real() <= 0.0 {
            return by_base;
        }
        let log = self.apply(f64::ln, |x, _| [1.0 / x, -1.0 / (x * x)]);
        by_base * ((exponent - Self::constant(y)) * log).apply(|_| 1.0, |_, _| [1.0, 1.0])
    }
}
