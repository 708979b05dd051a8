//! Risk measures: one number for the costs of many scenarios.
//!
//! Costs `j_i` with probabilities `p_i` (sum one). Mean `E = sum p_i j_i`, deviation `D = sqrt(sum p_i (j_i - E)^2)`.
//! Every measure is `R = E + D r(y)` with the standardised costs `y_i = (j_i - E)/D`: adding a constant to all costs
//! adds it to R, scaling the costs scales R, and no number in here has a unit. Where `D = 0` to rounding, `R = E`.
//!
//! Kinks are rounded over a width `e = s D`, a share s of the deviation, wherever the optimiser goes. The weights
//! include `de/dj_i`, so the derivative is exact; in exchange a scenario far below the others may have a slightly
//! negative weight (R is monotone up to a term of the order of s). An absolute width would be monotone, and would have
//! a unit.

mod cvar;
mod estimate;
mod mean;
mod standard;
mod worst_case;

pub use cvar::{Cvar, conditional_value_at_risk};
pub use estimate::Estimate;
pub use mean::{Mean, MeanDeviation};
pub use worst_case::WorstCase;

use standard::Standard;
use std::fmt::Debug;
use thiserror::Error;

/// A measure of risk R(j) of costs `j_i` with probabilities `p_i`.
///
/// Contract: [`weights`](Self::weights) is the exact derivative of [`value`](Self::value), sums to one (adding a
/// constant to every cost adds it to R), [`weights_change`](Self::weights_change) is its derivative, and all are deterministic. Costs and probabilities have the same length,
/// probabilities have passed [`check`](Self::check), costs are finite.
///
/// Source: Rockafellar & Uryasev, "The fundamental risk quadrangle", Surveys in OR and Management Science 18 (2013).
pub trait Risk: Debug + Send + Sync {
    /// Name in case files and results.
    fn name(&self) -> &'static str;

    /// R, in the unit of the costs.
    fn value(&self, p: &[f64], j: &[f64]) -> f64;

    /// `dR/dj_i`, a pure number for each scenario.
    fn weights(&self, p: &[f64], j: &[f64]) -> Vec<f64>;

    /// The change of [`weights`](Self::weights) along a change of the costs: `sum_k d2R/dj_i dj_k dj_k`. Second derivatives of a
    /// risk ask for it.
    ///
    /// # Errors
    /// [`RiskError::NoSecondDerivatives`] where the measure does not implement it (the default), [`RiskError::Kink`] where it has
    /// none.
    fn weights_change(&self, _p: &[f64], _j: &[f64], _dj: &[f64]) -> Result<Vec<f64>, RiskError> {
        Err(RiskError::NoSecondDerivatives { measure: self.name() })
    }

    /// Whether R is linear in the costs, so that its weights never change.
    fn is_linear(&self) -> bool {
        false
    }

    /// What a smoothed measure stands for, without the smoothing; for reports.
    fn exact(&self, _p: &[f64], _j: &[f64]) -> Option<f64> {
        None
    }

    /// The share of cases that it does not look at, where it has such a level.
    fn level(&self) -> Option<f64> {
        None
    }

    /// Whether the measure is defined for these probabilities, and its parameters make sense.
    ///
    /// # Errors
    /// [`RiskError`].
    fn check(&self, p: &[f64]) -> Result<(), RiskError> {
        check_signs(self.name(), p)
    }
}

/// A measure chosen at run time is one too.
impl Risk for Box<dyn Risk> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn value(&self, p: &[f64], j: &[f64]) -> f64 {
        (**self).value(p, j)
    }

    fn weights(&self, p: &[f64], j: &[f64]) -> Vec<f64> {
        (**self).weights(p, j)
    }

    fn weights_change(&self, p: &[f64], j: &[f64], dj: &[f64]) -> Result<Vec<f64>, RiskError> {
        (**self).weights_change(p, j, dj)
    }

    fn is_linear(&self) -> bool {
        (**self).is_linear()
    }

    fn exact(&self, p: &[f64], j: &[f64]) -> Option<f64> {
        (**self).exact(p, j)
    }

    fn level(&self) -> Option<f64> {
        (**self).level()
    }

    fn check(&self, p: &[f64]) -> Result<(), RiskError> {
        (**self).check(p)
    }
}

/// Why a risk measure was refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RiskError {
    /// A parameter out of range.
    #[error("risk measure {measure}: {name} is {value}; it {must}")]
    Parameter {
        /// The measure.
        measure: &'static str,
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// Probabilities that do not sum to one, or are not finite.
    #[error("the probabilities of {scenarios} scenarios sum to {sum}; they must sum to 1")]
    Sum {
        /// How many there are.
        scenarios: usize,
        /// What they sum to.
        sum: f64,
    },
    /// A negative weight, as sparse rules have them, in a measure that needs probabilities.
    #[error(
        "scenario {scenario} has probability {probability}, which {measure} cannot use; negative weights (of sparse \
         rules) work with the mean alone: take a tensor rule or a (quasi-)Monte Carlo sample"
    )]
    Negative {
        /// Which scenario.
        scenario: usize,
        /// Its weight.
        probability: f64,
        /// The measure.
        measure: &'static str,
    },
    /// A measure that does not give second derivatives.
    #[error("risk measure {measure} gives no second derivatives; implement `Risk::weights_change`, or take the mean")]
    NoSecondDerivatives {
        /// The measure.
        measure: &'static str,
    },
    /// Equal costs, where the deviation has a kink.
    #[error(
        "risk measure {measure} has no second derivatives where all costs are equal: its deviation has a kink there; ask at another \
         control, or take the mean"
    )]
    Kink {
        /// The measure.
        measure: &'static str,
    },
    /// No measure of that name.
    #[error("no risk measure `{name}`; there are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
}

/// How far the sum of probabilities may be from one.
const SUM_TOLERANCE: f64 = 1e-9;

/// Refuses a smoothing that is not a positive number.
fn check_smoothing(measure: &'static str, value: f64) -> Result<(), RiskError> {
    match value.is_finite() && value > 0.0 {
        true => Ok(()),
        false => Err(RiskError::Parameter { measure, name: "smoothing", value, must: "must be positive" }),
    }
}

fn check_probabilities(p: &[f64]) -> Result<(), RiskError> {
    let sum: f64 = p.iter().sum();
    if (sum - 1.0).abs() <= SUM_TOLERANCE { Ok(()) } else { Err(RiskError::Sum { scenarios: p.len(), sum }) }
}

fn check_signs(measure: &'static str, p: &[f64]) -> Result<(), RiskError> {
    check_probabilities(p)?;
    match p.iter().position(|p| *p < 0.0) {
        Some(scenario) => Err(RiskError::Negative { scenario, probability: p[scenario], measure }),
        None => Ok(()),
    }
}

/// A row of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct RiskRow {
    /// Name in case files.
    pub name: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The measure with its default parameters.
    pub make: fn() -> Box<dyn Risk>,
    /// Whether R never falls when a cost rises. The others break it: the deviation by its nature, relative smoothing by
    /// as much as is smoothed.
    pub monotone: bool,
}

/// Every risk measure.
pub const CATALOGUE: &[RiskRow] = &[
    RiskRow { name: "mean", about: "expected cost", make: || Box::new(Mean), monotone: true },
    RiskRow {
        name: "mean_deviation",
        about: "expected cost plus lambda standard deviations",
        make: || Box::new(MeanDeviation::default()),
        monotone: false,
    },
    RiskRow {
        name: "cvar",
        about: "expected cost of the worst share of cases, smoothed",
        make: || Box::new(Cvar::default()),
        monotone: false,
    },
    RiskRow {
        name: "worst_case",
        about: "largest cost, smoothed",
        make: || Box::new(WorstCase::default()),
        monotone: false,
    },
];

/// The measure of that name, with its default parameters.
///
/// # Errors
/// [`RiskError::Unknown`] with the names there are.
pub fn by_name(name: &str) -> Result<Box<dyn Risk>, RiskError> {
    let known = || CATALOGUE.iter().map(|row| row.name).collect::<Vec<_>>().join(", ");
    let row = CATALOGUE.iter().find(|row| row.name == name);
    row.map(|row| (row.make)()).ok_or_else(|| RiskError::Unknown { name: name.to_owned(), known: known() })
}

/// Standard deviation of the costs, `sqrt(sum p_i (j_i - E)^2)`.
pub fn deviation(p: &[f64], j: &[f64]) -> f64 {
    Standard::new(p, j).deviation
}
