//! The block `time`, and what it needs of materials.

use crate::schema::field::{Parameter, VectorField};
use crate::schema::named::SchemeName;
use crate::schema::read::Reader;
use nastic_fem::{FemError, Scheme};

object! {
    /// A motion from t = 0 instead of an equilibrium.
    pub struct Time one of [step, tolerance] checked by check {
        /// The last instant.
        pub end: f64 as POSITIVE_TIME,
        /// Length of a step, a whole part of the end.
        pub step: Option<f64> as POSITIVE_TIME,
        /// The estimated error that a step may add to the displacement at any node: the lengths of the steps are found with it at the start controls, once. With "tr_bdf2".
        pub tolerance: Option<f64> as POSITIVE_LENGTH,
        /// The longest step beside a tolerance; a fiftieth of the end if left out.
        pub longest: Option<f64> as POSITIVE_TIME,
        /// How steps are made; if left out "tr_bdf2", beside "contact" and without a tolerance "backward_euler", which creates no energy there.
        pub scheme: Option<SchemeName>,
        /// Of "newmark": v = v_n + h ((1 - gamma) a_n + gamma a), at least 1/2; 0.6 if left out.
        pub gamma: Option<f64> as POSITIVE,
        /// Of "newmark": u = u_n + h v_n + h^2 ((1/2 - beta) a_n + beta a), at least gamma/2; (gamma + 1/2)^2/4 if left out.
        pub beta: Option<f64> as POSITIVE,
        /// Of "generalized_alpha": what is left in a step of the amplitude of what the step does not resolve, from 0 to 1; 0.8 if left out.
        pub rho: Option<f64> as NOT_NEGATIVE,
        /// Time between the states that are written and shown, a multiple of the step (beside a tolerance steps lead there); about 50 of them if left out.
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
        /// What of its strain the spring resists to.
        pub measure: SpringMeasure = SpringMeasure::Hencky,
    }
}

choice! {
    /// What of its strain the spring of a Maxwell branch resists to; at small strains all are alike.
    pub enum SpringMeasure {
        /// Logarithmic strains.
        "hencky" => Hencky,
        /// Squares of stretches: it stiffens in tension.
        "neo_hooke" => NeoHooke,
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
/// The longest step beside a tolerance, as a part of the end.
const LONGEST: f64 = 1.0 / 50.0;

/// Newmark's gamma where the case does not say it, as in the catalogue.
const GAMMA: f64 = 0.6;

impl Time {
    /// The name of the scheme.
    #[must_use]
    pub fn scheme(&self) -> SchemeName {
        self.scheme.unwrap_or_default()
    }

    /// With the scheme that is taken where the case names none.
    pub(crate) fn choose_scheme(&mut self, touches: bool) {
        if touches && self.tolerance.is_none() {
            self.scheme = self.scheme.or_else(|| Some(SchemeName::beside_contact()));
        }
    }

    /// The scheme with its parameters.
    ///
    /// # Errors
    /// Parameters beyond those with which long steps are stable.
    pub fn built_scheme(&self) -> Result<Scheme, FemError> {
        match (self.scheme().name(), self.gamma.or(self.beta), self.rho) {
            ("newmark", Some(_), _) => {
                let gamma = self.gamma.unwrap_or(GAMMA);
                Scheme::newmark(self.beta.unwrap_or(0.25 * (gamma + 0.5).powi(2)), gamma)
            }
            ("generalized_alpha", _, Some(rho)) => Scheme::generalized_alpha(rho),
            _ => self.scheme().scheme(),
        }
    }

    /// The instants that steps must lead through on behalf of this block: all of equal steps; beside a tolerance those that are written.
    #[must_use]
    pub fn instants(&self) -> Vec<f64> {
        let equal = |count: usize| (0..=count).map(|n| self.end * n as f64 / count as f64).collect();
        match (self.step, self.output) {
            (Some(step), _) => equal((self.end / step).round().max(1.0) as usize),
            (None, Some(output)) => {
                let before = (0..).map(|n| output * f64::from(n)).take_while(|t| *t < self.end * (1.0 - WHOLE));
                before.chain([self.end]).collect()
            }
            (None, None) => equal(1),
        }
    }

    /// The longest step beside a tolerance.
    #[must_use]
    pub fn longest(&self) -> f64 {
        self.longest.unwrap_or(LONGEST * self.end)
    }

    /// Which of the instants of a motion are written.
    #[must_use]
    pub fn shown(&self, instants: &[f64]) -> Vec<bool> {
        let last = instants.len().saturating_sub(1);
        let stride = match (self.output, self.step) {
            (Some(output), Some(step)) => (output / step).round().max(1.0) as usize,
            (Some(output), None) => {
                let near = |t: f64| (t - output * (t / output).round()).abs() <= WHOLE * output;
                return instants.iter().enumerate().map(|(n, t)| n == last || near(*t)).collect();
            }
            (None, _) => last.div_ceil(SHOWN).max(1),
        };
        (0..=last).map(|n| n.is_multiple_of(stride) || n == last).collect()
    }
}

fn check(time: &Time, reader: &mut Reader<'_>) {
    let mut time = time.clone();
    time.choose_scheme(reader.document.root().find("contact").is_some());
    let time = &time;
    for (key, value, of) in
        [("gamma", time.gamma, "newmark"), ("beta", time.beta, "newmark"), ("rho", time.rho, "generalized_alpha")]
    {
        if value.is_some() && time.scheme().name() != of {
            let message =
                format!("is a parameter of \"{of}\", and the scheme is \"{}\": leave it out", time.scheme().name());
            reader.complain_at(&time.at.key(key), message);
        }
    }
    match time.step {
        Some(step) => check_equal_steps(time, step, reader),
        None => check_tolerance(time, reader),
    }
}

fn check_equal_steps(time: &Time, step: f64, reader: &mut Reader<'_>) {
    let whole = |number: f64| (number - number.round()).abs() <= WHOLE * number && number >= 1.0 - WHOLE;
    let steps = time.end / step;
    if !whole(steps) {
        let near = time.end / steps.ceil();
        let message = format!("the end {} is no multiple of the step {step}: take {near}", time.end);
        reader.complain_at(&time.at.key("step"), message);
    } else if steps > MOST_STEPS {
        let message = format!("{} steps are more than {MOST_STEPS}: take longer ones", steps.round());
        reader.complain_at(&time.at.key("step"), message);
    }
    if let Some(output) = time.output.filter(|output| !whole(output / step)) {
        let message = format!("{output} is no multiple of the step {step}");
        reader.complain_at(&time.at.key("output"), message);
    }
    if time.longest.is_some() {
        let message = "all steps have one length, \"step\": leave this out, or give a \"tolerance\" instead of it";
        reader.complain_at(&time.at.key("longest"), message);
    }
}

fn check_tolerance(time: &Time, reader: &mut Reader<'_>) {
    if time.built_scheme().is_ok_and(|scheme| !scheme.estimates_error()) {
        let message = format!(
            "\"{}\" does not estimate the error of its steps: take \"tr_bdf2\", or a \"step\" instead of a \"tolerance\"",
            time.scheme().name()
        );
        reader.complain_at(&time.at.key("scheme"), message);
    }
    for (key, length) in [("output", time.output), ("longest", time.longest)] {
        if length.is_some_and(|length| time.end / length > MOST_STEPS) {
            let message = format!("more than {MOST_STEPS} steps until the end: take a longer time");
            reader.complain_at(&time.at.key(key), message);
        }
    }
}

/// More are a mistake in a unit.
pub(super) const MOST_STEPS: f64 = 1e6;
