//! [`SweepRow`]: one run of a sweep as a row of its table.

use crate::record::{DiscretizationRecord, MemberRecord, RunRecord, SweepRunRecord, UnitsRecord};
use serde_json::{Map, Value};

/// What one run of a sweep found.
pub struct SweepRow {
    /// Its number among the planned runs, from 0.
    pub index: usize,
    /// Its directory, in that of the sweep.
    pub directory: String,
    /// The swept paths with their values as they were typed.
    pub values: Vec<(String, String)>,
    /// Directory of the run whose optimum it started from.
    pub warm_from: Option<String>,
    /// Its exit code.
    pub exit: u8,
    /// Why it failed.
    pub error: Option<String>,
    /// Codes of its warnings, each once, in alphabetical order.
    pub warnings: Vec<String>,
    /// Numbers of its result by their paths there, as in `expect`.
    pub figures: Map<String, Value>,
    /// The size of its problem, where it came to have one.
    pub discretization: Option<DiscretizationRecord>,
    /// Units of its figures.
    pub units: UnitsRecord,
    /// Units of its controls, by name.
    pub control_units: Vec<(String, String)>,
    /// What the names of its files begin with: of every load case's first scenario, and without the scenario.
    pub stems: Vec<(String, String)>,
}

/// Entries of a result that a table shows, of a plain case or of all members together.
const SHOWN: [&str; 18] = [
    "cost",
    "hausdorff",
    "tracking",
    "risk",
    "stop",
    "converged",
    "iterations",
    "trials",
    "failed_solves",
    "newton_iterations",
    "min_J",
    "energy",
    "potential",
    "inertia",
    "controls",
    "probes",
    "contributions",
    "reactions",
];
/// Those of each load case.
const OF_CASES: [&str; 7] = ["cost", "hausdorff", "tracking", "energy", "potential", "probes", "contributions"];
/// What is left out of them: descriptions, and what follows from the rest.
const LEFT_OUT: [&str; 10] =
    ["array", "slot", "space", "grid", "unit", "unknowns", "lower", "upper", "point", "position"];

impl SweepRow {
    /// The run of this index, by the exit code and the error it ended with and by what it left in its `result.json`.
    #[must_use]
    pub fn of(
        index: usize,
        directory: &str,
        values: Vec<(String, String)>,
        exit: u8,
        error: Option<String>,
        record: RunRecord,
    ) -> Self {
        let controls = record.controls.iter().flatten();
        let control_units = controls.filter_map(|(name, own)| Some((name.clone(), own.unit.clone()?))).collect();
        let figures = record.to_json().map(|result| figures(&result)).unwrap_or_default();
        let mut warnings: Vec<String> = record.warnings.into_iter().map(|warning| warning.code).collect();
        warnings.sort_unstable();
        warnings.dedup();
        Self {
            index,
            directory: directory.to_owned(),
            values,
            warm_from: None,
            exit,
            error: error.or(record.error),
            warnings,
            figures,
            discretization: record.discretization,
            units: record.units,
            control_units,
            stems: stems(record.members.as_deref().unwrap_or_default()),
        }
    }

    /// A figure that is a number.
    #[must_use]
    pub fn number(&self, figure: &str) -> Option<f64> {
        self.figures.get(figure)?.as_f64()
    }

    /// Whether it found what it looked for: exit code 0, or 8 of warnings.
    #[must_use]
    pub fn is_done(&self) -> bool {
        matches!(self.exit, 0 | 8)
    }

    pub(super) fn record(&self) -> SweepRunRecord {
        let value = |(path, text): &(String, String)| {
            (path.clone(), serde_json::from_str(text).unwrap_or_else(|_| text.as_str().into()))
        };
        SweepRunRecord {
            run: self.directory.clone(),
            values: Some(self.values.iter().map(value).collect()),
            warm_from: self.warm_from.clone().into(),
            exit: self.exit,
            warnings: self.warnings.clone(),
            error: self.error.clone().into(),
            figures: Some(self.figures.clone().into_iter().collect()),
        }
    }

    /// The same without depth, for the table.
    pub(super) fn cells(&self) -> Value {
        let mut out = Map::new();
        out.insert("run".into(), self.directory.as_str().into());
        out.extend(self.values.iter().map(|(path, text)| (path.clone(), text.as_str().into())));
        out.insert("exit".into(), self.exit.into());
        out.insert("warnings".into(), self.warnings.join(" ").into());
        out.insert("error".into(), self.error.clone().into());
        out.extend(self.figures.clone());
        Value::Object(out)
    }
}

/// What the names of the files begin with, of the first scenario of every load case.
fn stems(members: &[MemberRecord]) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::new();
    for member in members {
        if out.iter().all(|(_, known)| *known != member.case_stem) {
            out.push((member.stem.clone(), member.case_stem.clone()));
        }
    }
    out
}

fn figures(result: &Value) -> Map<String, Value> {
    let mut out = Map::new();
    for key in SHOWN {
        flatten(key, &result[key], &mut out);
    }
    for (name, case) in result["load_cases"].as_object().into_iter().flatten() {
        for key in OF_CASES {
            flatten(&format!("load_cases/{name}/{key}"), &case[key], &mut out);
        }
    }
    out
}

/// Every number, text and truth value below a path, under its own.
fn flatten(path: &str, value: &Value, out: &mut Map<String, Value>) {
    match value {
        Value::Null => {}
        Value::Object(entries) => {
            for (key, value) in entries.iter().filter(|(key, _)| !LEFT_OUT.contains(&key.as_str())) {
                flatten(&format!("{path}/{key}"), value, out);
            }
        }
        Value::Array(entries) => {
            entries.iter().enumerate().for_each(|(k, value)| flatten(&format!("{path}/{k}"), value, out));
        }
        leaf => {
            out.insert(path.to_owned(), leaf.clone());
        }
    }
}
