//! [`HyperDual`]: numbers that carry two first derivatives and the mixed second one.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What formulas are written in: numbers, or numbers with their derivatives.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// A constant.
    fn of(value: f64) -> Self;
    /// Without derivatives.
    fn value(self) -> f64;
    /// The n-th root of a positive number.
    fn root(self, n: usize) -> Self;
    /// `e^x`
    fn exp(self) -> Self;
    /// The natural logarithm of a positive number.
    fn ln(self) -> Self;
}

impl Scalar for f64 {
    #[inline]
    fn of(value: f64) -> Self {
        value
    }

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn root(self, n: usize) -> Self {
        match n {
            2 => self.sqrt(),
            3 => self.cbrt(),
            _ => self.powf(1.0 / n as f64),
        }
    }

    #[inline]
    fn exp(self) -> Self {
        f64::exp(self)
    }

    #[inline]
    fn ln(self) -> Self {
        f64::ln(self)
    }
}

/// `x + x_1 e_1 + x_2 e_2 + x_12 e_1 e_2` with `e_1^2 = e_2^2 = 0`: a function of `x = a + e_1 + e_2` has the parts `f, f', f', f''`,
/// without a difference.
///
/// Source: Fike, Alonso, "The development of hyper-dual numbers for exact second-derivative calculations", AIAA 2011-886.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HyperDual(pub [f64; 4]);

impl HyperDual {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        HyperDual([value, 0.0, 0.0, 0.0])
    }

    /// The value.
    pub fn real(self) -> f64 {
        self.0[0]
    }

    /// The derivative along the first change (0) or along the second (1).
    pub fn along(self, change: usize) -> f64 {
        self.0[1 + change]
    }

    /// The derivative along both.
    pub fn both(self) -> f64 {
        self.0[3]
    }

    /// `f(self)` from `f`, `f'` and `f''` at the value.
    #[inline]
    pub fn chain(self, [f, first, second]: [f64; 3]) -> Self {
        let [_, a, b, ab] = self.0;
        HyperDual([f, first * a, first * b, first * ab + second * a * b])
    }
}

impl Scalar for HyperDual {
    #[inline]
    fn of(value: f64) -> Self {
        HyperDual::constant(value)
    }

    #[inline]
    fn value(self) -> f64 {
        self.0[0]
    }

    #[inline]
    fn root(self, n: usize) -> Self {
        let (x, power) = (self.0[0], 1.0 / n as f64);
        let f = x.root(n);
        let first = power * f / x;
        self.chain([f, first, (power - 1.0) * first / x])
    }

    #[inline]
    fn exp(self) -> Self {
        self.chain([self.0[0].exp(); 3])
    }

    #[inline]
    fn ln(self) -> Self {
        let x = self.0[0];
        self.chain([x.ln(), 1.0 / x, -1.0 / (x * x)])
    }
}

impl Add for HyperDual {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        HyperDual(std::array::from_fn(|k| self.0[k] + other.0[k]))
    }
}

impl Neg for HyperDual {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        HyperDual(self.0.map(|x| -x))
    }
}

impl Sub for HyperDual {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        HyperDual(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }
}

impl Mul for HyperDual {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        let ([x, a, b, ab], [y, c, d, cd]) = (self.0, other.0);
        HyperDual([x * y, x * c + a * y, x * d + b * y, x * cd + a * d + b * c + ab * y])
    }
}

impl Div for HyperDual {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.0[0];
        self * other.chain([inverse, -inverse * inverse, 2.0 * inverse * inverse * inverse])
    }
}
