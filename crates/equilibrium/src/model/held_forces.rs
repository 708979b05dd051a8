//! The forces that supports exert.

use crate::model::views::PrescribedUnknowns;
use nastic_body::contribution::Demand;
use nastic_body::error::Inadmissible;
use nastic_body::instant::{Instant, TimeStep};
use nastic_body::state::State;

impl PrescribedUnknowns<'_> {
    /// The forces R that supports exert at held unknowns, `M a + C v + r(u; z_n, m)`, of a state by itself: velocities, accelerations and internal variables are
    /// those that it carries. Of an equilibrium `r(u, m)`. On free unknowns what is left of the equilibrium. Without friction, which takes the state before.
    ///
    /// # Errors
    /// [`Inadmissible`] where u is.
    pub fn held_forces(&self, state: &State) -> Result<Vec<f64>, Inadmissible> {
        let step = TimeStep { dt: f64::INFINITY, elapsed: f64::INFINITY, ..TimeStep::between(state, state) };
        let at = Instant::of(state);
        let at = if state.velocity.is_some() { at.in_step(&step) } else { at };
        Ok(self.model.evaluate(&at, Demand { energy: false, force: true })?.force)
    }
}
