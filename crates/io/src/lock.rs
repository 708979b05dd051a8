//! The lock of an output directory: one program at a time writes there.

use crate::error::WriteError;
use crate::own_file;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The file that is locked. It stays behind: a program that removed it could remove the one that another program has just
/// locked.
const NAME: &str = ".lock";

/// A held lock. The system releases it when it is dropped or the process ends, however that comes about.
#[derive(Debug)]
pub struct DirectoryLock {
    _file: File,
    held: bool,
}

/// Why a directory cannot be locked.
#[derive(Debug, Error)]
pub enum LockError {
    /// The file that is locked cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Another program holds the lock.
    #[error("{} is in use by another program{}", directory.display(), process.map_or_else(String::new, |process| format!(" (process {process})")))]
    InUse {
        /// The directory.
        directory: PathBuf,
        /// The other program, where its number is known.
        process: Option<u32>,
    },
}

impl DirectoryLock {
    /// Whether a program locks or has locked a directory.
    #[must_use]
    pub fn is_there(directory: &Path) -> bool {
        directory.join(NAME).exists()
    }

    /// Locks a directory that exists.
    ///
    /// # Errors
    /// [`LockError`]: another program holds the lock, or its file cannot be made.
    pub fn acquire(directory: &Path) -> Result<Self, LockError> {
        let path = directory.join(NAME);
        let fail = |source| LockError::from(WriteError::System { file: path.clone(), source });
        let mut how = OpenOptions::new();
        let mut file = own_file::open(&path, how.read(true).write(true).create(true).truncate(false)).map_err(fail)?;
        let held = match file.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => {
                return Err(LockError::InUse { directory: directory.to_owned(), process: process(&mut file) });
            }
            // A file system without locks: two programs do not notice each other there.
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => false,
            Err(TryLockError::Error(error)) => return Err(fail(error)),
        };
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(fail)?;
        if !text.iter().all(|byte| byte.is_ascii_digit() || *byte == b'\n') {
            let what = "nastic locks the directory by a file of this name, and this is another; give it another name";
            return Err(fail(io::Error::new(io::ErrorKind::InvalidData, what)));
        }
        // Who holds it is for the message to others alone.
        let _ = file.set_len(0).and_then(|()| file.rewind()).and_then(|()| writeln!(file, "{}", std::process::id()));
        Ok(Self { _file: file, held })
    }

    /// Whether no other program can write there; false on a file system without locks.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.held
    }
}

/// The process that holds a lock, as it noted there.
fn process(file: &mut File) -> Option<u32> {
    let mut text = String::new();
    file.read_to_string(&mut text).ok()?;
    text.trim().parse().ok()
}
