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
        /// Where the energy of the motion came from and where it went.
        energy_balance: Option<EnergyBalanceRecord>,
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

    /// Energies at the end of a motion, works and losses from t = 0 to there: kinetic + elastic + contact + viscous_loss + friction_loss, less their values at
    /// t = 0, are the works + scheme + unbalanced.
    EnergyBalanceRecord {
        /// Kinetic energy.
        kinetic: Number,
        /// Stored without controls by laws, viscous branches, springs and foundations.
        elastic: Number,
        /// Stored in the layers of contacts.
        contact: Number,
        /// What viscous laws and Rayleigh damping dissipated.
        viscous_loss: Number,
        /// What friction dissipated.
        friction_loss: Number,
        /// Work of loads.
        load_work: Number,
        /// Work of the fluid in chambers.
        pressure_work: Number,
        /// Work of actuations, tendons and other controls.
        drive_work: Number,
        /// Work of surfaces that are held and moved.
        support_work: Number,
        /// Work of obstacles that move.
        obstacle_work: Number,
        /// What the time scheme added (above zero) or took.
        scheme: Number,
        /// What is left: zero to the accuracy of solves.
        unbalanced: Number,
        /// How `scheme` was found: by a `formula`, or as the `remainder` of all others.
        scheme_by: String,
        /// The largest difference of two values of an energy, work or loss over the motion; of the kinetic energy its largest value.
        span: Number,
        /// The most that the scheme added between two instants, with what losses gave back that fell.
        added: Number,
        /// The most that it took.
        taken: Number,
    }

    /// An estimated error of displacements.
    StepErrorRecord {
        /// The largest, a length.
        largest: Number,
        /// The end of that step.
        t: Number,
    }
}
