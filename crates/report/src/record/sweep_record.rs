//! [`SweepRecord`]: the content of `sweep.json`.

use crate::record::{ByName, Nullable};
use serde_json::Value;

records! {
    /// A sweep.
    SweepRecord {
        /// The command of its runs.
        command: String,
        /// The case.
        case: String,
        /// What is swept.
        swept: Vec<SweptRecord>,
        /// Options with one value.
        fixed: Vec<String>,
        /// Whether runs start from the controls of the one before.
        warm: bool,
        /// How many runs were planned.
        planned: usize,
        /// Those that were made.
        runs: Vec<SweepRunRecord>,
        /// Directories of those that are missing: not made, or not finished.
        missing: Vec<String>,
        /// The exit code of the worst; at least 4 where some are missing.
        exit: u8,
    }

    /// A swept option.
    SweptRecord {
        /// Where in the case.
        path: String,
        /// Its values as they were typed.
        values: Vec<String>,
    }

    /// A run of a sweep.
    SweepRunRecord {
        /// Its directory.
        run: String,
        /// Its swept values, by path.
        values: Option<ByName<Value>>,
        /// The run whose controls it started from.
        warm_from: Nullable<String>,
        /// Its exit code.
        exit: u8,
        /// Codes of its warnings.
        warnings: Vec<String>,
        /// Why it failed.
        error: Nullable<String>,
        /// Numbers of its result, by their paths there.
        figures: Option<ByName<Value>>,
    }
}
