use std::ops::{Add, Mul, Neg, Sub};

use super::number::Number;

/// Points that a tape is evaluated at side by side: each instruction is decoded once for all of them.
pub const LANES: usize = 4;

/// The values at several points. Every lane has the bits of an evaluation by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

impl Lanes {
    #[inline(always)]
    fn zip(self, o: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Lanes(std::array::from_fn(|lane| f(self.0[lane], o.0[lane])))
    }
}

impl Number for Lanes {
    #[inline(always)]
    fn constant(x: f64) -> Self {
        Lanes([x; LANES])
    }

    #[inline(always)]
    fn apply(self, f: impl Fn(f64) -> f64, _slopes: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        Lanes(self.0.map(f))
    }

    #[inline(always)]
    fn select(self, other: Self, compare: impl Fn(f64, f64) -> bool, yes: Self, no: Self) -> Self {
        let chosen = |lane: usize| if compare(self.0[lane], other.0[lane]) { yes.0[lane] } else { no.0[lane] };
        Lanes(std::array::from_fn(chosen))
    }

    fn power(self, exponent: Self) -> Self {
        self.zip(exponent, f64::powf)
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(self.0.map(|x| -x))
    }
}
