//! What a solve may be asked.

use crate::model::Model;
use crate::model::views::Checks;
use crate::search::options::SolveOptions;
use nastic_body::controls::Controls;
use nastic_body::error::{FemError, StateError};
use nastic_body::state::State;

impl Model {
    /// Refuses what this model cannot be asked.
    pub(super) fn check_request(&self, controls: &Controls, how: &SolveOptions) -> Result<(), StateError> {
        self.check_solver(how.solver)?;
        self.check_spans_ranks(how.solver)?;
        self.checks().check_controls(controls)?;
        self.check_constraints(controls)?;
        let expected = self.unknowns().len();
        if let Some(guess) = how.guess.filter(|guess| guess.len() != expected) {
            let what = "guess of the displacement".to_owned();
            return Err(FemError::Length { what, found: guess.len(), expected }.into());
        }
        how.near.map_or(Ok(()), |near| self.checks().check_state(near))
    }

    /// Refuses changes of controls of another body.
    pub(crate) fn check_control_change(&self, controls: &Controls) -> Result<(), StateError> {
        if !controls.fits(&self.controls()) {
            let what = "the controls belong to another body; make them with Solid::controls".to_owned();
            return Err(nastic_body::error::FemError::Meaningless { what }.into());
        }
        for k in 0..controls.len() {
            let what = format!("control of actuation \"{}\"", self.controllable()[k].name);
            nastic_body::controls::check_finite(&what, controls.values(k))?;
        }
        Ok(())
    }
}

impl Checks<'_> {
    /// Refuses a state of another body.
    pub fn check_state(&self, state: &State) -> Result<(), StateError> {
        let expected = self.model.unknowns().len();
        if state.u.len() != expected {
            let what = "displacement of a state".to_owned();
            return Err(FemError::Length { what, found: state.u.len(), expected }.into());
        }
        self.check_controls(&state.controls)
    }

    /// Refuses controls of another body, and tendons that would push.
    pub fn check_controls(&self, controls: &Controls) -> Result<(), StateError> {
        self.model.check_control_change(controls)?;
        Ok(self.model.prescribed_unknowns().check_own_controls(controls)?)
    }
}
