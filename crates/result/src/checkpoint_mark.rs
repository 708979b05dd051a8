//! What checkpoints begin with.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The magic word.
pub const MAGIC: &[u8] = b"nastic-checkpoint";

/// Whether a file begins as checkpoints do.
pub(crate) fn is_checkpoint(file: &Path) -> bool {
    let mut head = [0; MAGIC.len()];
    let is_plain = file.symlink_metadata().is_ok_and(|found| found.is_file());
    is_plain && File::open(file).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == *MAGIC
}
