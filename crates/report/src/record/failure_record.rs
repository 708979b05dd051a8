//! [`FailureRecord`]: why a state solve failed.

use crate::record::Number;

records! {
    /// What a state solve that failed reports.
    FailureRecord {
        /// Its kind, a stable name.
        kind: String,
        /// The scenario or load case.
        member: Option<String>,
        /// Of a motion: when the step that failed begins.
        t: Number,
        /// Of a motion: the length of the step.
        step: Number,
        /// Where no equilibrium was found, as a share of the way from the starting state.
        load: Number,
        /// The last equilibrium, as a share of that way.
        reached: Number,
        /// Load steps that were cut.
        load_steps_cut: Option<usize>,
        /// Newton iterations of the solve.
        newton_iterations: Option<usize>,
        /// Relative residual at its end.
        residual: Number,
        /// Why, as far as it is known: `limit_point`, `convexity_bound`, `guides_meet`, `free_motion`, `saddle`, `unknown`.
        cause: Option<String>,
        /// Where the path of equilibria turns back, an estimated share of that way.
        limit_point: Number,
        /// Tensions beyond what the law bears, at the point where they are exceeded most.
        convexity_bound: Option<ExcessTensionRecord>,
        /// Guides of a tendon or ends of a spring that meet.
        guides_meet: Option<MeetingGuidesRecord>,
        /// What contact alone holds and nothing that touches it.
        free_motion: Option<FreeMotionRecord>,
        /// Negative pivots of the last equilibrium, where a stable one was sought.
        inertia: Option<usize>,
        /// The cell that inverted.
        cell: Option<usize>,
        /// Its quadrature point.
        point: Option<usize>,
        /// J there.
        #[serde(rename = "J")]
        jacobian: Number,
        /// The obstacle or surface that was crossed.
        penetrates: Option<PenetrationRecord>,
        /// The bound of a law that was left.
        domain: Option<DomainRecord>,
        /// The cells with the smallest J of the last good state.
        worst_cells: Option<Vec<CellRecord>>,
        /// Of a ramp: the value that was sought, with its unit.
        at: Option<String>,
        /// Of a ramp: the reason, in values of the control.
        why: Option<String>,
        /// Of a ramp: the value at which no equilibrium was found.
        value: Number,
        /// Of a ramp: the value of the last equilibrium.
        last_value: Number,
        /// Of a ramp: the value at which its path turns back.
        limit_value: Number,
    }

    /// A fibre tension beyond its bound.
    ExcessTensionRecord {
        /// The actuation with the largest tension there.
        actuation: String,
        /// Its tension.
        tension: Number,
        /// What it may reach, while those beside it change in proportion.
        limit: Number,
        /// The other families that lengthen there.
        beside: Vec<TensionRecord>,
    }

    /// The tension of a family.
    TensionRecord {
        /// Its actuation.
        actuation: String,
        /// Its tension.
        tension: Number,
    }

    /// Guides that meet.
    MeetingGuidesRecord {
        /// The tendon or spring.
        name: String,
        /// Where they are in the reference body.
        places: Vec<Vec<Number>>,
        /// Their distance over that in the reference body.
        share: Number,
    }

    /// Rigid motions that nothing resists to.
    FreeMotionRecord {
        /// How many.
        count: usize,
        /// The connected parts of the body, or the rigid bodies.
        what: String,
        /// Those of the first part, as far as they are along an axis, in words.
        example: String,
    }

    /// A penetration.
    PenetrationRecord {
        /// The contact.
        name: String,
        /// Where.
        place: Vec<Number>,
        /// How deep.
        depth: Number,
    }

    /// The bound of a law.
    DomainRecord {
        /// The law.
        law: String,
        /// What is bounded.
        measure: String,
        /// What was found.
        value: Number,
        /// What it must stay below.
        limit: Number,
    }

    /// A cell and its smallest J.
    CellRecord {
        /// Its number.
        cell: usize,
        /// The smallest J.
        #[serde(rename = "min_J")]
        min_j: Number,
    }
}

impl FreeMotionRecord {
    /// Of an equilibrium.
    pub fn words(&self) -> String {
        let FreeMotionRecord { count, what, example } = self;
        format!("nothing resists {count} rigid motion(s) of {what} ({example}); it rests where it came to")
    }
}
