//! [`Bound`]: what a functional is held to.

use std::fmt;

/// A bound on a functional j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// `c = j - bound <= 0`
    AtMost(f64),
    /// `c = bound - j <= 0`
    AtLeast(f64),
    /// `c = j - bound = 0`
    Equal(f64),
}

impl Bound {
    /// The functional where the constraint has the value c.
    pub fn functional(self, c: f64) -> f64 {
        match self {
            Bound::AtMost(bound) | Bound::Equal(bound) => bound + c,
            Bound::AtLeast(bound) => bound - c,
        }
    }

    /// The bound itself.
    pub fn value(self) -> f64 {
        let (Bound::AtMost(bound) | Bound::AtLeast(bound) | Bound::Equal(bound)) = self;
        bound
    }

    /// The key of case files.
    pub fn key(self) -> &'static str {
        match self {
            Bound::AtMost(_) => "at_most",
            Bound::AtLeast(_) => "at_least",
            Bound::Equal(_) => "equal",
        }
    }
}

/// `at most 0.5`, `at least 2`, `wanted 1`
impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = match self {
            Bound::AtMost(_) => "at most",
            Bound::AtLeast(_) => "at least",
            Bound::Equal(_) => "wanted",
        };
        write!(f, "{words} {}", self.value())
    }
}
