//! Warnings as results and checkpoints have them.

use nastic_case::warning::{WARNINGS, Warning};
use nastic_report::record::WarningRecord;

pub(crate) fn warning_record(warning: &Warning) -> WarningRecord {
    WarningRecord {
        code: warning.kind.code.to_owned(),
        place: warning.place.clone(),
        message: warning.message.clone(),
        advice: warning.kind.advice.to_owned(),
    }
}

/// A warning from a result; `None` where its code is of no known kind.
pub(crate) fn warning_of(record: WarningRecord) -> Option<Warning> {
    let WarningRecord { code, place, message, .. } = record;
    let kind = WARNINGS.iter().find(|kind| kind.code == code)?;
    Some(Warning { kind, place, message })
}

/// Warnings of a run, in a checkpoint.
pub(crate) mod saved {
    use super::{warning_of, warning_record};
    use crate::saved::json;
    use nastic_case::warning::Warning;
    use nastic_report::record::WarningRecord;
    use serde::de::{Deserializer, Error as _};
    use serde::ser::Serializer;

    pub fn serialize<S: Serializer>(warnings: &[Warning], out: S) -> Result<S::Ok, S::Error> {
        json::serialize(&warnings.iter().map(warning_record).collect::<Vec<_>>(), out)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(input: D) -> Result<Vec<Warning>, D::Error> {
        let records: Vec<WarningRecord> = json::deserialize(input)?;
        let known = records.into_iter().map(warning_of).collect::<Option<_>>();
        known.ok_or_else(|| D::Error::custom("a warning of no known kind"))
    }
}
