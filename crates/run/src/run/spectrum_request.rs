//! [`SpectrumRequest`]: what `optimize` is asked for beside the optimum.

use nastic_opt::Failed;
use thiserror::Error;

/// Leading eigenpairs of the reduced Hessian at the optimum: `--spectrum N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumRequest {
    /// How many.
    pub count: usize,
    /// The rise of the cost above the optimum that half-widths of the control belong to, in the unit of the cost; a hundredth of the cost
    /// there if absent.
    pub cost_rise: Option<f64>,
}

impl SpectrumRequest {
    /// So many, for a hundredth of the cost.
    #[must_use]
    pub fn leading(count: usize) -> Self {
        Self { count, cost_rise: None }
    }
}

/// Why there will be no spectrum: reported before the optimisation.
#[derive(Clone, Debug, Error)]
pub enum SpectrumRefusal {
    /// No eigenpair was asked for.
    #[error("ask for one eigenpair at least")]
    Count,
    /// An invalid rise of the cost.
    #[error("the rise of the cost is {0:e}; it is a positive number in the unit of the cost")]
    Rise(f64),
    /// Constraints on the state.
    #[error(
        "the case has constraints, in whose tangent space the second derivative would have to be taken, which is not done; \
         optimise without the spectrum, or put costs in the place of the constraints"
    )]
    Constraints,
    /// No second derivatives at the start.
    #[error("second derivatives of the cost are needed: {0}; optimise without the spectrum")]
    SecondDerivatives(#[source] Failed),
}
