//! [`ConstraintsReport`]: constraints at the end of a run.

use super::multipliers::Multipliers;
use crate::constrained::ConstraintGroup;
use serde::{Deserialize, Serialize};

/// A group of constraints at a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConstraintReport {
    /// Which.
    pub group: ConstraintGroup,
    /// The values c_k.
    pub values: Vec<f64>,
    /// The multipliers y_k, of `c <= 0` never negative: cost per unit of c.
    pub multipliers: Vec<f64>,
}

impl ConstraintReport {
    /// The largest violation, in the unit of the values.
    pub fn violation(&self) -> f64 {
        self.values.iter().map(|c| self.group.sense.violation(*c)).fold(0.0, f64::max)
    }

    /// How many multipliers are not zero.
    pub fn active(&self) -> usize {
        self.multipliers.iter().filter(|y| **y != 0.0).count()
    }
}

/// All constraints at a point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConstraintsReport {
    /// The groups; none without constraints.
    pub groups: Vec<ConstraintReport>,
    /// The largest violation, relative to the scales.
    pub violation: f64,
    /// The last penalty, in the unit of the cost.
    pub penalty: f64,
    /// Updates of the multipliers, or of the penalty alone where the method holds the constraints.
    pub updates: usize,
}

impl ConstraintsReport {
    /// Of values and multipliers y_k.
    pub(super) fn new(multipliers: &Multipliers, values: Vec<f64>, slopes: Vec<f64>, updates: usize) -> Self {
        let violation = multipliers.violation(&values);
        let mut groups = Vec::new();
        let mut first = 0;
        for group in multipliers.groups() {
            let own = first..first + group.len;
            let (values, multipliers) = (values[own.clone()].to_vec(), slopes[own].to_vec());
            groups.push(ConstraintReport { group: group.clone(), values, multipliers });
            first += group.len;
        }
        Self { groups, violation, penalty: multipliers.penalty, updates }
    }
}
