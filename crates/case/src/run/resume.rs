//! `nastic resume`: an optimisation that was interrupted goes on from its last checkpoint.

use super::error::RunError;
use super::optimize::{Checkpoint, Position};
use super::session::Session;
use crate::catalogue::Catalogue;
use crate::console::Console;
use crate::result::checkpoint_file::{self, CheckpointError};
use crate::result::files::Directory;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Reads the checkpoint of an output directory and the case it belongs to.
pub(super) fn open<'c>(
    catalogue: &Catalogue,
    directory: &Path,
    cancel: Arc<AtomicBool>,
    console: &'c Console,
) -> Result<(Session<'c>, Option<Position>), RunError> {
    let (out, Checkpoint { case, position, .. }) = read(directory)?;
    let document = case.reopen(catalogue, directory)?;
    let session = Session::resume(document, case.settings, out, cancel, console)?;
    Ok((session, position))
}

/// Claims an output directory and reads its checkpoint.
pub(super) fn read(directory: &Path) -> Result<(Directory, Checkpoint), RunError> {
    let file = directory.join(checkpoint_file::NAME);
    if !file.is_file() {
        // A name that was mistyped is not made a directory.
        return Err(CheckpointError::Missing { directory: directory.to_owned() }.into());
    }
    let out = Directory::claim(directory.to_owned())?;
    let checkpoint = Checkpoint::read(directory)?;
    if checkpoint.case.program != env!("CARGO_PKG_VERSION") {
        return Err(CheckpointError::Program { file, found: checkpoint.case.program }.into());
    }
    Ok((out, checkpoint))
}
