//! Warnings as results and checkpoints have them.

use nastic_case::warning::{WARNINGS, Warning};
use nastic_report::record::WarningRecord;

/// A warning as results have it.
pub fn warning_record(warning: &Warning) -> WarningRecord {
    WarningRecord {
        code: warning.kind.code.to_owned(),
        place: warning.place.clone(),
        message: warning.message.clone(),
        advice: warning.kind.advice.to_owned(),
    }
}

/// A warning from a result; `None` where its code is of no known kind.
pub fn warning_of(record: WarningRecord) -> Option<Warning> {
    let WarningRecord { code, place, message, .. } = record;
    let kind = WARNINGS.iter().find(|kind| kind.code == code)?;
    Some(Warning { kind, place, message })
}
