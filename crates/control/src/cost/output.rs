//! [`Output`]: a number of a state that a sensor could read, with its derivatives.

use super::Partials;

/// A number y(u, m) of a state, for sensitivities dy/dm and feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Its name. Of a [point of a cost](super::CostPoint::outputs) which of several numbers it is: `x`, a marker with its coordinate; empty of one alone.
    pub name: String,
    /// y
    pub value: f64,
    /// What it shall be; `None` of what has no target.
    pub target: Option<OutputTarget>,
    /// The unit of y in SI; empty of a plain number.
    pub unit: &'static str,
    /// dy/du and dy/dm.
    pub partials: Partials,
}

/// What an output shall be: the cost has the term `weight/2 (y - value)^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputTarget {
    /// y*
    pub value: f64,
    /// Its weight.
    pub weight: f64,
}

/// Names of the components of vectors.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

impl Output {
    /// A number without a target.
    pub fn watched(name: impl Into<String>, value: f64, unit: &'static str, partials: Partials) -> Self {
        Output { name: name.into(), value, target: None, unit, partials }
    }

    /// With a target and its weight.
    #[must_use]
    pub fn aiming(self, value: f64, weight: f64) -> Self {
        Output { target: Some(OutputTarget { value, weight }), ..self }
    }
}
