//! The block `time`, and what it needs of materials.

use crate::schema::field::{Parameter, VectorField};
use crate::schema::named::SchemeName;
use crate::schema::read::Reader;

object! {
    /// A motion from t = 0 instead of an equilibrium.
    pub struct Time checked by check {
        /// The last instant.
        pub end: f64 as POSITIVE_TIME,
        /// Length of a step, a whole part of the end.
        pub step: f64 as POSITIVE_TIME,
        /// How steps are made.
        pub scheme: SchemeName = SchemeName::default(),
        /// Time between the states that are written and shown, a multiple of the step; about 50 of them if left out.
        pub output: Option<f64> as POSITIVE_TIME,
        /// The state at t = 0.
        pub start: Beginning = Beginning::Equilibrium,
        /// Velocity at t = 0; zero if left out.
        pub velocity: Option<VectorField> as VELOCITY,
        /// How mass is distributed.
        pub mass: MassKind = MassKind::Consistent,
        /// Megabytes that the states of a motion may take, of each member; those that do not fit are computed again for the derivative, to the same bits.
        pub memory: Option<f64> as POSITIVE,
        /// Rayleigh damping of the whole body.
        pub rayleigh: Option<Rayleigh>,
    }
}

choice! {
    /// The state at t = 0.
    pub enum Beginning {
        /// The equilibrium under loads and controls at t = 0.
        "equilibrium" => Equilibrium,
        /// Undeformed, whatever loads and controls do from t = 0 on.
        "rest" => Rest,
    }
}

choice! {
    /// How mass is distributed.
    pub enum MassKind {
        /// With the shape functions: the consistent mass matrix.
        "consistent" => Consistent,
        /// On the nodes: a diagonal mass matrix.
        "lumped" => Lumped,
    }
}

object! {
    /// Forces (a0 M + a1 K) v, M the mass and K the stiffness at rest; not objective: a1 damps finite rotations, a0 every rigid motion.
    pub struct Rayleigh {
        /// a0, in proportion to the mass.
        pub mass: f64 as NOT_NEGATIVE_RATE = 0.0,
        /// a1, in proportion to the stiffness.
        pub stiffness: f64 as NOT_NEGATIVE_TIME = 0.0,
    }
}

object! {
    /// A spring in series with a dashpot, beside the passive law, in the change of shape.
    pub struct Maxwell {
        /// Shear modulus of the spring.
        pub shear: Parameter as POSITIVE_PRESSURE,
        /// Time in which its stress falls to 1/e.
        pub relaxation: Parameter as POSITIVE_TIME,
    }
}

object! {
    /// A dashpot beside the passive law.
    pub struct KelvinVoigt {
        /// Viscosity of shape.
        pub shear: Option<Parameter> as VISCOSITY,
        /// Viscosity of volume.
        pub bulk: Option<Parameter> as VISCOSITY,
    }
}

/// A number of steps is whole up to this.
const WHOLE: f64 = 1e-6;
/// States shown where the case does not say how many.
const SHOWN: usize = 50;

impl Time {
    /// Number of steps.
    #[must_use]
    pub fn steps(&self) -> usize {
        (self.end / self.step).round().max(1.0) as usize
    }

    /// Steps from one state that is written to the next.
    #[must_use]
    pub fn stride(&self) -> usize {
        match self.output {
            Some(output) => (output / self.step).round().max(1.0) as usize,
            None => self.steps().div_ceil(SHOWN),
        }
    }
}

fn check(time: &Time, reader: &mut Reader<'_>) {
    let whole = |number: f64| (number - number.round()).abs() <= WHOLE * number && number >= 1.0 - WHOLE;
    if !whole(time.end / time.step) {
        let near = time.end / (time.end / time.step).ceil();
        let message = format!("the end {} is no multiple of the step {}: take {near}", time.end, time.step);
        reader.complain_at(&time.at.key("step"), message);
    } else if time.steps() > MOST_STEPS {
        let message = format!("{} steps are more than {MOST_STEPS}: take longer ones", time.steps());
        reader.complain_at(&time.at.key("step"), message);
    }
    if let Some(output) = time.output.filter(|output| !whole(output / time.step)) {
        let message = format!("{output} is no multiple of the step {}", time.step);
        reader.complain_at(&time.at.key("output"), message);
    }
}

/// More are a mistake in a unit.
const MOST_STEPS: usize = 1_000_000;
