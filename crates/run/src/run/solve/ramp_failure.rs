//! [`RampFailure`]: where a ramp stopped, in values of its control.

use nastic_case::lower::CaseMember;
use nastic_fem::{Cause, StateError};
use nastic_language::number::{count, short};
use nastic_numeric::format::scientific;
use nastic_report::record::{FailureRecord, Number};
use nastic_result::failure;

/// An equilibrium of a ramp that was not found.
pub(super) struct RampFailure<'e> {
    pub error: &'e StateError,
    /// Value at the equilibrium before; none where the first one was sought, from rest.
    pub before: Option<f64>,
    /// Value at the one sought.
    pub target: f64,
    pub unit: &'e str,
}

impl RampFailure<'_> {
    /// The value after this share of the last step; none on the way from rest, which is none of the control alone.
    fn value(&self, share: f64) -> Option<f64> {
        self.before.map(|before| before + share * (self.target - before))
    }

    /// Value at the last equilibrium found.
    pub fn reached(&self) -> f64 {
        match self.error {
            StateError::NoConvergence { reached, .. } => self.value(*reached).unwrap_or(self.target),
            _ => self.before.unwrap_or(self.target),
        }
    }

    fn shown(&self, value: f64) -> String {
        format!("{} {}", short(value), self.unit).trim_end().to_owned()
    }

    /// The value that was sought.
    pub fn at(&self) -> String {
        self.shown(self.target)
    }

    /// Why there is no equilibrium, with values of the control in the place of shares of the last step.
    pub fn why(&self) -> String {
        match (self.error, self.before) {
            (StateError::NoConvergence { load, cuts, newton, residual, cause, .. }, Some(before)) => {
                let failed = self.shown(self.value(*load).unwrap_or(self.target));
                let cause = match cause {
                    Cause::LimitPoint { load } => format!(
                        "the path of equilibria seems to turn back at a limit point near {}: beyond it the body jumps to \
                         another equilibrium or has none; try --path, or a ramp that ends before it",
                        self.shown(self.value(*load).unwrap_or(before))
                    ),
                    other => other.to_string(),
                };
                format!(
                    "no equilibrium found at {failed}, the last one at {}, after {} of the step and {newton} Newton iterations \
                     (relative residual {}); {cause}",
                    self.shown(self.reached()),
                    count(*cuts, "cut"),
                    scientific(*residual, 2),
                )
            }
            (StateError::Inadmissible { at, load, cuts, .. }, Some(_)) => {
                let failed = self.shown(self.value(*load).unwrap_or(self.target));
                format!(
                    "{at} at {failed} after {} of the step; try a shorter ramp, or a finer mesh",
                    count(*cuts, "cut")
                )
            }
            (other, _) => other.to_string(),
        }
    }

    /// `failed` of the ramp: what a failure reports, `at`, `why`, and the values of the control in place of shares of the last step.
    pub fn record(&self, member: CaseMember<'_>) -> FailureRecord {
        let mut out = failure::record(member, self.error);
        (out.at, out.why) = (Some(self.at()), Some(self.why()));
        out.value = out.load.and_then(|share| self.value(share)).unwrap_or(self.target).into();
        if self.before.is_some() {
            out.last_value = self.reached().into();
            let limit = out.limit_point.and_then(|share| self.value(share));
            out.limit_value = limit.map(Number::from).unwrap_or_default();
            (out.load, out.reached, out.limit_point) = Default::default();
        }
        out
    }
}
