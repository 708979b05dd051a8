//! Control fields as a case describes them.

use nastic_language::syntax::At;
use nastic_opt::Bounds;

/// A control field as the case describes it; its place in the control vector is that of the same number in the layout.
#[derive(Clone, PartialEq, Debug)]
pub struct ControlField {
    /// Path of its block in the case.
    pub at: At,
    /// Its name in results; `LOAD_CASE.NAME` for what a load case has alone.
    pub name: String,
    /// Its name in files: without the load case.
    pub array: String,
    /// Index of the load case in the case that has it alone; `None` for what all share.
    pub load_case: Option<usize>,
    /// Unit of its values, in the case's system.
    pub unit: String,
    /// What its values may be.
    pub admitted: Admitted,
    /// Whether the unknowns are the logarithms of its values.
    pub log: bool,
    /// The bounds of every component of the unknowns, where these are scalars.
    pub bounds: Option<Bounds>,
    /// The convexity bound of the passive law on this tension alone, where the law has one: the smallest of all members.
    pub limit: Option<f64>,
}

/// What values are admitted.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Admitted {
    /// Between bounds; the least and the greatest over the body.
    Between {
        /// Least lower bound.
        lower: f64,
        /// Greatest upper bound.
        upper: f64,
    },
    /// Vectors of this length.
    Norm(f64),
    /// Vectors no longer than this.
    MaxNorm(f64),
    /// All vectors.
    Any,
}

impl ControlField {
    /// How far two admitted vectors of unknowns can lie apart; `None` where there is no limit.
    pub(super) fn range(&self) -> Option<f64> {
        match self.admitted {
            Admitted::Between { lower, upper } if self.log => Some((upper / lower).ln()),
            admitted => admitted.range(),
        }
        .filter(|range| range.is_finite() && *range > 0.0)
    }
}

impl Admitted {
    /// How far two admitted values can lie apart; `None` where there is no limit.
    pub(super) fn range(&self) -> Option<f64> {
        let range = match self {
            Self::Between { lower, upper } => upper - lower,
            Self::Norm(norm) | Self::MaxNorm(norm) => 2.0 * norm,
            Self::Any => f64::INFINITY,
        };
        (range.is_finite() && range > 0.0).then_some(range)
    }
}
