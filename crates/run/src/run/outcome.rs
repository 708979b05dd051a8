//! What a command found.

use crate::result::Missed;
use crate::run::error::Exit;
use nastic_report::record::RunRecord;
use serde_json::Value;

/// What a command found.
#[derive(Clone, PartialEq, Debug)]
pub struct Outcome {
    /// How it ended.
    pub exit: Exit,
    /// What was found, as values.
    pub record: RunRecord,
    /// The same as JSON: the content of `result.json`.
    pub result: Value,
    /// Expectations of the case that were not met.
    pub missed: Vec<Missed>,
}
