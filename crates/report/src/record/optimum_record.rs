//! [`OptimumRecord`]: how an optimisation went.

use crate::record::{ByName, IdentificationRecord, Nullable, Number, RangeRecord, SpectrumRecord};

records! {
    /// How an optimisation went.
    OptimumRecord {
        /// Norm of the projected gradient at the end.
        gradient_norm: Number,
        /// Why it ended.
        stop: Option<String>,
        /// Whether its own test was met.
        converged: Option<bool>,
        /// Iterations of the best start.
        iterations: Option<usize>,
        /// Its trials.
        trials: Option<usize>,
        /// Trials without an equilibrium.
        failed_solves: Option<usize>,
        /// Hessian products, whose two linear solves each are not among the work counted elsewhere.
        hessian_products: Option<usize>,
        /// Trials that led to a limit point.
        limit_points: Option<LimitPointsRecord>,
        /// Every stage of the smoothed distances.
        stages: Option<Vec<StageRecord>>,
        /// Every start, where there are several.
        starts: Option<Vec<StartRecord>>,
        /// Index of the best of them.
        best_start: Option<usize>,
        /// Of densities and mixtures: the cost where each cell is 0 or 1, of the volume of the field as nearly as cells allow (`"cut"` in the case); one more solve.
        cut_cost: Number,
        /// How many different minima they found.
        minima: Option<usize>,
        /// Constraints.
        constraints: ConstraintsRecord,
        /// Eigenvalues of the reduced Hessian, of `--spectrum`.
        spectrum: Option<SpectrumRecord>,
        /// What readings say of parameters, of `identify`; `identified.json` holds the same.
        identification: Option<IdentificationRecord>,
    }

    /// What the Taylor test said of the gradient.
    GradientCheckRecord {
        /// In a word.
        verdict: Option<String>,
        /// Relative difference of derivative and difference quotient.
        mismatch: Number,
    }

    /// Norms of the derivative.
    DerivativeNorm {
        /// Of its entries.
        euclidean: Number,
        /// Dual norm in the inner product of the controls.
        metric: Number,
    }

    /// Trials that led to a limit point.
    LimitPointsRecord {
        /// How many there were.
        trials: usize,
        /// What is known of the last one.
        last: LastLimitRecord,
    }

    /// A limit point in controls.
    LastLimitRecord {
        /// The scenario or load case; empty where there is but one.
        member: String,
        /// Controls that changed on the way there, with their values at the limit point.
        controls: Option<ByName<RangeRecord>>,
    }

    /// A stage.
    StageRecord {
        /// Its number.
        stage: usize,
        /// Its iterations.
        iterations: usize,
        /// Whether it met its test.
        converged: bool,
        /// Why it ended.
        why: String,
    }

    /// One of several starts of an optimisation.
    StartRecord {
        /// Its seed; null of the start as written.
        seed: Nullable<u64>,
        /// Cost at the start.
        start_cost: Number,
        /// Cost at the end.
        cost: Number,
        /// Norm of the projected gradient at the end.
        gradient_norm: Number,
        /// Iterations.
        iterations: Option<usize>,
        /// Trials.
        trials: Option<usize>,
        /// Whether its own test was met.
        converged: Option<bool>,
        /// Why it ended.
        stop: Option<String>,
        /// Whether it was ended because it could not reach the best one any more.
        stopped_early: Option<bool>,
        /// Largest violation of constraints.
        violation: Number,
        /// Its gradient check, of random starts.
        gradient_check: Option<GradientCheckRecord>,
        /// Why it could not begin.
        failed: Option<String>,
        /// Number of the minimum that it found, from the lowest cost.
        minimum: Option<usize>,
        /// Distance from the best control, as a share of the larger one.
        distance: Number,
    }

    /// Where a run went on.
    ResumedRecord {
        /// The start of an optimisation.
        start: Option<usize>,
        /// Its iteration.
        iteration: Option<usize>,
        /// Of a motion: the steps that were done, by member.
        steps: Option<Vec<usize>>,
    }

    /// Constraints.
    ConstraintsRecord {
        /// Largest violation over its scale.
        violation: Number,
        /// Penalty at the end.
        penalty: Number,
        /// Updates of multipliers.
        updates: Option<usize>,
        /// By group.
        groups: ByName<ConstraintGroupRecord>,
    }

    /// One group.
    ConstraintGroupRecord {
        /// What the values c below are: `at_most` (c = functional - bound <= 0; of an obstacle minus its distance), `at_least` (c = bound - functional <= 0) or `equal` (c = functional - bound = 0).
        sense: String,
        /// The bound of a functional.
        bound: Option<Number>,
        /// The functional itself, in a motion where it keeps its bound least.
        functional: Option<Number>,
        /// Number of constraints.
        count: usize,
        /// How many are active.
        active: usize,
        /// Largest violation.
        violation: Number,
        /// Largest value.
        largest: Number,
        /// Scale of the values.
        scale: Number,
        /// Their unit.
        unit: Nullable<String>,
        /// The worst of them.
        worst: Option<ConstraintValueRecord>,
        /// The least distance between nodes.
        between_nodes: Option<BetweenNodesRecord>,
        /// Values, of groups with few.
        values: Option<Vec<Number>>,
        /// Multipliers, of groups with few.
        multipliers: Option<Vec<Number>>,
        /// Instants of the values.
        t: Option<Vec<Number>>,
        /// Those with a multiplier, of groups with many.
        touching: Option<Vec<ConstraintValueRecord>>,
    }

    /// One constraint.
    ConstraintValueRecord {
        /// Its index in the group.
        index: usize,
        /// Its node.
        node: Nullable<u32>,
        /// Its value.
        value: Number,
        /// Its multiplier.
        multiplier: Number,
        /// Where the node is in the deformed body.
        position: Nullable<Vec<Number>>,
        /// The instant.
        t: Number,
    }

    /// The least distance of the body between nodes.
    BetweenNodesRecord {
        /// The distance.
        distance: Number,
        /// Where.
        position: Vec<Number>,
        /// The instant.
        t: Number,
    }
}
