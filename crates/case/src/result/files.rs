//! The output directory.

use nastic_io::{WriteError, write_atomically};
use nastic_mesh::Snapshot;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Where the files of a command go.
#[derive(Clone, Debug)]
pub(crate) struct Directory(PathBuf);

impl Directory {
    pub fn new(path: PathBuf) -> Self {
        Self(path)
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// A file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Makes the directory now, so that a place that cannot be written to is told before hours of work.
    pub fn create(&self) -> Result<(), WriteError> {
        std::fs::create_dir_all(&self.0).map_err(|source| WriteError::System { file: self.0.clone(), source })?;
        let probe = self.file(".nastic");
        write_atomically(&probe, |_| Ok(())).map(|()| {
            let _ = std::fs::remove_file(&probe);
        })
    }

    /// Removes what an earlier run left that this one may not overwrite.
    pub fn remove_old_iterations(&self) {
        let Ok(entries) = std::fs::read_dir(&self.0) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let number = name.rsplit_once("iteration_").and_then(|(_, rest)| rest.strip_suffix(".vtu"));
            let ours = number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()));
            let collection = name == "iterations.pvd" || name.ends_with("_iterations.pvd");
            if ours || collection || name == "failure.vtu" {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }

    /// Removes the snapshots `STEM0000.vtu` .. that an earlier run left.
    pub fn remove_numbered(&self, stem: &str) {
        let Ok(entries) = std::fs::read_dir(&self.0) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let number = name.strip_prefix(stem).and_then(|rest| rest.strip_suffix(".vtu"));
            if number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit())) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }

    pub fn write_json(&self, name: &str, value: &Value) -> Result<(), WriteError> {
        let text = format!("{value:#}\n");
        write_atomically(self.file(name), |out| out.write_all(text.as_bytes()))
    }

    pub fn write_vtu(&self, name: &str, snapshot: &Snapshot) -> Result<(), WriteError> {
        nastic_io::write_vtu(self.file(name), snapshot)
    }
}
