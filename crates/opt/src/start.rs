//! [`Start`]: the start of a run, a control or an evaluated point.

/// A start: one number for every component, one for each, or an evaluated point.
#[derive(Clone, Debug, PartialEq)]
pub enum Start<P> {
    /// The same everywhere.
    Uniform(f64),
    /// One per component.
    Each(Vec<f64>),
    /// An evaluated point, which is not evaluated again.
    Evaluated(EvaluatedStart<P>),
}

/// An evaluated start: what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedStart<P> {
    /// The control.
    pub m: Vec<f64>,
    /// The point, evaluated at `m` in stage 0.
    pub point: P,
    /// The derivative there, if it is known already.
    pub derivative: Option<Vec<f64>>,
}

impl<P> From<f64> for Start<P> {
    fn from(value: f64) -> Self {
        Self::Uniform(value)
    }
}

impl<P> From<Vec<f64>> for Start<P> {
    fn from(values: Vec<f64>) -> Self {
        Self::Each(values)
    }
}

impl<P> From<&[f64]> for Start<P> {
    fn from(values: &[f64]) -> Self {
        Self::Each(values.to_vec())
    }
}

impl<P> From<&Vec<f64>> for Start<P> {
    fn from(values: &Vec<f64>) -> Self {
        Self::Each(values.clone())
    }
}

impl<P> From<EvaluatedStart<P>> for Start<P> {
    fn from(start: EvaluatedStart<P>) -> Self {
        Self::Evaluated(start)
    }
}
