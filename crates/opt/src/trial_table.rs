//! [`TrialTable`]: the trials of a run as a table.

use crate::observer::{Reason, Trial};
use crate::summary::Summary;
use nastic_numeric::format::scientific;
use std::fmt::Write;

/// Name of the true Hausdorff distance among the [figures](crate::Objective::figures) of a point.
pub const TRUE_DISTANCE: &str = "hausdorff_true";

/// The trials of a run as a table: one row per trial, in columns of fixed width.
///
/// Columns of the work (`newton`, `factor`) and of `min J` are filled from the [`Summary`] of the trial; `-` stands where a trial
/// has no such number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrialTable {
    /// Whether there is a column of true distances.
    pub distance: bool,
    /// Whether there is a column of continuation stages.
    pub stages: bool,
    /// Whether there is a column of violations of constraints.
    pub violation: bool,
}

impl TrialTable {
    /// The columns, by the number of stages and the figures of points.
    #[must_use]
    pub fn new(stages: usize, figures: &Summary) -> Self {
        Self { distance: figures.get(TRUE_DISTANCE).is_some(), stages: stages > 1, violation: false }
    }

    /// With a column of violations, for a problem with constraints.
    #[must_use]
    pub fn with_violation(self, violation: bool) -> Self {
        Self { violation, ..self }
    }

    /// Names of the columns.
    #[must_use]
    pub fn header(&self) -> String {
        let mut out = format!("{:>5} {:>5}", "trial", "iter");
        if self.stages {
            let _ = write!(out, " {:>5}", "stage");
        }
        let _ = write!(out, "  {:>13} {:>10} {:>9}", "cost", "gradient", "step");
        if self.distance {
            let _ = write!(out, " {:>10}", "distance");
        }
        if self.violation {
            let _ = write!(out, " {:>9}", "violation");
        }
        let _ = write!(out, " {:>6} {:>6} {:>7} {:>7} {:>8}", "newton", "factor", "min J", "active", "seconds");
        out
    }

    /// What the columns hold, a line for each.
    #[must_use]
    pub fn explain(&self) -> Vec<&'static str> {
        let mut out = vec![
            "trial       number of the trial, accepted or not",
            "iter        number of the iteration it ends; - where it was rejected",
            "cost        value of the cost, as sums of its terms stand below the table",
            "gradient    norm of the projected gradient over that of the first",
            "step        length of the step over that of the direction; a rejected trial shortens it",
            "newton      Newton iterations of the state solve, of all load cases and scenarios",
            "factor      numeric factorisations, the adjoint's included where it was solved",
            "min J       smallest ratio of volumes at a quadrature point: 1 undeformed, 0 inverted",
            "active      share of the controls on their bounds",
            "seconds     time since the row before",
        ];
        if self.stages {
            out.insert(2, "stage       continuation stage of the cost: costs of different stages do not compare");
        }
        if self.distance {
            out.insert(out.len() - 5, "distance    true Hausdorff distance of an accepted state from the target");
        }
        if self.violation {
            let what =
                "violation   largest violation of a constraint, relative to its scale; the cost includes their penalty";
            out.insert(out.len() - 5, what);
        }
        out
    }

    /// The row of a trial. `figures` are those of its point, which are asked for where it was accepted; `seconds` is the time since
    /// the row before.
    #[must_use]
    pub fn row<P>(&self, trial: &Trial<'_, P>, figures: &Summary, seconds: f64) -> String {
        let mut out = format!("{:>5}", trial.trial);
        let iteration = if trial.accepted { trial.iteration.to_string() } else { "-".to_owned() };
        let _ = write!(out, " {iteration:>5}");
        if self.stages {
            let _ = write!(out, " {:>5}", trial.stage + 1);
        }
        let cost = trial.cost.map_or_else(|| "-".to_owned(), |cost| scientific(cost, 6));
        let gradient = if trial.accepted { scientific(trial.relative_gradient, 2) } else { "-".to_owned() };
        let step = if trial.step > 0.0 { scientific(trial.step, 2) } else { "-".to_owned() };
        let _ = write!(out, "  {cost:>13} {gradient:>10} {step:>9}");
        if self.distance {
            let distance = figures.get(TRUE_DISTANCE).map_or_else(|| "-".to_owned(), |d| scientific(d, 4));
            let _ = write!(out, " {distance:>10}");
        }
        if self.violation {
            let violation = trial.summary.get("violation").map_or_else(|| "-".to_owned(), |v| scientific(v, 2));
            let _ = write!(out, " {violation:>9}");
        }
        let count = |name: &str| trial.summary.get(name).map(|value| value as usize);
        let show = |value: Option<usize>| value.map_or_else(|| "-".to_owned(), |n| n.to_string());
        let newton = show(count("newton"));
        let factor = show(count("factorisations"));
        let min_j = trial.summary.get("min_J").map_or_else(|| "-".to_owned(), |j| format!("{j:.4}"));
        let active = format!("{:.1}%", 100.0 * trial.active_share);
        let _ = write!(out, " {newton:>6} {factor:>6} {min_j:>7} {active:>7} {seconds:>8.2}");
        if let Some(remark) = remark(&trial.reason) {
            let _ = write!(out, "  {remark}");
        }
        out
    }
}

/// What the columns do not say.
fn remark(reason: &Reason) -> Option<String> {
    match reason {
        Reason::Armijo | Reason::Conservative => None,
        Reason::Start => Some("start".to_owned()),
        Reason::Stage => Some("new stage".to_owned()),
        Reason::Multipliers => Some("new multipliers".to_owned()),
        Reason::NoDecrease { .. } => Some("rejected: not enough decrease".to_owned()),
        Reason::Underestimated { constraint: None, .. } => {
            Some("rejected: the model underestimates the cost".to_owned())
        }
        Reason::Underestimated { constraint: Some(k), .. } => {
            Some(format!("rejected: the model underestimates value {k} of the constraints"))
        }
        Reason::OtherBranch(why) => Some(format!("rejected, on another branch: {}", shortened(&why.to_string()))),
        Reason::Failed(why) | Reason::DerivativeFailed(why) => Some(format!("failed: {}", shortened(&why.to_string()))),
    }
}

/// The first part of a long explanation; [`Reason`] has it whole.
fn shortened(why: &str) -> String {
    let first = why.split(';').next().unwrap_or(why);
    match first.char_indices().nth(80) {
        Some((end, _)) => format!("{}...", &first[..end]),
        None => first.to_owned(),
    }
}
