//! [`Standing`]: how far a command is, as values.

use serde::Serialize;

/// How far a command is: what the line that passes on a terminal says, as values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Standing {
    /// What is being done: `reading`, `gradient check`, `motion`, ..
    pub phase: String,
    /// Seconds since the command began.
    pub seconds: f64,
    /// Of a motion: steps that are done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<usize>,
    /// How many there are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<usize>,
    /// The instant that the step under way leads to, in the case's unit of time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// The end of the motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end: Option<f64>,
    /// Of an optimisation: iterations that are done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iteration: Option<usize>,
    /// Their limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iterations: Option<usize>,
    /// The trial under way, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trial: Option<usize>,
    /// The cost of the last accepted trial.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// About the solve under way: Newton iteration, residual.
    pub line: String,
}
