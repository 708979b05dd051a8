//! Errors of ensembles.

use nastic_control::ControlError;
use nastic_team::TeamError;
use nastic_uncertainty::risk::RiskError;
use thiserror::Error;

/// An ensemble that cannot be built, or a member that cannot be evaluated.
#[derive(Clone, Debug, Error)]
pub enum EnsembleError {
    /// Nothing in it.
    #[error("{what} is empty; give at least one problem")]
    Empty {
        /// The ensemble or a scenario.
        what: String,
    },
    /// Two scenarios, or two load cases of one scenario, of one name.
    #[error("the name \"{name}\" is given twice; results go by these names")]
    Twice {
        /// The name.
        name: String,
    },
    /// A weight that is not positive and finite, a probability that is NaN or infinite.
    #[error("{who} has weight {weight}; weights of load cases are positive, probabilities finite numbers")]
    Weight {
        /// The member.
        who: String,
        /// Its weight.
        weight: f64,
    },
    /// Members that share a control do not mean the same by it.
    #[error(
        "{who} and {other} share the control \"{block}\" but differ in its {what}; give both the same space on the same \
         cells, or make it the load case's own"
    )]
    Block {
        /// The control.
        block: String,
        /// The later member.
        who: String,
        /// The earlier one.
        other: String,
        /// In what.
        what: &'static str,
    },
    /// A member that is incomplete or has no equilibrium.
    #[error("{}{source}", prefix(.who))]
    Member {
        /// Scenario and load case; empty where there is but one member without a name.
        who: String,
        /// What is wrong with it.
        source: Box<ControlError>,
    },
    /// A cost that is NaN or infinite.
    #[error("{}the cost is {value}; costs must be finite", prefix(.who))]
    Value {
        /// Scenario and load case.
        who: String,
        /// Its cost.
        value: f64,
    },
    /// A vector of the wrong length.
    #[error("the control vector has {found} entries where the ensemble has {expected}")]
    Length {
        /// Its length.
        found: usize,
        /// Length of all blocks.
        expected: usize,
    },
    /// No control of that name.
    #[error("control \"{name}\" not found in the ensemble; there are: {known}")]
    UnknownControl {
        /// The name asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// No mean shape.
    #[error("no mean shape: {what}")]
    Shape {
        /// Why.
        what: String,
    },
    /// A risk of first order that does not fit its members.
    #[error("{}the risk of first order: {what}", prefix(.who))]
    FirstOrder {
        /// Scenario and load case.
        who: String,
        /// What is wrong.
        what: String,
    },
    /// Second derivatives of a risk of first order.
    #[error(
        "a risk of first order gives first derivatives alone: its second ones have third ones of the cost; take a method that needs no others (lbfgs, spectral, \
         projected_gradient)"
    )]
    NoThirdDerivatives,
    /// The ranks of the team cannot continue together.
    #[error(transparent)]
    Team(#[from] TeamError),
    /// The risk measure does not fit.
    #[error(transparent)]
    Risk(#[from] RiskError),
}

fn prefix(who: &str) -> String {
    if who.is_empty() { String::new() } else { format!("{who}: ") }
}

impl EnsembleError {
    /// Whether a member, or the measure of risk at these costs, has no second derivatives.
    pub fn lacks_second_derivatives(&self) -> bool {
        match self {
            EnsembleError::Member { source, .. } => source.lacks_second_derivatives(),
            EnsembleError::NoThirdDerivatives => true,
            EnsembleError::Risk(error) => {
                matches!(error, RiskError::NoSecondDerivatives { .. } | RiskError::Kink { .. })
            }
            _ => false,
        }
    }

    pub(crate) fn member(who: &str, source: ControlError) -> Self {
        EnsembleError::Member { who: who.to_owned(), source: Box::new(source) }
    }
}
