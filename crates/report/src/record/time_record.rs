//! [`TimeRecord`]: a motion.

use crate::record::{Number, VibrationInSteps};

records! {
    /// A motion.
    TimeRecord {
        /// Its end.
        end: Number,
        /// Steps that were done.
        steps: usize,
        /// The time scheme.
        scheme: String,
        /// The mass matrix: `lumped` or `consistent`.
        mass: String,
        /// States that were written.
        written: usize,
        /// Energies at the beginning and at the end.
        energies: EnergiesRecord,
        /// The step, of a motion without a `tolerance`.
        step: Number,
        /// The tolerance of steps that adapt.
        tolerance: Number,
        /// The shortest of these.
        shortest: Number,
        /// The longest.
        longest: Number,
        /// Steps that were rejected for their error when they were found.
        rejected: Option<usize>,
        /// Steps without a solution.
        failed: Option<usize>,
        /// The largest estimated error that a step adds to the displacement of a node (of `tr_bdf2`).
        step_error: Option<StepErrorRecord>,
        /// The lowest vibrations as the steps move them.
        damping: Option<VibrationInSteps>,
    }

    /// Energies of a motion.
    EnergiesRecord {
        /// At the beginning.
        start: EnergyRecord,
        /// At the end.
        end: EnergyRecord,
    }

    /// Energies of a state.
    EnergyRecord {
        /// Kinetic energy.
        kinetic: Number,
        /// Potential of passive laws, actuations and loads.
        potential: Number,
    }

    /// An estimated error of displacements.
    StepErrorRecord {
        /// The largest, a length.
        largest: Number,
        /// The end of that step.
        t: Number,
    }
}
