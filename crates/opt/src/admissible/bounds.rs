//! The box: lower <= m <= upper, component by component.

use super::{Admissible, Face, Intervals, NotBounds, Outside, SetError};

/// One number for all components, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Limit {
    /// The same for every component.
    Uniform(f64),
    /// One per component.
    Each(Vec<f64>),
}

impl Limit {
    fn at(&self, i: usize) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Each(values) => values[i],
        }
    }

    fn len(&self) -> Option<usize> {
        match self {
            Self::Uniform(_) => None,
            Self::Each(values) => Some(values.len()),
        }
    }
}

impl From<f64> for Limit {
    fn from(value: f64) -> Self {
        Self::Uniform(value)
    }
}

impl From<Vec<f64>> for Limit {
    fn from(values: Vec<f64>) -> Self {
        Self::Each(values)
    }
}

/// The box lower <= m <= upper; infinite bounds are no bounds, equal ones fix the component. An amplitude along a given
/// direction is a box in the amplitude.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    lower: Limit,
    upper: Limit,
}

impl Bounds {
    /// The box between two limits, each one number or one per component.
    ///
    /// # Errors
    /// Bounds that cross, are not numbers, or are lists of different lengths.
    pub fn new(lower: impl Into<Limit>, upper: impl Into<Limit>) -> Result<Self, SetError> {
        let (lower, upper) = (lower.into(), upper.into());
        let len = match (lower.len(), upper.len()) {
            (Some(a), Some(b)) if a != b => return Err(SetError::Lengths { lower: a, upper: b }),
            (a, b) => a.or(b).unwrap_or(1),
        };
        for index in 0..len {
            let (lower, upper) = (lower.at(index), upper.at(index));
            if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
                return Err(SetError::Crossed { index, lower, upper });
            }
        }
        Ok(Self { lower, upper })
    }

    /// No bounds at all.
    pub fn none() -> Self {
        Self { lower: Limit::Uniform(f64::NEG_INFINITY), upper: Limit::Uniform(f64::INFINITY) }
    }

    /// The bounds of a component.
    pub fn at(&self, component: usize) -> (f64, f64) {
        (self.lower.at(component), self.upper.at(component))
    }

    /// m + step, put exactly on a bound that rounding alone keeps it from.
    fn arrive(&self, i: usize, m: f64, step: f64) -> f64 {
        let (lower, upper) = self.at(i);
        let x = m + step;
        let slack = 4.0 * f64::EPSILON * (m.abs() + step.abs());
        if x <= lower + slack {
            lower
        } else if x >= upper - slack {
            upper
        } else {
            x
        }
    }
}

impl Admissible for Bounds {
    fn check(&self, m: &[f64]) -> Result<(), Outside> {
        if let Some(len) = self.lower.len().or(self.upper.len()).filter(|len| *len != m.len()) {
            let allowed = format!("the bounds are for {len} components, the control has {}", m.len());
            return Err(Outside { index: len.min(m.len()), value: f64::NAN, allowed });
        }
        for (index, value) in m.iter().copied().enumerate() {
            let (lower, upper) = self.at(index);
            if !(lower <= value && value <= upper && value.is_finite()) {
                return Err(Outside { index, value, allowed: format!("[{lower:e}, {upper:e}]") });
            }
        }
        Ok(())
    }

    fn project(&self, m: &mut [f64]) {
        for (i, m) in m.iter_mut().enumerate() {
            let (lower, upper) = self.at(i);
            *m = m.clamp(lower, upper);
        }
    }

    fn restrict(&self, m: &[f64], d: &mut [f64]) {
        for (i, (m, d)) in m.iter().zip(d).enumerate() {
            let (lower, upper) = self.at(i);
            *d = d.clamp(lower - m, upper - m);
        }
    }

    fn reach(&self, m: &[f64], d: &[f64], s: &[f64]) -> f64 {
        let room = |i: usize| {
            let (lower, upper) = self.at(i);
            match s[i] {
                s if s > 0.0 => (upper - m[i] - d[i]) / s,
                s if s < 0.0 => (lower - m[i] - d[i]) / s,
                _ => 1.0,
            }
        };
        (0..m.len()).map(room).fold(1.0, f64::min).max(0.0)
    }

    fn tangent(&self, _m: &[f64], _v: &mut [f64]) {}

    fn retract(&self, m: &[f64], d: &[f64], t: f64, out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            // A component that does not move stays to the bit, also one that is within rounding of a bound.
            *out = if d[i] == 0.0 { m[i] } else { self.arrive(i, m[i], t * d[i]) };
        }
    }

    fn face(&self, m: &[f64], d: &[f64], derivative: &[f64]) -> Face {
        let mut face = Face::free(m.len());
        for i in 0..m.len() {
            let (lower, upper) = self.at(i);
            let x = self.arrive(i, m[i], d[i]);
            if lower == upper || (x <= lower && derivative[i] > 0.0) || (x >= upper && derivative[i] < 0.0) {
                face.fix(i);
            }
        }
        face
    }

    fn inward(&self, m: &[f64], d: &mut [f64]) {
        for (i, (m, d)) in m.iter().zip(d).enumerate() {
            let (below, above) = (self.lower.at(i) - m, self.upper.at(i) - m);
            if *d > above || *d < below {
                *d = if above >= -below { d.abs().min(above) } else { -d.abs().min(-below) };
            }
        }
    }

    fn intervals(&self, len: usize) -> Result<Intervals, NotBounds> {
        let (lower, upper) = (0..len).map(|i| self.at(i)).unzip();
        Ok(Intervals { lower, upper })
    }

    fn extent(&self, m: &[f64]) -> Vec<f64> {
        let width = |i| {
            let (lower, upper) = self.at(i);
            if (upper - lower).is_finite() { upper - lower } else { 0.0 }
        };
        (0..m.len()).map(width).collect()
    }
}
