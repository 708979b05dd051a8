//! [`ContactRecord`]: a contact as it was understood; [`ExactContactRecord`]: an equilibrium without contact layers;
//! [`HalfThicknessRecord`]: a state whose layers are half as thick.

use crate::record::{ByName, ContributionRecord, Nullable, Number, Numbers};

records! {
    /// A contact as `check` describes it.
    ContactRecord {
        /// Its name.
        name: String,
        /// Thickness of its layer.
        thickness: Number,
        /// Stiffness of its layer.
        stiffness: Number,
        /// Number of its samples.
        samples: usize,
        /// How far inside the obstacle gaps count from, where the body touches at rest.
        inset: Number,
        /// How far the obstacle enters between samples.
        between_samples: Number,
        /// Coefficient of friction.
        friction: Nullable<f64>,
        /// Slip speed at which friction is full.
        slip_speed: Nullable<f64>,
        /// Whether friction takes the normal forces of the instant before.
        lagged: bool,
    }

    /// The equilibrium of `solve --exact-contact`.
    ExactContactRecord {
        /// Equilibria that it took.
        rounds: usize,
        /// Newton iterations of all of them.
        newton_iterations: usize,
        /// Largest gap left, as a share of the layer.
        violation: Number,
        /// Samples almost without a pressure.
        weakly_active: usize,
        /// Largest change of a displacement.
        largest_change: Number,
        /// By name what each contact carries, as under `contributions`.
        #[schemars(with = "Option<ByName<Numbers>>")]
        contacts: Option<ByName<ContributionRecord>>,
    }

    /// The state of `solve --half-thickness`, of a motion its end.
    HalfThicknessRecord {
        /// Newton iterations that it took.
        newton_iterations: usize,
        /// Largest change of a displacement.
        largest_change: Number,
        /// Largest displacement.
        largest_displacement: Number,
        /// By name what each contact carries, as under `contributions`.
        #[schemars(with = "Option<ByName<Numbers>>")]
        contacts: Option<ByName<ContributionRecord>>,
    }
}
