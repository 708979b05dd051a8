//! [`KineticEnergy`]: a cost of a body that moves.

use super::Timeline;
use super::schedule::{Schedule, When};
use super::trajectory_cost::{TrajectoryContext, TrajectoryCost, TrajectoryPartials};
use crate::cost::{CostForm, Counts, check_weight};
use nastic_fem::Inadmissible;
use nastic_fields::{ControlError, Layout};
use nastic_numeric::vector::axpy;

/// `j = weight v . M v / 2` at the end, as an integral over the time, or at instants: a body that is to come to rest, or not to move.
///
/// Units: the weight's times N m (times s as an integral).
#[derive(Debug, Clone)]
pub struct KineticEnergy {
    when: When,
    weight: f64,
}

impl KineticEnergy {
    /// At some part of the motion.
    ///
    /// # Errors
    /// A weight that is not positive.
    pub fn new(when: When, weight: f64) -> Result<Self, ControlError> {
        Ok(KineticEnergy { when, weight: check_weight("kinetic_energy", weight)? })
    }

    fn schedule(&self, timeline: &Timeline) -> Result<Schedule, ControlError> {
        Schedule::new(self.when.clone(), timeline)
    }
}

/// How it stands in case files.
pub(crate) const FORM: CostForm = CostForm::of_motion("kinetic_energy", "weight times the kinetic energy", &[], |on| {
    Ok(Box::new(KineticEnergy::new(on.when.clone(), on.weight)?))
})
.counts(Counts::AtEnd)
.words(|_| "kinetic energy of the body".to_owned());

impl TrajectoryCost for KineticEnergy {
    fn name(&self) -> &str {
        "kinetic_energy"
    }

    fn check(&self, _: &Layout, timeline: &Timeline) -> Result<(), ControlError> {
        if timeline.scheme().is_quasi_static() {
            let name = timeline.scheme().name();
            let what = format!("the kinetic energy of a motion by {name}, which has none: leave it out");
            return Err(ControlError::Cost { what });
        }
        self.schedule(timeline).map(drop)
    }

    fn value(&self, at: &TrajectoryContext) -> Result<f64, ControlError> {
        let mut sum = 0.0;
        let schedule = self.schedule(at.timeline)?;
        for (n, weight) in &schedule.weights {
            let state = &at.trajectory.states()[*n];
            sum += weight * schedule.shape(self.weight * at.solid.model().energies().kinetic_energy(state)?).0;
        }
        Ok(sum)
    }

    fn add_partials(&self, at: &TrajectoryContext, out: &mut TrajectoryPartials) -> Result<(), ControlError> {
        let (schedule, energies) = (self.schedule(at.timeline)?, at.solid.model().energies());
        let of_instant = at.layout.of_instant();
        for (n, weight) in &schedule.weights {
            let state = &at.trajectory.states()[*n];
            let Some(velocity) = &state.velocity else { continue }; // at rest
            let energy = self.weight * energies.kinetic_energy(state)?;
            let v = at.solid.model().nodal(velocity);
            let mut momentum = vec![0.0; v.len()];
            energies.mass_under(&state.controls)?.multiply(v, &mut momentum);
            let by_velocity = &mut out.states[*n].velocity;
            by_velocity.resize(state.u.len(), 0.0);
            let factor = weight * schedule.shape(energy).1 * self.weight;
            axpy(factor, &momentum, &mut by_velocity[..v.len()]);
            if let Some(by_points) = energies.kinetic_by_controls(state).map_err(inadmissible)? {
                let t = at.timeline.instants()[*n];
                let mut by_instant = of_instant.control_vjp(&at.layout.at(at.m, t)?, &by_points);
                by_instant.iter_mut().for_each(|d| *d *= factor);
                at.layout.add_at(t, &by_instant, &mut out.m);
            }
        }
        Ok(())
    }
}

/// A state that was found is admissible.
fn inadmissible(error: Inadmissible) -> ControlError {
    ControlError::Cost { what: error.to_string() }
}
