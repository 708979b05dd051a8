//! [`WrittenFiles`]: which files of a directory are nastic's, so that those of others stay.

use crate::atomic::write_atomically;
use crate::error::WriteError;
use crate::own_file;
use std::collections::BTreeSet;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The list. It stays behind.
const NAME: &str = ".written";
const HEAD: &str = "# files of this directory that nastic wrote";

/// The names of the files that nastic wrote into a directory, kept there in `.written`: a line `+ NAME` before a file is written for
/// the first time, `- NAME` behind one that was removed, so that a program that is killed leaves the list complete.
#[derive(Debug)]
pub struct WrittenFiles {
    file: PathBuf,
    names: Mutex<BTreeSet<String>>,
}

impl WrittenFiles {
    /// Those of a directory, as far as they are still there.
    ///
    /// # Errors
    /// [`WriteError::System`]: a list that cannot be read, or a file of its name that nastic did not write.
    pub fn of(directory: &Path) -> Result<Self, WriteError> {
        let file = directory.join(NAME);
        let fail = |source| WriteError::system(&file, source);
        let text = match std::fs::read_to_string(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
            read => read.map_err(fail)?,
        };
        if !text.is_empty() && !text.starts_with(HEAD) {
            let what = "nastic keeps a list of its files under this name, and this is none; give it another name";
            return Err(fail(io::Error::new(io::ErrorKind::InvalidData, what)));
        }
        let mut names = BTreeSet::new();
        for line in text.lines() {
            if let Some(name) = line.strip_prefix("+ ") {
                names.insert(name.to_owned());
            } else if let Some(name) = line.strip_prefix("- ") {
                names.remove(name);
            }
        }
        // whoever removed a file may have put their own in its place since the next program looked
        names.retain(|name| directory.join(name).symlink_metadata().is_ok());
        Ok(Self { file, names: Mutex::new(names) })
    }

    /// For a directory whose list another process has read.
    #[must_use]
    pub fn of_another(directory: &Path) -> Self {
        Self { file: directory.join(NAME), names: Mutex::default() }
    }

    /// Whether nastic wrote a file of that name.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.names().contains(name)
    }

    /// Writes the list anew.
    ///
    /// # Errors
    /// [`WriteError::System`].
    pub fn save(&self) -> Result<(), WriteError> {
        let names = self.names();
        write_atomically(&self.file, |out| {
            writeln!(out, "{HEAD}")?;
            names.iter().try_for_each(|name| writeln!(out, "+ {name}"))
        })
    }

    /// Notes a file that is to be written.
    ///
    /// # Errors
    /// [`WriteError::System`].
    pub fn add(&self, name: &str) -> Result<(), WriteError> {
        let mut names = self.names();
        if !names.contains(name) {
            self.note('+', name)?;
            names.insert(name.to_owned());
        }
        Ok(())
    }

    /// Notes a file that was removed.
    ///
    /// # Errors
    /// [`WriteError::System`].
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        if self.names().remove(name) { self.note('-', name) } else { Ok(()) }
    }

    fn note(&self, sign: char, name: &str) -> Result<(), WriteError> {
        let written = own_file::open(&self.file, OpenOptions::new().append(true).create(true)).and_then(|mut file| {
            let head = if file.metadata()?.len() == 0 { HEAD } else { "" };
            // in one piece, as other processes may add to it; the line begins anew, behind a part that a full disk left
            file.write_all(format!("{head}\n{sign} {name}\n").as_bytes())
        });
        written.map_err(|source| WriteError::system(&self.file, source))
    }

    fn names(&self) -> MutexGuard<'_, BTreeSet<String>> {
        self.names.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
