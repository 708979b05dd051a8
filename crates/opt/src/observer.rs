//! Watching a run, trial by trial.

use crate::failed::Failed;
use crate::summary::Summary;
use std::fmt;

/// What became of a trial.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// The start of the run.
    Start,
    /// The accepted control, valued by the next stage, with its state where controls have stages.
    Stage,
    /// The accepted control, valued with new multipliers and a new penalty of the constraints.
    Multipliers,
    /// Accepted by Armijo's test.
    Armijo,
    /// Accepted: the method's model underestimates neither the cost nor a constraint there.
    Conservative,
    /// The method's model underestimates the cost or a constraint.
    Underestimated {
        /// Which of the values of all constraints, from 0; none of the cost.
        constraint: Option<usize>,
        /// What the model says; of a constraint relative to its scale.
        model: f64,
        /// What was found.
        found: f64,
    },
    /// The cost did not fall enough.
    NoDecrease {
        /// The cost that had to be reached.
        wanted: f64,
    },
    /// The cost did not fall enough, and its state lies on another branch.
    OtherBranch(Failed),
    /// The evaluation failed.
    Failed(Failed),
    /// The cost fell but its derivative could not be had.
    DerivativeFailed(Failed),
}

impl Reason {
    /// Whether the trial was accepted as the end of an iteration.
    pub fn is_step(&self) -> bool {
        matches!(self, Self::Armijo | Self::Conservative)
    }

    /// Whether it is the control of the previous trial with the value of another stage or other multipliers.
    pub fn is_revaluation(&self) -> bool {
        matches!(self, Self::Stage | Self::Multipliers)
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start => write!(f, "start"),
            Self::Stage => write!(f, "stage"),
            Self::Multipliers => write!(f, "multipliers"),
            Self::Armijo => write!(f, "armijo"),
            Self::Conservative => write!(f, "conservative"),
            Self::Underestimated { constraint: None, model, found } => {
                write!(f, "the model underestimates the cost: {model:.6e} for {found:.6e}")
            }
            Self::Underestimated { constraint: Some(k), model, found } => {
                write!(
                    f,
                    "the model underestimates value {k} of the constraints: {model:.3e} for {found:.3e} of its scale"
                )
            }
            Self::NoDecrease { wanted } => write!(f, "no decrease: wanted {wanted:.6e}"),
            Self::OtherBranch(why) => write!(f, "no decrease, on another branch: {why}"),
            Self::Failed(why) => write!(f, "failed: {why}"),
            Self::DerivativeFailed(why) => write!(f, "failed: derivative: {why}"),
        }
    }
}

/// One trial: everything a history line needs.
#[derive(Debug)]
pub struct Trial<'a, P> {
    /// Number of the trial, 0 for the start.
    pub trial: usize,
    /// Iterations done before it (the accepted trial of the first iteration says 1).
    pub iteration: usize,
    /// Continuation stage.
    pub stage: usize,
    /// Whether it became the present point.
    pub accepted: bool,
    /// Why, or why not.
    pub reason: Reason,
    /// Its cost; none if the evaluation failed.
    pub cost: Option<f64>,
    /// Norm of the projected gradient in the metric at the present point: this one if accepted, else the one before.
    pub gradient_norm: f64,
    /// The same relative to the first of the stage.
    pub relative_gradient: f64,
    /// Step length as the method counts it.
    pub step: f64,
    /// Length of the move in the metric's norm.
    pub length: f64,
    /// The change of cost that the derivative at the point before predicts, `dj/dm . (m - m_before)`; none where the control is the one before.
    pub predicted: Option<f64>,
    /// Active bounds at the present point.
    pub active: usize,
    /// The same as a share of the control components.
    pub active_share: f64,
    /// What the objective says of this trial; the work of the attempt if the evaluation failed.
    pub summary: Summary,
    /// The trial control.
    pub m: &'a [f64],
    /// The evaluated trial.
    pub point: Option<&'a P>,
    /// The derivative there (dual, tangential part), of accepted trials.
    pub derivative: Option<&'a [f64]>,
}

/// `  12 iteration   9 stage 1 cost 1.234567e-3 gradient 2.1e-2 armijo`: one line of a history.
impl<P> fmt::Display for Trial<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:4} iteration {:3} stage {} cost ", self.trial, self.iteration, self.stage)?;
        match self.cost {
            Some(cost) => write!(f, "{cost:.6e}")?,
            None => f.write_str("-")?,
        }
        write!(f, " gradient {:.1e} {}", self.relative_gradient, self.reason)
    }
}

/// Sees every trial, accepted or not. Any `FnMut(&Trial<P>)` is one; `()` ignores them.
pub trait Observer<P> {
    /// Called once per trial, accepted or not, in order.
    fn trial(&mut self, trial: &Trial<'_, P>);
}

impl<P> Observer<P> for () {
    fn trial(&mut self, _trial: &Trial<'_, P>) {}
}

impl<P, F: FnMut(&Trial<'_, P>)> Observer<P> for F {
    fn trial(&mut self, trial: &Trial<'_, P>) {
        self(trial);
    }
}
