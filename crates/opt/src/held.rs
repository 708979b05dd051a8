//! [`Held`]: constraints that a method holds itself, at an accepted control.

use nastic_numeric::vector::axpy;
use serde::{Deserialize, Serialize};

/// Constraints `d_k <= 0` that a method holds itself (each relative to its [scale](crate::ConstraintGroup::scale)), linearised at an accepted control.
/// Beside them the cost of a run is that of an exact penalty, `j(m) + r sum_k max(0, d_k(m))`. Without values where there are none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Held {
    /// d_k.
    pub values: Vec<f64>,
    /// `dd_k/dm`, a dual vector each.
    pub rows: Vec<Vec<f64>>,
    /// `dj/dm` of the cost without the penalty, a dual vector.
    pub cost_derivative: Vec<f64>,
    /// The multipliers l_k, between 0 and r, in the unit of the cost: the method's own.
    pub multipliers: Vec<f64>,
    /// r, in the unit of the cost: what a violation by one scale costs, and the largest multiplier.
    pub penalty: f64,
}

impl Held {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// `dj/dm + sum_k l_k dd_k/dm`.
    pub fn lagrangian(&self) -> Vec<f64> {
        let mut out = self.cost_derivative.clone();
        self.multipliers
            .iter()
            .zip(&self.rows)
            .filter(|(l, _)| **l != 0.0)
            .for_each(|(l, row)| axpy(*l, row, &mut out));
        out
    }

    /// The cost j of a point whose cost with the penalty is this.
    pub fn without_penalty(&self, cost: f64, values: &[f64]) -> f64 {
        let violation: f64 = values.iter().map(|d| d.max(0.0)).sum();
        if violation > 0.0 { cost - self.penalty * violation } else { cost }
    }

    /// The largest violation of those whose multiplier is below r: at r the penalty does not outweigh it, which the driver of the run looks for.
    pub fn unmet(&self) -> f64 {
        let of = |(d, l): (&f64, &f64)| d.min(1.0 - l / self.penalty).max(0.0);
        self.values.iter().zip(&self.multipliers).map(of).fold(0.0, f64::max)
    }

    /// `sum_k l_k max(0, -d_k)`: what the slack of constraints with multipliers may yet win of the cost.
    pub fn gap(&self) -> f64 {
        self.values.iter().zip(&self.multipliers).map(|(d, l)| l * (-d).max(0.0)).sum()
    }
}
