//! The errors of evaluations that failed and of checkpoints that do not fit; the last good state is kept on disk.

use crate::run::error::RunError;
use crate::run::session::destination::Destination;
use crate::run::session::input::CommandInput;
use crate::saved;
use crate::saved::CheckpointError;
use nastic_case::lower::CaseMember;
use nastic_control::{ControlError, StateFields};
use nastic_ensemble::EnsembleError;
use nastic_fem::StateError;
use nastic_opt::Failed;
use nastic_result::failure;
use std::path::PathBuf;

impl Destination {
    /// The error of an evaluation that failed; the last good state of the member at fault is kept on disk.
    pub fn forward_failed(&self, input: &CommandInput, error: EnsembleError) -> RunError {
        match error {
            EnsembleError::Member { who, source } => {
                let at = input.problem.ensemble.members().iter().position(|part| part.name() == who);
                self.member_failed(input, at.unwrap_or(0), *source)
            }
            EnsembleError::Team(error) => error.into(),
            other => {
                let error = Box::new(ControlError::Cost { what: other.to_string() });
                RunError::Forward { member: String::new(), of: String::new(), error, file: None }
            }
        }
    }

    /// The error of a checkpoint that is whole but not of this case, unless the reading of it was cancelled.
    pub fn unfit_checkpoint(&self, input: &CommandInput, what: &str) -> RunError {
        if input.is_cancelled() {
            return RunError::Cancelled;
        }
        let file = self.out.as_ref().map(|out| out.file(saved::NAME)).unwrap_or_default();
        CheckpointError::Content { file, what: what.to_owned() }.into()
    }

    /// The same, of an evaluation.
    pub fn evaluation_failed(&self, input: &CommandInput, failed: &Failed) -> RunError {
        match failed.downcast_ref::<EnsembleError>() {
            Some(error) => self.forward_failed(input, error.clone()),
            None => {
                let error = Box::new(ControlError::Cost { what: failed.to_string() });
                RunError::Forward { member: String::new(), of: String::new(), error, file: None }
            }
        }
    }

    /// The same, of a member.
    pub fn member_failed(&self, input: &CommandInput, index: usize, error: ControlError) -> RunError {
        if let ControlError::State(StateError::Cancelled) = error {
            return RunError::Cancelled;
        }
        let member = input.problem.member(index);
        // The start control is what was asked for; the state shows how far the body came.
        let write = |state| self.write_failure(member, "failure.vtu", &member.local(&input.problem.start), state);
        let file = match if let ControlError::State(state) = &error { write(state) } else { Ok(None) } {
            Ok(file) => file,
            Err(error) => return error,
        };
        let of = (member.words() + &input.on_rank(&error)).trim_start().to_owned();
        RunError::Forward { member: member.name(), of, error: Box::new(error), file }
    }

    /// Writes the last good state of a solve that failed, if there is one; the file it is in.
    pub fn write_failure(
        &self,
        member: CaseMember<'_>,
        name: &str,
        m: &[f64],
        error: &StateError,
    ) -> Result<Option<PathBuf>, RunError> {
        let (Some(out), Some(last)) = (&self.own_out, failure::last_state(error)) else { return Ok(None) };
        out.write_vtu(name, &failure::snapshot(member, &StateFields::new(last, m, 0), error)?)?;
        Ok(Some(out.file(name)))
    }
}
