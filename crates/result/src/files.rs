//! The output directory.

use crate::checkpoint_mark::is_checkpoint;
use crate::listed::listed;
use nastic_case::output_names::OutputNames;
use nastic_io::{DirectoryLock, LockError, PrintedBody, WriteError, WrittenFiles, write_atomically};
use nastic_mesh::{ClosedSurface, Snapshot};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Why a directory cannot be used.
#[derive(Debug, Error)]
pub enum DirectoryError {
    /// Another program is at work there, or it cannot be locked.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// Nothing can be written there.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A file that is read has the name of one that is to be written there.
    #[error("{} would be replaced", file.display())]
    Input {
        /// The file.
        file: PathBuf,
    },
    /// Files that nastic did not write have such names.
    #[error("{} would be replaced", files.first().map_or_else(String::new, |file| file.display().to_string()))]
    Others {
        /// The files.
        files: Vec<PathBuf>,
    },
}

/// Where the files of a command go. While it or a clone of it exists, no other program writes there.
#[derive(Clone, Debug)]
pub struct Directory {
    path: PathBuf,
    _lock: Option<Arc<DirectoryLock>>,
    /// What may be written and removed there.
    names: OutputNames,
    written: Arc<WrittenFiles>,
}

impl Directory {
    /// Makes the directory and locks it now, so that a place that cannot be written to, or that another program writes
    /// to, is reported before hours of work; and so is one where what the command writes would replace what
    /// it reads, or what nastic did not write.
    ///
    /// # Errors
    /// Each of these.
    pub fn claim<'f>(
        path: PathBuf,
        names: OutputNames,
        inputs: impl IntoIterator<Item = &'f Path>,
    ) -> Result<Self, DirectoryError> {
        if let Some(file) = names.replaced(&path, inputs) {
            return Err(DirectoryError::Input { file });
        }
        // before anything is written there
        if let Err(others) = refuse_others(&path, &names, &WrittenFiles::of(&path)?) {
            // a program at work there writes files behind the list that was just read, and is the reason then
            if DirectoryLock::is_there(&path) {
                DirectoryLock::acquire(&path)?;
            }
            return Err(others);
        }
        let mut out = Self::lock(path)?;
        out.take_names(names)?;
        Ok(out)
    }

    /// Makes the directory and locks it, before it is known what is written there.
    ///
    /// # Errors
    /// It cannot be made, locked or written to.
    pub fn lock(path: PathBuf) -> Result<Self, DirectoryError> {
        std::fs::create_dir_all(&path).map_err(|source| WriteError::System { file: path.clone(), source })?;
        let lock = DirectoryLock::acquire(&path)?;
        if lock.is_held() {
            remove_parts(&path);
        }
        let written = WrittenFiles::of(&path)?;
        // whether anything can be written there
        written.save()?;
        Ok(Self { path, _lock: Some(Arc::new(lock)), names: OutputNames::default(), written: Arc::new(written) })
    }

    /// Says what is written there.
    ///
    /// # Errors
    /// [`DirectoryError::Others`].
    pub fn take_names(&mut self, names: OutputNames) -> Result<(), DirectoryError> {
        refuse_others(&self.path, &names, &self.written)?;
        self.names = names;
        Ok(())
    }

    /// A directory that another rank of the team has claimed.
    pub fn of_another(path: &Path, names: OutputNames) -> Self {
        Self { path: path.to_owned(), _lock: None, names, written: Arc::new(WrittenFiles::of_another(path)) }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A file in it, to be read.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// A file in it that is to be written.
    ///
    /// # Errors
    /// The list of what nastic wrote there cannot be written.
    pub fn own(&self, name: &str) -> Result<PathBuf, WriteError> {
        debug_assert!(self.has(name), "{name} is none of the names that were claimed");
        self.written.add(name)?;
        Ok(self.file(name))
    }

    /// Whether files of that name are written there.
    pub fn has(&self, name: &str) -> bool {
        self.names.has(name)
    }

    /// Removes what an earlier run left that this one may not overwrite: iterations, states of a failure, designs.
    pub fn remove_old_iterations(&self) {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let number = name.rsplit_once("iteration_").and_then(|(_, rest)| rest.strip_suffix(".vtu"));
            let ours = number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()));
            let collection = name == "iterations.pvd" || name.ends_with("_iterations.pvd");
            let iterates = name == "iterates.bin" || name.ends_with("_iterates.bin");
            let design = [".stl", ".3mf"].iter().any(|end| name.ends_with(end))
                || (name.starts_with("directions_") && name.ends_with(".csv"));
            if ours || collection || iterates || design || name == "failure.vtu" {
                let _ = self.remove(&name);
            }
        }
    }

    /// Removes the snapshots `STEM0000.vtu` .. that an earlier run left, from this number on, with what stood beside them.
    pub fn remove_numbered(&self, stem: &str, from: usize) {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let number = name.strip_prefix(stem).and_then(|rest| rest.strip_suffix(".vtu"));
            let number = number.map(|rest| rest.trim_end_matches("_lines").trim_end_matches("_obstacles"));
            if number.and_then(|number| number.parse::<usize>().ok()).is_some_and(|number| number >= from) {
                let _ = self.remove(&name);
            }
        }
    }

    /// Removes a file, if it is there and of a name that is written there.
    ///
    /// # Errors
    /// What the system answers.
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        if !self.has(name) {
            return Ok(());
        }
        let file = self.file(name);
        match std::fs::remove_file(&file) {
            Err(source) if source.kind() == std::io::ErrorKind::NotFound => Ok(()),
            Err(source) => Err(WriteError::System { file, source }),
            Ok(()) => self.written.remove(name),
        }
    }

    /// A value as JSON.
    ///
    /// # Errors
    /// What the system answers.
    pub fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), WriteError> {
        write_atomically(self.own(name)?, |out| {
            serde_json::to_writer_pretty(&mut *out, value)?;
            out.write_all(b"\n")
        })
    }

    /// A snapshot.
    ///
    /// # Errors
    /// What the system answers.
    pub fn write_vtu(&self, name: &str, snapshot: &Snapshot) -> Result<(), WriteError> {
        nastic_io::write_vtu(self.own(name)?, snapshot)
    }

    /// A closed surface, its lengths multiplied by a factor.
    ///
    /// # Errors
    /// What the system answers.
    pub fn write_stl(&self, name: &str, surface: &ClosedSurface, scale: f64) -> Result<(), WriteError> {
        nastic_io::write_stl(self.own(name)?, surface, scale)
    }

    /// Bodies of several materials, their lengths multiplied by a factor.
    ///
    /// # Errors
    /// What the system answers.
    pub fn write_3mf(&self, name: &str, title: &str, bodies: &[PrintedBody], scale: f64) -> Result<(), WriteError> {
        nastic_io::write_3mf(self.own(name)?, title, bodies, scale)
    }

    /// A text.
    ///
    /// # Errors
    /// What the system answers.
    pub fn write_text(&self, name: &str, text: &str) -> Result<(), WriteError> {
        write_atomically(self.own(name)?, |out| out.write_all(text.as_bytes()))
    }

    /// A state `NAME.vtu`, and what is beside it; the names of the files.
    ///
    /// # Errors
    /// What the system answers.
    pub fn write_state(&self, name: &str, snapshot: &Snapshot) -> Result<Vec<String>, WriteError> {
        self.write_vtu(&format!("{name}.vtu"), snapshot)?;
        match snapshot.lines.is_empty() {
            false => nastic_io::write_lines(self.own(&lines_of(name))?, &snapshot.lines)?,
            true => self.remove(&lines_of(name))?,
        }
        match &snapshot.obstacles {
            Some(mesh) => self.write_vtu(&obstacles_of(name), &Snapshot::new(mesh.clone()))?,
            None => self.remove(&obstacles_of(name))?,
        }
        Ok(state_files(name, Beside::of(snapshot)))
    }
}

/// Whether files that nastic did not write would be replaced.
fn refuse_others(path: &Path, names: &OutputNames, written: &WrittenFiles) -> Result<(), DirectoryError> {
    let Ok(entries) = std::fs::read_dir(path) else { return Ok(()) };
    let listed = listed(path);
    let is_other = |name: &str| {
        names.has(name)
            && !written.has(name)
            && !listed.iter().any(|one| one == name)
            && !is_checkpoint(&path.join(name))
    };
    // a directory in the way is never replaced: what is to be written there fails
    let plain = entries.flatten().filter(|entry| entry.file_type().is_ok_and(|kind| !kind.is_dir()));
    let found = plain.filter_map(|entry| entry.file_name().into_string().ok());
    let mut others: Vec<String> = found.filter(|name| is_other(name)).collect();
    others.sort();
    let files: Vec<PathBuf> = others.iter().map(|name| path.join(name)).collect();
    if files.is_empty() { Ok(()) } else { Err(DirectoryError::Others { files }) }
}

/// What a state has beside its body.
#[derive(Debug, Clone, Copy)]
pub struct Beside {
    /// Lines: cables, springs.
    pub lines: bool,
    /// Obstacles that move.
    pub obstacles: bool,
}

impl Beside {
    /// What a snapshot has.
    pub fn of(snapshot: &Snapshot) -> Self {
        Self { lines: !snapshot.lines.is_empty(), obstacles: snapshot.obstacles.is_some() }
    }
}

/// The files of a state: `NAME.vtu`, `NAME_lines.vtu` where it has lines, `NAME_obstacles.vtu` where obstacles move.
pub fn state_files(name: &str, beside: Beside) -> Vec<String> {
    let others = [beside.lines.then(|| lines_of(name)), beside.obstacles.then(|| obstacles_of(name))];
    std::iter::once(format!("{name}.vtu")).chain(others.into_iter().flatten()).collect()
}

fn lines_of(name: &str) -> String {
    format!("{name}_lines.vtu")
}

fn obstacles_of(name: &str) -> String {
    format!("{name}_obstacles.vtu")
}

/// Removes unfinished files that a killed program left: `.NAME.PROCESS.COUNT.part`, as [`write_atomically`] calls them.
fn remove_parts(directory: &Path) {
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let mut parts = name.to_str().unwrap_or("").rsplit('.');
        let is_part =
            parts.next() == Some("part") && parts.by_ref().take(2).filter(|part| is_number(part)).count() == 2;
        if is_part && name.to_string_lossy().starts_with('.') {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
