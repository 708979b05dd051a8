//! [`RampFailure`]: where a ramp stopped, in values of its control.

use crate::result::failure;
use nastic_case::lower::CaseMember;
use nastic_fem::{Cause, StateError};
use nastic_language::number::{count, short};
use nastic_numeric::format::scientific;
use serde_json::{Map, Value, json};

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

    fn told(&self, value: f64) -> String {
        format!("{} {}", short(value), self.unit).trim_end().to_owned()
    }

    /// The value that was sought.
    pub fn at(&self) -> String {
        self.told(self.target)
    }

    /// Why there is no equilibrium, with values of the control in the place of shares of the last step.
    pub fn why(&self) -> String {
        match (self.error, self.before) {
            (StateError::NoConvergence { load, cuts, newton, residual, cause, .. }, Some(before)) => {
                let failed = self.told(self.value(*load).unwrap_or(self.target));
                let cause = match cause {
                    Cause::LimitPoint { load } => format!(
                        "the path of equilibria seems to turn back at a limit point near {}: beyond it the body jumps to \
                         another equilibrium or has none; try --path, or a ramp that ends before it",
                        self.told(self.value(*load).unwrap_or(before))
                    ),
                    other => other.to_string(),
                };
                format!(
                    "no equilibrium found at {failed}, the last one at {}, after {} of the step and {newton} Newton iterations \
                     (relative residual {}); {cause}",
                    self.told(self.reached()),
                    count(*cuts, "cut"),
                    scientific(*residual, 2),
                )
            }
            (StateError::Inadmissible { at, load, cuts, .. }, Some(_)) => {
                let failed = self.told(self.value(*load).unwrap_or(self.target));
                format!(
                    "{at} at {failed} after {} of the step; try a shorter ramp, or a finer mesh",
                    count(*cuts, "cut")
                )
            }
            (other, _) => other.to_string(),
        }
    }

    /// `failed` of the ramp: what a failure tells, `at`, `why`, and the values of the control.
    pub fn entry(&self, member: CaseMember<'_>) -> Value {
        let mut out: Map<String, Value> = failure::entries(member, self.error);
        out.insert("at".into(), json!(self.at()));
        out.insert("why".into(), json!(self.why()));
        let share = out.get("load").and_then(Value::as_f64);
        out.insert("value".into(), json!(share.and_then(|share| self.value(share)).unwrap_or(self.target)));
        if self.before.is_some() {
            out.insert("last_value".into(), json!(self.reached()));
            let limit = out.get("limit_point").and_then(Value::as_f64).and_then(|share| self.value(share));
            out.extend(limit.map(|limit| ("limit_value".to_owned(), json!(limit))));
            out.retain(|key, _| !["load", "reached", "limit_point"].contains(&key.as_str()));
        }
        Value::Object(out)
    }
}
