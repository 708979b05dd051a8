//! [`LoadCase`] and [`Member`]: the problems an ensemble is made of.

use nastic_control::Reduced;
use std::collections::BTreeSet;

/// One load case of a scenario: a problem with its weight in the scenario's cost.
#[derive(Debug)]
pub struct LoadCase {
    pub(crate) name: String,
    pub(crate) weight: f64,
    pub(crate) problem: Reduced,
    pub(crate) own: BTreeSet<String>,
}

impl LoadCase {
    /// A load case; its controls are shared with all members that have controls of the same names.
    pub fn new(name: &str, weight: f64, problem: Reduced) -> Self {
        LoadCase { name: name.to_owned(), weight, problem, own: BTreeSet::new() }
    }

    /// Makes a control this load case's own: other load cases do not see it, the same load case of other scenarios
    /// does. In the ensemble it is called `LOAD_CASE/CONTROL`.
    pub fn own(mut self, control: &str) -> Self {
        self.own.insert(control.to_owned());
        self
    }
}

/// A member as the ensemble keeps it: one load case of one scenario.
#[derive(Debug)]
pub struct Member {
    pub(crate) name: String,
    pub(crate) case: String,
    pub(crate) scenario: usize,
    pub(crate) weight: f64,
    pub(crate) problem: Reduced,
    /// For each control field of the problem, the block of the ensemble.
    pub(crate) blocks: Vec<usize>,
}

impl Member {
    /// `SCENARIO`, `LOAD_CASE` or `SCENARIO/LOAD_CASE`; empty where there is but one member without a name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name of its load case, empty where a scenario has but one.
    pub fn load_case(&self) -> &str {
        &self.case
    }

    /// Index of its scenario.
    pub fn scenario(&self) -> usize {
        self.scenario
    }

    /// Weight of its cost in that of the scenario.
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// The problem.
    pub fn problem(&self) -> &Reduced {
        &self.problem
    }

    /// Index of the ensemble's block for each control field of the problem.
    pub fn blocks(&self) -> &[usize] {
        &self.blocks
    }
}
