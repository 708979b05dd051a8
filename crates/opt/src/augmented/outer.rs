//! [`Outer`]: where the updates of multipliers and penalty stand, and what comes next; [`AugmentedState`]: a saved run under constraints.

use super::AugmentedLagrangian;
use super::multipliers::Multipliers;
use crate::saved::Saved;
use crate::state::RunState;
use serde::{Deserialize, Serialize};

/// Consecutive tenfold increases of the penalty without effect on the violation, after which the problem counts as infeasible.
const MAX_STAGNANT_STEPS: usize = 3;
/// Ratio of a violation to the one before above which the penalty had no effect.
const STAGNATION_RATIO: f64 = 0.9;
/// Largest multiplier over the first penalty.
const MAX_MULTIPLIER_RATIO: f64 = 1e10;

/// Where the updates stand.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Outer {
    /// Updates done.
    pub updates: usize,
    /// The first penalty.
    pub first_penalty: f64,
    /// The projected gradient of the cost at the start; that of the augmented Lagrangian where it is zero.
    pub first_gradient: f64,
    /// Violation and failing complementarity at the last update; infinite before.
    pub measure: f64,
    /// Violation at the last update; infinite before.
    pub violation: f64,
    /// Consecutive increases of the penalty that hardly changed the violation.
    pub stagnant: usize,
    /// Whether the penalty grew at the last update.
    pub grew: bool,
    /// Iterations of the run at which the optimiser is to stop for the next update.
    pub limit: usize,
}

impl Outer {
    /// Looks at the values c that a converged or stalled inner run ended with; whether they cannot be made feasible.
    pub fn is_infeasible(&mut self, options: &AugmentedLagrangian, multipliers: &Multipliers, c: &[f64]) -> bool {
        let violation = multipliers.violation(c);
        let stays = self.grew && violation > options.feasibility && violation > STAGNATION_RATIO * self.violation;
        self.stagnant = if stays { self.stagnant + 1 } else { 0 };
        self.stagnant >= MAX_STAGNANT_STEPS
    }

    /// Multipliers and penalty after an update at values c. Where the optimiser was cut short (not `settled`), they say nothing of
    /// the penalty, which stays.
    pub fn update(
        &mut self,
        options: &AugmentedLagrangian,
        multipliers: &Multipliers,
        c: &[f64],
        settled: bool,
    ) -> (Vec<f64>, f64) {
        let measure = multipliers.measure(c);
        let values = multipliers.updated(c, MAX_MULTIPLIER_RATIO * self.first_penalty);
        self.grew = settled && measure > options.decrease * self.measure;
        self.measure = measure;
        self.violation = multipliers.violation(c);
        self.updates += 1;
        (values, multipliers.penalty * if self.grew { options.growth } else { 1.0 })
    }

    /// The penalty after a run of a method that holds the constraints ended where they are violated: its multipliers are at their largest.
    pub fn stiffen(&mut self, options: &AugmentedLagrangian, multipliers: &Multipliers, c: &[f64]) -> f64 {
        self.grew = true;
        self.violation = multipliers.violation(c);
        self.updates += 1;
        multipliers.penalty * options.growth
    }
}

/// Everything a run under constraints needs to continue with the same bits.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AugmentedState {
    /// The optimiser's run.
    pub run: RunState,
    pub(super) outer: Option<SavedOuter>,
}

/// The constraints' part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SavedOuter {
    pub outer: Outer,
    pub multipliers: Vec<f64>,
    pub penalty: f64,
}

impl Saved for AugmentedState {
    const KIND: &'static str = "nastic-augmented-run-3";
}
