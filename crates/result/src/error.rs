//! Why a file of a result was not written.

use nastic_control::ControlError;
use nastic_io::WriteError;
use thiserror::Error;

/// Why a file of a result was not written.
#[derive(Debug, Error)]
pub enum ResultError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// An array does not fit its mesh.
    #[error(transparent)]
    Snapshot(#[from] ControlError),
}
