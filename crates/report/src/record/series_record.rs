//! [`SeriesRecord`]: equilibria along a parameter; [`ModesRecord`]: modes.

use crate::number::count;
use crate::record::{ByName, FailureRecord, Nullable, Number, RangeRecord, StateRecord};

records! {
    /// A ramp or a path.
    SeriesRecord {
        /// Of a ramp: its control.
        control: Option<String>,
        /// Of a ramp: the unit of its values.
        unit: Option<String>,
        /// Of a ramp: the first value.
        from: Number,
        /// Of a ramp: the last value.
        to: Number,
        /// The equilibria.
        points: Vec<PointRecord>,
        /// Of a ramp: values at which the count of negative pivots changes.
        critical: Option<Vec<PointRecord>>,
        /// Of a ramp: steps on which the body leaves its branch.
        jumps: Option<Vec<JumpRecord>>,
        /// Of a ramp: where and why it stopped.
        failed: Nullable<FailureRecord>,
        /// Of a path: limit points and bifurcations.
        events: Option<Vec<PointRecord>>,
        /// Of a path: why it stopped short of the end.
        stopped: Nullable<String>,
    }

    /// An equilibrium of them, or a critical one.
    PointRecord {
        /// `limit point` or `bifurcation`.
        kind: Option<String>,
        /// The parameter.
        value: Number,
        /// How well a critical value is known.
        error: Number,
        /// Controls at a critical point of a path.
        controls: Option<ByName<RangeRecord>>,
        /// Negative pivots before a critical point.
        before: Nullable<usize>,
        /// Negative pivots behind it.
        after: Nullable<usize>,
        /// Times the solve began anew.
        restarts: Option<usize>,
        /// What the state says of itself.
        #[serde(flatten)]
        state: StateRecord,
    }

    /// A step between branches.
    JumpRecord {
        /// Value before it.
        from: Number,
        /// Value behind it.
        to: Number,
    }

    /// What `solve --equilibria` found.
    EquilibriaRecord {
        /// How many were asked for.
        asked: usize,
        /// Those that were found.
        found: Vec<PointRecord>,
        /// Starts of the search.
        starts: Nullable<usize>,
        /// Newton iterations of the search.
        newton_iterations: Nullable<usize>,
    }

    /// Modes of the tangent, or of vibration.
    ModesRecord {
        /// The state that they are about: `equilibrium`, `equilibrium at t = 0` or `undeformed body`.
        about: Option<String>,
        /// Of `solve --modes`: eigenvalues, ascending, of K phi = lambda M phi, M the volumes of the nodes.
        eigenvalues: Option<Vec<Number>>,
        /// Of `solve --modes`: negative eigenvalues of K, unless `counted` those that were found.
        negative: Option<usize>,
        /// Whether the pivots of a factor show that no lower mode is missing.
        counted: Option<bool>,
        /// Of modes without a factor: iterations that found them.
        iterations: Option<usize>,
        /// Of modes without a factor, by mode: estimated relative error of the shape in the energy norm, whose square is about that of the value.
        errors: Option<Vec<Number>>,
        /// Unit of the eigenvalues.
        unit: Option<String>,
        /// Frequencies w/(2 pi) in Hz: 0 of neutral modes, such as rigid motions; null of unstable ones.
        frequencies: Option<Vec<Number>>,
        /// Growth rates of unstable modes in 1/s; null of others.
        growth_rates: Option<Vec<Number>>,
        /// phi . M phi with a largest component of 1, in kg (plane strain: kg/m).
        modal_masses: Option<Vec<Number>>,
        /// Shares of the kinetic energy along x, y, z.
        directions: Option<Vec<Vec<Number>>>,
        /// Modes whose frequency is zero within rounding, as of rigid motions that the supports leave free.
        neutral: Option<usize>,
        /// Modes that grow.
        unstable: Option<usize>,
        /// Units.
        units: Option<ModesUnits>,
        /// The modes as the steps of a motion move them.
        in_steps: Option<VibrationInSteps>,
    }

    /// Units of modes.
    ModesUnits {
        /// Of frequencies.
        frequency: String,
        /// Of growth rates.
        growth_rate: String,
        /// Of modal masses.
        modal_mass: String,
    }

    /// Modes as the steps of a motion move them: q'' + d q' + w^2 q = 0.
    VibrationInSteps {
        /// The time scheme.
        scheme: String,
        /// The step.
        step: Number,
        /// d/w of Rayleigh damping.
        damping: Vec<Number>,
        /// d/w with that of the steps.
        damping_seen: Vec<Number>,
        /// The frequency seen, as a share.
        frequency_ratio: Vec<Number>,
        /// Of motions: the frequencies in Hz.
        frequencies: Option<Vec<Number>>,
    }
}

impl ModesRecord {
    /// What is said of how modes were found: which are zero, and without a factor in how many iterations and how well.
    pub fn how_found(&self) -> String {
        let mut said = match self.neutral {
            None | Some(0) => String::new(),
            Some(1) => "; one is zero within rounding, as a rigid motion is".to_owned(),
            Some(n) => format!("; {n} are zero within rounding, as rigid motions are"),
        };
        if self.counted == Some(true) {
            said += "; counted by a factor";
        } else if self.counted == Some(false) {
            let errors = self.errors.iter().flatten().filter_map(|error| **error);
            let error = errors.fold(0.0, f64::max);
            let iterations = count(self.iterations.unwrap_or_default(), "iteration");
            said += &format!(
                "; without a factor, in {iterations}, shapes to about {error:.1e} in the energy norm: nothing proves that no lower one is missing"
            );
        }
        said
    }
}
