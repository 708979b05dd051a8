//! [`StateRecord`]: what a result says of a state, or of several together.

use crate::record::{MemberRecord, Number, Numbers};
use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny};

records! {
    /// Costs, distances, what a state says of itself, the work it took; below it those of scenarios and load cases.
    StateRecord {
        probability: Number, weight: Number, cost: CostRecord, risk: RiskRecord, hausdorff: Option<HausdorffRecord>,
        tracking: IndexMap<String, Numbers>, figures: IndexMap<String, Numbers>,
        #[serde(rename = "min_J")] min_j: Number,
        probes: IndexMap<String, ProbesRecord>, contributions: IndexMap<String, Numbers>,
        reactions: Option<IndexMap<String, Vec<Number>>>,
        /// `None` where nothing is said of it.
        #[serde(deserialize_with = "said")] inertia: Option<Option<u64>>,
        inertia_missing: Option<UncountedRecord>, self_intersection: Option<IntersectionRecord>,
        newton_iterations: Option<u64>, factorisations: Option<u64>, reused_factorisations: Option<u64>,
        back_substitutions: Option<u64>, multigrid_cycles: Option<u64>, linear_solver: String,
        time: Option<IgnoredAny>, ramp: Option<SeriesRecord>, path: Option<SeriesRecord>,
        equilibria: Option<IgnoredAny>, modes: ModesRecord,
        scenarios: IndexMap<String, StateRecord>, load_cases: IndexMap<String, StateRecord>,
    }

    /// The sum of costs and its terms.
    CostRecord { total: Number, terms: Numbers }

    /// Measures of risk of the scenarios' costs.
    RiskRecord { measure: String, deviation: Number, measures: Option<IndexMap<String, MeasureRecord>> }

    /// One of them.
    MeasureRecord { value: Number, exact: Number, level: Number }

    /// Distances from a target shape.
    #[derive(Copy)]
    HausdorffRecord {
        #[serde(rename = "true")] exact: Number,
        smoothed: Number,
        #[serde(rename = "self")] floor: Number,
    }

    /// Why negative pivots were not counted.
    UncountedRecord { singular: bool, why: Option<String> }

    /// Cells that lie in others.
    #[derive(Copy)]
    IntersectionRecord { cells: Option<u64> }

    /// A ramp or a path.
    SeriesRecord {
        control: Option<String>, unit: String, points: Vec<PointRecord>, critical: Vec<PointRecord>,
        events: Vec<PointRecord>,
    }

    /// An equilibrium of them, or a critical one.
    PointRecord { kind: Option<String>, value: Number, before: Number, after: Number }

    /// Modes of the tangent, or of vibration.
    ModesRecord { about: Option<String>, eigenvalues: Vec<Number>, frequencies: Vec<Number>, unit: String }
}

/// The displacement of a probe; of several scenarios the mean, and its standard deviation.
#[derive(Clone, Debug, Deserialize)]
#[allow(missing_docs)] // fields are keys
pub struct ProbeRecord {
    pub displacement: Vec<Number>,
    pub position: Vec<Number>,
    pub deviation: Option<Vec<Number>>,
}

/// A probe, or those of a load case.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum ProbesRecord {
    /// A probe.
    One(ProbeRecord),
    /// Those of a load case.
    OfLoadCase(IndexMap<String, ProbeRecord>),
}

impl StateRecord {
    /// What is said of a member; nothing where its scenario or load case is missing.
    #[must_use]
    pub fn member(&self, member: &MemberRecord) -> Option<&Self> {
        let scenario = member.scenario.as_ref().map_or(Some(self), |name| self.scenarios.get(name))?;
        member.load_case.as_ref().map_or(Some(scenario), |name| scenario.load_cases.get(name))
    }

    /// All members with their names, of a case that is not plain.
    #[must_use]
    pub fn members(&self) -> Vec<(String, &Self)> {
        let mut out = Vec::new();
        for (name, scenario) in &self.scenarios {
            if scenario.load_cases.is_empty() {
                out.push((name.clone(), scenario));
            }
            out.extend(scenario.load_cases.iter().map(|(case, state)| (format!("{name}/{case}"), state)));
        }
        out.extend(self.load_cases.iter().map(|(name, state)| (name.clone(), state)));
        out
    }
}

fn said<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<u64>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}
