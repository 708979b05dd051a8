//! The block `expect`.

use crate::schema::read::Reader;

object! {
    /// A value the result must have; the key is its path in `result.json`.
    pub struct Expectation checked by check {
        /// The command it belongs to; every command with such a value if left out.
        pub command: Option<Command>,
        /// The value, in the case's units.
        pub value: f64,
        /// Largest deviation.
        pub absolute: Option<f64> as ANY_NOT_NEGATIVE,
        /// Largest deviation as a fraction of the value.
        pub relative: Option<f64> as NOT_NEGATIVE,
    }
}

choice! {
    /// Commands with results.
    pub enum Command {
        /// nastic check
        "check" => Check,
        /// nastic solve
        "solve" => Solve,
        /// nastic modes
        "modes" => Modes,
        /// nastic gradient
        "gradient" => Gradient,
        /// nastic gradcheck
        "gradcheck" => Gradcheck,
        /// nastic optimize
        "optimize" => Optimize,
        /// nastic identify
        "identify" => Identify,
        /// nastic gains
        "gains" => Gains,
    }
}

impl Command {
    /// Whether it runs the optimiser.
    #[must_use]
    pub fn optimizes(&self) -> bool {
        matches!(self, Self::Optimize | Self::Identify)
    }
}

impl Expectation {
    /// True if `found` is near enough: within the larger of both tolerances.
    #[must_use]
    pub fn is_met_by(&self, found: f64) -> bool {
        let relative = self.relative.map_or(0.0, |part| part * self.value.abs());
        (found - self.value).abs() <= self.absolute.unwrap_or(0.0).max(relative)
    }
}

fn check(expectation: &Expectation, reader: &mut Reader<'_>) {
    if expectation.absolute.is_none() && expectation.relative.is_none() {
        reader.complain_at(&expectation.at, "a tolerance is needed: \"absolute\" or \"relative\"");
    }
}
