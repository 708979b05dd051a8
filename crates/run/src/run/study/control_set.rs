//! [`ControlSet`]: where a control of a program may be.

use nastic_case::lower::{Admission, Admitted};
use nastic_opt::{Admissible, Ball, Bounds, Sphere};
use std::sync::Arc;

/// Where a control may be: one of the sets that results can name.
#[derive(Clone, Debug, PartialEq)]
pub enum ControlSet {
    /// Scalars between bounds.
    Bounds(Bounds),
    /// Vectors of one length.
    Sphere(Sphere),
    /// Vectors up to a length.
    Ball(Ball),
}

impl ControlSet {
    /// No bounds.
    #[must_use]
    pub fn none() -> Self {
        Self::Bounds(Bounds::none())
    }

    pub(super) fn set(&self) -> Arc<dyn Admissible> {
        match self {
            Self::Bounds(set) => Arc::new(set.clone()),
            Self::Sphere(set) => Arc::new(set.clone()),
            Self::Ball(set) => Arc::new(set.clone()),
        }
    }

    pub(super) fn admission(&self) -> Admission {
        match self {
            Self::Bounds(set) => Admission::Bounds(set.clone()),
            Self::Sphere(set) => Admission::Vectors { admitted: Admitted::Norm(set.radius()), dim: set.dim() },
            Self::Ball(set) => Admission::Vectors { admitted: Admitted::MaxNorm(set.radius()), dim: set.dim() },
        }
    }
}

impl From<Bounds> for ControlSet {
    fn from(set: Bounds) -> Self {
        Self::Bounds(set)
    }
}

impl From<Sphere> for ControlSet {
    fn from(set: Sphere) -> Self {
        Self::Sphere(set)
    }
}

impl From<Ball> for ControlSet {
    fn from(set: Ball) -> Self {
        Self::Ball(set)
    }
}
