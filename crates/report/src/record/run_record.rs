//! [`RunRecord`]: the whole of `result.json`.

use crate::error::ReportError;
use crate::record::{Number, Numbers, StateRecord};
use indexmap::IndexMap;
use serde::Deserialize;
use serde_json::Value;
use std::ops::Deref;

records! {
    /// The result of a command; `start` has the costs at the start of an optimisation, `state` what was found.
    RunRecord {
        command: String, case: Option<String>, case_hash: String, title: Option<String>, versions: VersionsRecord,
        units: UnitsRecord, threads: Option<u64>, warnings: Vec<WarningRecord>, error: Option<String>, exit: Number,
        expect: ExpectRecord, seconds: Numbers, peak_memory: Option<u64>, stop: Option<String>,
        iterations: Option<u64>, trials: Option<u64>, failed_solves: Option<u64>, gradient_check: GradientCheckRecord,
        starts: Vec<StartRecord>, best_start: Option<u64>, files: Vec<String>, members: Vec<MemberRecord>,
        controls: IndexMap<String, ControlRecord>, constraints: ConstraintsRecord, spectrum: Option<SpectrumRecord>,
        derivative_norm: Numbers, start: StateRecord,
        #[serde(flatten)] state: StateRecord,
    }

    /// The program that ran.
    VersionsRecord { nastic: String }

    /// The units of all numbers.
    UnitsRecord { length: String, force: String, field: String, pressure: String }

    /// What deserves attention.
    WarningRecord { code: String, place: String, message: String, #[serde(rename = "try")] advice: String }

    /// Values that the case expects.
    ExpectRecord { missed: Vec<MissRecord> }

    /// One that was not met.
    MissRecord { path: String, found: Value, expected: Value }

    /// What the Taylor test said of the gradient.
    GradientCheckRecord { verdict: Option<String>, mismatch: Number }

    /// One of several starts of an optimisation.
    StartRecord {
        seed: Option<u64>, start_cost: Number, cost: Number, iterations: Option<u64>, stop: Option<String>,
        stopped_early: bool, failed: Option<String>, minimum: Option<u64>, distance: Number,
    }

    /// A member, and what the names of its files begin with.
    MemberRecord {
        name: String, scenario: Option<String>, load_case: Option<String>, stem: String, case_stem: String,
        targets: Vec<String>, obstacles: Vec<String>,
    }

    /// A control field.
    ControlRecord {
        array: Option<String>, slot: Option<String>, space: Option<String>, unit: Option<String>,
        unknowns: Option<u64>, min: Number, max: Number, lower: Number, upper: Number, active: Option<u64>,
        active_share: Number, total_variation: Number,
    }

    /// Constraints by group.
    ConstraintsRecord { groups: IndexMap<String, ConstraintGroupRecord> }

    /// One group.
    ConstraintGroupRecord { count: u64, active: u64, violation: Number, scale: Number, unit: Option<String> }

    /// Eigenvalues of the reduced Hessian at an optimum, or why they were not found.
    SpectrumRecord {
        failed: Option<String>, eigenvalues: Option<Vec<Number>>, residuals: Vec<Number>, free: Option<u64>,
        negative: Option<u64>, lowest: Number, shares: Option<IndexMap<String, Vec<Number>>>, above: Option<u64>,
        most: Option<u64>, cost_rise: Number, half_widths: Vec<Number>,
        half_width: Option<IndexMap<String, RangeRecord>>,
    }

    /// Least and largest value of a control.
    RangeRecord { min: Number, max: Number }
}

impl Deref for RunRecord {
    type Target = StateRecord;

    fn deref(&self) -> &StateRecord {
        &self.state
    }
}

impl RunRecord {
    /// The result that a program has as JSON.
    ///
    /// # Errors
    /// A value of another kind than its key has.
    pub fn of(result: &Value) -> Result<Self, ReportError> {
        Self::deserialize(result).map_err(ReportError::of_result)
    }
}

impl StartRecord {
    /// An entry of the list of starts.
    ///
    /// # Errors
    /// A value of another kind than its key has.
    pub fn of(entry: &Value) -> Result<Self, ReportError> {
        Self::deserialize(entry).map_err(ReportError::of_result)
    }
}
