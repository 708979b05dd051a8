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

/// `x + a e1 + b e2 + c e1 e2` with `e1^2 = e2^2 = 0`: a function of it carries its derivatives along two changes `a`, `b` and the second
/// derivative along both, exactly (J. Fike & J. Alonso, AIAA 2011-886, doi 10.2514/6.2011-886).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HyperDual {
    /// The value.
    pub real: f64,
    /// Along the first change and along the second.
    pub first: [f64; 2],
    /// Along both.
    pub both: f64,
}

impl Number for HyperDual {
    fn constant(x: f64) -> Self {
        HyperDual { real: x, first: [0.0; 2], both: 0.0 }
    }

    fn apply(self, f: impl Fn(f64) -> f64, slopes: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        let value = f(self.real);
        let [first, second] = slopes(self.real, value);
        let [a, b] = self.first;
        HyperDual { real: value, first: [first * a, first * b], both: first * self.both + second * a * b }
    }

    fn select(self, other: Self, compare: impl Fn(f64, f64) -> bool, yes: Self, no: Self) -> Self {
        if compare(self.real, other.real) { yes } else { no }
    }

    /// `a^b = exp(b log a)`, of a constant exponent for every base that has the power.
    fn power(self, exponent: Self) -> Self {
        let y = exponent.real;
        let by_base = self.apply(|x| x.powf(y), |x, _| [y * x.powf(y - 1.0), y * (y - 1.0) * x.powf(y - 2.0)]);
        if self.real <= 0.0 {
            return by_base;
        }
        let log = self.apply(f64::ln, |x, _| [1.0 / x, -1.0 / (x * x)]);
        by_base * ((exponent - Self::constant(y)) * log).apply(|_| 1.0, |_, _| [1.0, 1.0])
    }
}

impl Add for HyperDual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let first = [self.first[0] + o.first[0], self.first[1] + o.first[1]];
        HyperDual { real: self.real + o.real, first, both: self.both + o.both }
    }
}

impl Neg for HyperDual {
    type Output = Self;
    fn neg(self) -> Self {
        HyperDual { real: -self.real, first: [-self.first[0], -self.first[1]], both: -self.both }
    }
}

impl Sub for HyperDual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for HyperDual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let ([a, b], [c, d]) = (self.first, o.first);
        let first = [self.real * c + a * o.real, self.real * d + b * o.real];
        let both = self.real * o.both + a * d + b * c + self.both * o.real;
        HyperDual { real: self.real * o.real, first, both }
    }
}
