//! [`TrialRecord`]: a line of `history.jsonl`.

use crate::record::{Nullable, Number, Numbers};

records! {
    /// A trial of an optimisation.
    TrialRecord {
        /// Its number.
        trial: usize,
        /// The iteration that it belongs to.
        iteration: usize,
        /// The stage of the smoothed distances.
        stage: usize,
        /// Whether it became the new point.
        accepted: bool,
        /// Why, or why not.
        reason: String,
        /// What is made small: the objective, with constraints the augmented Lagrangian; null where there is no equilibrium.
        cost: Number,
        /// Its terms.
        terms: Option<Numbers>,
        /// Norm of the projected gradient.
        gradient_norm: Number,
        /// The same over the first.
        relative_gradient: Number,
        /// Step length.
        step: Number,
        /// Predicted change of the cost.
        predicted: Number,
        /// Newton iterations; of a failed trial those that its error reports.
        newton: Nullable<u64>,
        /// Factorisations.
        factorisations: Nullable<u64>,
        /// Solves with a factor.
        back_substitutions: Nullable<u64>,
        /// The smallest J.
        #[serde(rename = "min_J")]
        min_j: Number,
        /// Values on their bounds.
        active: usize,
        /// Wall time.
        seconds: Number,
        /// Hausdorff distance from the target.
        hausdorff_true: Number,
        /// Root mean square distance of tracked points.
        tracking_root_mean_square: Number,
        /// Largest distance of a tracked point.
        tracking_largest: Number,
        /// Largest distance of a position from its target; of a motion at its end.
        position_distance: Number,
        /// Negative pivots of the tangent, of accepted points.
        inertia: Nullable<usize>,
        /// Whether the point lies on another branch than the one before; null where that is not known, left out where it does not.
        branch_changed: Nullable<bool>,
        /// Costs of the scenarios.
        scenarios: Option<Vec<Number>>,
        /// With constraints: the objective without them.
        objective: Number,
        /// Their largest violation.
        violation: Number,
        /// Their penalty.
        penalty: Number,
        /// Index of the start, where there are several.
        start: Option<usize>,
    }
}
