//! Why a study has no result.

use crate::run::error::RunError;
use crate::saved::CheckpointError;
use nastic_case::lower::AssemblyError;
use nastic_ensemble::EnsembleError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a [`Study`](crate::run::study::Study) has no result.
#[derive(Debug, Error)]
pub enum StudyError {
    /// The body is incomplete, or has nothing to control.
    #[error(transparent)]
    Problem(#[from] EnsembleError),
    /// A set or a start of a control that there is not.
    #[error("there is no control \"{name}\"; there are: {known}")]
    UnknownControl {
        /// The name.
        name: String,
        /// The names there are.
        known: String,
    },
    /// A start of another length than the control vector.
    #[error("the start has {found} values, the control vector {expected}")]
    Length {
        /// Values of the start.
        found: usize,
        /// Values of the control vector.
        expected: usize,
    },
    /// Members, a set, a start, a control or a probe that do not fit.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// The derivative does not belong to the cost, so nothing was optimised.
    #[error(
        "the derivative at the start does not belong to the cost, so nothing was optimised{}: test each cost alone \
         with Taylor::test; a cost with a kink at the start is refused too: start elsewhere", mismatch_text(.mismatch)
    )]
    Derivative {
        /// Relative difference between the derivative and a difference quotient.
        mismatch: Option<f64>,
    },
    /// The directory holds an interrupted optimisation.
    #[error(
        "{} holds the checkpoint of an interrupted optimisation (iteration {iteration}): go on with it by Study::resume, begin anew with \
         Study::restart(true), or choose another directory", directory.display()
    )]
    Interrupted {
        /// The directory.
        directory: PathBuf,
        /// Iteration of the checkpoint.
        iteration: usize,
    },
    /// The checkpoint is of another problem.
    #[error(
        "the checkpoint in {} is of another problem: {}; put it back, begin anew with Study::restart(true), or choose another directory",
        directory.display(), what.join("; ")
    )]
    Changed {
        /// The directory.
        directory: PathBuf,
        /// What differs.
        what: Vec<String>,
    },
    /// The checkpoint is of another version of the library, which may not give the same bits.
    #[error(
        "{} was written by version {found} of the library, this is version {}: build with that one, begin anew with Study::restart(true), \
         or choose another directory", file.display(), env!("CARGO_PKG_VERSION")
    )]
    Version {
        /// The checkpoint.
        file: PathBuf,
        /// The version that wrote it.
        found: String,
    },
    /// The checkpoint cannot be read, or is not what this problem would have written.
    #[error("{0}; begin anew with Study::restart(true), or choose another directory")]
    Checkpoint(#[source] CheckpointError),
    /// All else that can go wrong in an optimisation.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl StudyError {
    /// What a command of a case file would answer, in terms of the library.
    pub(super) fn of(error: RunError) -> Self {
        match error {
            RunError::Interrupted { directory, iteration } => Self::Interrupted { directory, iteration },
            RunError::Checkpoint(error) | RunError::UnreadableCheckpoint(error) => Self::of_checkpoint(error),
            other => Self::Run(other),
        }
    }

    fn of_checkpoint(error: CheckpointError) -> Self {
        match error {
            CheckpointError::Changed { directory, what } => Self::Changed { directory, what },
            CheckpointError::Program { file, found } => Self::Version { file, found },
            other => Self::Checkpoint(other),
        }
    }
}

fn mismatch_text(mismatch: &Option<f64>) -> String {
    mismatch.map_or_else(String::new, |mismatch| format!(" (relative difference {mismatch:.1e})"))
}
